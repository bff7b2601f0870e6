//! What the node holds for one size: the images and buffers between its passes.

use crate::gbuffer::{BYTES_PER_SAMPLE, GBuffer};
use crate::loans::Loans;
use crate::resources::Part;
use crate::{TILE, statistics};

/// Format of S and of the shaded image: f32, so that the linear mean is exact to f32 and 65520 is a number.
pub(crate) const IMAGE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// What a list is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum ListKind {
    Pixels,
    Samples,
}

impl ListKind {
    /// Rows that are counted and scanned: one for each k from 2, or one.
    pub fn rows(self, m: u32) -> u32 {
        match self {
            Self::Pixels => (m * m - 1).max(1),
            Self::Samples => 1,
        }
    }
}

/// Bytes of a `DaaWork` of list.wgsl: one dispatch's part of a list.
pub(crate) const WORK_BYTES: u64 = 256;

/// Samples of a list that are shaded before they are added up. More: fewer dispatches; 16 bytes each.
pub(crate) const BATCH: u64 = 1 << 22;

/// Most entries of a list.
fn entries(kind: ListKind, size: [u32; 2], m: u32) -> u64 {
    let [w, h] = size.map(u64::from);
    match kind {
        // Each row is padded to whole workgroups.
        ListKind::Pixels => w * h + 63 * u64::from(kind.rows(m)),
        // The first sample of a window is not in it.
        ListKind::Samples => (w * h * u64::from(m * m - 1)).max(1),
    }
}

/// Batches that the samples of any frame of a size fit in.
pub(crate) fn batches(size: [u32; 2], m: u32) -> u32 {
    entries(ListKind::Samples, size, m).div_ceil(BATCH) as u32
}

/// A list of the frame's pixels or samples, made when an execution first asks for it.
#[derive(Debug)]
pub(crate) struct List {
    pub rows: wgpu::Buffer,
    pub list: wgpu::Buffer,
    pub work: wgpu::Buffer,
    /// Of listed samples.
    pub colors: Option<wgpu::Buffer>,
}

impl List {
    /// Where the workgroups of an indirect dispatch stand in a `DaaWork`.
    pub const GROUPS_AT: u64 = 16;

    /// Bytes of rows, list, work and colours.
    pub fn bytes(kind: ListKind, size: [u32; 2], m: u32) -> [u64; 4] {
        let [tiles_x, tiles_y] = tiles(size).map(u64::from);
        let entries = entries(kind, size, m);
        let rows = tiles_x * tiles_y * u64::from(kind.rows(m)) * 4;
        let (parts, colors) = match kind {
            ListKind::Pixels => (kind.rows(m), 0),
            // The last tile of a batch may reach beyond it.
            ListKind::Samples => (batches(size, m), entries.min(BATCH + u64::from(TILE * TILE * 63)) * 16),
        };
        [rows, entries * 4, u64::from(parts + 1) * WORK_BYTES, colors]
    }

    pub fn new(device: &wgpu::Device, kind: ListKind, size: [u32; 2], m: u32, loans: &Loans) -> Self {
        let buffer = |part, label, size, usage| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | usage;
            loans.buffer_or(part, device, label, size, usage)
        };
        let none = wgpu::BufferUsages::empty();
        let bytes = Self::bytes(kind, size, m);
        let parts = Part::of_list(kind);
        Self {
            rows: buffer(parts[0], "daa list rows", bytes[0], none),
            list: buffer(parts[1], "daa list", bytes[1], none),
            work: buffer(parts[2], "daa list work", bytes[2], wgpu::BufferUsages::INDIRECT),
            colors: (bytes[3] > 0).then(|| buffer(parts[3], "daa list colors", bytes[3], none)),
        }
    }
}

/// The resources of one size.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub size: [u32; 2],
    pub gbuffer: GBuffer,
    pub first: wgpu::TextureView,
    pub color: wgpu::TextureView,
    pub counts: wgpu::Buffer,
    pub plan: wgpu::Buffer,
    pub statistics: wgpu::Buffer,
}

/// Tiles along x and y.
pub(crate) fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(TILE))
}

/// Bytes of a buffer with a word for each pixel of each tile.
pub(crate) fn plan_bytes(size: [u32; 2]) -> u64 {
    let [x, y] = tiles(size).map(u64::from);
    x * y * u64::from(TILE * TILE) * 4
}

/// Bytes of the G-buffer.
pub(crate) fn gbuffer_bytes(size: [u32; 2], m: u32) -> u64 {
    let [w, h] = size.map(u64::from);
    w * h * u64::from(m * m) * BYTES_PER_SAMPLE
}

/// Bytes of everything else that depends on the size.
pub(crate) fn scratch_bytes(size: [u32; 2]) -> u64 {
    2 * image_bytes(size) + 2 * plan_bytes(size) + statistics::COUNTER_BYTES
}

/// Bytes of an image of the frame.
pub(crate) fn image_bytes(size: [u32; 2]) -> u64 {
    u64::from(size[0]) * u64::from(size[1]) * 16
}

impl Scratch {
    /// `old`: of the same size, with what was lent then; what is its own it hands over.
    pub fn new(device: &wgpu::Device, size: [u32; 2], m: u32, loans: &Loans, old: Option<(&Self, &Loans)>) -> Self {
        let image = |part, label, old: Option<&wgpu::TextureView>| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: IMAGE_FORMAT,
                usage: wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            };
            loans.texture_or(part, device, &descriptor, old)
        };
        let buffer = |part, label, size, old: Option<&wgpu::Buffer>| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
            old.cloned().unwrap_or_else(|| loans.buffer_or(part, device, label, size, usage))
        };
        // What neither was lent before nor is now.
        let own = |part: Part| old.filter(|(_, lent)| !lent.has(part) && !loans.has(part)).map(|(old, _)| old);
        let gbuffer = Part::GBUFFER.map(|part| {
            own(part).map(|old| match part {
                Part::GBufferSurface => &old.gbuffer.color[0],
                Part::GBufferFrame => &old.gbuffer.color[1],
                Part::GBufferUv => &old.gbuffer.color[2],
                _ => &old.gbuffer.depth,
            })
        });
        Self {
            size,
            gbuffer: GBuffer::new(device, size[0] * m, size[1] * m, loans, gbuffer),
            first: image(Part::First, "daa first", own(Part::First).map(|old| &old.first)),
            color: image(Part::Color, "daa color", own(Part::Color).map(|old| &old.color)),
            counts: buffer(Part::Counts, "daa counts", plan_bytes(size), own(Part::Counts).map(|old| &old.counts)),
            plan: buffer(Part::Plan, "daa plan", plan_bytes(size), own(Part::Plan).map(|old| &old.plan)),
            statistics: buffer(
                Part::Counters,
                "daa statistics",
                statistics::COUNTER_BYTES,
                own(Part::Counters).map(|old| &old.statistics),
            ),
        }
    }
}
