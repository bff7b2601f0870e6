//! Settings of `Technique::Windowed`, and presets of them.

use super::curve::LuminanceCurve;

/// The metrics of [`Technique::Windowed`](crate::Technique::Windowed). k is the greatest number of samples that any
/// metric asks for, rounded, from 1 to n = m².
///
/// Each metric has a constant of its own; 0 switches it off. The default is [`Preset::Balanced`]; [`Self::PAPER`] has
/// only the paper's metrics.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Windowed {
    /// What the depth metric measures.
    pub depth: DepthMeasure,
    /// Samples per unit of the depth measure, 0 to 1e9. Higher: more samples at depth edges, down to the noise of the
    /// depth buffer. Lower: fewer; 0: off. The measure is relative to depth, so this needs no scene units.
    pub depth_scale: f32,
    /// Samples per √(1 − cos θ), 0 to 1e6, where θ is the angle from the mean normal to the normal furthest from it
    /// (section 3.1). Higher: more samples on curved surfaces and creases. Lower: fewer; 0: off.
    pub normal_scale: f32,
    /// Counts opposite normals as equal: the paper's |n̄·n|. Useful for leaves drawn as one-sided planes.
    pub two_sided: bool,
    /// Samples per unit of the range of luminance, or of a channel, over the neighbouring first samples (section 3.1), 0
    /// to 1e6. It holds for m = 4 and is multiplied by m/4 at other m, as an edge crosses m samples per side. Higher:
    /// more samples at edges of light and texture. Lower: fewer; 0: off. Windows with nothing but sky keep k = 1.
    pub luminance_scale: f32,
    /// Ranges below this are not edges, 0 to 1e6. Higher: less work in dark noise. Lower: detects fainter
    /// edges. FXAA's published values are 0.0312 to 0.0833.
    pub luminance_min: f32,
    /// Ranges below this share of the greatest value are not edges, 0 to 1. Higher: fewer samples in
    /// bright texture. Lower: more. FXAA's published values are 0.125 to 0.166.
    pub luminance_edge: f32,
    /// The curve on which the range is measured.
    pub luminance: LuminanceCurve,
    /// Measures the range in red, green and blue apart and takes the greatest. Off: that of luminance alone, as in the
    /// paper, which does not see an edge between colours of equal luminance.
    pub luminance_channels: bool,
    /// Includes the pixel itself in its luminance range, as FXAA does. Off: only its four neighbours, as the paper
    /// words it.
    pub luminance_centre: bool,
    /// Samples for a window with more than one material or object, 0 to 64. Higher: better edges between coplanar
    /// materials; 0: off. Not in the paper.
    pub identity_samples: f32,
    /// Samples for a window whose first sample is lit by other casting lights than a direct neighbour's first sample, 0
    /// to 64. Only where shadows are traced. Higher: better edges of faint shadows; 0: off, shadows are then detected
    /// only by their luminance. Not in the paper.
    pub shadow_samples: f32,
    /// How far from a change of shadow three more samples of a window cast shadow rays, 0 to 4 pixels. Where one of them is
    /// lit otherwise than the first, the window gets [`shadow_samples`](Self::shadow_samples). Higher: thin shadows that
    /// first samples hit here and there come out whole, for more rays. 0: none do. Only where shadows are traced. Not in the
    /// paper.
    pub shadow_reach: u32,
    /// Samples per unit of the range that the host's own 32 bits, `user`, have over the window's samples, 0 to 1e6. Each
    /// of their four bytes counts from 0 to 1, and the greatest range is taken. Higher: more samples where vertex
    /// colours, or whatever the host keeps there, differ, so that 255 times n sees any difference. Lower: fewer; 0: off,
    /// and `user` is not read. A stored G-buffer without [`Channels::user`](crate::Channels) has no such range. Not in
    /// the paper.
    pub user_scale: f32,
    /// The least k of every window that is not all sky, 1 to 64. Higher: better where the metrics see nothing, at a
    /// cost everywhere; n: full supersampling. Not in the paper.
    pub least_samples: f32,
    /// Scales the texture footprint of a shaded sample, 0 to 4. At 1 it is √(n/k) times the sample's own, so that it
    /// covers the n/k samples that the sample stands for, as in the paper; it is never smaller than the sample's own.
    /// Higher: blurrier textures. Lower: sharper textures, which shimmer below about ½.
    pub footprint: f32,
    /// Shifts texture lookups so that the footprint of the k samples together is centred in the window. In the printed
    /// matrices the first k samples lie up to a quarter pixel off the centre. Not in the paper.
    pub centred: bool,
    /// Shades the first sample of a window with an edge in it with its own texture footprint, as one of many. Off: with
    /// that of the whole pixel, as in other windows. Not in the paper.
    pub edge_aware_first: bool,
    /// The most samples beyond the first that a tile of 8 × 8 pixels may ask for, 0 to 4032 = 64 · 63, where nothing is
    /// limited. A tile that asks for more falls back to k = 1 and is counted in the statistics. Lower: bounds the time
    /// of the worst tile.
    pub tile_limit: u32,
}

/// What the depth metric measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DepthMeasure {
    /// The variance of the window's depths over their squared mean (section 3.1; the paper does not say in which unit
    /// depth is). A slanted plane counts as an edge.
    Variance,
    /// The greatest step between neighbouring depths that the plane on neither side explains, relative to their depth.
    /// A slanted plane does not count as an edge. Not in the paper.
    #[default]
    Discontinuity,
}

impl Windowed {
    /// The metrics of Holländer et al. 2013 and nothing else. The paper gives no constants: the scales are chosen here,
    /// the luminance thresholds are FXAA's defaults, to which section 3.1 refers.
    pub const PAPER: Self = Self {
        depth: DepthMeasure::Variance,
        depth_scale: 2000.0,
        normal_scale: 16.0,
        two_sided: true,
        luminance_scale: 32.0,
        luminance_min: 0.0625,
        luminance_edge: 0.125,
        luminance: LuminanceCurve::Perceptual,
        luminance_channels: false,
        luminance_centre: false,
        identity_samples: 0.0,
        shadow_samples: 0.0,
        shadow_reach: 0,
        user_scale: 0.0,
        least_samples: 1.0,
        footprint: 1.0,
        centred: false,
        edge_aware_first: false,
        tile_limit: Self::NO_TILE_LIMIT,
    };

    /// The [`tile_limit`](Self::tile_limit) that limits nothing: 64 pixels with 63 samples each beyond the first.
    pub const NO_TILE_LIMIT: u32 = 64 * 63;

    pub(super) const MOST_DEPTH_SCALE: f32 = 1e9;
    pub(super) const MOST_SCALE: f32 = 1e6;
    /// The number of samples in the largest window.
    pub(super) const MOST_SAMPLES: f32 = 64.0;

    /// What all presets share: our additions to the paper, with every metric but that of shadows off.
    const OURS: Self = Self {
        depth: DepthMeasure::Discontinuity,
        depth_scale: 0.0,
        normal_scale: 0.0,
        two_sided: false,
        luminance_scale: 0.0,
        luminance_min: 0.0,
        luminance_edge: 0.0,
        luminance: LuminanceCurve::Perceptual,
        luminance_channels: true,
        luminance_centre: true,
        identity_samples: 0.0,
        shadow_samples: 8.0,
        shadow_reach: 2,
        user_scale: 0.0,
        least_samples: 1.0,
        footprint: 1.0,
        centred: true,
        edge_aware_first: true,
        tile_limit: Self::NO_TILE_LIMIT,
    };

    /// These settings with all metrics scaled by 2^effort, which lies in -12 to 8. Above 0 the luminance thresholds
    /// fall by the same factor, and from 4 to 8 the least k rises to n. At 0 they stay as they are.
    pub(crate) fn at_effort(self, effort: f32, m: u32) -> Self {
        let scale = effort.exp2();
        let threshold = 1.0 / scale.max(1.0);
        let n = (m * m) as f32;
        let least = 1.0 + (n - 1.0) * ((effort - 4.0) / 4.0).clamp(0.0, 1.0);
        Self {
            depth_scale: (self.depth_scale * scale).min(Self::MOST_DEPTH_SCALE),
            normal_scale: (self.normal_scale * scale).min(Self::MOST_SCALE),
            luminance_scale: (self.luminance_scale * scale).min(Self::MOST_SCALE),
            luminance_min: self.luminance_min * threshold,
            luminance_edge: self.luminance_edge * threshold,
            identity_samples: (self.identity_samples * scale).min(Self::MOST_SAMPLES),
            shadow_samples: (self.shadow_samples * scale).min(Self::MOST_SAMPLES),
            user_scale: (self.user_scale * scale).min(Self::MOST_SCALE),
            least_samples: self.least_samples.max(least),
            ..self
        }
    }
}

impl Default for Windowed {
    fn default() -> Self {
        Preset::default().windowed()
    }
}

/// Metrics of [`Technique::Windowed`](crate::Technique::Windowed) in three steps from few samples to little error.
///
/// Found by `deferred-aa-demo tune` on the built-in scenes alone: at 320×180 and m = 4, the fewest samples that hold
/// 41, 45.8 and 50 dB on every scene, and 3 dB more on its edges. Run it on scenes of your own to find constants for
/// them. `depth_scale` was then raised by hand, so that depth steps of 0.1 % are detected, and `luminance_scale`
/// lowered in exchange, and again as each channel came to count, so that about as many samples are shaded. The figures
/// are the PSNR against [`Technique::Full`](crate::Technique::Full) and the share of all samples that is shaded, from
/// `deferred-aa-demo render --technique windowed --preset P --scene S --m 4 --size 640x360`. Those of Sponza are from
/// `--size 640x480 --camera=9,1.7,-0.3,-2,4,-0.5,60`; the search never saw that scene, but the changes by hand were
/// judged on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Preset {
    /// Sponza 40.6 dB at 19.8 % of the samples, atrium 45.1 at 24.5, checker 41.2 at 16.5, fence 54.0 at 26.2.
    Fast,
    /// Sponza 43.8 dB at 32.8 % of the samples, atrium 49.4 at 35.2, checker 45.1 at 28.5, fence 55.2 at 29.4.
    #[default]
    Balanced,
    /// Sponza 48.6 dB at 53.6 % of the samples, atrium 54.4 at 48.3, checker 49.9 at 36.7, fence 56.4 at 33.1.
    Quality,
}

impl Preset {
    /// All presets, the fewest samples first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Balanced, Self::Quality];

    /// The metrics of this preset.
    pub const fn windowed(self) -> Windowed {
        match self {
            Self::Fast => Windowed {
                depth_scale: 4000.0,
                normal_scale: 24.0,
                luminance_scale: 28.0,
                luminance_min: 0.08,
                luminance_edge: 0.12,
                shadow_reach: 1,
                footprint: 0.6,
                ..Windowed::OURS
            },
            Self::Balanced => Windowed {
                depth_scale: 4000.0,
                normal_scale: 24.0,
                luminance_scale: 72.0,
                luminance_min: 0.02,
                luminance_edge: 0.085,
                footprint: 0.5,
                ..Windowed::OURS
            },
            Self::Quality => Windowed {
                depth_scale: 4000.0,
                normal_scale: 24.0,
                luminance_scale: 176.0,
                luminance_min: 0.02,
                luminance_edge: 0.057,
                shadow_reach: 3,
                footprint: 0.5,
                ..Windowed::OURS
            },
        }
    }
}
