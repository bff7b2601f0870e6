// The word of a pixel in the plan and in the counts that the plan is made from. `PlanWord` of src/host/plan.rs has
// the same accessors.
//
// - Bits 0 to 7: k.
// - Bits 8 to 11: the reason for k, DAA_BY_*. With `Selective`: the attribute whose threshold applies to the first
//   active quadrant, counted from 1.
// - Bits 12 to 14: the lattice that the pixel's point was chosen on.
// - Bit 15: whether the pixel's point was shaded.
// - Bits 16 to 19: in a plan of `Selective`, the active quadrants, a bit each.
// - Bits 20 to 31: in a plan, the number of the tile's samples before this window's, without first ones: at most 64 · 63.
// - Bits 16 to 31: in counts, the k that was wanted (`daa_wanted_code`).

const DAA_BY_NOTHING: u32 = 0u;
const DAA_BY_DEPTH: u32 = 1u;
const DAA_BY_NORMAL: u32 = 2u;
const DAA_BY_LUMINANCE: u32 = 3u;
const DAA_BY_IDENTITY: u32 = 4u;
const DAA_BY_LEAST: u32 = 5u;
const DAA_BY_SHADOW: u32 = 6u;
const DAA_BY_USER: u32 = 7u;
/// The number of reasons.
const DAA_REASONS: u32 = 8u;

fn daa_plan_word(k: u32, reason: u32, quadrants: u32, before: u32) -> u32 {
    return k | (reason << 8u) | (quadrants << 16u) | (before << 20u);
}

/// The word with the number of the tile's samples before this window's.
fn daa_plan_word_before(word: u32, before: u32) -> u32 {
    return word | (before << 20u);
}

fn daa_count_word(k: u32, reason: u32, wanted: u32) -> u32 {
    return k | (reason << 8u) | (wanted << 16u);
}

/// The reason for k together with the lattice of the pixel's point.
fn daa_lattice_reason(by: u32, level: u32, own: u32) -> u32 {
    return by | (level << 4u) | (own << 7u);
}

fn daa_plan_k(word: u32) -> u32 {
    return word & 0xffu;
}

/// The reason for k together with the lattice.
fn daa_plan_reason(word: u32) -> u32 {
    return (word >> 8u) & 0xffu;
}

/// The reason for k alone.
fn daa_plan_by(word: u32) -> u32 {
    return (word >> 8u) & 15u;
}

/// The lattice that the pixel's point was chosen on: `Level` of src/gpu/uniforms/lattice.rs.
fn daa_plan_level(word: u32) -> u32 {
    return (word >> 12u) & 7u;
}

/// Whether the pixel's point was shaded instead of interpolated.
fn daa_plan_own(word: u32) -> bool {
    return (word & 0x8000u) != 0u;
}

/// The number of the tile's samples, without first ones, before this window's.
fn daa_plan_before(word: u32) -> u32 {
    return word >> 20u;
}

/// The active quadrants, a bit each.
fn daa_plan_quadrants(word: u32) -> u32 {
    return (word >> 16u) & 15u;
}

/// For counts: the k that was wanted, before it was limited to n, as 16 bits on a log scale. The audit computes from it
/// the k at a lower effort.
fn daa_wanted_code(k: f32) -> u32 {
    return u32(clamp(log2(k), 0.0, 31.0) * 2048.0);
}

fn daa_wanted_log2(word: u32) -> f32 {
    return f32(word >> 16u) / 2048.0;
}
