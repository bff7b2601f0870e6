// Stands in for shadows.wgsl in frames without shadow rays.

fn daa_shadow_bits(pixel: vec2u, rank: u32) -> u32 {
    return 0u;
}
