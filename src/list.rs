//! list: the frame's pixels by count, or its samples, as one list.

use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::{self, BATCH, List, ListKind, Scratch};
use crate::wgsl;

pub(crate) const INFO: PassInfo = PassInfo { name: "list", reads: &[Resource::Plan], writes: &[Resource::List] };

const WGSL: &str = concat!(include_str!("../shaders/work.wgsl"), "\n", include_str!("../shaders/list.wgsl"));

/// Counts, scan, and the list itself.
#[derive(Debug)]
struct Pipelines {
    count: wgpu::ComputePipeline,
    scan: wgpu::ComputePipeline,
    list: wgpu::ComputePipeline,
}

#[derive(Debug)]
pub(crate) struct Lists {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<Pipelines>; 2],
}

impl Lists {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa list"),
            entries: &[
                entry::buffer(0, compute, true),
                entry::buffer(1, compute, false),
                entry::buffer(2, compute, false),
                entry::buffer(3, compute, false),
            ],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch, list: &List) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa list"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: list.rows.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: list.list.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: list.work.as_entire_binding() },
            ],
        })
    }

    /// Compiles what this kind of list needs.
    pub fn warm_up(&self, build: &Build, kind: ListKind) -> Result<(), PipelineError> {
        self.pipelines(build, kind).map(|_| ())
    }

    fn pipelines(&self, build: &Build, kind: ListKind) -> Result<&Pipelines, PipelineError> {
        self.pipelines[kind as usize].get(|| {
            let (count, list) = match kind {
                ListKind::Pixels => ("daa_list_count_pixels", "daa_list_pixels"),
                ListKind::Samples => ("daa_list_count_samples", "daa_list_samples"),
            };
            let constants = [("DAA_ROWS", f64::from(kind.rows(build.m))), ("DAA_BATCH", BATCH as f64)];
            let pipeline = |entry| {
                let source = wgsl::join_plain(WGSL);
                build.compute_with(INFO.name, source, entry, &self.layout, None, &constants)
            };
            Ok(Pipelines { count: pipeline(count)?, scan: pipeline("daa_list_scan")?, list: pipeline(list)? })
        })
    }

    /// The frame's group 0 and the list's group 3 are set.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, build: &Build, kind: ListKind, size: [u32; 2]) {
        let Ok(pipelines) = self.pipelines(build, kind) else { return };
        let tiles = scratch::tiles(size);
        let groups = (tiles[0] * tiles[1]).div_ceil(64);
        pass.set_pipeline(&pipelines.count);
        pass.dispatch_workgroups(groups, 1, 1);
        pass.set_pipeline(&pipelines.scan);
        pass.dispatch_workgroups(kind.rows(build.m), 1, 1);
        pass.set_pipeline(&pipelines.list);
        match kind {
            ListKind::Pixels => pass.dispatch_workgroups(groups, 1, 1),
            ListKind::Samples => pass.dispatch_workgroups(tiles[0], tiles[1], 1),
        }
    }
}
