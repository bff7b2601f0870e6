//! What a peer shows: displayed values on the GPU, and as a picture.

use super::display;
use crate::host::gpu::Gpu;
use crate::picture::Picture;

#[derive(Debug)]
pub struct Output {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
}

impl Output {
    pub fn new(device: &wgpu::Device, width: u32, height: u32) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("peers output"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: display::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), texture }
    }

    pub fn size(&self) -> (u32, u32) {
        size(&self.texture)
    }

    /// The radiance that would be displayed so. Waits.
    pub fn picture(&self, gpu: &Gpu) -> Picture {
        let (width, height) = self.size();
        let radiance: [f32; 256] = std::array::from_fn(|shown| display::radiance(shown as u8));
        let bytes = gpu.read_texture(&self.texture, 4);
        let linear = |&[r, g, b, _]: &[u8; 4]| {
            let [r, g, b] = [r, g, b].map(|c| radiance[usize::from(c)]);
            [r, g, b, 1.0]
        };
        Picture { width, height, rgba: bytes.as_chunks::<4>().0.iter().map(linear).collect() }
    }
}

pub fn size(texture: &wgpu::Texture) -> (u32, u32) {
    (texture.width(), texture.height())
}
