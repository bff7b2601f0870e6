//! points: shades the chosen points of a lattice.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::lattice::{self, Lattices, Place};
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;

/// Of a lattice.
pub(crate) fn info(place: Place, traced: bool) -> PassInfo {
    let reads: &[Resource] = if traced {
        &[Resource::GBuffer, Resource::Host, Resource::Lattice, Resource::Traced]
    } else {
        &[Resource::GBuffer, Resource::Host, Resource::Lattice]
    };
    let names = ["points", "points shifted", "points 1/2", "points 1/4", "points 1/8"];
    PassInfo { name: place.named(names), reads, writes: &[Resource::Lattice, Resource::Statistics] }
}

/// Points along one side of a workgroup's block.
pub(crate) const BLOCK: u32 = 32;

#[derive(Debug)]
pub(crate) struct Points {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Points {
    pub fn new(device: &wgpu::Device) -> Self {
        let buffer = |binding| entry::buffer(binding, wgpu::ShaderStages::COMPUTE, false);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa points"),
            entries: &[lattice::step_entry(0), buffer(1), buffer(2), buffer(3)],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(
        &self,
        device: &wgpu::Device,
        steps: &wgpu::Buffer,
        lattices: &Lattices,
        scratch: &Scratch,
    ) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa points"),
            layout: &self.layout,
            entries: &[
                lattice::bind_step(0, steps),
                wgpu::BindGroupEntry { binding: 1, resource: lattices.points.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: lattices.colors.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: scratch.statistics.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let pass = [
                include_str!("../shaders/lattice.wgsl"),
                include_str!("../shaders/lattice_colors.wgsl"),
                include_str!("../shaders/listing.wgsl"),
                include_str!("../shaders/points.wgsl"),
            ];
            let source = build.host.join(&pass.join("\n"), traced);
            build.compute("points", source, "daa_points_main", &self.layout, Some(traced))
        })
    }
}
