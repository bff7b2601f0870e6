//! trace: shadow rays from the samples that will be shaded.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy};
use crate::rays::{RayScene, RayTier};
use crate::scratch::Scratch;
use crate::traces::{self, Traces};

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
}
