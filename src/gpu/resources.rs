//! The resources that depend on the size: the memory of the parts, the node's own or lent, and the groups that bind it.

use crate::gpu::bands::Layout;
use crate::gpu::binding::{Access, Binding, PassData, Slot};
use crate::gpu::buffers::NodeBuffers;
use crate::gpu::loans::Loans;
use crate::gpu::pipelines::{self, Build, Pipeline};
use crate::gpu::sizes::{FIXED, SURFACE_LIST_HEAD_BYTES, Shape, TILE_CLASSES_BYTES, plan_bytes};
use crate::host::error::{RecordError, SizeError};
use crate::host::gbuffer::{DEPTH_FORMAT, GBuffer, GBufferTier};
use crate::host::graph::{Part, PartKind, Resource, Stage};
use crate::host::needs::RayInputs;
use crate::rays::RayScene;
use crate::settings::{Execution, Pattern};
use std::collections::HashMap;

/// The memory of a part.
#[derive(Debug, Clone)]
enum Memory {
    Texture(wgpu::TextureView),
    Buffer(wgpu::Buffer),
}

impl Memory {
    /// The size in bytes, without what the driver adds.
    fn bytes(&self) -> u64 {
        match self {
            Self::Buffer(buffer) => buffer.size(),
            Self::Texture(view) => {
                let texture = view.texture();
                let texel = u64::from(texture.format().block_copy_size(None).unwrap_or(0));
                // Depth has no block size for copies.
                let texel = if texture.format() == DEPTH_FORMAT { 4 } else { texel };
                texel * u64::from(texture.width()) * u64::from(texture.height())
            }
        }
    }
}

/// A stage of a pass, by the addresses of both declarations.
type StageKey = (usize, usize);

fn stage_key(pass: &'static PassData, stage: &'static Stage) -> StageKey {
    // Stages that bind all of a pass share its group.
    let own = if stage.without.is_empty() { 0 } else { std::ptr::from_ref(stage).addr() };
    (std::ptr::from_ref(pass).addr(), own)
}

/// The limit and the frames that bands were made for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Within {
    pub limit: u64,
    pub apron: u32,
    /// The shape of a tile of such a frame, and its parts.
    pub shape: Shape,
    pub parts: Vec<Part>,
}

/// The resources of one size.
#[derive(Debug)]
pub(crate) struct SizedResources {
    /// The size of the image, or of its bands with their aprons.
    pub size: [u32; 2],
    pub image: [u32; 2],
    pub m: u32,
    /// What the bands were made for, if they were made within a limit.
    pub within: Option<Within>,
    pub gbuffer: GBuffer,
    pub loans: Loans,
    parts: HashMap<Part, Memory>,
    /// Each stage's own group, with the generation of the ray scene that it binds.
    groups: HashMap<StageKey, (u64, wgpu::BindGroup)>,
    /// Group 0, by the ray results of the frame and those that its pipelines were compiled for, with the generation of
    /// the scene whose surfaces it binds.
    frames: HashMap<(RayInputs, RayInputs), (u64, wgpu::BindGroup)>,
}

impl SizedResources {
    /// Creates the resources. Parts that are lent neither in `old`, which has the same size, nor now are taken over
    /// from it.
    pub fn new(device: &wgpu::Device, shape: &Shape, loans: Loans, old: Option<&Self>) -> Self {
        let mut parts = HashMap::new();
        if let Some(old) = old {
            let kept = old.parts.iter().filter(|(part, _)| !old.loans.has(**part) && !loans.has(**part));
            parts.extend(kept.map(|(&part, memory)| (part, memory.clone())));
        }
        let [width, height] = shape.size.map(|side| side * shape.m);
        let mut attachment = |part, format| match parts.get(&part) {
            Some(Memory::Texture(view)) => view.clone(),
            _ => {
                let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
                let view = texture(device, part, format, [width, height], usage, &loans);
                parts.insert(part, Memory::Texture(view.clone()));
                view
            }
        };
        let gbuffer = GBuffer {
            width,
            height,
            color: [
                (Part::GBufferSurface, Some(shape.gbuffer.first_format())),
                (Part::GBufferFrame, shape.gbuffer.frame_format()),
                (Part::GBufferUv, shape.gbuffer.uv_format()),
            ]
            .into_iter()
            .filter_map(|(part, format)| Some(attachment(part, format?)))
            .collect(),
            depth: attachment(Part::GBufferDepth, DEPTH_FORMAT),
        };
        for part in FIXED {
            if let Some(kind) = shape.kind(part) {
                parts.entry(part).or_insert_with(|| make(device, part, kind, &loans));
            }
        }
        let (groups, frames) = (HashMap::new(), HashMap::new());
        let within = old.and_then(|old| old.within.clone());
        Self { size: shape.size, image: shape.image, m: shape.m, within, gbuffer, loans, parts, groups, frames }
    }

    pub fn layout(&self) -> Layout {
        Layout { image: self.image, size: self.size }
    }

    /// Drops the groups, since buffers that they bind were replaced.
    pub fn forget_groups(&mut self) {
        self.groups.clear();
        self.frames.clear();
    }

    /// Drops the parts that frames have needed, except for some.
    pub fn keep_only(&mut self, parts: &[Part]) {
        self.parts.retain(|part, _| Part::GBUFFER.contains(part) || FIXED.contains(part) || parts.contains(part));
        self.forget_groups();
    }

    /// Binds the lent memory once, so that the device reports memory of another device.
    pub fn try_binding(&self, device: &wgpu::Device) {
        for (_, memory) in self.parts.iter().filter(|(part, _)| self.loans.has(**part)) {
            let (ty, resource) = match memory {
                Memory::Buffer(buffer) => (
                    wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Storage { read_only: false },
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    buffer.as_entire_binding(),
                ),
                Memory::Texture(view) => {
                    let sampled = view.texture().format().sample_type(Some(wgpu::TextureAspect::All), None);
                    let sample_type = match sampled {
                        Some(wgpu::TextureSampleType::Uint) => wgpu::TextureSampleType::Uint,
                        _ => wgpu::TextureSampleType::Float { filterable: false },
                    };
                    let view_dimension = wgpu::TextureViewDimension::D2;
                    let ty = wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
                    (ty, wgpu::BindingResource::TextureView(view))
                }
            };
            let visibility = wgpu::ShaderStages::COMPUTE;
            let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("daa lent"),
                entries: &[wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None }],
            });
            let _ = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("daa lent"),
                layout: &layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource }],
            });
        }
    }

    /// The buffer of a part, once a frame has needed it.
    pub fn buffer(&self, part: Part) -> Option<&wgpu::Buffer> {
        match self.parts.get(&part)? {
            Memory::Buffer(buffer) => Some(buffer),
            Memory::Texture(_) => None,
        }
    }

    fn view(&self, part: Part) -> Option<&wgpu::TextureView> {
        match self.parts.get(&part)? {
            Memory::Texture(view) => Some(view),
            Memory::Buffer(_) => None,
        }
    }

    /// The texture of a part, once a frame has needed it.
    pub fn texture(&self, part: Part) -> Option<&wgpu::Texture> {
        match self.parts.get(&part)? {
            Memory::Texture(view) => Some(view.texture()),
            Memory::Buffer(_) => None,
        }
    }

    /// The bytes of a part that the node has allocated itself.
    pub fn held(&self, part: Part) -> u64 {
        self.parts.get(&part).map_or(0, |memory| self.loans.own(part, memory.bytes()))
    }

    /// Creates those of the parts that are missing or do not fit the frame's shape. `execution` is named in the error
    /// if its list is too large.
    pub fn ensure(
        &mut self,
        device: &wgpu::Device,
        shape: &Shape,
        parts: &[Part],
        execution: Option<Execution>,
    ) -> Result<(), RecordError> {
        for of in [Resource::List, Resource::Lattice, Resource::Surfaces, Resource::Tiles, Resource::Traced] {
            let of_resource = parts.iter().copied().filter(|part| part.resource() == of);
            let needed = of_resource.filter_map(|part| Some((part, shape.kind(part)?)));
            let missing: Vec<_> = needed.filter(|&(part, kind)| !self.fits(shape, part, kind.bytes())).collect();
            if let Some((part, lent, needed)) =
                self.loans.too_small(missing.iter().map(|&(part, kind)| (part, kind.bytes())))
            {
                return Err(RecordError::Lent { part, lent, needed });
            }
            let largest = missing.iter().map(|(_, kind)| kind.bytes()).max().unwrap_or(0);
            let all = missing.iter().map(|(_, kind)| kind.bytes()).sum();
            let limit = binding_limit(device);
            if largest > limit {
                let bytes = if of == Resource::Lattice { all } else { largest };
                return Err(refused(of, shape, execution, bytes, format!("the device binds {limit}")));
            }
            if missing.is_empty() {
                continue;
            }
            let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
            let made: Vec<_> =
                missing.into_iter().map(|(part, kind)| (part, make(device, part, kind, &self.loans))).collect();
            if let Some(e) = pipelines::ready(scope.pop()) {
                return Err(refused(of, shape, execution, all, e.to_string()));
            }
            self.parts.extend(made);
            // A part may have been replaced, so no group can be kept.
            self.forget_groups();
        }
        Ok(())
    }

    fn fits(&self, shape: &Shape, part: Part, needed: u64) -> bool {
        self.parts.get(&part).is_some_and(|memory| {
            let held = memory.bytes();
            held >= needed && (held <= shape.most(part) || self.loans.has(part))
        })
    }

    /// Clears the counters at the `first` band of a frame, the counts of rays, and the results that the frame may not
    /// write.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder, shape: &Shape, first: bool) {
        if let Some(counters) = self.buffer(Part::Counters).filter(|_| first) {
            encoder.clear_buffer(counters, 0, None);
        }
        if let Some(tiles) = self.buffer(Part::Tiles).filter(|_| shape.inputs.any()) {
            encoder.clear_buffer(tiles, 0, Some(TILE_CLASSES_BYTES));
        }
        for list in [Part::SurfaceList, Part::SurfaceCutList].into_iter().filter_map(|list| self.buffer(list)) {
            encoder.clear_buffer(list, 0, Some(SURFACE_LIST_HEAD_BYTES));
        }
        // `trace` reads the first samples of neighbouring windows. Points beyond the image's border read samples there
        // that may have no point of their own.
        let all = shape.lattices.is_some_and(|lattices| lattices.has(Pattern::Equilateral));
        if let Some(shadows) = self.buffer(Part::Shadows).filter(|_| shape.inputs.shadows) {
            let bytes = shape.results.bytes();
            encoder.clear_buffer(shadows, 0, Some(if all { bytes } else { plan_bytes(shape.size) }));
            if shape.rays {
                encoder.clear_buffer(shadows, bytes, Some(bytes));
            }
        }
        // The code 0 means that nothing was traced.
        if let Some(reflections) = self.buffer(Part::Reflections).filter(|_| shape.inputs.reflections) {
            encoder.clear_buffer(reflections, 0, Some(shape.bytes(Part::Reflections)));
        }
    }

    /// The own group of a stage.
    pub fn group(
        &mut self,
        build: &Build,
        (pass, stage): (&'static PassData, &'static Stage),
        pipeline: &Pipeline,
        buffers: &NodeBuffers,
        scene: Option<&RayScene>,
    ) -> wgpu::BindGroup {
        let of_scene = pass.bindings.iter().any(|binding| binding.slot.is_of_scene());
        let generation = scene.filter(|_| of_scene).map_or(0, RayScene::generation);
        let key = stage_key(pass, stage);
        if let Some((_, group)) = self.groups.get(&key).filter(|(bound, _)| *bound == generation) {
            return group.clone();
        }
        let entry = |binding: &Binding| wgpu::BindGroupEntry {
            binding: binding.index,
            resource: self.resource(binding, buffers, scene),
        };
        let tier = build.rays.unwrap_or_default();
        let entries: Vec<_> = pass.bound(stage).filter(|binding| binding.is_on(tier)).map(entry).collect();
        let group = build.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(stage.entry),
            layout: &pipeline.layout,
            entries: &entries,
        });
        self.groups.insert(key, (generation, group.clone()));
        group
    }

    fn resource<'a>(
        &'a self,
        binding: &Binding,
        buffers: &'a NodeBuffers,
        scene: Option<&'a RayScene>,
    ) -> wgpu::BindingResource<'a> {
        let of_scene = |index: usize| scene.map(|scene| scene.buffers()[index]);
        let buffer = match binding.slot {
            Slot::Part(part) => match self.parts.get(&part) {
                Some(Memory::Texture(view)) => return wgpu::BindingResource::TextureView(view),
                Some(Memory::Buffer(buffer)) => Some(buffer),
                None => None,
            },
            Slot::RayTree => match scene.and_then(RayScene::top_level) {
                Some(tree) => return tree.as_binding(),
                None => None,
            },
            Slot::RayMeshes => of_scene(0),
            Slot::RayTop => of_scene(1),
            slot => buffers.of(slot),
        };
        let buffer = buffer.unwrap_or_else(|| buffers.nothing(binding.access));
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size: binding.dynamic() })
    }

    /// Group 0 of a frame with the ray results `inputs`, for pipelines that were compiled for `set`.
    pub fn frame(
        &mut self,
        build: &Build,
        buffers: &NodeBuffers,
        inputs: RayInputs,
        set: RayInputs,
        scene: Option<&RayScene>,
    ) -> wgpu::BindGroup {
        let drawn = scene.filter(|_| build.gbuffer.ids().is_some());
        let generation = drawn.map_or(0, RayScene::generation);
        if let Some((_, group)) = self.frames.get(&(inputs, set)).filter(|(bound, _)| *bound == generation) {
            return group.clone();
        }
        let view = |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
        let constants = wgpu::BufferBinding {
            buffer: &buffers.frames.buffer,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<crate::gpu::uniforms::frame::FrameUniform>() as u64),
        };
        let mut entries = vec![
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(constants) },
            view(1, &self.gbuffer.depth),
        ];
        match build.gbuffer {
            GBufferTier::Stored(_) => {
                let targets = [(2, Part::GBufferSurface), (3, Part::GBufferFrame), (4, Part::GBufferUv)];
                let bound = targets.into_iter().filter_map(|(binding, part)| Some((binding, self.view(part)?)));
                entries.extend(bound.map(|(binding, target)| view(binding, target)));
            }
            GBufferTier::Visibility(_) => {
                let drawn = drawn.and_then(RayScene::visibility_buffers);
                let [meshes, instances] = drawn.unwrap_or([buffers.nothing(Access::Read); 2]);
                entries.extend(self.view(Part::GBufferSurface).map(|ids| view(2, ids)));
                for (binding, buffer) in [(3, meshes), (4, instances)] {
                    entries.push(wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
                }
            }
        }
        // Results that were not traced read as 0.
        let found = [
            (5, Part::Shadows, set.shadows, inputs.shadows),
            (6, Part::Reflections, set.reflections, inputs.reflections),
        ];
        for (binding, part, _, traced) in found.into_iter().filter(|found| found.2) {
            let buffer = self.buffer(part).filter(|_| traced);
            let buffer = buffer.unwrap_or_else(|| buffers.nothing(Access::Read));
            entries.push(wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        }
        let group = build.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa frame"),
            layout: &build.frame_layouts[set.index()],
            entries: &entries,
        });
        self.frames.insert((inputs, set), (generation, group.clone()));
        group
    }
}

/// The memory that is lent for a part, or newly created memory.
fn make(device: &wgpu::Device, part: Part, kind: PartKind, loans: &Loans) -> Memory {
    match kind {
        PartKind::Texture { format, width, height, usage } => {
            Memory::Texture(texture(device, part, format, [width, height], usage, loans))
        }
        PartKind::Buffer { bytes, usage } => Memory::Buffer(loans.buffer(part).cloned().unwrap_or_else(|| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(&format!("daa {part:?}")),
                size: bytes,
                usage: usage | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        })),
    }
}

fn texture(
    device: &wgpu::Device,
    part: Part,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    usage: wgpu::TextureUsages,
    loans: &Loans,
) -> wgpu::TextureView {
    let own = || {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some(&format!("daa {part:?}")),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    };
    let texture = loans.texture(part).cloned().unwrap_or_else(own);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn refused(of: Resource, shape: &Shape, execution: Option<Execution>, bytes: u64, why: String) -> RecordError {
    let &Shape { size: [width, height], m, .. } = shape;
    match of {
        Resource::List => RecordError::List { execution, width, height, m, bytes, why },
        Resource::Lattice => RecordError::Lattices { width, height, bytes, why },
        Resource::Surfaces => RecordError::Surfaces { width, height, m, bytes, why },
        _ => RecordError::Traces { width, height, m, bytes, why },
    }
}

/// The most bytes that the device binds as one storage buffer.
pub(crate) fn binding_limit(device: &wgpu::Device) -> u64 {
    let limits = device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// Refuses sizes that exceed the device's limits.
pub(crate) fn check_size(size: [u32; 2], m: u32, limits: &wgpu::Limits) -> Result<(), SizeError> {
    let [width, height] = size;
    if width == 0 || height == 0 {
        return Err(SizeError::Empty { width, height });
    }
    let limit = limits.max_texture_dimension_2d;
    if size.iter().any(|side| side.checked_mul(m).is_none_or(|samples| samples > limit)) {
        return Err(SizeError::TooLarge { width, height, m, limit });
    }
    let (bytes, limit) = (plan_bytes(size), limits.max_storage_buffer_binding_size.min(limits.max_buffer_size));
    if bytes > limit {
        return Err(SizeError::Buffer { width, height, bytes, limit });
    }
    Ok(())
}
