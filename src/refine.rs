//! refine: which points of a lattice are worth their own sample, and what the others are.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::lattice::{self, Lattices, Place, StepUniform, Use};
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::traces::Traces;
use crate::wgsl;

/// To a lattice.
pub(crate) fn info(of: Use, place: Place, traced: bool) -> PassInfo {
    let (names, reads, writes): (_, &[Resource], &[Resource]) = match of {
        Use::Shading => (
            ["refine", "refine shifted", "refine 1/2", "refine 1/4", "refine 1/8"],
            if traced {
                &[Resource::GBuffer, Resource::Lattice, Resource::Traced]
            } else {
                &[Resource::GBuffer, Resource::Lattice]
            },
            &[Resource::Lattice],
        ),
        Use::Rays => (
            ["refine rays", "refine rays shifted", "refine rays 1/2", "refine rays 1/4", "refine rays 1/8"],
            &[Resource::GBuffer, Resource::Lattice, Resource::Traced],
            &[Resource::Lattice, Resource::Traced],
        ),
    };
    PassInfo { name: place.named(names), reads, writes }
}

#[derive(Debug)]
struct Pipelines {
    judge: wgpu::ComputePipeline,
    main: wgpu::ComputePipeline,
}

#[derive(Debug)]
pub(crate) struct Refine {
    layouts: [wgpu::BindGroupLayout; 2],
    /// By [`Traced::index`].
    colors: [Lazy<Pipelines>; Traced::COUNT],
    rays: Lazy<Pipelines>,
}

impl Refine {
    pub fn new(device: &wgpu::Device) -> Self {
        let buffer = |binding| entry::buffer(binding, wgpu::ShaderStages::COMPUTE, false);
        let layout = |buffers: &[u32]| {
            let entries: Vec<_> =
                std::iter::once(lattice::step_entry(0)).chain(buffers.iter().map(|&b| buffer(b))).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("daa refine"),
                entries: &entries,
            })
        };
        Self { layouts: [layout(&[1, 2]), layout(&[1, 2, 3])], colors: Default::default(), rays: Lazy::default() }
    }

    /// For colours.
    pub fn bind(&self, device: &wgpu::Device, steps: &wgpu::Buffer, lattices: &Lattices) -> wgpu::BindGroup {
        self.bind_as(device, Use::Shading, steps, &[&lattices.points, &lattices.colors])
    }

    /// For rays.
    pub fn bind_rays(
        &self,
        device: &wgpu::Device,
        steps: &wgpu::Buffer,
        lattices: &Lattices,
        traces: &Traces,
    ) -> wgpu::BindGroup {
        let found = [&traces.shadows, &traces.secondary].map(|found| found.as_ref());
        // What is not traced is not touched; any two buffers do.
        let nothing = [0, 1].map(|_| Traces::nothing(device));
        let [shadows, secondary] = [0, 1].map(|i| found[i].unwrap_or(&nothing[i]));
        self.bind_as(device, Use::Rays, steps, &[&lattices.points, shadows, secondary])
    }

    fn bind_as(
        &self,
        device: &wgpu::Device,
        of: Use,
        steps: &wgpu::Buffer,
        buffers: &[&wgpu::Buffer],
    ) -> wgpu::BindGroup {
        let buffers = buffers.iter().map(|buffer| buffer.as_entire_binding());
        let entries = (1..).zip(buffers).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
        let entries: Vec<_> = std::iter::once(lattice::bind_step(0, steps)).chain(entries).collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa refine"),
            layout: &self.layouts[of as usize],
            entries: &entries,
        })
    }

    /// Compiles both steps.
    pub fn warm_up(&self, build: &Build, of: Use, traced: Traced) -> Result<(), PipelineError> {
        self.pipelines(build, of, traced).map(|_| ())
    }

    fn pipelines(&self, build: &Build, of: Use, traced: Traced) -> Result<&Pipelines, PipelineError> {
        let (pipelines, values, traced) = match of {
            Use::Shading => (&self.colors[traced.index()], include_str!("../shaders/lattice_colors.wgsl"), traced),
            Use::Rays => (&self.rays, include_str!("../shaders/lattice_rays.wgsl"), Traced::default()),
        };
        pipelines.get(|| {
            let pass = [
                include_str!("../shaders/lattice.wgsl"),
                values,
                include_str!("../shaders/bilateral.wgsl"),
                include_str!("../shaders/residual.wgsl"),
                include_str!("../shaders/refine.wgsl"),
            ];
            let source = wgsl::join_reading(&pass.join("\n"), traced);
            let pipeline =
                |entry| build.compute_plain("refine", source.clone(), entry, &self.layouts[of as usize], traced);
            Ok(Pipelines { judge: pipeline("daa_refine_judge")?, main: pipeline("daa_refine_main")? })
        })
    }

    /// The frame's group 0 and group 3 are set.
    pub fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        build: &Build,
        of: Use,
        traced: Traced,
        step: &StepUniform,
    ) {
        let Ok(pipelines) = self.pipelines(build, of, traced) else { return };
        let (points, parents) = (step.points, step.parents);
        let groups = |side: u32| side.div_ceil(crate::TILE);
        pass.set_pipeline(&pipelines.judge);
        pass.dispatch_workgroups(groups(parents.width), groups(parents.height), 1);
        pass.set_pipeline(&pipelines.main);
        let nested = points.kind == parents.kind && step.scale[0] == 0.5;
        // A lane for each cell, of which triangles have one more in a row.
        let [x, y] = [points.width, points.height].map(|side| if nested { side / 2 + 2 } else { side });
        pass.dispatch_workgroups(groups(x), groups(y), 1);
    }
}
