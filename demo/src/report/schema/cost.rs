//! What a frame costs, as curves.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// All curves of the cost of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// The settings that all curves share, except for what each varies.
    pub base: Base,
    /// The cost against the number of times that the light loop runs.
    pub stall: Vec<Point>,
    /// The least stall from which on Windowed takes less time than Full, G-buffer included.
    pub crossover_stall: Option<f64>,
    /// The cost against the number of pixels.
    pub resolution: Vec<Point>,
    /// The cost against m.
    pub m: Vec<Point>,
    /// The cost against the number of punctual lights, without the sun.
    pub lights: Vec<Point>,
    /// The cost against the number of triangles.
    pub triangles: Vec<Point>,
    /// The fits by curve and time, such as "resolution" and "full_ms".
    pub fits: BTreeMap<String, BTreeMap<String, Fit>>,
}

/// Where the curves were measured: smaller than the report on a software driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Base {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples along one side of a window.
    pub m: u32,
    /// How often the light loop runs.
    pub stall: u32,
    /// Measured frames of each point.
    pub frames: u32,
}

/// Median milliseconds at one place of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The value that is varied.
    pub x: f64,
    /// Time of Full's passes in the node.
    pub full_ms: Option<f64>,
    /// Time of Single's passes in the node.
    pub single_ms: Option<f64>,
    /// Time of Windowed's passes in the node.
    pub windowed_ms: Option<f64>,
    /// Time of Full with the G-buffer.
    pub full_total_ms: Option<f64>,
    /// Time of Single with the G-buffer.
    pub single_total_ms: Option<f64>,
    /// Time of Windowed with the G-buffer.
    pub windowed_total_ms: Option<f64>,
}

/// A power law, y ≈ c·x^exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The exponent: 1 where y grows as x does, 0 where it does not grow.
    pub exponent: f64,
    /// The share of the variance of log y that the fit explains, at most 1.
    pub r2: f64,
}
