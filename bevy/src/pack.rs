//! Packs what the node's metrics read from Bevy's G-buffer into the node's.

use crate::fullscreen;
use crate::program::GBUFFER;
use bevy_ecs::prelude::*;
use bevy_render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy_render::renderer::RenderDevice;
use deferred_aa::{GBuffer, wgpu};

/// The pipeline of pack.wgsl.
#[derive(Resource)]
pub struct PackPipeline {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

impl FromWorld for PackPipeline {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>().wgpu_device();
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Uint,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("deferred_aa_pack"),
            entries: &[texture(0), texture(1)],
        });
        let source = [&GBUFFER.pack_wgsl(), include_str!("pack.wgsl")].join("\n");
        let targets = GBUFFER.color_targets();
        let pipeline = fullscreen::pipeline(device, "deferred_aa_pack", &source, &layout, &targets, None);
        Self { layout, pipeline }
    }
}

impl PackPipeline {
    pub fn group(
        &self,
        device: &wgpu::Device,
        texels: &wgpu::TextureView,
        lighting_passes: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let entry =
            |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("deferred_aa_pack"),
            layout: &self.layout,
            entries: &[entry(0, texels), entry(1, lighting_passes)],
        })
    }

    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        group: &wgpu::BindGroup,
        gbuffer: &GBuffer,
        diagnostics: Option<&DiagnosticsRecorder>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("deferred_aa_pack"),
            color_attachments: &gbuffer.color_attachments(),
            ..Default::default()
        });
        let span = diagnostics.pass_span(&mut pass, "deferred_aa_pack");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
        span.end(&mut pass);
    }
}
