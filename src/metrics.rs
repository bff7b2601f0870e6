//! metrics: how many samples each window is worth.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

pub(crate) const INFO: PassInfo =
    PassInfo { name: "metrics", reads: &[Resource::GBuffer, Resource::First], writes: &[Resource::Counts] };

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::First, Resource::Traced], ..INFO };

#[derive(Debug)]
pub(crate) struct Metrics {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Metrics {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa metrics"),
            entries: &[entry::texture(0, compute), entry::buffer(1, compute, false)],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa metrics"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.counts.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let source = wgsl::join_reading(include_str!("../shaders/metrics.wgsl"), traced);
            build.compute_plain(INFO.name, source, "daa_metrics_main", &self.layout, traced)
        })
    }
}
