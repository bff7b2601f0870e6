//! Packs what the node's metrics read from Bevy's G-buffer into the node's.

use crate::program::GBUFFER;
use bevy_ecs::prelude::*;
use bevy_render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy_render::renderer::RenderDevice;
use deferred_aa::{GBuffer, wgpu};

/// The pipeline of pack.wgsl.
#[derive(Resource)]
pub struct PackPipelines {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

impl FromWorld for PackPipelines {
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
        let pipeline = fullscreen(device, "deferred_aa_pack", &source, &layout, &targets, None);
        Self { layout, pipeline }
    }
}

impl PackPipelines {
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

/// A pipeline that covers its targets with one triangle; its entry points are `vertex` and `fragment`.
pub fn fullscreen(
    device: &wgpu::Device,
    label: &str,
    source: &str,
    layout: &wgpu::BindGroupLayout,
    targets: &[Option<wgpu::ColorTargetState>],
    depth_stencil: Option<wgpu::DepthStencilState>,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
