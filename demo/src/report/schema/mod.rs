//! report.json. Every field is present or null.

pub mod cost;
pub mod effects;
pub mod executions;
pub mod papers;

use crate::measure::oracle::{Bound, Coverage};
use crate::measure::stats::{Adapter, Stats};
use crate::measure::temporal::{Deviation, FrameErrors};
use cost::Cost;
use deferred_aa::Rect;
use effects::Effects;
use executions::ExecutionRow;
use papers::Papers;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of this layout of report.json.
pub const VERSION: u32 = 1;

/// All of report.json.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The version of the layout, [`VERSION`].
    pub version: u32,
    /// The command line as it was typed.
    pub command: String,
    /// The built-in's name or the file's path.
    pub scene: String,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// How often the light loop ran.
    pub stall: u32,
    /// Whether it was made with `--quick`: with fewer settings, samples and points.
    pub quick: bool,
    /// Number of punctual lights, the sun included.
    pub lights: u32,
    /// Triangles of all instances.
    pub triangles: u64,
    /// The adapter that it ran on.
    pub adapter: ReportAdapter,
    /// The reference that everything is held against.
    pub truth: Option<TruthInfo>,
    /// The entries that were measured, in the order of the plan.
    pub entries: Vec<Entry>,
    /// The bounds on mean-of-k, on groups of a surface's samples and on exact coverage, by m.
    pub oracles: Vec<Oracle>,
    /// Where the entries' flicker was measured.
    pub temporal: Option<TemporalBase>,
    /// The entries that no other one beats.
    pub frontier: Frontier,
    /// One image, with its samples run in each way that there is.
    pub executions: Vec<ExecutionRow>,
    /// The cost of a frame against what makes frames costly.
    pub cost: Option<Cost>,
    /// What the effects cost where the scene does not call for them.
    #[serde(default)]
    pub effects: Option<Effects>,
    /// The tables of the papers, with the same rows measured here.
    #[serde(default)]
    pub papers: Option<Papers>,
    /// What the search for each goal settled on.
    pub goals: Vec<GoalRow>,
    /// The places where the image is worst, worst first.
    pub crops: Vec<Crop>,
    /// What was planned and is not finished: ids of entries, and names of other parts.
    pub unfinished: Vec<String>,
    /// The seconds that each part took this time.
    pub seconds: BTreeMap<String, f64>,
}

/// The adapter that a report ran on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReportAdapter {
    /// Its name, driver and backend.
    #[serde(flatten)]
    pub adapter: Adapter,
    /// Whether it is no GPU, so that only ratios of times count.
    pub software: bool,
}

/// The reference of many samples, the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TruthInfo {
    /// Samples of each pixel, on a regular grid.
    pub samples_per_pixel: u32,
    /// Whether it was in the cache already.
    pub cached: bool,
    /// Seconds that it took to render when it was rendered.
    pub seconds: f64,
    /// The name of its file in the folder.
    pub file: String,
}

/// One measured technique with its settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Unique, and the stem of its files: lower-case letters, digits and dashes.
    pub id: String,
    /// Its name for people.
    pub label: String,
    /// Why it is here.
    pub role: Role,
    /// The name of its settings, if they have one.
    pub preset: Option<String>,
    /// The measurements, as stats.json has them.
    #[serde(flatten)]
    pub stats: Stats,
    /// Its files in the folder.
    pub files: Files,
    /// How far it lies above the bounds.
    pub oracle: Option<EntryOracle>,
    /// How much it flickers, and how far its moving frames are from the truth.
    pub temporal: Option<Temporal>,
}

/// Why an entry is in the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// It is a technique of the library.
    Technique,
    /// It is a peer, to measure against.
    Peer,
    /// It is what a goal settled on.
    Goal,
}

/// An entry's files, by their names in the folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Files {
    /// The picture in 8-bit sRGB, as the measures see it.
    pub png: String,
    /// The linear picture.
    pub exr: String,
    /// The samples of each pixel.
    pub samples: Option<String>,
    /// The error against the truth.
    pub error: Option<String>,
}

/// An entry against the bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EntryOracle {
    /// The fewest samples of mean-of-k for the same error.
    pub mean_of_k: Option<EqualError>,
    /// The fewest lights of groups of a surface's samples for the same error; of Surfaces only.
    pub groups: Option<EqualError>,
    /// One sample a surface, weighted by its coverage.
    pub exact_coverage: Option<Coverage>,
}

/// A bound with the error of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EqualError {
    /// The bound's samples or lights over all n · w · h samples.
    pub ratio: f64,
    /// The entry's samples or lights over these.
    pub achieved_over_oracle: f64,
}

/// The bounds at one m, against the grid reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Oracle {
    /// Samples along one side of a window.
    pub m: u32,
    /// The bound on means of k samples.
    pub curve: Vec<Bound>,
    /// The bound on lights of groups of a surface's samples, where there are entries of Surfaces.
    #[serde(default)]
    pub groups: Vec<Bound>,
    /// The bound on one sample a surface.
    pub exact_coverage: Option<Coverage>,
}

/// Where flicker was measured: smaller than the report, as each frame has a truth of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TemporalBase {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames of each movement.
    pub frames: u32,
    /// Samples a pixel of each frame's truth.
    pub samples_per_pixel: u32,
}

/// The standard deviation over time of (image − truth), on [0, 1], and the errors of moving frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Temporal {
    /// While the image moves by 1/64 pixel a frame.
    pub pan: Option<Deviation>,
    /// While the camera turns slowly.
    pub turn: Option<Deviation>,
    /// The same frames against the truth of each, and frames for which a history is of no use.
    #[serde(default)]
    pub errors: Option<MovingErrors>,
}

/// The errors of moving frames. Those without a history have the same error in the last two, which are one view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MovingErrors {
    /// Of the slow pan.
    pub pan: FrameErrors,
    /// Of the slow turn.
    pub turn: FrameErrors,
    /// PSNR of the first frame after the camera cuts, in dB.
    pub cut_db: f64,
    /// PSNR of a frame while the camera goes round what it looks at, 4 pixels a frame, in dB.
    pub uncovering_db: f64,
}

/// Ids of the entries that no other one beats, by rising cost.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frontier {
    /// The frontier of median total milliseconds and error against the truth.
    pub time: Vec<String>,
    /// The frontier of samples a pixel and error against the truth.
    pub samples: Vec<String>,
}

/// What a goal settled on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GoalRow {
    /// The goal as it is written on the command line.
    pub goal: String,
    /// The value that was asked for.
    pub target: f64,
    /// The unit of the target: "ms" or "rmse".
    pub unit: String,
    /// The value that was measured at the end.
    pub achieved: f64,
    /// Whether that is within the tolerance.
    pub met: bool,
    /// Frames until it stayed within the tolerance.
    pub frames: u32,
}

/// A square of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    /// Leftmost column.
    pub x: u32,
    /// Topmost row.
    pub y: u32,
    /// Pixels of a side; fewer at the border of a small picture.
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
