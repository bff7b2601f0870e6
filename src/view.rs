//! view: a debug view in place of resolve.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

pub(crate) const NAME: &str = "view";

/// It reads the first samples and the plan of frames that have them.
pub(crate) const fn info(first: bool, planned: bool) -> PassInfo {
    let reads: &[Resource] = match (first, planned) {
        (_, true) => &[Resource::GBuffer, Resource::First, Resource::Plan],
        (true, false) => &[Resource::GBuffer, Resource::First],
        (false, false) => &[Resource::GBuffer],
    };
    PassInfo { name: NAME, reads, writes: &[Resource::Target] }
}

#[derive(Debug)]
pub(crate) struct View {
    layout: wgpu::BindGroupLayout,
    pipeline: Lazy<wgpu::RenderPipeline>,
}

impl View {
    pub fn new(device: &wgpu::Device) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa view"),
            entries: &[entry::texture(0, fragment), entry::buffer(1, fragment, true)],
        });
        Self { layout, pipeline: Lazy::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa view"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build) -> Result<&wgpu::RenderPipeline, PipelineError> {
        self.pipeline.get(|| {
            let text = wgsl::join_plain(include_str!("../shaders/view.wgsl"));
            let entries = ["daa_view_vertex", "daa_view_fragment"];
            build.fullscreen(NAME, text, entries, &self.layout, &[("DAA_M", f64::from(build.m))])
        })
    }
}
