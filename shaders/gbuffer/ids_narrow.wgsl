/// The number of bits for the triangle; the higher ones are the instance's.
override DAA_TRIANGLE_BITS: u32 = 16u;

/// Index of the instance + 1, 0 where nothing is drawn, and index of the triangle.
fn daa_ids_at(at: vec2u) -> vec2u {
    let word = textureLoad(daa_gbuffer_ids, at, 0).x;
    return vec2u(word >> DAA_TRIANGLE_BITS, word & ((1u << DAA_TRIANGLE_BITS) - 1u));
}
