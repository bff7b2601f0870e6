//! first: shades the rank-0 sample of every window into S.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "first",
    reads: &[Resource::GBuffer, Resource::Host],
    writes: &[Resource::First, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::Host, Resource::Traced], ..INFO };

#[derive(Debug)]
pub(crate) struct First {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl First {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa first"),
            entries: &[entry::store(0), entry::buffer(1, wgpu::ShaderStages::COMPUTE, false)],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa first"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.statistics.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let source = build.host.join(include_str!("../shaders/first.wgsl"), traced);
            build.compute(INFO.name, source, "daa_first_main", &self.layout, Some(traced))
        })
    }
}
