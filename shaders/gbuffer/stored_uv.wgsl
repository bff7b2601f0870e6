@group(0) @binding(4) var daa_gbuffer_uv: texture_2d<u32>;

/// u and v as f32; the gradients as four f16.
fn daa_stored_uv(at: vec2u) -> vec4u {
    return textureLoad(daa_gbuffer_uv, at, 0);
}
