@group(0) @binding(3) var daa_gbuffer_frame: texture_2d<u32>;

/// The geometric normal (octahedral, 8+8 bits) and the tangent (16 bits). The host's 32 bits are not kept.
fn daa_stored_frame(at: vec2u) -> vec2u {
    return vec2u(textureLoad(daa_gbuffer_frame, at, 0).x, 0u);
}
