//! map: takes S from the finest lattice, and decides which windows are refined beyond it.

use crate::error::PipelineError;
use crate::lattice::{self, Lattices};
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

/// Where nothing is refined beyond.
pub(crate) const INFO: PassInfo = PassInfo {
    name: "map",
    reads: &[Resource::GBuffer, Resource::Lattice],
    writes: &[Resource::First, Resource::Plan],
};

/// Where something is.
pub(crate) const INFO_SUPERSAMPLED: PassInfo = PassInfo { writes: &[Resource::First, Resource::Counts], ..INFO };

#[derive(Debug)]
pub(crate) struct Map {
    layout: wgpu::BindGroupLayout,
    pipeline: Lazy<wgpu::ComputePipeline>,
}

impl Map {
    pub fn new(device: &wgpu::Device) -> Self {
        let buffer = |binding| entry::buffer(binding, wgpu::ShaderStages::COMPUTE, false);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa map"),
            entries: &[lattice::step_entry(0), buffer(1), buffer(2), entry::store(3), buffer(4), buffer(5)],
        });
        Self { layout, pipeline: Lazy::default() }
    }

    pub fn bind(
        &self,
        device: &wgpu::Device,
        steps: &wgpu::Buffer,
        lattices: &Lattices,
        scratch: &Scratch,
    ) -> wgpu::BindGroup {
        let resources = [
            lattices.points.as_entire_binding(),
            lattices.colors.as_entire_binding(),
            wgpu::BindingResource::TextureView(&scratch.first),
            scratch.counts.as_entire_binding(),
            scratch.plan.as_entire_binding(),
        ];
        let entries = (1..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
        let entries: Vec<_> = std::iter::once(lattice::bind_step(0, steps)).chain(entries).collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa map"),
            layout: &self.layout,
            entries: &entries,
        })
    }

    pub fn pipeline(&self, build: &Build) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipeline.get(|| {
            let pass = [
                include_str!("../shaders/lattice.wgsl"),
                include_str!("../shaders/lattice_colors.wgsl"),
                include_str!("../shaders/bilateral.wgsl"),
                include_str!("../shaders/residual.wgsl"),
                include_str!("../shaders/map.wgsl"),
            ];
            let source = wgsl::join_plain(&pass.join("\n"));
            build.compute("map", source, "daa_map_main", &self.layout, None)
        })
    }
}
