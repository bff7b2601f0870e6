//! resolve: writes the image into the host's target.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

pub(crate) const NAME: &str = "resolve";

/// Where the image lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Source {
    First,
    Color,
    ByPlan,
    Lattice,
}

impl Source {
    pub const fn info(self) -> PassInfo {
        let reads: &[Resource] = match self {
            Self::First => &[Resource::First],
            Self::Color => &[Resource::Color],
            Self::Lattice => &[Resource::Lattice],
            Self::ByPlan => &[Resource::First, Resource::Color, Resource::Plan],
        };
        PassInfo { name: NAME, reads, writes: &[Resource::Target] }
    }
}

#[derive(Debug)]
pub(crate) struct Resolve {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::RenderPipeline>; 4],
}

impl Resolve {
    pub fn new(device: &wgpu::Device) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa resolve"),
            entries: &[
                entry::texture(0, fragment),
                entry::texture(1, fragment),
                entry::buffer(2, fragment, true),
                entry::buffer(3, fragment, true),
            ],
        });
        Self { layout, pipelines: Default::default() }
    }

    /// `lattice`: the colours of [`Source::Lattice`]; without, any buffer stands for them.
    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch, lattice: Option<&wgpu::Buffer>) -> wgpu::BindGroup {
        let lattice = lattice.unwrap_or(&scratch.plan);
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa resolve"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&scratch.color) },
                wgpu::BindGroupEntry { binding: 2, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: lattice.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, source: Source) -> Result<&wgpu::RenderPipeline, PipelineError> {
        self.pipelines[source as usize].get(|| {
            let constants = [
                ("DAA_M", f64::from(build.m)),
                ("DAA_SOURCE", f64::from(source as u32)),
                ("DAA_TARGET_MAX", f64::from(target_max(build.target_format))),
            ];
            let text = wgsl::join_plain(include_str!("../shaders/resolve.wgsl"));
            let entries = ["daa_resolve_vertex", "daa_resolve_fragment"];
            build.fullscreen(NAME, text, entries, &self.layout, &constants)
        })
    }
}

/// The greatest finite value of a colour format.
fn target_max(format: wgpu::TextureFormat) -> f32 {
    match format {
        wgpu::TextureFormat::Rgba16Float | wgpu::TextureFormat::Rg16Float | wgpu::TextureFormat::R16Float => 65504.0,
        wgpu::TextureFormat::Rg11b10Ufloat => 64512.0,
        wgpu::TextureFormat::Rgba32Float | wgpu::TextureFormat::Rg32Float | wgpu::TextureFormat::R32Float => 1e30,
        _ => 1.0,
    }
}
