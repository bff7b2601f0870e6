//! reconstruct: geometric samples take their colours from shaded ones around them.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource};
use crate::pixels;
use crate::scratch::Scratch;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "reconstruct",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First],
    writes: &[Resource::Color, Resource::Plan, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Traced], ..INFO };

const LABEL: &str = "daa reconstruct";

#[derive(Debug)]
pub(crate) struct Reconstruct {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Reconstruct {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = pixels::layout(device, LABEL, true);
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        pixels::bind(device, LABEL, &self.layout, scratch)
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let pass = [
                include_str!("../shaders/ranks.wgsl"),
                include_str!("../shaders/bilateral.wgsl"),
                include_str!("../shaders/reconstruct.wgsl"),
            ];
            let source = build.host.join(&pass.join("\n"), traced);
            build.compute(INFO.name, source, "daa_reconstruct_main", &self.layout, Some(traced))
        })
    }
}
