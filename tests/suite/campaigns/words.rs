//! G-buffers written word by word, past the packing that keeps a host from most mistakes.

use deferred_aa::{GBuffer, wgpu};
use deferred_aa_demo::gpu::Gpu;
use std::fmt::Write as _;
use wgpu::util::DeviceExt as _;

/// Writes samples as they are stored: the bits of the depth, then the words of each target.
pub struct Writer {
    pipeline: wgpu::RenderPipeline,
    /// The number of words of a sample.
    pub words: usize,
}

impl Writer {
    /// A writer for all G-buffers of this one's formats.
    pub fn new(gpu: &Gpu, gbuffer: &GBuffer) -> Self {
        let formats: Vec<_> = gbuffer.color.iter().map(|view| view.texture().format()).collect();
        let words = 1 + formats.iter().map(|format| usize::from(format.components())).sum::<usize>();
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("words"),
            source: wgpu::ShaderSource::Wgsl(source(&formats, words).into()),
        });
        let targets: Vec<_> = formats.into_iter().map(|format| Some(format.into())).collect();
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("words"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                depth_compare: Some(wgpu::CompareFunction::Always),
                ..GBuffer::depth_state()
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, words }
    }

    /// Records the writing of every sample, rows from the top.
    pub fn record(&self, device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, gbuffer: &GBuffer, words: &[u32]) {
        assert_eq!(words.len(), gbuffer.width as usize * gbuffer.height as usize * self.words);
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let samples = buffer(bytemuck::cast_slice(words), wgpu::BufferUsages::STORAGE);
        let width = buffer(bytemuck::bytes_of(&[gbuffer.width, 0, 0, 0]), wgpu::BufferUsages::UNIFORM);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("words"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: samples.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: width.as_entire_binding() },
            ],
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("words"),
            color_attachments: &gbuffer.color_attachments(),
            depth_stencil_attachment: Some(gbuffer.depth_attachment()),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Writes every sample.
    pub fn write(&self, gpu: &Gpu, gbuffer: &GBuffer, words: &[u32]) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.record(&gpu.device, &mut encoder, gbuffer, words);
        gpu.queue.submit([encoder.finish()]);
    }
}

/// A shader that writes these targets.
fn source(formats: &[wgpu::TextureFormat], words: usize) -> String {
    let (mut fields, mut values, mut next) = (String::new(), String::new(), 1);
    for (location, format) in formats.iter().enumerate() {
        let ty = ["", "u32", "vec2u", "", "vec4u"][usize::from(format.components())];
        let read: Vec<_> =
            (next..).take(usize::from(format.components())).map(|i| format!("words[at + {i}u]")).collect();
        next += read.len();
        let _ = writeln!(fields, "@location({location}) c{location}: {ty},");
        let _ = write!(values, ", {ty}({})", read.join(", "));
    }
    format!(
        "@group(0) @binding(0) var<storage, read> words: array<u32>;
        @group(0) @binding(1) var<uniform> width: vec4u;
        struct Out {{ @builtin(frag_depth) depth: f32, {fields} }}
        @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {{
            return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
        }}
        @fragment fn fragment(@builtin(position) p: vec4f) -> Out {{
            let at = (u32(p.y) * width.x + u32(p.x)) * {words}u;
            return Out(bitcast<f32>(words[at]){values});
        }}"
    )
}
