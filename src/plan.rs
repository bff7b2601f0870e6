//! plan: where each window's samples lie in its tile's list, and what the frame will shade.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

pub(crate) const INFO: PassInfo =
    PassInfo { name: "plan", reads: &[Resource::Counts], writes: &[Resource::Plan, Resource::Statistics] };

#[derive(Debug)]
pub(crate) struct Plan {
    layout: wgpu::BindGroupLayout,
    pipeline: Lazy<wgpu::ComputePipeline>,
}

impl Plan {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa plan"),
            entries: &[
                entry::buffer(0, compute, true),
                entry::buffer(1, compute, false),
                entry::buffer(2, compute, false),
            ],
        });
        Self { layout, pipeline: Lazy::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa plan"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: scratch.counts.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: scratch.statistics.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipeline.get(|| {
            let source = wgsl::join_plain(include_str!("../shaders/plan.wgsl"));
            build.compute(INFO.name, source, "daa_plan_main", &self.layout, None)
        })
    }
}
