//! bench.json.

use super::plan::Cell;
use crate::measure::stats::{Adapter, Spread};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What was measured on an adapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bench {
    /// The version of the crate.
    pub version: String,
    /// The operating system and the architecture.
    pub system: String,
    /// The adapter, its driver and backend.
    pub adapter: Adapter,
    /// Whether a CPU stands in for a GPU: only ratios of its times count.
    pub software: bool,
    /// Width and height of the pictures in pixels.
    pub size: (u32, u32),
    /// Seconds that it all took.
    pub seconds: f64,
    /// In the order of the plan.
    pub measured: Vec<Measured>,
    /// What of the plan is missing.
    pub left_out: Vec<LeftOut>,
}

/// A cell, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// What it is.
    pub cell: Cell,
    /// What the G-buffer kept: `visibility` or `stored`.
    pub gbuffer: String,
    /// Its entries, the reference last.
    pub rows: Vec<Row>,
}

/// An entry of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The technique and its preset.
    pub label: String,
    /// Measured frames.
    pub frames: u32,
    /// Lit samples a pixel.
    pub k: f64,
    /// Lit samples over all m² a pixel.
    pub ratio: f64,
    /// Evaluations of materials a pixel.
    pub taps: f64,
    /// PSNR to `Full` of the same m, on the displayed picture; 200 if identical.
    pub psnr_db: Option<f64>,
    /// Rays a frame.
    pub rays: u64,
    /// Rays over the seconds of the passes that trace them.
    pub rays_per_second: Option<f64>,
    /// Milliseconds of GPU time by pass, with `gbuffer`, `node` and `total`; empty without timestamps.
    pub time_ms: BTreeMap<String, Spread>,
    /// Milliseconds of a whole frame on the CPU's clock, from recording until the GPU is done.
    pub wall_ms: Option<Spread>,
    /// Bytes of the G-buffer, and of the meshes that a visibility buffer is read with.
    pub gbuffer_bytes: u64,
    /// Bytes of everything else that the node holds, the scene for rays among them.
    pub other_bytes: u64,
    /// Samples that were no number, in the last frame.
    pub not_finite: u64,
    /// Samples without room for their own rays, which took what the first one of their window found: more would come
    /// nearer to `Full` with a greater `Settings::ray_samples`.
    #[serde(default)]
    pub without_rays: u64,
}

/// Why a cell was left out for which there was no time.
pub const OVER: &str = "the time was over";

/// A cell that was not measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOut {
    /// What it is.
    pub cell: Cell,
    /// Why.
    pub why: String,
}

impl Measured {
    /// The row of this label.
    pub fn row(&self, label: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.label == label)
    }
}

impl Row {
    /// Median milliseconds of a pass, of `gbuffer`, `node` or `total`.
    pub fn ms(&self, name: &str) -> Option<f64> {
        self.time_ms.get(name).map(|spread| spread.median)
    }

    /// Why its figures tell little: rays for which there was no room, few frames, or times of the whole frame that
    /// differ by more than three tenths.
    pub fn doubts(&self) -> impl Iterator<Item = &'static str> {
        let unsteady = self.time_ms.get("total").is_some_and(|t| t.p95 > 1.3 * t.min);
        let kinds = [
            (self.without_rays > 0, "SHARED RAYS"),
            (unsteady, "UNSTEADY"),
            (!unsteady && self.frames < 3, "FEW FRAMES"),
        ];
        kinds.into_iter().filter(|(is, _)| *is).map(|(_, kind)| kind)
    }
}
