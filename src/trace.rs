//! trace: rays from the samples that will be shaded.

use crate::audit::Audited;
use crate::effects::{CastingUniform, Traced};
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::rays::{RayScene, RayTier};
use crate::scratch::{self, Scratch};

/// Before `first`.
pub(crate) const INFO_FIRST: PassInfo = PassInfo {
    name: "trace first",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays],
    writes: &[Resource::Shadows, Resource::Statistics],
};

/// For `Full`.
pub(crate) const INFO_FULL: PassInfo = PassInfo { name: "trace", ..INFO_FIRST };

/// Behind the plan.
pub(crate) const INFO: PassInfo = PassInfo {
    name: "trace",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Plan],
    writes: &[Resource::Shadows, Resource::Statistics],
};

/// Before `audit`.
pub(crate) const INFO_AUDITED: PassInfo = PassInfo { name: "trace audited", ..INFO };

/// Behind `first`, for `Reconstructed`.
pub(crate) const INFO_GEOMETRIC: PassInfo = PassInfo {
    name: "trace",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Shadows],
    writes: &[Resource::Shadows, Resource::Statistics],
};

/// Which samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Samples {
    First,
    Full,
    Planned,
    Audited,
    Geometric,
}

impl Samples {
    pub fn info(self) -> PassInfo {
        match self {
            Self::First => INFO_FIRST,
            Self::Full => INFO_FULL,
            Self::Planned => INFO,
            Self::Audited => INFO_AUDITED,
            Self::Geometric => INFO_GEOMETRIC,
        }
    }
}

#[derive(Debug)]
pub(crate) struct Trace {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; 5],
}

/// What a size needs once something is traced.
#[derive(Debug)]
pub(crate) struct Traces {
    /// The shadow bits of all samples.
    pub shadows: wgpu::Buffer,
}

impl Traces {
    /// Bytes of the shadow bits.
    pub fn bytes(size: [u32; 2], m: u32) -> u64 {
        scratch::plan_bytes(size) * u64::from(m * m)
    }

    pub fn new(device: &wgpu::Device, size: [u32; 2], m: u32) -> Self {
        let shadows = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("daa shadows"),
            size: Self::bytes(size, m),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Self { shadows }
    }
}

impl Trace {
    pub fn new(device: &wgpu::Device, tier: RayTier) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let mut nodes = entry::buffer(0, compute, true);
        if tier == RayTier::Query {
            nodes.ty = wgpu::BindingType::AccelerationStructure { vertex_return: false };
        }
        let mut lights = entry::buffer(3, compute, true);
        lights.ty = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: true,
            min_binding_size: wgpu::BufferSize::new(size_of::<CastingUniform>() as u64),
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa trace"),
            entries: &[
                nodes,
                entry::buffer(1, compute, true),
                entry::buffer(2, compute, true),
                lights,
                entry::buffer(4, compute, true),
                entry::buffer(5, compute, false),
                entry::buffer(6, compute, false),
            ],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(
        &self,
        device: &wgpu::Device,
        scratch: &Scratch,
        traces: &Traces,
        scene: &RayScene,
        lights: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let [nodes, geometry, top] = scene.buffers();
        let nodes = scene.top_level().map_or(nodes.as_entire_binding(), wgpu::Tlas::as_binding);
        let size = wgpu::BufferSize::new(size_of::<CastingUniform>() as u64);
        let lights = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: lights, offset: 0, size });
        let resources = [
            nodes,
            geometry.as_entire_binding(),
            top.as_entire_binding(),
            lights,
            scratch.plan.as_entire_binding(),
            traces.shadows.as_entire_binding(),
            scratch.statistics.as_entire_binding(),
        ];
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa trace"),
            layout: &self.layout,
            entries: &entries,
        })
    }

    pub fn pipeline(
        &self,
        build: &Build,
        tier: RayTier,
        samples: Samples,
    ) -> Result<&wgpu::ComputePipeline, PipelineError> {
        let entry = match samples {
            Samples::First => "daa_trace_first",
            Samples::Full => "daa_trace_full",
            Samples::Planned => "daa_trace_planned",
            Samples::Audited => "daa_trace_audited",
            Samples::Geometric => "daa_trace_geometric",
        };
        self.pipelines[samples as usize].get(|| {
            let source = build.host.join_traced(include_str!("../shaders/trace.wgsl"), tier);
            build.compute("trace", source, entry, &self.layout, build.host.solid.then(Traced::default))
        })
    }

    /// Workgroups of a dispatch.
    pub fn groups(samples: Samples, size: [u32; 2], audited: Audited) -> [u32; 2] {
        match samples {
            Samples::Audited => crate::audit::Audit::groups(audited, size),
            _ => scratch::tiles(size),
        }
    }
}
