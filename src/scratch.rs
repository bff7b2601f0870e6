//! What the node holds for one size: the images and buffers between its passes.

use crate::gbuffer::{BYTES_PER_SAMPLE, GBuffer};
use crate::{TILE, statistics};

/// Format of S and of the shaded image: f32, so that the linear mean is exact to f32 and 65520 is a number.
pub(crate) const IMAGE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

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
