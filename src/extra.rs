//! extra: the samples of active quadrants, and their mean with the first samples.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::{self, List, Scratch};

pub(crate) const INFO: PassInfo = PassInfo {
    name: "extra",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::List],
    writes: &[Resource::Color, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo = PassInfo {
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::List, Resource::Traced],
    ..INFO
};

const LABEL: &str = "daa extra";

#[derive(Debug)]
pub(crate) struct Extra {
    layout: wgpu::BindGroupLayout,
    listed: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
    between: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Extra {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(LABEL),
            entries: &[
                entry::texture(0, compute),
                entry::buffer(1, compute, true),
                entry::store(2),
                entry::buffer(3, compute, false),
                entry::buffer(4, compute, true),
                entry::buffer(5, compute, true),
            ],
        });
        Self { layout, listed: Default::default(), between: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch, list: &List) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&scratch.color) },
                wgpu::BindGroupEntry { binding: 3, resource: scratch.statistics.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 4, resource: list.list.as_entire_binding() },
                // Work 0: the whole list.
                wgpu::BindGroupEntry { binding: 5, resource: list.work.as_entire_binding() },
            ],
        })
    }

    /// Compiles what it needs; `between`: quadrants that are not active are interpolated.
    pub fn warm_up(&self, build: &Build, between: bool, traced: Traced) -> Result<(), PipelineError> {
        self.pipeline(build, false, traced)?;
        if between { self.pipeline(build, true, traced).map(|_| ()) } else { Ok(()) }
    }

    fn pipeline(&self, build: &Build, between: bool, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        let (lazy, entry) =
            if between { (&self.between, "daa_extra_between") } else { (&self.listed, "daa_extra_main") };
        lazy[traced.index()].get(|| {
            let pass = concat!(
                include_str!("../shaders/ranks.wgsl"),
                "\n",
                include_str!("../shaders/work.wgsl"),
                "\n",
                include_str!("../shaders/extra.wgsl")
            );
            build.compute(INFO.name, build.host.join(pass, traced), entry, &self.layout, Some(traced))
        })
    }

    /// Groups 0 to 2 are set.
    pub fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        build: &Build,
        (between, traced): (bool, Traced),
        list: &List,
        group: &wgpu::BindGroup,
        size: [u32; 2],
    ) {
        let Ok(listed) = self.pipeline(build, false, traced) else { return };
        pass.set_bind_group(3, group, &[]);
        pass.set_pipeline(listed);
        pass.dispatch_workgroups_indirect(&list.work, List::GROUPS_AT);
        if between && let Ok(pipeline) = self.pipeline(build, true, traced) {
            let [x, y] = scratch::tiles(size);
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}
