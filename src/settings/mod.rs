//! What a host may change at any frame.

mod curve;
mod execution;
mod goal;
mod multi_resolution;
mod ranges;
mod reconstructed;
mod selective;
mod surfaces;
mod view;
mod windowed;

pub use curve::LuminanceCurve;
pub use execution::Execution;
pub use goal::Goal;
pub use multi_resolution::{Lattice, MultiResolution, Pattern};
pub use ranges::{SettingRange, SettingScale, SettingsError};
pub use reconstructed::Reconstructed;
pub use selective::{ColorReference, Enabled, Selective};
pub use surfaces::Surfaces;
pub use view::DebugView;
pub use windowed::{DepthMeasure, Preset, Windowed};

/// The greatest reach of a change of shadow, which is also the apron of a band.
const MOST_SHADOW_REACH: u32 = 4;

/// The library's Rust source of all settings, for tools that show their documentation.
pub const SETTINGS_SOURCE: &[&str] = &[
    include_str!("mod.rs"),
    include_str!("curve.rs"),
    include_str!("execution.rs"),
    include_str!("goal.rs"),
    include_str!("multi_resolution.rs"),
    include_str!("reconstructed.rs"),
    include_str!("selective.rs"),
    include_str!("surfaces.rs"),
    include_str!("view.rs"),
    include_str!("windowed.rs"),
];

/// Everything that can change between two frames without rebuilding the node.
///
/// A pixel's *window* is its m × m samples, n = m² in all; k is how many of them are shaded. Every numeric setting has
/// a range, listed in [`RANGES`](Self::RANGES).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Settings {
    /// How samples are chosen and combined into pixels.
    pub technique: Technique,
    /// How the GPU runs the chosen samples. It changes the time but, except for [`Execution::MaxFiltered`], not the
    /// image. Used by [`Technique::Windowed`] and [`MultiResolution::supersampled`]; other techniques ignore it.
    pub execution: Execution,
    /// Settings of [`Technique::Windowed`].
    pub windowed: Windowed,
    /// Settings of [`Technique::Reconstructed`].
    pub reconstructed: Reconstructed,
    /// Settings of [`Technique::Selective`].
    pub selective: Selective,
    /// Settings of [`Technique::MultiResolution`].
    pub multi_resolution: MultiResolution,
    /// Settings of [`Technique::Surfaces`].
    pub surfaces: Surfaces,
    /// How a pixel's samples are weighted when they are averaged.
    pub weight: Weight,
    /// Whether shadow rays are traced towards the lights of [`Needs::shadows`](crate::Needs::shadows).
    pub shadows: Effect,
    /// Whether reflected rays are traced from the materials of [`Needs::reflective`](crate::Needs::reflective).
    pub reflections: Effect,
    /// Whether refracted rays are traced from the materials of [`Needs::reflective`](crate::Needs::reflective).
    pub refraction: Effect,
    /// The number of samples a pixel beyond the first whose ray results there is room for, on average over the image or
    /// its band, 0 to 63. Each takes 4 bytes for shadows, and 4 for reflections and refractions. Higher: takes more
    /// memory. Lower: where a frame plans more samples, those without room take what the rays of their window's first
    /// sample found, so that edges of shadows and reflections are rougher from the image's bottom up;
    /// [`Statistics::without_rays`](crate::Statistics::without_rays) counts them. Used where a plan chooses samples: by
    /// [`Technique::Windowed`], [`Technique::Selective`], [`Technique::Surfaces`] and
    /// [`MultiResolution::supersampled`]. With a
    /// [`goal`](Self::goal) there is room for all.
    pub ray_samples: f32,
    /// How far from a surface rays start at least, in samples, 0 to 1, where the position follows from a stored depth.
    /// It covers what rasterisers lose by placing vertices on a grid, of 1/256 of a sample on most GPUs. Higher: no
    /// surface shadows itself on coarser ones, and shadows narrower than that are lost where surfaces touch. Lower:
    /// finer contact shadows. A visibility buffer has exact positions and ignores it.
    pub ray_bias: f32,
    /// What is written to the target: the image or a debug view.
    pub view: DebugView,
    /// An error or a time to hold. The node then scales the constants of [`windowed`](Self::windowed) together from
    /// frame to frame instead of using them as they are. Only for [`Technique::Windowed`]; other techniques ignore it.
    pub goal: Option<Goal>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            technique: Technique::default(),
            execution: Execution::default(),
            windowed: Windowed::default(),
            reconstructed: Reconstructed::default(),
            selective: Selective::default(),
            multi_resolution: MultiResolution::default(),
            surfaces: Surfaces::default(),
            weight: Weight::default(),
            shadows: Effect::default(),
            reflections: Effect::default(),
            refraction: Effect::default(),
            ray_samples: 8.0,
            ray_bias: 1.0 / 128.0,
            view: DebugView::default(),
            goal: None,
        }
    }
}

/// How samples are chosen and combined into pixels. All techniques work on the same G-buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Technique {
    /// Shades every sample: full supersampling, the reference that other techniques are compared with.
    Full,
    /// Shades one sample per pixel, with the whole pixel as its texture footprint: plain deferred shading.
    Single,
    /// Shades the first k samples of each window. k follows from how much depth, normal and luminance vary there
    /// (Holländer, Boubekeur, Eisemann 2013).
    #[default]
    Windowed,
    /// Shades one sample per window. The other, geometric samples take the colours of nearby shaded samples on the same
    /// surface and in the same shadow (subpixel reconstruction, Chajdas, McGuire, Luebke 2011, as adapted to ray
    /// tracing at WSCG 2012). A sample with no similar neighbour is shaded.
    Reconstructed,
    /// Shades one sample per pixel, and four in each quadrant of a pixel that contrasts with the three pixels at its
    /// corner. The threshold depends on which attributes differ there (Jin, Ihm, Chang, Park, Lee, Jung 2009).
    /// [`Execution`] is ignored: it runs a list of the pixels sorted by k.
    Selective,
    /// Refines a coarse lattice of points into finer ones. A point is shaded, or interpolated where its neighbourhood
    /// is smooth; its rays likewise (University of Alaska Fairbanks thesis on tri-adaptive sampling). Can shade less
    /// than one sample per pixel and, on request, more.
    MultiResolution,
    /// Gathers the samples of each window into surfaces whose coverage is counted, reads the material of a surface at
    /// several taps, and lights once each group of taps that would be lit alike. The crate's own technique; it lights
    /// about one sample a pixel. Hosts whose hook is `shade` instead of `material` and `light` have one sample shaded
    /// for each surface.
    Surfaces,
}

impl Technique {
    /// All techniques, in order.
    pub const ALL: [Self; 7] = [
        Self::Full,
        Self::Single,
        Self::Windowed,
        Self::Reconstructed,
        Self::Selective,
        Self::MultiResolution,
        Self::Surfaces,
    ];

    /// Whether it can be scaled to meet a [`Goal`]. Others ignore goals.
    pub fn follows_goals(self) -> bool {
        matches!(self, Self::Windowed | Self::Surfaces)
    }
}

/// Whether a kind of ray is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Effect {
    /// Traced if the frame's [`Needs`](crate::Needs) ask for it.
    #[default]
    Auto,
    /// Always on. The image equals that of [`Auto`](Self::Auto) bit for bit; where the scene needs none, the passes and
    /// their memory are spent for nothing.
    On,
    /// Never traced.
    Off,
}

/// How the samples of a pixel are weighted when they are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Weight {
    /// Equal weights: the exact linear mean.
    #[default]
    Linear,
    /// Weights of 1/(1 + exposed luminance), so that bright samples do not dominate an edge (Karis 2014). Darker than
    /// the linear mean.
    Luminance,
}

impl Preset {
    /// Settings with this preset's metrics and surfaces, and the defaults for everything else.
    pub fn settings(self) -> Settings {
        Settings { windowed: self.windowed(), surfaces: self.surfaces(), ..Default::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_sound_and_differ() {
        for preset in Preset::ALL {
            assert_eq!(preset.settings().validate(), Ok(()), "{preset:?}");
            let (windowed, surfaces) = (preset.windowed(), preset.surfaces());
            assert_eq!(preset.settings(), Settings { windowed, surfaces, ..Default::default() });
        }
        let [fast, balanced, quality] = Preset::ALL.map(Preset::windowed);
        assert!(fast != balanced && balanced != quality && quality != fast);
        assert_eq!(Windowed::default(), balanced);
        assert_eq!(Settings::default(), Preset::Balanced.settings());
    }
}
