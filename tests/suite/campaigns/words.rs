//! G-buffers written word by word, past the packing that keeps a host from most mistakes.

use crate::harness::{cover, covering};
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
        let source = source(&formats, words);
        let targets: Vec<_> = formats.into_iter().map(|format| Some(format.into())).collect();
        let pipeline = covering(&gpu.device, "words", None, source, &targets);
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
        cover(encoder, gbuffer, &self.pipeline, &group);
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
        @fragment fn fragment(@builtin(position) p: vec4f) -> Out {{
            let at = (u32(p.y) * width.x + u32(p.x)) * {words}u;
            return Out(bitcast<f32>(words[at]){values});
        }}"
    )
}
