//! A pass at its position in a frame.

use crate::gpu::binding::{PassData, Slot};
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::lattice::LatticeStep;
use crate::host::graph::{Part, PassInfo};
use crate::host::needs::RayInputs;
use crate::settings::Settings;

/// A pass of the frame, in the order in which [`DeferredAa::passes`](crate::DeferredAa::passes) yields it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    /// The name of the pass, its entry points, and the resources that it reads and writes.
    pub info: PassInfo,
    pub(crate) step: Step,
    pub(crate) index: usize,
}

/// A pass and the samples or lattice that it works on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    pub pass: &'static PassData,
    /// The samples that it casts rays from.
    pub samples: Option<CastSamples>,
    /// The position among the lattices of the one that it works on.
    pub lattice: Option<LatticeStep>,
}

impl From<&'static PassData> for Step {
    fn from(pass: &'static PassData) -> Self {
        Self { pass, samples: None, lattice: None }
    }
}

impl Step {
    pub fn cast(pass: &'static PassData, samples: CastSamples) -> Self {
        Self { pass, samples: Some(samples), lattice: samples.step() }
    }

    pub fn on(pass: &'static PassData, lattice: LatticeStep) -> Self {
        Self { pass, samples: None, lattice: Some(lattice) }
    }

    fn name(&self) -> &'static str {
        let of_level = self.lattice.and_then(|lattice| self.pass.names.get(lattice.level as usize));
        of_level.or(self.pass.names.first()).copied().unwrap_or_default()
    }

    /// The public description of the step in a frame with these ray results.
    pub fn info(&self, settings: &Settings, inputs: RayInputs) -> PassInfo {
        PassInfo {
            name: self.name(),
            kind: self.pass.kind,
            reads: self.pass.reads(inputs),
            writes: self.pass.writes(inputs),
            stages: self.pass.stages,
            rounds: self.pass.rounds,
            lattice: self.lattice.map(|lattice| lattice.shapes(&settings.multi_resolution)),
        }
    }
}

/// The steps of a frame, top to bottom.
#[derive(Debug, Default)]
pub(crate) struct Steps(pub Vec<Step>);

impl Steps {
    pub fn then(mut self, step: impl Into<Step>) -> Self {
        self.0.push(step.into());
        self
    }

    pub fn then_if(self, condition: bool, step: impl Into<Step>) -> Self {
        if condition { self.then(step) } else { self }
    }

    pub fn then_all(mut self, steps: impl IntoIterator<Item = Step>) -> Self {
        self.0.extend(steps);
        self
    }
}

/// The parts that the passes of a frame use.
pub(crate) fn used_parts(steps: &[Step]) -> Vec<Part> {
    let mut parts = Vec::new();
    let bound = steps.iter().flat_map(|step| step.pass.bindings).filter(|binding| binding.used.is_some());
    for part in bound.filter_map(|binding| if let Slot::Part(part) = binding.slot { Some(part) } else { None }) {
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    parts
}
