// Counters that the passes add to. Integers, so that the order of the additions cannot show.

struct DaaStatistics {
    /// Windows with k = index + 1.
    histogram: array<atomic<u32>, 64>,
    /// Samples that the host's code returned with NaN or infinity.
    not_finite: atomic<u32>,
    /// Samples that the host's code returned with a negative component.
    negative: atomic<u32>,
    /// Tiles that wanted more samples than the limit and fell back to k = 1.
    overflowed_tiles: atomic<u32>,
    /// Windows whose k was decided by: nothing, depth, normal, luminance, identity, the least allowed, shadow.
    decided: array<atomic<u32>, 7>,
    /// Rays towards lights.
    shadow_rays: atomic<u32>,
    /// Rays from mirrors.
    reflection_rays: atomic<u32>,
    /// Rays into what is transparent.
    refraction_rays: atomic<u32>,
    /// Tiles with a surface, and with one that sends rays.
    tiles: array<atomic<u32>, 2>,
    /// Active quadrants by what their threshold is for: colour, then object, normal, shadow, texture, then these of what is reflected
    /// and refracted.
    quadrants: array<atomic<u32>, 9>,
    /// Points of lattices that were shaded, by `Level` of src/gpu/uniforms/lattice.rs.
    points: array<atomic<u32>, 5>,
}
