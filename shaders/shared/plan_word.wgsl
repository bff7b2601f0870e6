// The word that the plan has for each pixel, and the counts before it. `PlanWord` of src/host/plan.rs reads the same.
//
// bits 0 to 7: k. Bits 8 to 11: what decided it, DAA_BY_*; of `Selective` what the threshold of the first active quadrant is for,
// from 1. Bits 12 to 14: the lattice that the pixel's point was chosen on, and bit 15: that it was shaded. Bits 16 to 31: of a plan
// the samples of the tile before this window's; of `Selective` the active quadrants, a bit each; of counts what was wanted.

const DAA_BY_NOTHING: u32 = 0u;
const DAA_BY_DEPTH: u32 = 1u;
const DAA_BY_NORMAL: u32 = 2u;
const DAA_BY_LUMINANCE: u32 = 3u;
const DAA_BY_IDENTITY: u32 = 4u;
const DAA_BY_LEAST: u32 = 5u;
const DAA_BY_SHADOW: u32 = 6u;

fn daa_plan_word(k: u32, reason: u32, rest: u32) -> u32 {
    return k | (reason << 8u) | (rest << 16u);
}

/// What decided k, with the lattice of its point.
fn daa_lattice_reason(by: u32, level: u32, own: u32) -> u32 {
    return by | (level << 4u) | (own << 7u);
}

fn daa_plan_k(word: u32) -> u32 {
    return word & 0xffu;
}

/// What decided k, and all that stands beside it.
fn daa_plan_reason(word: u32) -> u32 {
    return (word >> 8u) & 0xffu;
}

/// What decided k.
fn daa_plan_by(word: u32) -> u32 {
    return (word >> 8u) & 15u;
}

/// The lattice that the pixel's point was chosen on: `Level` of src/gpu/uniforms/lattice.rs.
fn daa_plan_level(word: u32) -> u32 {
    return (word >> 12u) & 7u;
}

/// Whether the pixel's point was shaded, and not interpolated.
fn daa_plan_own(word: u32) -> bool {
    return (word & 0x8000u) != 0u;
}

/// Samples of the tile, beyond first ones, before this window's.
fn daa_plan_before(word: u32) -> u32 {
    return word >> 16u;
}

/// Active quadrants, a bit each.
fn daa_plan_quadrants(word: u32) -> u32 {
    return (word >> 16u) & 15u;
}

/// Of counts: what was wanted before n cut it, on a log scale of 16 bits, since the audit asks what less effort would make of it.
fn daa_wanted_code(k: f32) -> u32 {
    return u32(clamp(log2(k), 0.0, 31.0) * 2048.0);
}

fn daa_wanted_log2(word: u32) -> f32 {
    return f32(word >> 16u) / 2048.0;
}
