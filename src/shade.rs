//! shade: the samples beyond the first, and their mean with it.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
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

#[derive(Debug)]
pub(crate) struct Shade {
    layout: wgpu::BindGroupLayout,
    pipelines: [[Lazy<wgpu::ComputePipeline>; Traced::COUNT]; 3],
}

impl Shade {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa shade"),
            entries: &[
                entry::texture(0, compute),
                entry::buffer(1, compute, true),
                entry::store(2),
                entry::buffer(3, compute, false),
            ],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa shade"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&scratch.color) },
                wgpu::BindGroupEntry { binding: 3, resource: scratch.statistics.as_entire_binding() },
            ],
        })
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
