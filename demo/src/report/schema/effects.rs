//! What a scene does not pay for.

use super::cost::Base;
use crate::measure::stats::Spread;
use deferred_aa::TileCounts;
use serde::{Deserialize, Serialize};

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    /// Where frames were measured.
    pub base: Base,
    /// Each effect.
    pub rows: Vec<EffectRow>,
    /// Each way to trace that the adapter has.
    pub tiers: Vec<TierRow>,
    /// A made scene of which some tiles are mirrors, by Windowed.
    pub mirrors: Vec<MirrorRow>,
}

/// An effect on and off.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectRow {
    /// "shadows", "reflections" or "refraction".
    pub effect: String,
    /// The scene calls for it: a light casts, a material sends rays.
    pub needed: bool,
    /// With it.
    pub on: Frames,
    /// Without it.
    pub off: Frames,
}

/// Frames that are alike, of Windowed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// With the G-buffer.
    pub total_ms: Option<Spread>,
    /// Held for rays, the scene for rays included.
    pub ray_bytes: u64,
    /// Of a frame.
    pub rays: u64,
    /// By name, in order.
    pub passes: Vec<String>,
    /// By class.
    pub tiles: TileCounts,
}

/// Who traces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TierRow {
    /// "software" or "query".
    pub tier: String,
    /// Rays towards lights from the first samples, a second.
    pub rays_per_second: Option<f64>,
    /// Of the bottom levels together.
    pub triangles: u64,
    /// A triangle's share of nodes and indices, vertices apart. The adapter's own structures are not known.
    pub bytes_per_triangle: Option<f64>,
    /// To build the bottom levels, on all cores.
    pub build_ms: f64,
}

/// Some of 64 equal squares of the picture mirror.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MirrorRow {
    /// Squares.
    pub mirrors: u32,
    /// Their frames.
    pub frames: Frames,
    /// Median over the rounds of the time over that without mirrors in the same round.
    pub relative: Option<f64>,
}
