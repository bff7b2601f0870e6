// The texture table within the default WebGPU limits: one array texture and one sampler for each class of size, format,
// mip count and sampler. A slot is class << 16 | layer. Unused classes have a white texel.

@group(1) @binding(0) var<storage, read> daa_texture_slots: array<u32>;
@group(1) @binding(1) var daa_texture_0: texture_2d_array<f32>;
@group(1) @binding(2) var daa_texture_1: texture_2d_array<f32>;
@group(1) @binding(3) var daa_texture_2: texture_2d_array<f32>;
@group(1) @binding(4) var daa_texture_3: texture_2d_array<f32>;
@group(1) @binding(5) var daa_texture_4: texture_2d_array<f32>;
@group(1) @binding(6) var daa_texture_5: texture_2d_array<f32>;
@group(1) @binding(7) var daa_texture_6: texture_2d_array<f32>;
@group(1) @binding(8) var daa_sampler_0: sampler;
@group(1) @binding(9) var daa_sampler_1: sampler;
@group(1) @binding(10) var daa_sampler_2: sampler;
@group(1) @binding(11) var daa_sampler_3: sampler;
@group(1) @binding(12) var daa_sampler_4: sampler;
@group(1) @binding(13) var daa_sampler_5: sampler;
@group(1) @binding(14) var daa_sampler_6: sampler;

/// Samples texture `index` of the table at `uv`, filtered over the footprint. It may be called with any index in any
/// control flow; an index beyond the table reads its last entry.
fn daa_texture(index: u32, uv: vec2f, ddx: vec2f, ddy: vec2f) -> vec4f {
    let slot = daa_texture_slots[min(index, arrayLength(&daa_texture_slots) - 1u)];
    let layer = slot & 0xffffu;
    switch slot >> 16u {
        case 1u: { return textureSampleGrad(daa_texture_1, daa_sampler_1, uv, layer, ddx, ddy); }
        case 2u: { return textureSampleGrad(daa_texture_2, daa_sampler_2, uv, layer, ddx, ddy); }
        case 3u: { return textureSampleGrad(daa_texture_3, daa_sampler_3, uv, layer, ddx, ddy); }
        case 4u: { return textureSampleGrad(daa_texture_4, daa_sampler_4, uv, layer, ddx, ddy); }
        case 5u: { return textureSampleGrad(daa_texture_5, daa_sampler_5, uv, layer, ddx, ddy); }
        case 6u: { return textureSampleGrad(daa_texture_6, daa_sampler_6, uv, layer, ddx, ddy); }
        default: { return textureSampleGrad(daa_texture_0, daa_sampler_0, uv, layer, ddx, ddy); }
    }
}
