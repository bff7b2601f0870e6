// The counters that the passes add to. They are integers, so that the sums do not depend on the order.

struct DaaStatistics {
    /// Number of windows with k = index + 1.
    histogram: array<atomic<u32>, 64>,
    /// Number of samples for which the host's code returned NaN or infinity.
    not_finite: atomic<u32>,
    /// Number of samples for which the host's code returned a negative component.
    negative: atomic<u32>,
    /// Number of tiles that asked for more samples than the limit and fell back to k = 1.
    overflowed_tiles: atomic<u32>,
    /// Number of windows by the reason for their k: nothing, depth, normal, luminance, identity, the least allowed,
    /// shadow, the host's bytes.
    decided: array<atomic<u32>, 8>,
    /// Number of shadow rays.
    shadow_rays: atomic<u32>,
    /// Number of reflected rays.
    reflection_rays: atomic<u32>,
    /// Number of refracted rays.
    refraction_rays: atomic<u32>,
    /// Number of tiles with a surface, and with a surface that sends rays.
    tiles: array<atomic<u32>, 2>,
    /// Number of active quadrants by the attribute of their threshold: colour; object, normal, shadow and texture; and
    /// those of reflected and refracted surfaces.
    quadrants: array<atomic<u32>, 9>,
    /// Number of shaded points by lattice: `Level` of src/gpu/uniforms/lattice.rs.
    points: array<atomic<u32>, 5>,
    /// Number of planned samples for whose ray results there was no room.
    without_rays: atomic<u32>,
    /// Number of surfaces of all windows, of taps, and of windows with more surfaces than are told apart,
    /// and of surfaces that take their light from the corners of a block.
    surfaces: array<atomic<u32>, 4>,
}
