//! Draws the node's image and depth over the camera's.

use crate::fullscreen;
use crate::view::Targets;
use bevy_core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy_ecs::prelude::*;
use bevy_platform::collections::HashMap;
use bevy_render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy_render::renderer::RenderDevice;
use deferred_aa::wgpu;

/// The pipelines of composite.wgsl by the format of the target.
#[derive(Resource)]
pub struct CompositePipelines {
    layout: wgpu::BindGroupLayout,
    by_format: HashMap<wgpu::TextureFormat, wgpu::RenderPipeline>,
}

impl FromWorld for CompositePipelines {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>().wgpu_device();
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(16),
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("deferred_aa_composite"),
            entries: &[entry(0, texture), entry(1, texture), entry(2, uniform)],
        });
        Self { layout, by_format: HashMap::default() }
    }
}

impl CompositePipelines {
    pub fn group(
        &self,
        device: &wgpu::Device,
        image: &wgpu::TextureView,
        depth: &wgpu::TextureView,
        view: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("deferred_aa_composite"),
            layout: &self.layout,
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(image)),
                entry(1, wgpu::BindingResource::TextureView(depth)),
                entry(2, view.as_entire_binding()),
            ],
        })
    }

    /// Compiles the pipeline of a format.
    pub fn prepare(&mut self, device: &wgpu::Device, format: wgpu::TextureFormat) {
        let Self { layout, by_format } = self;
        by_format.entry(format).or_insert_with(|| {
            let target = wgpu::ColorTargetState {
                format,
                // The share of a pixel that is sky shows what lies below.
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            };
            let depth = wgpu::DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            };
            let source = include_str!("composite.wgsl");
            fullscreen::pipeline(device, "deferred_aa_composite", source, layout, &[Some(target)], Some(depth))
        });
    }

    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        format: wgpu::TextureFormat,
        color: wgpu::RenderPassColorAttachment<'_>,
        depth: wgpu::RenderPassDepthStencilAttachment<'_>,
        diagnostics: Option<&DiagnosticsRecorder>,
    ) {
        let Some(pipeline) = self.by_format.get(&format) else { return };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("deferred_aa_composite"),
            color_attachments: &[Some(color)],
            depth_stencil_attachment: Some(depth),
            ..Default::default()
        });
        let span = diagnostics.pass_span(&mut pass, "deferred_aa_composite");
        let ([x, y], [width, height]) = (targets.origin, targets.size);
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &targets.composite, &[]);
        pass.draw(0..3, 0..1);
        span.end(&mut pass);
    }
}
