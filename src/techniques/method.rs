//! The trait of techniques.

use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::Steps;
use crate::gpu::uniforms::frame::FrameUniform;
use crate::gpu::uniforms::lattice::LatticeSteps;
use crate::host::error::RecordError;
use crate::host::needs::{Needs, RayInputs};
use crate::host::plan::PlanWord;
use crate::host::statistics::{Counters, DecidedCounts};
use crate::settings::{Execution, Settings};
use crate::window;

/// The effort of a frame with a goal, and the step below it at which its audit also measures the error; both log2.
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

/// The meaning of a frame's counters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Counted {
    pub shaded: u64,
    pub histogram_k: Vec<u32>,
    pub decided: DecidedCounts,
}

impl Counted {
    /// For frames whose passes count windows by k.
    pub fn by_k(counters: &Counters, n: usize, decided: DecidedCounts) -> Self {
        let histogram_k = counters.histogram[..n].to_vec();
        let shaded = histogram_k.iter().zip(1u64..).map(|(&windows, k)| u64::from(windows) * k).sum();
        Self { shaded, histogram_k, decided }
    }

    /// For frames in which all windows have the same k.
    pub fn uniform(k: usize, of: Windows) -> Self {
        let mut histogram_k = vec![0; of.n];
        histogram_k[k - 1] = of.windows as u32;
        Self { shaded: of.windows * k as u64, histogram_k, decided: nothing(of) }
    }
}

/// The counts of frames in which no metric decides k.
pub(super) fn nothing(of: Windows) -> DecidedCounts {
    DecidedCounts { nothing: of.windows as u32, ..Default::default() }
}

/// A technique: its check of a frame, its part of the constants, its passes, and the meaning of its counters.
pub(crate) trait Method: Sync {
    /// Refuses frames that the technique can't render although all settings are in range.
    fn check(&self, _settings: &Settings, _needs: &Needs<'_>, _size: [u32; 2], _m: u32) -> Result<(), RecordError> {
        Ok(())
    }

    /// Fills in its part of the frame's constants.
    fn uniform(&self, settings: &Settings, m: u32, effort: Option<Effort>, uniform: &mut FrameUniform);

    /// The passes of a frame, in order.
    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps;

    /// Interprets the counters.
    fn count(&self, counters: &Counters, of: Windows) -> Counted;

    /// The places of a window's samples in the order in which they are shaded: `order[rank] = (x, y)`.
    fn order(&self, _settings: &Settings, m: u32) -> Vec<(u8, u8)> {
        window::order(m)
    }

    /// The ranks of a window that are shaded, from its word of the plan. `None` if the plan has only their number.
    fn shaded(&self, _settings: &Settings, _m: u32, word: PlanWord) -> Option<Vec<usize>> {
        Some((0..word.k() as usize).collect())
    }

    /// The ranks of a window that cast rays, from its word of the plan: those that are shaded.
    fn cast(&self, settings: &Settings, m: u32, word: PlanWord) -> Option<Vec<usize>> {
        self.shaded(settings, m, word)
    }

    /// The execution of its planned samples, `None` if it ignores the setting.
    fn execution(&self, _settings: &Settings) -> Option<Execution> {
        None
    }

    /// The lattices that it refines, if any.
    fn lattices(
        &self,
        _settings: &Settings,
        _size: [u32; 2],
        _image: [u32; 2],
        _inputs: RayInputs,
    ) -> Option<LatticeSteps> {
        None
    }

    /// The samples that may cast rays.
    fn casting(&self, settings: &Settings, m: u32) -> CastingRanks;

    /// How far around a pixel its passes read what lies in other pixels, in pixels. A band is rastered so much further
    /// than it is shown.
    fn apron(&self, _settings: &Settings, _inputs: RayInputs) -> u32 {
        0
    }

    /// Whether it reads the marks of materials and objects ([`Needs::textured`], [`Needs::importance`]).
    fn reads_marks(&self) -> bool {
        false
    }

    /// Whether it reads the hits of the rays of first samples.
    fn reads_hits(&self) -> bool {
        false
    }
}
