//! What a technique is made of.

use crate::gpu::step::Steps;
use crate::gpu::uniforms::frame::FrameUniform;
use crate::gpu::uniforms::lattice::LatticeSteps;
use crate::host::error::RecordError;
use crate::host::needs::{Needs, RayInputs};
use crate::host::statistics::{Counters, DecidedCounts};
use crate::settings::{Execution, Settings};

/// The effort of a frame with a goal: what it is scaled by, and how far below its audit looks ahead, log2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Effort {
    pub effort: f32,
    pub step: f32,
}

/// The windows of a frame, and the samples of each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Windows {
    pub n: usize,
    pub windows: u64,
}

/// What the counters of a frame say.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Counted {
    pub shaded: u64,
    pub histogram_k: Vec<u32>,
    pub decided: DecidedCounts,
}

impl Counted {
    /// Of frames whose passes count windows by k.
    pub fn by_k(counters: &Counters, n: usize, decided: DecidedCounts) -> Self {
        let histogram_k = counters.histogram[..n].to_vec();
        let shaded = histogram_k.iter().zip(1u64..).map(|(&windows, k)| u64::from(windows) * k).sum();
        Self { shaded, histogram_k, decided }
    }

    /// Of frames all of whose windows have the same k.
    pub fn uniform(k: usize, of: Windows) -> Self {
        let mut histogram_k = vec![0; of.n];
        histogram_k[k - 1] = of.windows as u32;
        Self { shaded: of.windows * k as u64, histogram_k, decided: nothing(of) }
    }
}

/// No metric decides anything.
pub(super) fn nothing(of: Windows) -> DecidedCounts {
    DecidedCounts { nothing: of.windows as u32, ..Default::default() }
}

/// A technique: what it refuses, what it tells the shaders, its passes, and what its counters mean.
pub(crate) trait Method: Sync {
    /// Refuses frames that the ranges of the settings let through.
    fn check(&self, _settings: &Settings, _needs: &Needs<'_>, _size: [u32; 2], _m: u32) -> Result<(), RecordError> {
        Ok(())
    }

    /// Fills in its part of the frame's constants.
    fn uniform(&self, settings: &Settings, m: u32, effort: Option<Effort>, uniform: &mut FrameUniform);

    /// Its passes in order.
    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps;

    /// What its counters mean.
    fn count(&self, counters: &Counters, of: Windows) -> Counted;

    /// How its planned samples are run, if the settings say.
    fn execution(&self, _settings: &Settings) -> Option<Execution> {
        None
    }

    /// The lattices that it goes through.
    fn lattices(&self, _settings: &Settings, _size: [u32; 2], _inputs: RayInputs) -> Option<LatticeSteps> {
        None
    }

    /// Whether it can be scaled to a goal.
    fn has_effort(&self) -> bool {
        false
    }

    /// Whether it looks at what the host says of its materials and objects.
    fn reads_marks(&self) -> bool {
        false
    }

    /// Whether it looks at what the rays of first samples met.
    fn reads_hits(&self) -> bool {
        false
    }
}
