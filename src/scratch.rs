//! What the node holds for one size: the images and buffers between its passes.

use crate::gbuffer::{BYTES_PER_SAMPLE, GBuffer};
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

    pub fn new(device: &wgpu::Device, kind: ListKind, size: [u32; 2], m: u32) -> Self {
        let buffer = |label, size, usage| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | usage;
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        let none = wgpu::BufferUsages::empty();
        let [rows, list, work, colors] = Self::bytes(kind, size, m);
        Self {
            rows: buffer("daa list rows", rows, none),
            list: buffer("daa list", list, none),
            work: buffer("daa list work", work, wgpu::BufferUsages::INDIRECT),
            colors: (colors > 0).then(|| buffer("daa list colors", colors, none)),
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
    let [w, h] = size.map(u64::from);
    2 * w * h * 16 + 2 * plan_bytes(size) + statistics::COUNTER_BYTES
}

impl Scratch {
    pub fn new(device: &wgpu::Device, size: [u32; 2], m: u32) -> Self {
        let image = |label| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
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
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let buffer = |label, size| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        Self {
            size,
            gbuffer: GBuffer::new(device, size[0] * m, size[1] * m),
            first: image("daa first"),
            color: image("daa color"),
            counts: buffer("daa counts", plan_bytes(size)),
            plan: buffer("daa plan", plan_bytes(size)),
            statistics: buffer("daa statistics", statistics::COUNTER_BYTES),
        }
    }
}
