//! trace: shadow rays from the samples that will be shaded.

use crate::audit::Audited;
use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource};
use crate::rays::{RayScene, RayTier};
use crate::scratch::{self, Scratch};
use crate::traces::{self, Traces};

/// Before `first`.
pub(crate) const INFO_FIRST: PassInfo = PassInfo {
    name: "trace first",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays],
    writes: &[Resource::Traced, Resource::Statistics],
};

/// For `Full`.
pub(crate) const INFO_FULL: PassInfo = PassInfo { name: "trace", ..INFO_FIRST };

/// Behind the plan.
pub(crate) const INFO: PassInfo = PassInfo {
    name: "trace",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Plan],
    writes: &[Resource::Traced, Resource::Statistics],
};

/// Before `audit`.
pub(crate) const INFO_AUDITED: PassInfo = PassInfo { name: "trace audited", ..INFO };

/// Behind `first`, for `Reconstructed`.
pub(crate) const INFO_GEOMETRIC: PassInfo = PassInfo {
    name: "trace",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Traced],
    writes: &[Resource::Traced, Resource::Statistics],
};

/// Which samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Samples {
    First,
    Full,
    Planned,
    Audited,
    Geometric,
}

impl Samples {
    /// How many there are.
    pub const COUNT: u64 = 5;

    pub fn info(self) -> PassInfo {
        match self {
            Self::First => INFO_FIRST,
            Self::Full => INFO_FULL,
            Self::Planned => INFO,
            Self::Audited => INFO_AUDITED,
            Self::Geometric => INFO_GEOMETRIC,
        }
    }
}

#[derive(Debug)]
pub(crate) struct Trace {
    layout: wgpu::BindGroupLayout,
    pipeline: Lazy<wgpu::ComputePipeline>,
}

impl Trace {
    pub fn new(device: &wgpu::Device, tier: RayTier) -> Self {
        Self { layout: traces::layout(device, tier, false), pipeline: Lazy::default() }
    }

    /// `None` if the frame traces no shadows.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        scratch: &Scratch,
        traces: &Traces,
        scene: &RayScene,
    ) -> Option<wgpu::BindGroup> {
        let shadows = traces.shadows.as_ref()?;
        Some(traces::bind(device, &self.layout, scratch, traces, scene, shadows, None))
    }

    pub fn pipeline(&self, build: &Build, tier: RayTier) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipeline.get(|| {
            let source = build.host.join_traced(include_str!("../shaders/trace.wgsl"), tier, false);
            let host = build.host.solid.then(Traced::default);
            build.compute("trace", source, "daa_trace_main", &self.layout, host)
        })
    }

    /// Workgroups of a dispatch.
    pub fn groups(samples: Samples, size: [u32; 2], audited: Audited) -> [u32; 2] {
        match samples {
            Samples::Audited => crate::audit::Audit::groups(audited, size),
            _ => scratch::tiles(size),
        }
    }
}
