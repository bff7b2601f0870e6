//! bounce: mirrored and refracted rays from samples whose material sends them.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo};
use crate::rays::{RayScene, RayTier};
use crate::scratch::Scratch;
use crate::traces::{self, Samples, Traces};

/// What it reads and writes is what `trace` does for the same samples.
pub(crate) fn info(samples: Samples) -> PassInfo {
    let name = match samples {
        Samples::First => "bounce first",
        Samples::Audited => "bounce audited",
        Samples::Full | Samples::Planned | Samples::Geometric => "bounce",
        Samples::Points(place) => place.named(["bounce", "bounce shifted", "bounce 1/2", "bounce 1/4", "bounce 1/8"]),
    };
    PassInfo { name, ..samples.info() }
}

#[derive(Debug)]
pub(crate) struct Bounce {
    layout: wgpu::BindGroupLayout,
    pipeline: Lazy<wgpu::ComputePipeline>,
}

impl Bounce {
    pub fn new(device: &wgpu::Device, tier: RayTier) -> Self {
        Self { layout: traces::layout(device, tier, true), pipeline: Lazy::default() }
    }

    /// `None` if the frame reflects and refracts nothing.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        scratch: &Scratch,
        traces: &Traces,
        scene: &RayScene,
        bouncing: &wgpu::Buffer,
    ) -> Option<wgpu::BindGroup> {
        let secondary = traces.secondary.as_ref()?;
        Some(traces::bind(device, &self.layout, scratch, traces, scene, secondary, Some(bouncing)))
    }

    pub fn pipeline(&self, build: &Build, tier: RayTier) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipeline.get(|| {
            let source = build.host.join_traced(include_str!("../shaders/bounce.wgsl"), tier, true);
            build.compute("bounce", source, "daa_bounce_main", &self.layout, Some(Traced::default()))
        })
    }
}
