//! A pass as data: its module, its bindings and its stages. Layouts, bind groups, reads and writes all come from the
//! one list of bindings.

use crate::gpu::modules::{Base, Module};
use crate::gpu::sizes::{IMAGE_FORMAT, REFLECTIVE_BYTES, WORK_BYTES};
use crate::gpu::uniforms::casting::CastingUniform;
use crate::gpu::uniforms::frame::FrameUniform;
use crate::gpu::uniforms::lattice::StepUniform;
use crate::host::gbuffer::GBufferTier;
use crate::host::graph::{Part, PassKind, Resource, ResourceSet, Rounds, Stage};
use crate::host::needs::RayInputs;
use crate::rays::RayTier;

/// The group of the texture table; where there is none, it is the host's second one.
pub(crate) const TABLE_GROUP: u32 = 1;

/// The group of a pass's own bindings. Group 0 belongs to the frame, 2 to the host.
pub(crate) const OWN_GROUP: u32 = 3;

/// A resource that passes bind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Slot {
    Part(Part),
    /// `DaaStep`: the lattices that the pass works on.
    Step,
    /// `DaaCasting`: the samples that cast rays, and the lights.
    Casting,
    /// The marks of materials and objects, from the host.
    Marks,
    /// A bit for each material: whether it sends rays.
    Reflective,
    /// The squared errors of audited tiles.
    Audits,
    /// Counters for audited samples, which are not read.
    AuditedCounters,
    /// The counts of the check of a host's input.
    InputCounts,
    /// The adapter's structure over the instances, on [`RayTier::Query`] alone.
    RayTree,
    /// The nodes, triangles and vertices of the ray scene.
    RayMeshes,
    /// The instances, and in software the nodes over them.
    RayTop,
}

impl Slot {
    /// The resource that a graph sees; `None` if passes do not exchange data through it.
    pub fn resource(self) -> Option<Resource> {
        match self {
            Self::Part(part) => Some(part.resource()),
            Self::Audits => Some(Resource::Statistics),
            Self::RayTree | Self::RayMeshes | Self::RayTop => Some(Resource::Rays),
            Self::Step | Self::Casting | Self::Marks | Self::Reflective | Self::AuditedCounters | Self::InputCounts => {
                None
            }
        }
    }

    /// Whether it belongs to the frame's ray scene.
    pub fn is_of_scene(self) -> bool {
        self.resource() == Some(Resource::Rays)
    }
}

/// How a shader accesses a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Access {
    Read,
    /// Adds to it, or writes what no earlier pass of the frame has written.
    Write,
    /// Writes it, and reads what earlier passes have written.
    Update,
}

/// A binding of a pass at [`OWN_GROUP`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Binding {
    pub index: u32,
    /// The name in WGSL.
    pub name: &'static str,
    pub slot: Slot,
    /// The access that its declaration in WGSL allows.
    pub access: Access,
    /// The access that this pass uses; `None` if it is bound only because other passes with the same shader use it.
    pub used: Option<Access>,
}

impl Binding {
    pub const fn read(index: u32, name: &'static str, slot: Slot) -> Self {
        Self { index, name, slot, access: Access::Read, used: Some(Access::Read) }
    }

    pub const fn write(index: u32, name: &'static str, slot: Slot) -> Self {
        Self { index, name, slot, access: Access::Write, used: Some(Access::Write) }
    }

    pub const fn update(index: u32, name: &'static str, slot: Slot) -> Self {
        Self { index, name, slot, access: Access::Update, used: Some(Access::Update) }
    }

    /// Marks it as bound only for other passes, unless this pass uses it.
    pub const fn if_used(self, used: bool) -> Self {
        if used { self } else { Self { used: None, ..self } }
    }

    /// Marks it as only read by this pass, although its declaration also allows writing.
    pub const fn only_read(self) -> Self {
        Self { used: Some(Access::Read), ..self }
    }

    /// Whether shaders have it on a tier of rays.
    pub fn is_on(&self, tier: RayTier) -> bool {
        self.slot != Slot::RayTree || tier == RayTier::Query
    }

    /// The type that WGSL declares.
    pub fn ty(&self) -> wgpu::BindingType {
        let read_only = self.access == Access::Read;
        let buffer = |ty, has_dynamic_offset, bytes| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset,
            min_binding_size: wgpu::BufferSize::new(bytes),
        };
        let storage = wgpu::BufferBindingType::Storage { read_only };
        match self.slot {
            Slot::Part(Part::First | Part::Color) if read_only => wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            Slot::Part(Part::First | Part::Color) => wgpu::BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: IMAGE_FORMAT,
                view_dimension: wgpu::TextureViewDimension::D2,
            },
            // A reader binds the part of one round; the writer binds all of it.
            Slot::Part(Part::PixelListWork | Part::SampleListWork) if read_only => buffer(storage, true, WORK_BYTES),
            Slot::Step => buffer(wgpu::BufferBindingType::Uniform, true, size_of::<StepUniform>() as u64),
            Slot::Casting => buffer(wgpu::BufferBindingType::Uniform, true, size_of::<CastingUniform>() as u64),
            Slot::Reflective => buffer(wgpu::BufferBindingType::Uniform, false, REFLECTIVE_BYTES),
            Slot::RayTree => wgpu::BindingType::AccelerationStructure { vertex_return: false },
            _ => buffer(storage, false, 0),
        }
    }

    /// The size of the binding if it has a dynamic offset.
    pub fn dynamic(&self) -> Option<wgpu::BufferSize> {
        match self.ty() {
            wgpu::BindingType::Buffer { has_dynamic_offset: true, min_binding_size, .. } => min_binding_size,
            _ => None,
        }
    }
}

/// The names of a pass on the lattices of [`Level`](crate::gpu::uniforms::lattice::Level), in its order.
macro_rules! by_level {
    ($name:literal) => {
        &[$name, concat!($name, " shifted"), concat!($name, " 1/2"), concat!($name, " 1/4"), concat!($name, " 1/8")]
    };
}
pub(crate) use by_level;

/// The declaration of a pass: everything except what its shader does.
#[derive(Debug)]
pub(crate) struct PassData {
    /// Its name, or its names for the lattices that it may work on.
    pub names: &'static [&'static str],
    pub kind: PassKind,
    pub module: &'static Module,
    /// Whether it reads the G-buffer.
    pub gbuffer: bool,
    pub bindings: &'static [Binding],
    pub stages: &'static [Stage],
    pub rounds: Rounds,
}

impl PartialEq for PassData {
    /// Each pass is declared once, so addresses can be compared.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl PassData {
    /// The bindings that a stage uses.
    pub fn bound(&self, stage: &Stage) -> impl Iterator<Item = &'static Binding> + use<> {
        let without = stage.without;
        self.bindings.iter().filter(move |binding| !without.contains(&binding.name))
    }

    /// Whether it reads samples together with their ray results.
    pub fn reads_found(&self) -> bool {
        matches!(self.module.base, Base::Found | Base::Shading | Base::Lighting)
    }

    fn used(&self, inputs: RayInputs) -> impl Iterator<Item = (Resource, Access)> {
        let own = self.bindings.iter().filter_map(|binding| Some((binding.slot.resource()?, binding.used?)));
        let given = [
            (self.gbuffer, Resource::GBuffer),
            (self.module.base.has_host(), Resource::Host),
            (self.reads_found() && inputs.any(), Resource::Traced),
        ];
        own.chain(given.into_iter().filter(|(is, _)| *is).map(|(_, resource)| (resource, Access::Read)))
    }

    /// The resources that it reads in a frame with these ray results.
    pub fn reads(&self, inputs: RayInputs) -> ResourceSet {
        self.used(inputs).filter(|used| used.1 != Access::Write).map(|used| used.0).collect()
    }

    /// The resources that it changes.
    pub fn writes(&self, inputs: RayInputs) -> ResourceSet {
        let drawn = self.stages.iter().filter_map(|stage| stage.grid.drawn());
        let written = self.used(inputs).filter(|used| used.1 != Access::Read).map(|used| used.0);
        written.chain(drawn).collect()
    }

    /// Whether it draws a triangle.
    pub fn draws(&self) -> bool {
        self.stages.iter().any(|stage| stage.grid.drawn().is_some())
    }
}

/// Creates the layout of a stage's own group.
pub(crate) fn layout(device: &wgpu::Device, pass: &PassData, stage: &Stage, tier: RayTier) -> wgpu::BindGroupLayout {
    let visibility = if pass.draws() { wgpu::ShaderStages::FRAGMENT } else { wgpu::ShaderStages::COMPUTE };
    let entry = |binding: &Binding| wgpu::BindGroupLayoutEntry {
        binding: binding.index,
        visibility,
        ty: binding.ty(),
        count: None,
    };
    let entries: Vec<_> = pass.bound(stage).filter(|binding| binding.is_on(tier)).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(stage.entry), entries: &entries })
}

/// Creates the layout of group 0: the frame's constants, the G-buffer, and the ray results.
pub(crate) fn frame_layout(device: &wgpu::Device, tier: GBufferTier, inputs: RayInputs) -> wgpu::BindGroupLayout {
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
    let buffer = |binding, visibility, ty, has_dynamic_offset, bytes| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: wgpu::BufferSize::new(bytes) },
        count: None,
    };
    let bytes = size_of::<FrameUniform>() as u64;
    let found = wgpu::BufferBindingType::Storage { read_only: true };
    let mut entries = vec![
        buffer(0, visibility, wgpu::BufferBindingType::Uniform, true, bytes),
        texture(1, wgpu::TextureSampleType::Float { filterable: false }),
        texture(2, wgpu::TextureSampleType::Uint),
    ];
    match tier {
        GBufferTier::Stored(_) => {
            entries.extend(tier.frame_format().map(|_| texture(3, wgpu::TextureSampleType::Uint)));
            entries.extend(tier.uv_format().map(|_| texture(4, wgpu::TextureSampleType::Uint)));
        }
        // The meshes, and the instances of the frame.
        GBufferTier::Visibility(_) => {
            entries.extend([3, 4].map(|binding| buffer(binding, visibility, found, false, 0)));
        }
    }
    for (binding, has) in [(5, inputs.shadows), (6, inputs.reflections)] {
        if has {
            entries.push(buffer(binding, wgpu::ShaderStages::COMPUTE, found, false, 0));
        }
    }
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("daa frame"), entries: &entries })
}
