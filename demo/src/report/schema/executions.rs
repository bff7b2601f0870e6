//! One image, its samples run in each way that there is.

use crate::measure::stats::Spread;
use deferred_aa::Execution;
use serde::{Deserialize, Serialize};

/// One way to run the samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExecutionRow {
    /// The execution.
    pub execution: Execution,
    /// Samples along one side of a window.
    pub m: u32,
    /// How often the light loop ran.
    pub stall: u32,
    /// Shaded samples over all n · w · h samples.
    pub samples_ratio: f64,
    /// Time of all passes of the node.
    pub node_ms: Option<Spread>,
    /// Time of the pass that shades the planned samples.
    pub shade_ms: Option<Spread>,
    /// Time of a sample beyond the first over that of a sample of Full.
    pub beta: Option<f64>,
    /// Median over the rounds of the node's time over that of the first execution in the same round.
    pub relative_to_loop: Option<f64>,
    /// Greatest difference to the first execution's displayed image, on [0, 1].
    pub max_difference: f64,
}
