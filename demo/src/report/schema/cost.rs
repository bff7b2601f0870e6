//! What a frame costs, as curves.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// All curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// What the curves have in common, but for what each varies.
    pub base: Base,
    /// Against how often the light loop runs.
    pub stall: Vec<Point>,
    /// The least stall from which on Windowed takes less time than Full, G-buffer included.
    pub crossover_stall: Option<f64>,
    /// Against pixels.
    pub resolution: Vec<Point>,
    /// Against m.
    pub m: Vec<Point>,
    /// Against punctual lights, the sun left out.
    pub lights: Vec<Point>,
    /// Against triangles.
    pub triangles: Vec<Point>,
    /// By curve and time, such as "resolution", "full_ms".
    pub fits: BTreeMap<String, BTreeMap<String, Fit>>,
}

/// Where the curves were measured: smaller than the report on a software driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Base {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Samples along one side of a window.
    pub m: u32,
    /// How often the light loop runs.
    pub stall: u32,
    /// Measured frames a point.
    pub frames: u32,
}

/// Median milliseconds at one place of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// What is varied.
    pub x: f64,
    /// Full, the node alone.
    pub full_ms: Option<f64>,
    /// Single, the node alone.
    pub single_ms: Option<f64>,
    /// Windowed, the node alone.
    pub windowed_ms: Option<f64>,
    /// Full with the G-buffer.
    pub full_total_ms: Option<f64>,
    /// Single with the G-buffer.
    pub single_total_ms: Option<f64>,
    /// Windowed with the G-buffer.
    pub windowed_total_ms: Option<f64>,
}

/// y ≈ c·x^exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// 1: as x; 0: not at all.
    pub exponent: f64,
    /// The share of the variance of log y that the fit explains; 1: all.
    pub r2: f64,
}
