// The ray results of `trace`, for the passes that shade.

@group(0) @binding(5) var<storage, read> daa_traced_shadows: array<u32>;

fn daa_shadow_bits(pixel: vec2u, rank: u32) -> u32 {
    return daa_traced_shadows[daa_result_index(pixel, rank)];
}
