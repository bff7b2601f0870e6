//! The tables that papers print, and the same rows measured.

use crate::measure::stats::Spread;
use deferred_aa::Settings;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The tables of all papers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Papers {
    /// The tables, in the order of the papers.
    pub tables: Vec<Table<Row>>,
}

/// A table or figure of a paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table<R> {
    /// A unique id: lower-case letters, digits and dashes.
    pub id: String,
    /// The paper, and the place in it.
    pub title: String,
    /// What the paper measured and what we do.
    pub note: String,
    /// The id of the row that samples and speeds are over.
    pub over: String,
    /// Whether its rows have times.
    pub timed: bool,
    /// No row is supersampled: they are held against the one that the table is over, which comes first, and their times
    /// are apart by what they are for.
    #[serde(default)]
    pub sparse: bool,
    /// The rows, in the paper's order.
    pub rows: Vec<R>,
}

impl<R> Table<R> {
    /// Makes each row into another one.
    pub fn try_map<S, E>(self, row: impl FnMut(R) -> Result<S, E>) -> Result<Table<S>, E> {
        let Self { id, title, note, over, timed, sparse, rows } = self;
        Ok(Table { id, title, note, over, timed, sparse, rows: rows.into_iter().map(row).collect::<Result<_, _>>()? })
    }
}

/// A row before it is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// An id that is unique in its table.
    pub id: String,
    /// The name for people.
    pub label: String,
    /// The curve that it is a point of, where its table has curves.
    pub series: Option<String>,
    /// Samples along one side of a window: rows of other m have a G-buffer of their own.
    pub m: u32,
    /// The settings that are recorded.
    pub settings: Settings,
    /// What the paper prints, for each of its scenes; none for rows of our own.
    pub printed: Vec<Printed>,
}

/// A paper's own figures of a row on one of its scenes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Printed {
    /// The paper's name of the scene.
    pub scene: String,
    /// PSNR against the paper's truth.
    pub psnr_db: Option<f64>,
    /// Samples over those of the row that the table is over.
    pub samples: Option<f64>,
    /// Frames a second.
    pub fps: Option<f64>,
    /// Frames a second over those of the row that the table is over.
    pub speed: Option<f64>,
    /// Samples over those of the first curve at the same PSNR.
    pub same_psnr: Option<f64>,
}

/// A row, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What was measured.
    #[serde(flatten)]
    pub planned: Planned,
    /// Samples a pixel.
    pub mean_k: f64,
    /// Samples over those of the row that the table is over.
    pub samples: Option<f64>,
    /// PSNR against the truth.
    pub truth_db: f64,
    /// PSNR against all samples of the same grid; none at m = 1.
    pub grid_db: Option<f64>,
    /// PSNR against the row that the table is over; none where the table is not sparse.
    #[serde(default)]
    pub over_db: Option<f64>,
    /// Times by pass, with `gbuffer`, `node` and `total`; empty where the table has no times.
    pub time_ms: BTreeMap<String, Spread>,
    /// Times of the node's passes by what they are for, [`PARTS`](crate::pass_kind::PARTS); empty where the table is
    /// not sparse.
    #[serde(default)]
    pub parts_ms: BTreeMap<String, Spread>,
    /// Median over the rounds of the total of the row that the table is over, in the same round, over this row's.
    pub speed: Option<f64>,
    /// The same of the node's passes alone, without the G-buffer.
    pub node_speed: Option<f64>,
    /// Samples over those of the table's first curve at the same PSNR, between its points; none beyond them and for
    /// that curve.
    pub same_psnr: Option<f64>,
}
