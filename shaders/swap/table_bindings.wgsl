// The texture table on adapters with binding arrays. A slot is sampler << 16 | texture.

@group(1) @binding(0) var<storage, read> daa_texture_slots: array<u32>;
@group(1) @binding(1) var daa_textures: binding_array<texture_2d<f32>>;
@group(1) @binding(2) var daa_samplers: binding_array<sampler>;

/// Samples texture `index` of the table at `uv`, filtered over the footprint. It may be called with any index in any
/// control flow; an index beyond the table reads its last entry.
fn daa_texture(index: u32, uv: vec2f, ddx: vec2f, ddy: vec2f) -> vec4f {
    let slot = daa_texture_slots[min(index, arrayLength(&daa_texture_slots) - 1u)];
    return textureSampleGrad(daa_textures[slot & 0xffffu], daa_samplers[slot >> 16u], uv, ddx, ddy);
}
