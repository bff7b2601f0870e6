/// Texture coordinates are not kept.
fn daa_stored_uv(at: vec2u) -> vec4u {
    return vec4u(0u);
}
