//! What `trace` and `bounce` share: which samples they work on, what a size keeps of rays, and how it is bound.

use crate::effects::{CastingUniform, Traced};
use crate::lattice::Place;
use crate::loans::Loans;
use crate::pipeline::{PassInfo, Resource, entry};
use crate::rays::{RayScene, RayTier};
use crate::resources::Part;
use crate::scratch::{self, Scratch};
use crate::settings::{DebugView, Settings, Technique};

/// Before `first`.
pub(crate) const INFO_FIRST: PassInfo = PassInfo {
    name: "trace first",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Tiles],
    writes: &[Resource::Traced, Resource::Statistics],
};

/// For `Full`.
pub(crate) const INFO_FULL: PassInfo = PassInfo { name: "trace", ..INFO_FIRST };

/// Behind the plan.
pub(crate) const INFO: PassInfo = PassInfo {
    name: "trace",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Tiles, Resource::Plan],
    writes: &[Resource::Traced, Resource::Statistics],
};

/// Before `audit`.
pub(crate) const INFO_AUDITED: PassInfo = PassInfo {
    name: "trace audited",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Plan],
    ..INFO
};

/// Behind `first`, for `Reconstructed`.
pub(crate) const INFO_GEOMETRIC: PassInfo = PassInfo {
    name: "trace",
    reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Tiles, Resource::Traced],
    writes: &[Resource::Traced, Resource::Statistics],
};

/// At the points of a lattice.
pub(crate) fn info_points(place: Place) -> PassInfo {
    PassInfo {
        name: place.named(["trace", "trace shifted", "trace 1/2", "trace 1/4", "trace 1/8"]),
        reads: &[Resource::GBuffer, Resource::Host, Resource::Rays, Resource::Lattice],
        writes: &[Resource::Traced, Resource::Lattice, Resource::Statistics],
    }
}

/// Which samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Samples {
    First,
    Full,
    Planned,
    Audited,
    Geometric,
    /// The chosen points of a lattice.
    Points(Place),
}

impl Samples {
    /// How many there are.
    pub const COUNT: u64 = 5 + Place::COUNT as u64;

    /// Below [`COUNT`](Self::COUNT).
    pub fn index(self) -> u64 {
        match self {
            Self::First => 0,
            Self::Full => 1,
            Self::Planned => 2,
            Self::Audited => 3,
            Self::Geometric => 4,
            Self::Points(place) => 5 + place as u64,
        }
    }

    /// `DAA_SAMPLES_*` of casting.wgsl.
    pub fn code(self) -> u32 {
        self.index().min(5) as u32
    }

    pub fn info(self) -> PassInfo {
        match self {
            Self::First => INFO_FIRST,
            Self::Full => INFO_FULL,
            Self::Planned => INFO,
            Self::Audited => INFO_AUDITED,
            Self::Geometric => INFO_GEOMETRIC,
            Self::Points(place) => info_points(place),
        }
    }
}

/// The tiles that `classify` lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum TileClass {
    /// With a surface.
    Surface,
    /// With one that sends rays.
    Bounce,
}

/// What is kept of rays besides what shading reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Kept {
    /// What those of first samples met, for `Selective`.
    pub hits: bool,
    /// How many each sample sent, for the debug view.
    pub rays: bool,
}

impl Kept {
    pub fn of(settings: &Settings) -> Self {
        Self { hits: settings.technique == Technique::Selective, rays: settings.view == DebugView::Rays }
    }
}

/// Made when a frame first needs it.
#[derive(Debug)]
pub(crate) struct Traces {
    /// `DaaCasting`, a slot for each frame and each [`Samples`]. The node's.
    pub lights: wgpu::Buffer,
    /// `DaaTileLists` of classify.wgsl.
    pub tiles: wgpu::Buffer,
    /// The shadow bits of all samples.
    pub shadows: Option<wgpu::Buffer>,
    /// What all samples reflect and refract, and with hits what the rays of first samples met.
    pub secondary: Option<wgpu::Buffer>,
    /// Of [`Lattices`](crate::lattice::Lattices), or nothing.
    pub points: wgpu::Buffer,
}

impl Traces {
    /// Bytes before the lists of tiles: two `DaaTileClass`.
    pub const CLASSES_BYTES: u64 = 32;

    /// Where a class's workgroups for an indirect dispatch stand.
    pub fn groups_at(class: TileClass) -> u64 {
        class as u64 * 16 + 4
    }

    pub fn new(device: &wgpu::Device, lights: &wgpu::Buffer, size: [u32; 2], loans: &Loans) -> Self {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST;
        let tiles = loans.buffer_or(Part::Tiles, device, "daa tiles", Self::tile_bytes(size), usage);
        Self { lights: lights.clone(), tiles, shadows: None, secondary: None, points: Self::nothing(device) }
    }

    /// What is bound where nothing is read.
    pub fn nothing(device: &wgpu::Device) -> wgpu::Buffer {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("daa nothing traced"),
            size: 256,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    }

    /// Of the lists of tiles: a word for each tile and class, and one for each tile's classes.
    pub fn tile_bytes(size: [u32; 2]) -> u64 {
        let [x, y] = scratch::tiles(size).map(u64::from);
        Self::CLASSES_BYTES + 3 * x * y * 4
    }

    /// Clears what a frame counts and what it may leave out.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder, (size, m): ([u32; 2], u32), traced: Traced, kept: Kept) {
        encoder.clear_buffer(&self.tiles, 0, Some(Self::CLASSES_BYTES));
        // `trace` looks at the first samples around its own.
        if let Some(shadows) = self.shadows.as_ref().filter(|_| traced.shadows) {
            encoder.clear_buffer(shadows, 0, Some(scratch::plan_bytes(size)));
            if kept.rays {
                let bytes = Self::bytes(size, m);
                encoder.clear_buffer(shadows, bytes, Some(bytes));
            }
        }
        // 0: nothing was traced.
        if let Some(secondary) = self.secondary.as_ref().filter(|_| traced.secondary) {
            encoder.clear_buffer(secondary, 0, None);
        }
    }

    /// Bytes of shadows or of what is reflected and refracted.
    pub fn bytes(size: [u32; 2], m: u32) -> u64 {
        scratch::plan_bytes(size) * u64::from(m * m)
    }

    /// Bytes of what the rays of first samples met: three words each of a mirrored and a refracted one.
    pub fn hit_bytes(size: [u32; 2]) -> u64 {
        scratch::plan_bytes(size) * 6
    }

    /// Bytes of shadow bits, and of the rays that found them.
    pub fn shadow_bytes(size: [u32; 2], m: u32, kept: Kept) -> u64 {
        Self::bytes(size, m) * if kept.rays { 2 } else { 1 }
    }

    /// Bytes of what is reflected and refracted, of what the rays of first samples met, and of the rays that found it. Rays lie behind
    /// the room for hits, whether these are kept or not.
    pub fn secondary_bytes(size: [u32; 2], m: u32, kept: Kept) -> u64 {
        let hits = if kept.hits || kept.rays { Self::hit_bytes(size) } else { 0 };
        Self::shadow_bytes(size, m, kept) + hits
    }

    /// Bytes held that are not lent.
    pub fn held(&self, loans: &Loans) -> u64 {
        let found = [(Part::Shadows, &self.shadows), (Part::Secondary, &self.secondary)];
        let found = found.into_iter().filter_map(|(part, found)| Some(loans.own(part, found.as_ref()?.size())));
        loans.own(Part::Tiles, self.tiles.size()) + found.sum::<u64>()
    }

    /// Makes what is missing, and takes back the room for rays if none are kept any more. Whether anything was.
    pub fn make(
        &mut self,
        device: &wgpu::Device,
        size: [u32; 2],
        m: u32,
        traced: Traced,
        kept: Kept,
        loans: &Loans,
    ) -> bool {
        let buffer = |part, label, size| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
            loans.buffer_or(part, device, label, size, usage)
        };
        let bytes = [Self::shadow_bytes, Self::secondary_bytes].map(|bytes| bytes(size, m, kept));
        // What hits make larger stays, as frames of several techniques may take turns.
        let most =
            [Self::shadow_bytes, Self::secondary_bytes].map(|bytes| bytes(size, m, Kept { hits: true, rays: false }));
        let misfits = |part, held: &Option<wgpu::Buffer>, i: usize| {
            held.as_ref()
                .is_none_or(|held| held.size() < bytes[i] || (!kept.rays && held.size() > most[i] && !loans.has(part)))
        };
        let shadows = traced.shadows && misfits(Part::Shadows, &self.shadows, 0);
        let secondary = traced.secondary && misfits(Part::Secondary, &self.secondary, 1);
        if shadows {
            self.shadows = Some(buffer(Part::Shadows, "daa shadows", bytes[0]));
        }
        if secondary {
            self.secondary = Some(buffer(Part::Secondary, "daa secondary", bytes[1]));
        }
        shadows || secondary
    }
}

/// `@group(3)` of either pass; `bounces`: with the materials that send rays.
pub(crate) fn layout(device: &wgpu::Device, tier: RayTier, bounces: bool) -> wgpu::BindGroupLayout {
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
    let mut entries = vec![
        nodes,
        entry::buffer(1, compute, true),
        entry::buffer(2, compute, true),
        lights,
        entry::buffer(4, compute, true),
        entry::buffer(5, compute, false),
        entry::buffer(6, compute, false),
        entry::buffer(7, compute, true),
        entry::buffer(8, compute, false),
    ];
    if bounces {
        entries.push(entry::buffer(9, compute, true));
    }
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("daa rays"), entries: &entries })
}

/// `found`: what the pass writes.
pub(crate) fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    scratch: &Scratch,
    traces: &Traces,
    scene: &RayScene,
    found: &wgpu::Buffer,
    bouncing: Option<&wgpu::Buffer>,
) -> wgpu::BindGroup {
    let [nodes, geometry, top] = scene.buffers();
    let nodes = scene.top_level().map_or(nodes.as_entire_binding(), wgpu::Tlas::as_binding);
    let size = wgpu::BufferSize::new(size_of::<CastingUniform>() as u64);
    let lights = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &traces.lights, offset: 0, size });
    let resources = [
        nodes,
        geometry.as_entire_binding(),
        top.as_entire_binding(),
        lights,
        scratch.plan.as_entire_binding(),
        found.as_entire_binding(),
        scratch.statistics.as_entire_binding(),
        traces.tiles.as_entire_binding(),
        traces.points.as_entire_binding(),
    ];
    let resources = resources.into_iter().chain(bouncing.map(wgpu::Buffer::as_entire_binding));
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("daa rays"), layout, entries: &entries })
}
