//! shade: the samples beyond the first, and their mean with it.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource};
use crate::pixels;
use crate::scratch::Scratch;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "shade",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan],
    writes: &[Resource::Color, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::Traced], ..INFO };

/// For `Full`, which has neither first samples nor a plan.
pub(crate) const INFO_FULL: PassInfo = PassInfo {
    name: "shade",
    reads: &[Resource::GBuffer, Resource::Host],
    writes: &[Resource::Color, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_FULL_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::Host, Resource::Traced], ..INFO_FULL };

/// The ways to run it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Variant {
    Full,
    Loop,
    Tiled,
}

const LABEL: &str = "daa shade";

#[derive(Debug)]
pub(crate) struct Shade {
    layout: wgpu::BindGroupLayout,
    pipelines: [[Lazy<wgpu::ComputePipeline>; Traced::COUNT]; 3],
}

impl Shade {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = pixels::layout(device, LABEL, false);
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        pixels::bind(device, LABEL, &self.layout, scratch)
    }

    pub fn pipeline(
        &self,
        build: &Build,
        variant: Variant,
        traced: Traced,
    ) -> Result<&wgpu::ComputePipeline, PipelineError> {
        let entry = match variant {
            Variant::Full => "daa_shade_full",
            Variant::Loop => "daa_shade_loop",
            Variant::Tiled => "daa_shade_tiled",
        };
        self.pipelines[variant as usize][traced.index()].get(|| {
            let source = build.host.join(include_str!("../shaders/shade.wgsl"), traced);
            build.compute(INFO.name, source, entry, &self.layout, Some(traced))
        })
    }
}
