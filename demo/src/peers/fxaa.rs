//! The pass `fxaa`.

use super::display;
use super::pass::{self, Fullscreen};

#[derive(Debug)]
pub struct Fxaa {
    pass: Fullscreen,
    bind_group: wgpu::BindGroup,
    /// What it reads: displayed values, alpha their luma.
    pub input: wgpu::TextureView,
}

impl Fxaa {
    pub fn new(device: &wgpu::Device, width: u32, height: u32) -> Self {
        let sampler = wgpu::BindGroupLayoutEntry {
            binding: 1,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            count: None,
        };
        let entries = [pass::texture_entry(0, true), sampler];
        let pass = Fullscreen::new(device, "fxaa", include_str!("fxaa.wgsl"), &entries, display::FORMAT);
        let input = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("fxaa input"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: display::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let input = input.create_view(&wgpu::TextureViewDescriptor::default());
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("fxaa"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let bind_group = pass.bind(
            device,
            &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&input) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
            ],
        );
        Self { pass, bind_group, input }
    }

    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        to: &wgpu::TextureView,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        self.pass.record(encoder, &self.bind_group, to, timestamps);
    }
}
