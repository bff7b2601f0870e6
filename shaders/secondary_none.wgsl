// Nothing was reflected or refracted.

fn daa_secondary_code(pixel: vec2u, rank: u32) -> u32 {
    return 0u;
}
