// Stands in for reflections.wgsl in frames without reflections and refractions.

/// Only the shown surface is compared.
const DAA_KINDS: u32 = 1u;

fn daa_reflection_code(pixel: vec2u, rank: u32) -> u32 {
    return 0u;
}

fn daa_reflection_hit(pixel: vec2u, kind: u32) -> vec3u {
    return vec3u(0u);
}
