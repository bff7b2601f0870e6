// display: from linear HDR to what a screen shows, as `picture::display` on the CPU. Alpha is the luma that FXAA looks
// at.

@group(0) @binding(0) var image: texture_2d<f32>;

/// ITU-R BT.601 luma of displayed values.
const LUMA = vec3f(0.299, 0.587, 0.114);
/// Where a float is an infinity or a NaN, all of these bits are set.
const EXPONENT = vec3u(0x7f800000u);

@vertex
fn display_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the view.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

/// IEC 61966-2-1.
fn srgb(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

@fragment
fn display_fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let radiance = textureLoad(image, vec2u(at.xy), 0).rgb;
    let not_finite = any((bitcast<vec3u>(radiance) & EXPONENT) == EXPONENT);
    let light = max(radiance, vec3f(0.0));
    let shown = select(srgb(light / (1.0 + light)), vec3f(1.0, 0.0, 1.0), not_finite);
    return vec4f(shown, dot(shown, LUMA));
}
