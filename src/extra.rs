//! extra: the samples of active quadrants, and their mean with the first samples.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "extra",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan],
    writes: &[Resource::Color, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::Traced], ..INFO };

#[derive(Debug)]
pub(crate) struct Extra {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Extra {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa extra"),
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
            label: Some("daa extra"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&scratch.color) },
                wgpu::BindGroupEntry { binding: 3, resource: scratch.statistics.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let pass = concat!(include_str!("../shaders/ranks.wgsl"), "\n", include_str!("../shaders/extra.wgsl"));
            let source = build.host.join(pass, traced);
            build.compute(INFO.name, source, "daa_extra_main", &self.layout, Some(traced))
        })
    }
}
