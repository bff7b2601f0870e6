//! The curve on which colours and luminances are compared.

/// The curve on which colours and luminances are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum LuminanceCurve {
    /// Radiance times the exposure. For hosts whose exposed radiance lies in 0 to 1.
    Linear,
    /// √(l/(1+l)) of the exposed radiance l, close to what a display shows: a difference then means about the same in
    /// bright and in dark regions.
    #[default]
    Perceptual,
}
