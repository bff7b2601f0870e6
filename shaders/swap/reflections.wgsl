// The ray results of `reflect`, for the passes that shade.

@group(0) @binding(6) var<storage, read> daa_traced_reflections: array<u32>;

/// The kinds of surfaces that are compared: shown, reflected and refracted.
const DAA_KINDS: u32 = 3u;

fn daa_reflection_code(pixel: vec2u, rank: u32) -> u32 {
    return daa_traced_reflections[daa_result_index(pixel, rank)];
}

/// The surface that the first sample's mirrored (kind 0) or refracted (1) ray hit: object | material << 16, normal,
/// shadow bits. 0 if there is none.
fn daa_reflection_hit(pixel: vec2u, kind: u32) -> vec3u {
    // The hits lie behind the codes, word by word.
    let at = daa_frame.results.words + daa_sample_index(pixel, kind * 3u);
    let slots = daa_tile_count() * 64u;
    return vec3u(
        daa_traced_reflections[at],
        daa_traced_reflections[at + slots],
        daa_traced_reflections[at + 2u * slots],
    );
}
