//! Targets that the node holds by itself.

/// A target that the node holds by itself. It measures its own frames for that, so it collects statistics even where
/// the host does not ask for them. [`Statistics::goal`](crate::Statistics::goal) reports the progress. Techniques that
/// [do not follow goals](crate::Technique::follows_goals) ignore it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Goal {
    /// Root mean square error of the displayed image against all n samples, 0 to 1: 0.01 is 40 dB, 0.0032 is 50 dB.
    /// Displayed means x/(1+x) of exposed radiance, then the sRGB curve. The node holds the error with the fewest
    /// samples it can. Each frame it shades all samples of one tile in 32 (more of a small image) to measure the error,
    /// about 3 % of the cost of full supersampling. It starts with every sample and drops more as the measurements
    /// allow. `Surfaces` can't light every sample, so it starts with all spreads at 0, and an error below what is left
    /// then is missed. Lower: more samples.
    Error(f32),
    /// GPU time of the node's passes in milliseconds, above 0 to 1e6. The node shades as many samples as fit. Needs
    /// [`wgpu::Features::TIMESTAMP_QUERY`]. Higher: more samples.
    Time(f32),
}
