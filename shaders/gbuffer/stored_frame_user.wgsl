@group(0) @binding(3) var daa_gbuffer_frame: texture_2d<u32>;

/// The host's 32 bits. The geometric normal and the tangent are not kept.
fn daa_stored_frame(at: vec2u) -> vec2u {
    return vec2u(0u, textureLoad(daa_gbuffer_frame, at, 0).x);
}
