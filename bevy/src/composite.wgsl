// Draws the anti-aliased image over the camera's target, and its depth into the camera's depth texture, so that skybox,
// blended meshes and gizmos follow as they do after Bevy's own lighting.

@group(0) @binding(0) var image: texture_2d<f32>;
@group(0) @binding(1) var depth: texture_2d<f32>;
/// x, y: the first pixel of the viewport.
@group(0) @binding(2) var<uniform> view: vec4u;

struct Pixel {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> Pixel {
    let at = vec2u(position.xy) - view.xy;
    return Pixel(textureLoad(image, at, 0), textureLoad(depth, at, 0).x);
}
