//! Settings of `Technique::Surfaces`, and presets of them.

use super::windowed::Preset;

/// How [`Technique::Surfaces`](crate::Technique::Surfaces) tells surfaces apart, at how many taps it reads their
/// materials, and which taps it lights together.
///
/// The *spread* of taps is the sum of the squared deviations of their features from the mean, each in proportion to the
/// share of the window that the tap stands for. The features are what the host's `spread` returns for a material, or
/// else `DaaSpread` of the contract as the crate computes it.
///
/// The default is [`Preset::Balanced`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Surfaces {
    /// The spread above which taps do not share one light, 0 to 1e6. Higher: fewer lights, bumps and highlights are
    /// smoothed. Lower: more lights, up to [`groups`](Self::groups) for each surface; 0: taps share a light only if
    /// they are the same.
    pub spread: f32,
    /// The most groups of taps that a surface is cut into, 1 to 8, each of which is lit once. Higher: better where a
    /// pixel holds bumps or highlights, at the price of more lights there. 1: one light for each surface, for which a
    /// light is in shadow only where all its taps are.
    pub groups: u32,
    /// The most taps at which the material of a surface is read, 1 to 16. Higher: less aliasing of textures and normal
    /// maps. Lower: fewer reads, and below 16 and m² fewer rays in windows of several surfaces, where samples that are not
    /// read cast none.
    pub taps: u32,
    /// The taps of a window of one surface before their spread decides whether it gets all [`taps`](Self::taps), 1 to
    /// 16. Higher: sees more of what is small. Lower: fewer reads where a surface is even.
    pub first_taps: u32,
    /// The spread above which a window of one surface gets all its taps, with its colours at full weight, 0 to 1e6.
    /// Higher: fewer taps. 0: all taps unless the first are the same.
    pub tap_spread: f32,
    /// The squared distance of features up to which a window takes its light from the corners of a block of 4 × 4
    /// windows instead of being lit itself, 0 to 1e6. Its colours remain its own. Higher: fewer lights, down to a
    /// quarter for each pixel, bumps are smoothed. 0: every window is lit. Needs a host whose `light` returns `DaaLight`;
    /// without it, nothing changes.
    pub block_spread: f32,
    /// The greatest difference of a displayed channel between a block's corners (c/(1+c), 0 to 1) up to which the light
    /// between them is interpolated. Higher: fewer lights, small highlights and the rims of lights are missed.
    pub block_contrast: f32,
    /// How far from a change of shadow three more samples of a window cast shadow rays, 0 to 4 pixels, and all of them
    /// where one of those is lit otherwise than the first. Further off, and where one surface fills the window, the first
    /// sample casts for all. Higher: thin shadows that first samples hit here and there come out whole, for more rays.
    /// 0: all samples cast only in windows of several surfaces.
    pub shadow_reach: u32,
    /// The most surfaces that are told apart in a window, 1 to 6. The samples of further ones are merged into the last;
    /// [`SurfaceCounts::merged`](crate::SurfaceCounts::merged) counts such windows. Higher: better foliage, ropes and
    /// fences.
    pub surfaces: u32,
    /// The cosine of the angle between normals of one surface, -1 to 1. Higher: splits curved surfaces into more, each
    /// with its own light. Lower: fewer lights on edges of low curvature.
    pub normal_cosine: f32,
    /// The distance of a sample to the plane of its surface, over that to the camera, 0 to 1. Higher: merges surfaces
    /// that lie behind each other. Lower: splits curved ones.
    pub plane: f32,
    /// How much the length that a mean of normals loses widens the highlight, 0 to 1: the variance of slopes is twice
    /// this over κ (Tokuyoshi, Kaplanyan 2019). Higher: blurs highlights that normal maps break up. Lower: they glitter.
    pub widening: f32,
    /// Scales the texture footprint of a tap, 0 to 4. At 1 it covers the samples that the tap stands for; it is never
    /// smaller than the sample's own. Higher: blurrier textures. Lower: sharper ones, which shimmer if the surface has
    /// few taps.
    pub footprint: f32,
}

impl Surfaces {
    /// Reads and lights each surface of a window once, which is what multisampling does where shading is forward: edges of
    /// geometry are counted as exactly as by the presets, while textures, highlights and the edges of shadows within
    /// a surface are those of one sample a pixel. The demo's node takes two to three times as long as with
    /// [`Technique::Single`](crate::Technique::Single), the less the dearer its light is.
    pub const ONCE: Self = Self {
        groups: 1,
        taps: 1,
        first_taps: 1,
        block_spread: 0.0,
        shadow_reach: 0,
        footprint: 0.6,
        ..Self::BALANCED
    };

    const BALANCED: Self = Self {
        spread: 0.01,
        groups: 8,
        taps: 16,
        first_taps: 4,
        tap_spread: 0.005,
        block_spread: 0.001,
        block_contrast: 0.008,
        shadow_reach: 2,
        surfaces: 6,
        normal_cosine: 0.95,
        plane: 0.01,
        widening: 0.2,
        footprint: 0.5,
    };

    /// The most taps of a surface.
    pub(crate) const MOST_TAPS: u32 = 16;
    /// The most groups of a surface.
    pub(crate) const MOST_GROUPS: u32 = 8;
    /// The most surfaces of a window: their labels and their number have three bits each.
    pub(crate) const MOST_SURFACES: u32 = 6;

    /// These settings with all spreads divided by 2^effort, which lies in -12 to 8. At 0 they stay as they are, at 8
    /// taps share a light only if they are the same.
    pub(crate) fn at_effort(self, effort: f32) -> Self {
        let scale = if effort >= 8.0 { 0.0 } else { (-effort).exp2() };
        Self {
            spread: self.spread * scale,
            tap_spread: self.tap_spread * scale,
            block_spread: self.block_spread * scale,
            ..self
        }
    }
}

impl Default for Surfaces {
    fn default() -> Self {
        Preset::Balanced.surfaces()
    }
}

impl Preset {
    /// The settings of [`Technique::Surfaces`](crate::Technique::Surfaces) of this preset.
    pub const fn surfaces(self) -> Surfaces {
        let balanced = Surfaces::BALANCED;
        match self {
            Self::Fast => {
                Surfaces { spread: 0.025, block_spread: 0.006, block_contrast: 0.02, shadow_reach: 1, ..balanced }
            }
            Self::Balanced => balanced,
            Self::Quality => {
                Surfaces { spread: 0.004, tap_spread: 0.001, block_contrast: 0.004, shadow_reach: 3, ..balanced }
            }
        }
    }
}
