//! view: a debug view in place of resolve.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::traces::Traces;
use crate::wgsl;

pub(crate) const NAME: &str = "view";

/// What it shows of a frame's rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Seen {
    /// Where they were dispatched.
    Tiles,
    /// What they found.
    Traced,
}

/// It reads the first samples and the plan of frames that have them, or what it shows of rays.
pub(crate) const fn info(first: bool, planned: bool, seen: Option<Seen>) -> PassInfo {
    let reads: &[Resource] = match (seen, first, planned) {
        (Some(Seen::Tiles), ..) => &[Resource::GBuffer, Resource::Tiles],
        (Some(Seen::Traced), ..) => &[Resource::GBuffer, Resource::Traced],
        (None, _, true) => &[Resource::GBuffer, Resource::First, Resource::Plan],
        (None, true, false) => &[Resource::GBuffer, Resource::First],
        (None, false, false) => &[Resource::GBuffer],
    };
    PassInfo { name: NAME, reads, writes: &[Resource::Target] }
}

#[derive(Debug)]
pub(crate) struct View {
    layout: wgpu::BindGroupLayout,
    /// For frames of whose rays nothing is shown.
    nothing: wgpu::Buffer,
    pipeline: Lazy<wgpu::RenderPipeline>,
}

impl View {
    pub fn new(device: &wgpu::Device) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa view"),
            entries: &[
                entry::texture(0, fragment),
                entry::buffer(1, fragment, true),
                entry::buffer(2, fragment, true),
                entry::buffer(3, fragment, true),
                entry::buffer(4, fragment, true),
            ],
        });
        Self { layout, nothing: Traces::nothing(device), pipeline: Lazy::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch, traces: Option<&Traces>) -> wgpu::BindGroup {
        let tiles = traces.map_or(&self.nothing, |traces| &traces.tiles);
        let shadows = traces.and_then(|traces| traces.shadows.as_ref()).unwrap_or(&self.nothing);
        let secondary = traces.and_then(|traces| traces.secondary.as_ref()).unwrap_or(&self.nothing);
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa view"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: tiles.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: shadows.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 4, resource: secondary.as_entire_binding() },
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
