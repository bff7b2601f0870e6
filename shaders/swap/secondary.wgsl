// What `bounce` found, for those who shade.

@group(0) @binding(6) var<storage, read> daa_traced_secondary: array<u32>;

/// What is seen, reflected and refracted.
const DAA_KINDS: u32 = 3u;

fn daa_secondary_code(pixel: vec2u, rank: u32) -> u32 {
    return daa_traced_secondary[daa_sample_index(pixel, rank)];
}

/// What the first sample's mirrored (kind 0) or refracted (1) ray met: object | material << 16, normal, shadow bits. 0:
/// nothing.
fn daa_secondary_hit(pixel: vec2u, kind: u32) -> vec3u {
    // Behind the codes of all samples, word by word.
    let word = DAA_M * DAA_M + kind * 3u;
    return vec3u(
        daa_traced_secondary[daa_sample_index(pixel, word)],
        daa_traced_secondary[daa_sample_index(pixel, word + 1u)],
        daa_traced_secondary[daa_sample_index(pixel, word + 2u)],
    );
}
