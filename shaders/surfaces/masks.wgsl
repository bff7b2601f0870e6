// The surfaces of windows, as `cover` finds them and `light` lights them. Declares no bindings.
//
// A word for each slot:
// - Bits 0 to 2: the number of surfaces, 0 where the window is not shown.
// - Bit 3: whether samples were merged into the last surface although they do not belong to it.
// - Bit 4: whether the window is lit, or not shown.
// - Bits 5 to 7: the number of surfaces that take their light from the corners of a block. Until the window is lit, bit 5
//   says whether its surface is cut into groups.
// - Bits 8 to 14: the number of lights.
// - Bits 16 to 31: the number of taps so far.
// Then, for the samples of each window, three bits of the surface's label: each of the three is a set of ranks. Then the
// corners of blocks, as light.wgsl has them.

/// The number of taps of a surface is at most this.
const DAA_MOST_TAPS: u32 = 16u;

fn daa_surface_word(surfaces: u32, merged: bool) -> u32 {
    return surfaces | select(0u, 8u, merged);
}

fn daa_surface_count(word: u32) -> u32 {
    return word & 7u;
}

fn daa_surface_merged(word: u32) -> bool {
    return (word & 8u) != 0u;
}

fn daa_surface_is_lit(word: u32) -> bool {
    return (word & 7u) == 0u || (word & 16u) != 0u;
}

fn daa_surface_lights(word: u32) -> u32 {
    return (word >> 8u) & 127u;
}

fn daa_surface_taps(word: u32) -> u32 {
    return word >> 16u;
}

fn daa_surface_interpolated(word: u32) -> u32 {
    return (word >> 5u) & 7u;
}

/// Whether the surface of a window that is not lit is cut into groups.
fn daa_surface_is_apart(word: u32) -> bool {
    return (word & 32u) != 0u;
}

/// The word of a window of one surface that so many taps could not light.
fn daa_surface_word_read(word: u32, taps: u32, apart: bool) -> u32 {
    return (word & 15u) | select(0u, 32u, apart) | (taps << 16u);
}

fn daa_surface_word_lit(word: u32, lights: u32, taps: u32, interpolated: u32) -> u32 {
    return (word & 15u) | 16u | (interpolated << 5u) | (lights << 8u) | (taps << 16u);
}

/// The index of the first word of a set of ranks of a slot.
fn daa_label_index(slot: u32, bit: u32) -> u32 {
    return (1u + bit * daa_set_words()) * daa_tile_count() * 64u + slot;
}

/// The number of words in a set: one holds up to 32 ranks.
fn daa_set_words() -> u32 {
    return select(1u, 2u, DAA_M > 5u);
}

/// All ranks of a window.
fn daa_all_ranks() -> vec2u {
    let n = DAA_M * DAA_M;
    return vec2u(0xffffffffu >> (32u - min(n, 32u)), select(0u, 0xffffffffu >> (64u - max(n, 33u)), n > 32u));
}
