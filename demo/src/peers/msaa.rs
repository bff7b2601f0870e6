//! Hardware MSAA of forward shading: all meshes at two, four or eight samples a pixel, lit in the fragment shader by the
//! WGSL that lights deferred samples, once a triangle and pixel, then resolved by the hardware. It has no G-buffer,
//! traces no rays and blends nothing, so it stands beside the techniques where the scene asks for neither.

use super::display::Display;
use super::output::Output;
use super::pass::{PeerShot, Timer};
use crate::host::gpu::Gpu;
use crate::host::raster::{self, SHADING_WGSL, VERTICES_WGSL, View};
use crate::host::upload::Vertex;
use crate::host::{Host, HostError, TARGET_FORMAT, blend, traces};
use crate::picture::Picture;
use crate::scene::Scene;
use deferred_aa::gbuffer::DEPTH_FORMAT;
use deferred_aa::{CONTRACT_WGSL, Camera, DeferredAa, Settings, TextureTier};
use glam::Mat4;

/// How many samples a pixel has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Samples {
    /// Two, which an adapter may lack.
    Two,
    /// Four, which every adapter has.
    Four,
    /// Eight, which an adapter may lack.
    Eight,
}

impl Samples {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Two, Self::Four, Self::Eight];

    /// The number.
    pub fn count(self) -> u32 {
        match self {
            Self::Two => 2,
            Self::Four => 4,
            Self::Eight => 8,
        }
    }

    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Two => "msaa2x",
            Self::Four => "msaa4x",
            Self::Eight => "msaa8x",
        }
    }

    /// Whether the device renders so many to color and depth.
    fn are_had_by(self, gpu: &Gpu) -> bool {
        let device = gpu.device.features();
        let own = device.contains(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);
        [TARGET_FORMAT, DEPTH_FORMAT].into_iter().all(|format| {
            let features = if own {
                gpu.adapter.get_texture_format_features(format)
            } else {
                format.guaranteed_format_features(device)
            };
            features.flags.sample_count_supported(self.count())
        })
    }
}

/// Why it does not stand beside the techniques.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum Refusal {
    /// The frames show what it does not.
    #[error("forward shading traces no rays and blends nothing, and this scene wants it")]
    Scene,
    /// The device has other numbers of samples.
    #[error("this adapter lacks that number of samples a pixel in {TARGET_FORMAT:?} or {DEPTH_FORMAT:?}")]
    Samples,
}

/// Why it does not stand beside the techniques on this device, in frames of a scene with these settings.
pub fn refusal(samples: Samples, gpu: &Gpu, scene: &Scene, settings: &Settings) -> Option<Refusal> {
    if traces(scene, settings) || scene.instances.iter().any(|i| scene.is_blended(i)) {
        return Some(Refusal::Scene);
    }
    (!samples.are_had_by(gpu)).then_some(Refusal::Samples)
}

/// The pipelines and targets for a host's scene and size.
#[derive(Debug)]
pub struct Msaa {
    samples: Samples,
    /// By mask, double-sided, mirrored.
    pipelines: [wgpu::RenderPipeline; 8],
    sky: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    view: wgpu::Buffer,
    instances: wgpu::Buffer,
    relative_from_clip: wgpu::Buffer,
    draws: Vec<Draw>,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::TextureView,
    display: Display,
    output: Output,
    timer: Option<Timer>,
}

#[derive(Debug, Clone, Copy)]
struct Draw {
    pipeline: usize,
    mesh: usize,
    instance: u32,
}

impl Msaa {
    /// For the host's scene at its size.
    pub fn new(host: &Host, samples: Samples) -> Result<Self, HostError> {
        if !samples.are_had_by(&host.gpu) {
            return Err(HostError::NoPeer(Refusal::Samples.to_string()));
        }
        let (device, name) = (&host.gpu.device, samples.name());
        let bound = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(name),
            entries: &[bound(0, uniform), bound(1, storage), bound(2, uniform)],
        });
        let buffer = |label, size: usize, usage| raster::buffer(device, label, size as u64, usage);
        let view = buffer("msaa view", size_of::<View>(), wgpu::BufferUsages::UNIFORM);
        let bytes = size_of::<raster::Instance>() * host.scene.instances.len().max(1);
        let instances = buffer("msaa instances", bytes, wgpu::BufferUsages::STORAGE);
        let relative_from_clip = buffer("msaa sky", size_of::<Mat4>(), wgpu::BufferUsages::UNIFORM);
        let buffers = [&view, &instances, &relative_from_clip];
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(name),
            layout: &layout,
            entries: &entries,
        });
        let (pipelines, sky) = pipelines(host, &layout, samples);
        let size = (host.options.width, host.options.height);
        let msaa = Self {
            samples,
            pipelines,
            sky,
            bind_group,
            view,
            instances,
            relative_from_clip,
            draws: draws(&host.scene),
            color: target(device, size, samples.count(), TARGET_FORMAT),
            depth: target(device, size, samples.count(), DEPTH_FORMAT),
            resolved: target(device, size, 1, TARGET_FORMAT),
            display: Display::new(device),
            output: Output::new(device, size.0, size.1),
            timer: Timer::new(device),
        };
        complaints(host)?;
        Ok(msaa)
    }

    /// Bytes of what it renders to.
    pub fn bytes(&self) -> u64 {
        let (width, height) = self.output.size();
        // Color of 8 bytes and depth of 4 a sample, and the resolved color.
        u64::from(width) * u64::from(height) * (u64::from(self.samples.count()) * (8 + 4) + 8)
    }

    /// Draws a frame of the host's scene, and waits. The result is in [`picture`](Self::picture).
    pub fn run(&mut self, host: &mut Host, camera: Camera) -> Result<PeerShot, HostError> {
        let lit = host.lit_for(&camera);
        let (device, queue) = (&host.gpu.device, &host.gpu.queue);
        let view = View::of(&camera);
        let relative_from_clip = Mat4::from_cols_array_2d(&view.clip_from_relative).as_dmat4().inverse().as_mat4();
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&raster::instances(&host.scene, &camera)));
        queue.write_buffer(&self.relative_from_clip, 0, bytemuck::cast_slice(&relative_from_clip.to_cols_array()));
        let mut encoder = device.create_command_encoder(&Default::default());
        let timer = self.timer.as_ref();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.samples.name()),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.color,
                depth_slice: None,
                resolve_target: Some(&self.resolved),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Discard },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: timer.map(Timer::begin),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_bind_group(1, host.uploaded.table.bind_group(), &[]);
        pass.set_bind_group(2, &lit, &[]);
        pass.set_vertex_buffer(0, host.uploaded.vertices.slice(..));
        pass.set_index_buffer(host.uploaded.indices.slice(..), wgpu::IndexFormat::Uint32);
        for draw in &self.draws {
            let mesh = host.uploaded.meshes[draw.mesh];
            pass.set_pipeline(&self.pipelines[draw.pipeline]);
            pass.draw_indexed(mesh.first..mesh.first + mesh.count, mesh.base_vertex, draw.instance..draw.instance + 1);
        }
        // Last, where nothing else is.
        pass.set_pipeline(&self.sky);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.display.record(device, &mut encoder, &self.resolved, &self.output.view, timer.map(Timer::end));
        if let Some(timer) = timer {
            timer.resolve(&mut encoder);
        }
        queue.submit([encoder.finish()]);
        host.gpu.wait();
        complaints(host)?;
        Ok(PeerShot { milliseconds: timer.and_then(|t| t.milliseconds(&host.gpu)) })
    }

    /// What the last [`run`](Self::run) made on this host; as of the other peers, what would be displayed so. Waits.
    pub fn picture(&self, host: &Host) -> Picture {
        self.output.picture(&host.gpu)
    }
}

fn complaints(host: &Host) -> Result<(), HostError> {
    host.gpu.complaint().map_or(Ok(()), |complaint| Err(HostError::Device(complaint)))
}

/// In the order in which pipelines change least.
fn draws(scene: &Scene) -> Vec<Draw> {
    let mut draws: Vec<_> = (0..)
        .zip(&scene.instances)
        .map(|(instance, i)| {
            let material = &scene.materials[scene.meshes[i.mesh].material];
            let pipeline = usize::from(material.alpha_cutoff.is_some())
                | usize::from(material.double_sided) << 1
                | usize::from(i.world_from_mesh.determinant() < 0.0) << 2;
            Draw { pipeline, mesh: i.mesh, instance }
        })
        .collect();
    draws.sort_by_key(|d| (d.pipeline, d.instance));
    draws
}

fn target(
    device: &wgpu::Device,
    (width, height): (u32, u32),
    sample_count: u32,
    format: wgpu::TextureFormat,
) -> wgpu::TextureView {
    let read = if sample_count == 1 { wgpu::TextureUsages::TEXTURE_BINDING } else { wgpu::TextureUsages::empty() };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("msaa"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | read,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// The shader for a tier of textures.
fn source(textures: TextureTier) -> String {
    let (directives, table) = DeferredAa::texture_wgsl(textures);
    let own = include_str!("msaa.wgsl");
    [directives, CONTRACT_WGSL, table, SHADING_WGSL, VERTICES_WGSL, blend::FRAGMENT_WGSL, own].join("\n")
}

/// Those of meshes, by mask, double-sided, mirrored, and that of the sky.
fn pipelines(
    host: &Host,
    layout: &wgpu::BindGroupLayout,
    samples: Samples,
) -> ([wgpu::RenderPipeline; 8], wgpu::RenderPipeline) {
    let (device, name, count) = (&host.gpu.device, samples.name(), samples.count());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(source(host.options.textures).into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &[Some(layout), host.aa.texture_layout(), Some(&crate::host::host_layout(device))],
        immediate_size: 0,
    });
    let pipeline = |[vertex, fragment]: [&str; 2], buffers: &[_], primitive, compare, write, covers| {
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
            },
            primitive,
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count, mask: !0, alpha_to_coverage_enabled: covers },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(TARGET_FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    let mesh = |key: usize| {
        let (mask, double_sided, mirrored) = (key & 1 != 0, key & 2 != 0, key & 4 != 0);
        let primitive = wgpu::PrimitiveState {
            front_face: if mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
            cull_mode: (!double_sided).then_some(wgpu::Face::Back),
            ..Default::default()
        };
        let names = ["raster_vertex", if mask { "msaa_mask" } else { "msaa_opaque" }];
        pipeline(names, &[Some(Vertex::LAYOUT)], primitive, wgpu::CompareFunction::Greater, true, mask)
    };
    // The sky lies where the depth still is what it was cleared to.
    let at_infinity = wgpu::CompareFunction::Equal;
    let sky = pipeline(["msaa_sky_vertex", "msaa_sky"], &[], Default::default(), at_infinity, false, false);
    (std::array::from_fn(mesh), sky)
}

#[cfg(test)]
mod tests;
