//! extra: the samples of active quadrants, and their mean with the first samples.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource};
use crate::pixels;
use crate::scratch::Scratch;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "extra",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan],
    writes: &[Resource::Color, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::Traced], ..INFO };

const LABEL: &str = "daa extra";

#[derive(Debug)]
pub(crate) struct Extra {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Extra {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = pixels::layout(device, LABEL, false);
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        pixels::bind(device, LABEL, &self.layout, scratch)
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let pass = concat!(include_str!("../shaders/ranks.wgsl"), "\n", include_str!("../shaders/extra.wgsl"));
            let source = build.host.join(pass, traced);
            build.compute(INFO.name, source, "daa_extra_main", &self.layout, Some(traced))
        })
    }
}
