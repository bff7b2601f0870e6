//! Settings of `Technique::Selective`.

use super::curve::LuminanceCurve;

/// Thresholds of [`Technique::Selective`](crate::Technique::Selective).
///
/// The technique compares the shaded samples at the centres of pixels: each quadrant's own pixel with the three around
/// its corner (Jin et al. 2009, sections 4.1.3 and 4.2). If attributes disagree there, the quadrant's threshold τ is
/// the least of theirs, otherwise [`tau_col`](Self::tau_col); an attribute with a greater τ thus *relaxes* the test.
/// The quadrant is active, and four of its samples are shaded, if the contrast of the four colours is at least (1.36,
/// 1.02, 2.04) τ in red, green or blue.
///
/// Every τ lies in 0 to 1. Lower: more samples. 0 shades the quadrant whatever its colours; 1 never shades it, whereas
/// a threshold that is [off](Enabled) leaves the decision to the others. Attributes of what is reflected and refracted
/// are known in frames that trace it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Selective {
    /// τcol, 0 to 1: the contrast threshold where no attribute disagrees. Lower: more samples.
    pub tau_col: f32,
    /// τpoid, 0 to 1: the threshold where the pixels show different objects, or an object and the sky. Lower: more
    /// samples.
    pub tau_poid: f32,
    /// τpsn, 0 to 1: the threshold where the pixels' normals differ, see [`normal_cosine`](Self::normal_cosine). Lower:
    /// more samples.
    pub tau_psn: f32,
    /// τpsc, 0 to 1: the threshold where lights reach the pixels differently, see
    /// [`shadow_lights`](Self::shadow_lights). Lower: more samples.
    pub tau_psc: f32,
    /// τpte, 0 to 1: the threshold where the pixel's own material is one of
    /// [`Needs::textured`](crate::Needs::textured), whatever its neighbours are. Lower: more samples.
    pub tau_pte: f32,
    /// τsoid, 0 to 1: like τpoid, for the objects that the pixels reflect or refract. A reflected ray counts with its
    /// first hit, a refracted one with the first hit behind the body it passes through.
    pub tau_soid: f32,
    /// τssn, 0 to 1: like τpsn, for the surfaces that the pixels reflect or refract.
    pub tau_ssn: f32,
    /// τssc, 0 to 1: like τpsc, for the surfaces that the pixels reflect or refract.
    pub tau_ssc: f32,
    /// τste, 0 to 1: like τpte, for the materials that the pixel reflects or refracts.
    pub tau_ste: f32,
    /// Which of the thresholds apply.
    pub enabled: Enabled,
    /// The quantity whose contrast is measured.
    pub reference: ColorReference,
    /// The curve on which contrast is measured. The perceptual curve shows about half the linear contrast in dark
    /// regions and much less in bright ones.
    pub curve: LuminanceCurve,
    /// Differences of a channel below this, on [`curve`](Self::curve), are no contrast, 0 to 1. Higher: less work in
    /// dark noise. The paper has no such limit, but contrast is a ratio and sees any noise in the dark.
    pub contrast_min: f32,
    /// Normals differ if the cosine of the angle between them is below this, -1 to 1. Higher: τpsn applies to more
    /// pixels at creases and curves. The paper has such a value but does not print it (and writes cross product where
    /// it must mean the dot product).
    pub normal_cosine: f32,
    /// Shadows differ if different lights are blocked. Off: only if different numbers of lights are blocked, as in the
    /// paper.
    pub shadow_lights: bool,
    /// Interpolates the colour of inactive quadrants between the pixels at their corner. Off: they take their own
    /// pixel's, as in the paper, which suggests interpolation for textures. On: smoother, and blurs what contrasts less
    /// than the threshold.
    pub bilinear: bool,
    /// Attributes disagree only where an object of [`Needs::importance`](crate::Needs::importance) is involved (section
    /// 5, "fairy focused").
    pub focused: bool,
    /// Scales the texture footprint of a shaded sample, 0 to 4. At 1 it covers the samples that the shaded one stands
    /// for; it is never smaller than the sample's own. Higher: blurrier textures.
    pub footprint: f32,
    /// Shades the sample at the centre of a window with an edge in it with its own texture footprint. Off: with that of
    /// the whole pixel. Not in the paper, which filters no textures.
    pub edge_aware_first: bool,
}

/// Which thresholds of [`Selective`] apply. Without a threshold its attribute counts as equal everywhere; without
/// `col`, only quadrants with a disagreement can be active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Enabled {
    /// Whether [`Selective::tau_col`] applies.
    pub col: bool,
    /// Whether [`Selective::tau_poid`] applies.
    pub poid: bool,
    /// Whether [`Selective::tau_psn`] applies.
    pub psn: bool,
    /// Whether [`Selective::tau_psc`] applies.
    pub psc: bool,
    /// Whether [`Selective::tau_pte`] applies.
    pub pte: bool,
    /// Whether [`Selective::tau_soid`] applies.
    pub soid: bool,
    /// Whether [`Selective::tau_ssn`] applies.
    pub ssn: bool,
    /// Whether [`Selective::tau_ssc`] applies.
    pub ssc: bool,
    /// Whether [`Selective::tau_ste`] applies.
    pub ste: bool,
}

impl Enabled {
    /// Every threshold applies.
    pub const ALL: Self =
        Self { col: true, poid: true, psn: true, psc: true, pte: true, soid: true, ssn: true, ssc: true, ste: true };
    /// No threshold applies, so no quadrant is active.
    pub const NONE: Self = Self {
        col: false,
        poid: false,
        psn: false,
        psc: false,
        pte: false,
        soid: false,
        ssn: false,
        ssc: false,
        ste: false,
    };
}

impl Default for Enabled {
    fn default() -> Self {
        Self::ALL
    }
}

/// The quantity whose contrast [`Technique::Selective`](crate::Technique::Selective) measures (section 4.1.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum ColorReference {
    /// The shaded colours, channel by channel.
    #[default]
    Color,
    /// The luminance of the shaded colours, compared with 1.02 τ.
    Luminance,
    /// The greatest length of the luminance gradients at the four pixels, compared with 1.02 τ. Gradients are measured
    /// with the Sobel operator, where a step from black to white between two pixels is 1. This is not a ratio, so dark
    /// regions count little.
    Gradient,
}

impl Selective {
    /// The thresholds of the paper's table 2, from its tests at about 20 % of nine samples per pixel. τa, which colour
    /// and textures share there, is 0.6; the paper's range for it is 0.1 to 1.
    pub const PAPER: Self = Self {
        tau_col: 0.6,
        tau_poid: 0.05,
        tau_psn: 0.06,
        tau_psc: 0.06,
        tau_pte: 0.6,
        tau_soid: 0.05,
        tau_ssn: 0.06,
        tau_ssc: 0.06,
        tau_ste: 0.6,
        enabled: Enabled::ALL,
        reference: ColorReference::Color,
        curve: LuminanceCurve::Linear,
        contrast_min: 0.0,
        normal_cosine: 0.9,
        shadow_lights: false,
        bilinear: false,
        focused: false,
        footprint: 1.0,
        edge_aware_first: false,
    };

    /// The thresholds, `None` where they are off: colour, then object, normal, shadow and texture of what pixels show,
    /// then of what they reflect and refract.
    pub(crate) fn thresholds(&self) -> [Option<f32>; 9] {
        let e = &self.enabled;
        [
            e.col.then_some(self.tau_col),
            e.poid.then_some(self.tau_poid),
            e.psn.then_some(self.tau_psn),
            e.psc.then_some(self.tau_psc),
            e.pte.then_some(self.tau_pte),
            e.soid.then_some(self.tau_soid),
            e.ssn.then_some(self.tau_ssn),
            e.ssc.then_some(self.tau_ssc),
            e.ste.then_some(self.tau_ste),
        ]
    }
}

impl Default for Selective {
    fn default() -> Self {
        Self {
            tau_col: 0.1,
            tau_poid: 0.01,
            tau_psn: 0.01,
            tau_psc: 0.01,
            tau_pte: 0.1,
            tau_soid: 0.01,
            tau_ssn: 0.01,
            tau_ssc: 0.01,
            tau_ste: 0.1,
            enabled: Enabled::ALL,
            reference: ColorReference::Color,
            curve: LuminanceCurve::Perceptual,
            contrast_min: 0.02,
            normal_cosine: 0.95,
            shadow_lights: true,
            bilinear: true,
            focused: false,
            footprint: 0.5,
            edge_aware_first: true,
        }
    }
}
