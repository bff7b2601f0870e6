//! What goes with a size: the buffers and images of the passes, and what binds them.

use super::order::{Step, order};
use super::pipelines::{Pipelines, Tracing};
use crate::effects::{self, Traced};
use crate::error::{RecordError, SizeError};
use crate::frame::FrameUniform;
use crate::gbuffer::GBuffer;
use crate::lattice::{Lattices, Steps};
use crate::listed;
use crate::loans::Loans;
use crate::pipeline::{self, Build};
use crate::rays::RayScene;
use crate::resources::Part;
use crate::scratch::{self, List, ListKind, Scratch};
use crate::select::Marks;
use crate::settings::{Settings, Technique};
use crate::traces::{Kept, Traces};

/// What goes with a size.
#[derive(Debug)]
pub(super) struct Sized {
    pub scratch: Scratch,
    pub loans: Loans,
    /// By [`Traced::index`], each from the first frame that needs it.
    pub frames: [Option<wgpu::BindGroup>; Traced::COUNT],
    /// For pipelines of a set (the second) that serve a frame that gets less (the first).
    pub served: Option<(Traced, Traced, wgpu::BindGroup)>,
    pub traced: Option<SizedTraces>,
    pub first: wgpu::BindGroup,
    pub metrics: wgpu::BindGroup,
    pub max_filter: wgpu::BindGroup,
    pub plan: wgpu::BindGroup,
    pub shade: wgpu::BindGroup,
    pub reconstruct: wgpu::BindGroup,
    /// From the first frame that selects.
    pub select: Option<wgpu::BindGroup>,
    pub resolve: wgpu::BindGroup,
    pub view: wgpu::BindGroup,
    pub audit: wgpu::BindGroup,
    /// From the first frame that refines lattices.
    pub lattices: Option<SizedLattices>,
    /// By [`ListKind`], each from the first frame that needs it.
    pub lists: [Option<SizedList>; 2],
}

/// What rays find, and what binds it with the scene of a generation.
#[derive(Debug)]
pub(super) struct SizedTraces {
    pub traces: Traces,
    pub bound: Option<BoundTraces>,
}

#[derive(Debug)]
pub(super) struct BoundTraces {
    pub generation: u64,
    pub classify: wgpu::BindGroup,
    pub trace: Option<wgpu::BindGroup>,
    pub bounce: Option<wgpu::BindGroup>,
    pub view: wgpu::BindGroup,
}

/// Lattices and what binds them; for rays, once something is traced.
#[derive(Debug)]
pub(super) struct SizedLattices {
    pub lattices: Lattices,
    /// `DaaStep`, a slot for each frame and step. The node's.
    steps: wgpu::Buffer,
    pub refine: wgpu::BindGroup,
    pub refine_rays: Option<wgpu::BindGroup>,
    pub points: wgpu::BindGroup,
    pub map: wgpu::BindGroup,
    pub resolve: wgpu::BindGroup,
}

/// A list and what binds it.
#[derive(Debug)]
pub(super) struct SizedList {
    pub list: List,
    pub fill: wgpu::BindGroup,
    pub shade: listed::Bound,
    /// For [`ListKind::Pixels`].
    pub extra: Option<wgpu::BindGroup>,
}

/// What a node that traces holds whatever its size, from the first frame that traces.
#[derive(Debug)]
pub(super) struct RayBuffers {
    /// `DaaCasting`, a slot for each frame and each [`Samples`](crate::traces::Samples).
    pub lights: wgpu::Buffer,
    /// The materials that send rays, and as what they were last written.
    bouncing: wgpu::Buffer,
    written: Vec<u32>,
}

impl RayBuffers {
    pub fn new(device: &wgpu::Device, lights_bytes: u64) -> Self {
        let buffer = |label, size, usage| {
            let usage = usage | wgpu::BufferUsages::COPY_DST;
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        Self {
            lights: buffer("daa casting lights", lights_bytes, wgpu::BufferUsages::UNIFORM),
            bouncing: buffer("daa bouncing materials", effects::BOUNCING_BYTES, wgpu::BufferUsages::STORAGE),
            written: Vec::new(),
        }
    }

    /// Bytes held.
    pub fn held(&self) -> u64 {
        self.lights.size() + self.bouncing.size()
    }

    /// Writes the materials that send rays if they differ from the last frame's.
    pub fn write_bouncing(&mut self, queue: &wgpu::Queue, materials: &[u32]) {
        if effects::bouncing(materials, &mut self.written) {
            queue.write_buffer(&self.bouncing, 0, bytemuck::cast_slice(&self.written));
        }
    }
}

impl Sized {
    pub fn new(pipelines: &Pipelines, uniforms: &wgpu::Buffer, scratch: Scratch, loans: Loans) -> Self {
        let device = &pipelines.build.device;
        let plain = bind_frame(device, &pipelines.build.frame_layouts[0], uniforms, &scratch.gbuffer, [None, None]);
        Self {
            frames: [Some(plain), None, None, None],
            served: None,
            traced: None,
            first: pipelines.first.bind(device, &scratch),
            metrics: pipelines.metrics.bind(device, &scratch),
            max_filter: pipelines.max_filter.bind(device, &scratch),
            plan: pipelines.plan.bind(device, &scratch),
            shade: pipelines.shade.bind(device, &scratch),
            reconstruct: pipelines.reconstruct.bind(device, &scratch),
            select: None,
            resolve: pipelines.resolve.bind(device, &scratch, None),
            view: pipelines.view.bind(device, &scratch, None),
            audit: pipelines.audit.bind(device, &scratch),
            lattices: None,
            lists: [None, None],
            loans,
            scratch,
        }
    }

    /// Group 0 for pipelines of `set`, of a frame that gets `traced`.
    pub fn frame(&self, traced: Traced, set: Traced) -> Option<&wgpu::BindGroup> {
        if traced == set {
            return self.frames[set.index()].as_ref();
        }
        let (_, _, group) = self.served.as_ref().filter(|served| (served.0, served.1) == (traced, set))?;
        Some(group)
    }

    /// Binds what `select` reads, in the first frame that asks for it.
    pub fn make_select(&mut self, pipelines: &Pipelines, marks: &Marks) {
        self.select.get_or_insert_with(|| pipelines.select.bind(&pipelines.build.device, &self.scratch, marks));
    }

    /// Refuses loans that are less than what parts need.
    fn lent(&self, parts: impl IntoIterator<Item = (Part, u64)>) -> Result<(), RecordError> {
        let refused = |(part, lent, needed)| Err(RecordError::Lent { part, lent, needed });
        self.loans.too_small(parts).map_or(Ok(()), refused)
    }

    /// Makes the list of a frame that has one, in the first frame that asks for it.
    pub fn make_list(&mut self, pipelines: &Pipelines, settings: &Settings) -> Result<(), RecordError> {
        let kind = order(settings, Traced::default()).into_iter().flatten().find_map(|step| match step {
            Step::List(kind) => Some(kind),
            _ => None,
        });
        let Some(kind) = kind.filter(|&kind| self.lists[kind as usize].is_none()) else { return Ok(()) };
        let (device, m, size) = (&pipelines.build.device, pipelines.build.m, self.scratch.size);
        let bytes = List::bytes(kind, size, m);
        let largest = bytes.into_iter().max().unwrap_or(0);
        let refused = |bytes, why| {
            let execution = (settings.technique != Technique::Selective).then_some(settings.execution);
            Err(RecordError::List { execution, width: size[0], height: size[1], m, bytes, why })
        };
        let limit = binding_limit(device);
        if largest > limit {
            return refused(largest, format!("the device binds {limit}"));
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let list = List::new(device, kind, size, m, &self.loans);
        if let Some(e) = pipeline::ready(scope.pop()) {
            return refused(bytes.iter().sum(), e.to_string());
        }
        self.lists[kind as usize] = Some(SizedList {
            fill: pipelines.lists.bind(device, &self.scratch, &list),
            shade: pipelines.listed.bind(device, &self.scratch, &list),
            extra: (kind == ListKind::Pixels).then(|| pipelines.extra.bind(device, &self.scratch, &list)),
            list,
        });
        Ok(())
    }

    /// Makes the lattices, in the first frame that refines so many points. Before [`make_traces`](Self::make_traces).
    pub fn make_lattices(
        &mut self,
        pipelines: &Pipelines,
        slots: &wgpu::Buffer,
        steps: &Steps,
    ) -> Result<(), RecordError> {
        let bytes = steps.bytes();
        if self.lattices.as_ref().is_some_and(|made| made.lattices.hold(bytes)) {
            return Ok(());
        }
        let device = &pipelines.build.device;
        let [width, height] = self.scratch.size;
        let refused = |why| Err(RecordError::Lattices { width, height, bytes: bytes.iter().sum(), why });
        self.lent(Lattices::PARTS.into_iter().zip(bytes))?;
        let limit = binding_limit(device);
        if bytes.into_iter().any(|bytes| bytes > limit) {
            return refused(format!("the device binds {limit}"));
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let lattices = Lattices::new(device, bytes, &self.loans);
        if let Some(e) = pipeline::ready(scope.pop()) {
            return refused(e.to_string());
        }
        if let Some(made) = &mut self.traced {
            made.traces.points = lattices.points.clone();
            made.bound = None;
        }
        self.lattices = Some(SizedLattices {
            steps: slots.clone(),
            refine: pipelines.refine.bind(device, slots, &lattices),
            refine_rays: None,
            points: pipelines.points.bind(device, slots, &lattices, &self.scratch),
            map: pipelines.map.bind(device, slots, &lattices, &self.scratch),
            resolve: pipelines.resolve.bind(device, &self.scratch, Some(&lattices.colors)),
            lattices,
        });
        Ok(())
    }

    /// Makes what rays find room in, in the first frame that traces, and binds the frame's scene.
    pub fn make_traces(
        &mut self,
        pipelines: &Pipelines,
        tracing: &Tracing,
        buffers: &RayBuffers,
        scene: &RayScene,
        traced: Traced,
        kept: Kept,
    ) -> Result<(), RecordError> {
        let (device, m, size) = (&pipelines.build.device, pipelines.build.m, self.scratch.size);
        let bytes = Traces::secondary_bytes(size, m, kept);
        let shadows = traced.shadows.then(|| (Part::Shadows, Traces::shadow_bytes(size, m, kept)));
        self.lent([shadows, traced.secondary.then_some((Part::Secondary, bytes))].into_iter().flatten())?;
        let refused = |why| Err(RecordError::Traces { width: size[0], height: size[1], m, bytes, why });
        let limit = binding_limit(device);
        if bytes > limit {
            return refused(format!("the device binds {limit}"));
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let loans = &self.loans;
        let made = self.traced.get_or_insert_with(|| SizedTraces {
            traces: Traces::new(device, &buffers.lights, size, loans),
            bound: None,
        });
        let added = made.traces.make(device, size, m, traced, kept, loans);
        if let Some(lattices) = &self.lattices {
            made.traces.points = lattices.lattices.points.clone();
        }
        if let Some(e) = pipeline::ready(scope.pop()) {
            self.traced = None;
            self.frames[1..].fill(None);
            self.served = None;
            return refused(e.to_string());
        }
        if added {
            // One that is there may have been made anew.
            self.frames[1..].fill(None);
            self.served = None;
        }
        let (scratch, traces) = (&self.scratch, &made.traces);
        if let Some(made) = &mut self.lattices
            && (added || made.refine_rays.is_none())
        {
            made.refine_rays = Some(pipelines.refine.bind_rays(device, &made.steps, &made.lattices, traces));
        }
        if added || made.bound.as_ref().is_none_or(|bound| bound.generation != scene.generation()) {
            made.bound = Some(BoundTraces {
                generation: scene.generation(),
                classify: tracing.classify.bind(device, scratch, traces, &buffers.bouncing),
                trace: tracing.trace.bind(device, scratch, traces, scene),
                bounce: tracing.bounce.bind(device, scratch, traces, scene, &buffers.bouncing),
                view: pipelines.view.bind(device, scratch, Some(traces)),
            });
        }
        Ok(())
    }

    /// Binds the G-buffer, and what was traced, for pipelines of `set` and a frame that gets `traced`.
    pub fn make_frame(&mut self, build: &Build, uniforms: &wgpu::Buffer, traced: Traced, set: Traced) {
        if self.frame(traced, set).is_some() {
            return;
        }
        let traces = self.traced.as_ref().map(|t| &t.traces);
        // Of what was not traced, 0 wherever it is read.
        let nothing = (traced != set).then(|| Traces::nothing(&build.device));
        let shadows = if traced.shadows { traces.and_then(|t| t.shadows.as_ref()) } else { nothing.as_ref() };
        let secondary = if traced.secondary { traces.and_then(|t| t.secondary.as_ref()) } else { nothing.as_ref() };
        let layout = &build.frame_layouts[set.index()];
        let bound = [shadows.filter(|_| set.shadows), secondary.filter(|_| set.secondary)];
        let group = bind_frame(&build.device, layout, uniforms, &self.scratch.gbuffer, bound);
        if traced == set {
            self.frames[set.index()] = Some(group);
        } else {
            self.served = Some((traced, set, group));
        }
    }
}

pub(super) fn binding_limit(device: &wgpu::Device) -> u64 {
    let limits = device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

pub(super) fn check_size(size: [u32; 2], m: u32, limits: &wgpu::Limits) -> Result<(), SizeError> {
    let [width, height] = size;
    if width == 0 || height == 0 {
        return Err(SizeError::Empty { width, height });
    }
    let limit = limits.max_texture_dimension_2d;
    if size.iter().any(|side| side.checked_mul(m).is_none_or(|samples| samples > limit)) {
        return Err(SizeError::TooLarge { width, height, m, limit });
    }
    let (bytes, limit) =
        (scratch::plan_bytes(size), limits.max_storage_buffer_binding_size.min(limits.max_buffer_size));
    if bytes > limit {
        return Err(SizeError::Buffer { width, height, bytes, limit });
    }
    Ok(())
}

pub(super) fn frame_layout(device: &wgpu::Device, traced: Traced) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT;
    let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    };
    let mut entries = vec![
        wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: wgpu::BufferSize::new(size_of::<FrameUniform>() as u64),
            },
            count: None,
        },
        texture(1, wgpu::TextureSampleType::Float { filterable: false }),
        texture(2, wgpu::TextureSampleType::Uint),
        texture(3, wgpu::TextureSampleType::Uint),
        texture(4, wgpu::TextureSampleType::Uint),
    ];
    for (binding, has) in [(5, traced.shadows), (6, traced.secondary)] {
        if has {
            entries.push(pipeline::entry::buffer(binding, wgpu::ShaderStages::COMPUTE, true));
        }
    }
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("daa frame"), entries: &entries })
}

fn bind_frame(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniforms: &wgpu::Buffer,
    gbuffer: &GBuffer,
    traced: [Option<&wgpu::Buffer>; 2],
) -> wgpu::BindGroup {
    let view = |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
    let mut entries = vec![
        wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: uniforms,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<FrameUniform>() as u64),
            }),
        },
        view(1, &gbuffer.depth),
        view(2, &gbuffer.color[0]),
        view(3, &gbuffer.color[1]),
        view(4, &gbuffer.color[2]),
    ];
    for (binding, buffer) in (5..).zip(traced) {
        entries.extend(buffer.map(|b| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() }));
    }
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("daa frame"), layout, entries: &entries })
}
