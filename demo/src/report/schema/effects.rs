//! What a scene does not pay for.

use super::cost::Base;
use crate::measure::stats::Spread;
use deferred_aa::TileCounts;
use serde::{Deserialize, Serialize};

/// What the effects of a scene cost, and what they do not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    /// Where frames were measured.
    pub base: Base,
    /// A row for each effect.
    pub rows: Vec<EffectRow>,
    /// A row for each way to trace that the adapter has.
    pub tiers: Vec<TierRow>,
    /// Windowed on a made scene, some of whose tiles are mirrors.
    pub mirrors: Vec<MirrorRow>,
}

/// An effect, switched on and off.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectRow {
    /// "shadows", "reflections" or "refraction".
    pub effect: String,
    /// Whether the scene calls for it: a light casts, or a material sends rays.
    pub needed: bool,
    /// Frames with the effect.
    pub on: Frames,
    /// Frames without it.
    pub off: Frames,
}

/// Frames of Windowed that are alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// Their time with the G-buffer.
    pub total_ms: Option<Spread>,
    /// Bytes held for rays, including the scene for rays.
    pub ray_bytes: u64,
    /// Rays of one frame.
    pub rays: u64,
    /// Names of the passes, in order.
    pub passes: Vec<String>,
    /// Tiles by class.
    pub tiles: TileCounts,
}

/// A way to trace rays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TierRow {
    /// "software" or "query".
    pub tier: String,
    /// Shadow rays a second, cast from the first samples.
    pub rays_per_second: Option<f64>,
    /// Triangles of the bottom levels together.
    pub triangles: u64,
    /// Bytes of nodes and indices over the number of triangles, without vertices. An adapter's own structures are not
    /// known.
    pub bytes_per_triangle: Option<f64>,
    /// Milliseconds to build the bottom levels, on all cores.
    pub build_ms: f64,
}

/// A picture of 64 equal squares, of which some are mirrors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MirrorRow {
    /// Squares that are mirrors.
    pub mirrors: u32,
    /// The frames of this picture.
    pub frames: Frames,
    /// Median over the rounds of the time over that without mirrors in the same round.
    pub relative: Option<f64>,
}
