//! classify: the tiles in which rays are wanted, by kind.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::{self, Scratch};
use crate::traces::Traces;
use crate::wgsl;

pub(crate) const INFO: PassInfo =
    PassInfo { name: "classify", reads: &[Resource::GBuffer], writes: &[Resource::Tiles, Resource::Statistics] };

#[derive(Debug)]
struct Pipelines {
    main: wgpu::ComputePipeline,
    finish: wgpu::ComputePipeline,
}

#[derive(Debug)]
pub(crate) struct Classify {
    layout: wgpu::BindGroupLayout,
    /// Without and with materials that send rays.
    pipelines: [Lazy<Pipelines>; 2],
}

impl Classify {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa classify"),
            entries: &[
                entry::buffer(0, compute, false),
                entry::buffer(1, compute, true),
                entry::buffer(2, compute, false),
            ],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(
        &self,
        device: &wgpu::Device,
        scratch: &Scratch,
        traces: &Traces,
        bouncing: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa classify"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: traces.tiles.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: bouncing.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: scratch.statistics.as_entire_binding() },
            ],
        })
    }

    /// Compiles both.
    pub fn warm_up(&self, build: &Build) -> Result<(), PipelineError> {
        [false, true].into_iter().try_for_each(|bounces| self.compile(build, bounces))
    }

    /// Compiles one.
    pub fn compile(&self, build: &Build, bounces: bool) -> Result<(), PipelineError> {
        self.pipelines(build, bounces).map(|_| ())
    }

    fn pipelines(&self, build: &Build, bounces: bool) -> Result<&Pipelines, PipelineError> {
        self.pipelines[usize::from(bounces)].get(|| {
            let constants = [("DAA_BOUNCES", f64::from(u8::from(bounces)))];
            let pipeline = |entry| {
                let source = wgsl::join_plain(include_str!("../shaders/classify.wgsl"));
                build.compute_with(INFO.name, source, entry, &self.layout, None, &constants)
            };
            Ok(Pipelines { main: pipeline("daa_classify_main")?, finish: pipeline("daa_classify_finish")? })
        })
    }

    /// The frame's group 0 and group 3 are set.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, build: &Build, bounces: bool, size: [u32; 2]) {
        let Ok(pipelines) = self.pipelines(build, bounces) else { return };
        let [x, y] = scratch::tiles(size);
        pass.set_pipeline(&pipelines.main);
        pass.dispatch_workgroups(x, y, 1);
        pass.set_pipeline(&pipelines.finish);
        pass.dispatch_workgroups(1, 1, 1);
    }
}
