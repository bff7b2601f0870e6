//! max_filter: every pixel takes the greatest k of its block of 6 × 6 pixels.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

pub(crate) const INFO: PassInfo =
    PassInfo { name: "max_filter", reads: &[Resource::Counts], writes: &[Resource::Counts] };

/// Pixels along a side that one workgroup filters: 8 blocks of 6.
pub(crate) const REACH: u32 = 48;

#[derive(Debug)]
pub(crate) struct MaxFilter {
    layout: wgpu::BindGroupLayout,
    pipeline: Lazy<wgpu::ComputePipeline>,
}

impl MaxFilter {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa max_filter"),
            entries: &[entry::buffer(0, wgpu::ShaderStages::COMPUTE, false)],
        });
        Self { layout, pipeline: Lazy::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa max_filter"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: scratch.counts.as_entire_binding() }],
        })
    }

    pub fn pipeline(&self, build: &Build) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipeline.get(|| {
            let source = wgsl::join_plain(include_str!("../shaders/max_filter.wgsl"));
            build.compute(INFO.name, source, "daa_max_filter_main", &self.layout, None)
        })
    }
}
