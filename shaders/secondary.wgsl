// What `bounce` found, for those who shade.

@group(0) @binding(6) var<storage, read> daa_traced_secondary: array<u32>;

fn daa_secondary_code(pixel: vec2u, rank: u32) -> u32 {
    return daa_traced_secondary[daa_sample_index(pixel, rank)];
}
