// What a fragment of a forward pass shows: lit by the functions that light all others, but for what takes rays: no light
// is shadowed, and only the sky is mirrored. Joined with the contract, the texture table, material.wgsl, textured.wgsl,
// shading.wgsl and vertices.wgsl.

/// The greatest value that the target holds.
const MOST: f32 = 65504.0;

/// Radiance, and alpha that it is not multiplied by.
fn shaded(v: Varying, front: bool) -> vec4f {
    let instance = instances[v.instance];
    let own = facing(v, front, dpdx(v.relative), dpdy(v.relative));
    var s: DaaSample;
    s.position = v.relative + lighting.camera;
    s.depth = -dot(v.relative, view.orthographic.xyz);
    s.relative_position = v.relative;
    s.material = instance.material;
    s.view = normalize(towards_camera(v.relative));
    s.object = instance.object;
    s.geometric_normal = normalize(own.geometric_normal);
    s.user = pack4x8unorm(v.color);
    s.normal = normalize(own.normal);
    s.tangent = own.tangent;
    s.uv = v.uv;
    s.ddx = dpdx(v.uv);
    s.ddy = dpdy(v.uv);
    s.pixel = vec2u(v.clip.xy);
    let m = material(s);
    let radiance = daa_radiance(light(daa_surface(s, 1.0), m), m).rgb;
    // NaN is not greater than 0.
    let clean = select(vec3f(0.0), min(radiance, vec3f(MOST)), radiance > vec3f(0.0));
    return vec4f(clean, clamp(m.base_color.a, 0.0, 1.0));
}
