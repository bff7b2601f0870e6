//! What is written to the target.

/// What is written to the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[repr(u32)]
pub enum DebugView {
    /// The anti-aliased image.
    #[default]
    Image = 0,
    /// k on a log scale: 1 is black, n white, between them red and yellow. For
    /// [`Technique::Surfaces`](crate::Technique::Surfaces), the number of lights, dark blue where a window has none of
    /// its own.
    Count = 1,
    /// The metric that decided k: black none, red depth, green normal, blue luminance, yellow identity, cyan shadow,
    /// white the host's bytes.
    /// For [`Technique::Selective`](crate::Technique::Selective), what the threshold of the window's first active
    /// quadrant is for: black no quadrant is active, red shadow, green normal, blue colour or texture, yellow object.
    Decided = 2,
    /// The first samples S, exposed, on the curve c/(1+c).
    First = 3,
    /// Fourth root of the depth buffer's value. This and the following views of the G-buffer show each window's first
    /// sample.
    Depth = 4,
    /// Normal · ½ + ½.
    Normal = 5,
    /// Geometric normal · ½ + ½.
    GeometricNormal = 6,
    /// Tangent · ½ + ½.
    Tangent = 7,
    /// The fraction of u in red, that of v in green.
    Uv = 8,
    /// log2 of the length of the longer uv gradient: 2⁻¹⁶ is black, 1 white.
    Gradient = 9,
    /// A colour for each material.
    Material = 10,
    /// A colour for each object.
    Object = 11,
    /// The lowest 24 of the host's 32 bits as RGB, 8 bits per channel.
    User = 12,
    /// Active quadrants of [`Technique::Selective`](crate::Technique::Selective): 0 black, 1 red, 2 green, 3 blue, 4
    /// white (Jin et al. 2009, figure 1).
    Quadrants = 13,
    /// The lattice of [`Technique::MultiResolution`](crate::Technique::MultiResolution) on which a pixel was shaded:
    /// white every pixel, cyan shifted pixels, green every second, yellow every fourth, red every eighth; black:
    /// interpolated.
    Levels = 14,
    /// How many surfaces a window's samples see, on a log scale: 1 is black, n white, between them red and yellow. An
    /// object with a material is a surface, and so is the sky. Black windows hold no edge between surfaces, only
    /// perhaps one within a surface.
    Surfaces = 15,
    /// Which rays were dispatched for each tile of 8 × 8 pixels: black none; blue shadow rays, as the tile holds a
    /// surface; yellow mirrored and refracted rays too, as one of its materials sends them. Black in a frame that
    /// traces nothing, and where [`Technique::MultiResolution`](crate::Technique::MultiResolution) casts rays only at
    /// the points of its lattices.
    Tiles = 16,
    /// Which casting lights reach the first sample. The first of [`Needs::shadows`](crate::Needs::shadows) is red, the
    /// second green, the third blue, the fourth red again, and so on; each channel is the share of its lights that
    /// reach. A single light is white. A light behind the surface does not reach; a light out of its own range counts
    /// as if it did. Black: no light reaches, the sky, or a frame that traces no shadows.
    Shadows = 17,
    /// How many shadow, mirrored and refracted rays the pixel's samples send, on a log scale: 0 is black, then red and
    /// yellow. White is the most possible: from each of n samples one to every casting light, one mirrored and one
    /// refracted. Leaves out points of [`Technique::MultiResolution`](crate::Technique::MultiResolution) beyond the
    /// image's border and the audit of [`Goal::Error`](crate::Goal::Error). Doubles the memory for ray results;
    /// [`Intermediates::shadows`](crate::Intermediates::shadows) has the count of each sample.
    Rays = 18,
    /// How often the host's material is read for a pixel of [`Technique::Surfaces`](crate::Technique::Surfaces), on a
    /// log scale: 1 is black, 2 n white, between them red and yellow. Taps of a surface that is cut into groups are
    /// read twice. For other techniques [`Count`](Self::Count) says it, and this is black.
    Taps = 19,
}

impl DebugView {
    /// All views, in order.
    pub const ALL: [Self; 20] = [
        Self::Image,
        Self::Count,
        Self::Decided,
        Self::First,
        Self::Depth,
        Self::Normal,
        Self::GeometricNormal,
        Self::Tangent,
        Self::Uv,
        Self::Gradient,
        Self::Material,
        Self::Object,
        Self::User,
        Self::Quadrants,
        Self::Levels,
        Self::Surfaces,
        Self::Tiles,
        Self::Shadows,
        Self::Rays,
        Self::Taps,
    ];
}
