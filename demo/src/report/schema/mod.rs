//! report.json. Every field is present or null.

pub mod cost;
pub mod effects;
pub mod executions;
pub mod papers;

use crate::measure::oracle::{Coverage, Neyman};
use crate::measure::stats::{Adapter, Stats};
use crate::measure::temporal::Deviation;
use crate::picture::Rect;
use cost::Cost;
use effects::Effects;
use executions::ExecutionRow;
use papers::Papers;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Of this layout of report.json.
pub const VERSION: u32 = 1;

/// All of report.json.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`VERSION`].
    pub version: u32,
    /// As typed.
    pub command: String,
    /// The built-in's name or the file's path.
    pub scene: String,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// How often the light loop ran.
    pub stall: u32,
    /// Fewer settings, samples and points.
    pub quick: bool,
    /// Punctual lights, the sun included.
    pub lights: u32,
    /// Of all instances.
    pub triangles: u64,
    /// What it ran on.
    pub adapter: ReportAdapter,
    /// What everything is held against.
    pub truth: Option<TruthInfo>,
    /// What was measured, in the order of the plan.
    pub entries: Vec<Entry>,
    /// The bounds on mean-of-k and on exact coverage, by m.
    pub oracles: Vec<Oracle>,
    /// Where the entries' flicker was measured.
    pub temporal: Option<TemporalBase>,
    /// Entries that no other one beats.
    pub frontier: Frontier,
    /// One image, run in each way that there is.
    pub executions: Vec<ExecutionRow>,
    /// Cost against what makes frames costly.
    pub cost: Option<Cost>,
    /// What the scene does not pay for.
    #[serde(default)]
    pub effects: Option<Effects>,
    /// The tables of the papers, and the same rows here.
    #[serde(default)]
    pub papers: Option<Papers>,
    /// What settings given as goals settled on.
    pub goals: Vec<GoalRow>,
    /// Where the image is worst, worst first.
    pub crops: Vec<Crop>,
    /// Planned, not finished: ids of entries, and names of other parts.
    pub unfinished: Vec<String>,
    /// How long each part took, in seconds, this time.
    pub seconds: BTreeMap<String, f64>,
}

/// What it ran on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReportAdapter {
    /// Name, driver, backend.
    #[serde(flatten)]
    pub adapter: Adapter,
    /// No GPU: only ratios of times count.
    pub software: bool,
}

/// The reference of many samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthInfo {
    /// On a regular grid.
    pub samples_per_pixel: u32,
    /// It was there already.
    pub cached: bool,
    /// That it took to render, when it was rendered.
    pub seconds: f64,
    /// In the folder.
    pub file: String,
}

/// One measured technique with its settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Unique, and the stem of its files: lower-case letters, digits and dashes.
    pub id: String,
    /// For people.
    pub label: String,
    /// Why it is here.
    pub role: Role,
    /// The named settings that it has, if it has such.
    pub preset: Option<String>,
    /// As in stats.json.
    #[serde(flatten)]
    pub stats: Stats,
    /// In the folder.
    pub files: Files,
    /// How far above the bounds it lies.
    pub oracle: Option<EntryOracle>,
    /// How it flickers.
    pub temporal: Option<Temporal>,
}

/// Why an entry is in the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// One of ours.
    Technique,
    /// To measure against.
    Peer,
    /// What a goal settled on.
    Goal,
}

/// An entry's files, by their names in the folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Files {
    /// sRGB, 8 bits: what the measures see.
    pub png: String,
    /// Linear.
    pub exr: String,
    /// k of each pixel.
    pub samples: Option<String>,
    /// Against the truth.
    pub error: Option<String>,
}

/// An entry against the bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EntryOracle {
    /// The fewest samples of mean-of-k for the same error.
    pub mean_of_k: Option<MeanOfK>,
    /// One sample a surface, weighted by its coverage.
    pub exact_coverage: Option<Coverage>,
}

/// Neyman's allocation with the error of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanOfK {
    /// Samples, over all.
    pub ratio: f64,
    /// The entry's samples over these.
    pub achieved_over_oracle: f64,
}

/// The bounds at one m, against the grid reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Oracle {
    /// Samples along one side of a window.
    pub m: u32,
    /// Of mean-of-k.
    pub curve: Vec<Neyman>,
    /// Of one sample a surface.
    pub exact_coverage: Option<Coverage>,
}

/// Where flicker was measured: smaller than the report, as each frame has a truth of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TemporalBase {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Of each movement.
    pub frames: u32,
    /// Of each frame's truth.
    pub samples_per_pixel: u32,
}

/// Standard deviation over time of (image − truth), on [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Temporal {
    /// A pan of 1/64 pixel a frame.
    pub pan: Option<Deviation>,
    /// A slow turn.
    pub turn: Option<Deviation>,
}

/// Ids of the entries that no other one beats, by rising cost.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frontier {
    /// By median total milliseconds and error against the truth.
    pub time: Vec<String>,
    /// By samples a pixel and error against the truth.
    pub samples: Vec<String>,
}

/// What a goal settled on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoalRow {
    /// As on the command line.
    pub goal: String,
    /// Asked for.
    pub target: f64,
    /// Of the target: "ms" or "rmse".
    pub unit: String,
    /// Measured at the end.
    pub achieved: f64,
    /// Within the tolerance.
    pub met: bool,
    /// Until it stayed within the tolerance.
    pub frames: u32,
}

/// A square of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    /// Leftmost column.
    pub x: u32,
    /// Topmost row.
    pub y: u32,
    /// Of a side; less at the border of a small picture.
    pub size: u32,
}

impl From<Rect> for Crop {
    fn from(r: Rect) -> Self {
        Self { x: r.x, y: r.y, size: r.width.max(r.height) }
    }
}

impl Entry {
    /// Root mean square error of the displayed image on [0, 1], against all samples of the same grid.
    pub fn grid_error(&self) -> Option<f64> {
        self.stats.quality.grid?.psnr_db.map(rmse)
    }

    /// Root mean square error of the displayed image on [0, 1], against the truth.
    pub fn error(&self) -> Option<f64> {
        self.stats.quality.truth?.psnr_db.map(rmse)
    }

    /// Median milliseconds with the G-buffer.
    pub fn total_ms(&self) -> Option<f64> {
        self.stats.time_ms.get("total").map(|s| s.median)
    }
}

fn rmse(db: f64) -> f64 {
    if db >= crate::measure::quality::IDENTICAL_DB { 0.0 } else { 10f64.powf(-db / 20.0) }
}
