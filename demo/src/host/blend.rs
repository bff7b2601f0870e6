//! Blended surfaces: drawn over the image, from back to front, tested against the depth that the node writes at the
//! output's size.

use crate::host::raster::{self, SHADING_WGSL, TARGET_FORMAT, VERTICES_WGSL, View};
use crate::host::upload::{GpuScene, UploadError, Vertex};
use crate::scene::Scene;
use deferred_aa::gbuffer::DEPTH_FORMAT;
use deferred_aa::{CONTRACT_WGSL, DeferredAa, Depth, TextureTier};
use glam::{DMat4, DVec3, Vec4};

/// The WGSL of what a fragment shows, for this pass and other forward ones.
pub(crate) const FRAGMENT_WGSL: &str = include_str!("fragment.wgsl");

/// The depth that blended surfaces are tested against. A pixel at the edge of what hides them is theirs as long as one
/// of its samples is: against the nearest, what lies behind them would shine through along such edges, and surfaces
/// just above a slanted one would be pierced by it.
pub const DEPTH: Depth = Depth::Farthest;

/// The pipeline and per-frame buffers.
#[derive(Debug)]
pub struct Blend {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    view: wgpu::Buffer,
    instances: wgpu::Buffer,
    /// Of the triangles that face the camera, in the order of drawing.
    indices: wgpu::Buffer,
    depth: wgpu::TextureView,
}

/// A triangle of an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Triangle {
    /// Of its centroid, along the view direction.
    distance: f64,
    mesh: usize,
    triangle: usize,
    instance: usize,
}

impl Blend {
    /// `None` for a scene in which nothing is blended. `host` is the layout of the host's bind group.
    pub fn new(
        device: &wgpu::Device,
        aa: &DeferredAa,
        textures: TextureTier,
        scene: &Scene,
        host: &wgpu::BindGroupLayout,
        (width, height): (u32, u32),
    ) -> Result<Option<Self>, UploadError> {
        let blended = scene.instances.iter().filter(|i| scene.is_blended(i));
        let count: u64 = blended.map(|i| scene.meshes[i.mesh].indices.len() as u64).sum();
        if count == 0 {
            return Ok(None);
        }
        let (bytes, limit) = (count * 4, device.limits().max_buffer_size);
        if bytes > limit {
            return Err(UploadError::Buffer { what: "blended triangles", bytes, limit });
        }
        let buffer = |label, size, usage| raster::buffer(device, label, size, usage);
        let view = buffer("blend view", size_of::<View>() as u64, wgpu::BufferUsages::UNIFORM);
        let bytes_of_instances = (size_of::<raster::Instance>() * scene.instances.len()) as u64;
        let instances = buffer("blend instances", bytes_of_instances, wgpu::BufferUsages::STORAGE);
        let bound = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("blend"),
            entries: &[
                bound(0, wgpu::BufferBindingType::Uniform),
                bound(1, wgpu::BufferBindingType::Storage { read_only: true }),
            ],
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blend"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: instances.as_entire_binding() },
            ],
        });
        Ok(Some(Self {
            pipeline: pipeline(device, textures, &[Some(&layout), aa.texture_layout(), Some(host)]),
            bind_group,
            view,
            instances,
            indices: buffer("blended triangles", bytes, wgpu::BufferUsages::INDEX),
            depth: depth(device, width, height),
        }))
    }

    /// The texture that the node writes [`DEPTH`] to.
    pub fn depth(&self) -> &wgpu::TextureView {
        &self.depth
    }

    /// Changes the output size.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) {
        self.depth = depth(device, width, height);
    }

    /// Draws over the whole image, which the node has finished. `host` is the host's bind group.
    pub fn record(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        (scene, gpu): (&Scene, &GpuScene),
        camera: &deferred_aa::Camera,
        (host, target): (&wgpu::BindGroup, &wgpu::TextureView),
    ) {
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&View::of(camera)));
        queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&raster::instances(scene, camera)));
        let triangles = back_to_front(scene, camera);
        let corners = |t: &Triangle| &scene.meshes[t.mesh].indices[3 * t.triangle..3 * t.triangle + 3];
        let indices: Vec<u32> = triangles.iter().flat_map(corners).copied().collect();
        queue.write_buffer(&self.indices, 0, bytemuck::cast_slice(&indices));

        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("blend"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_bind_group(1, gpu.table.bind_group(), &[]);
        pass.set_bind_group(2, host, &[]);
        pass.set_vertex_buffer(0, gpu.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut first = 0;
        for run in triangles.chunk_by(|a, b| a.instance == b.instance) {
            let (end, instance) = (first + 3 * run.len() as u32, run[0].instance as u32);
            pass.draw_indexed(first..end, gpu.meshes[run[0].mesh].base_vertex, instance..instance + 1);
            first = end;
        }
    }
}

/// The blended triangles that are seen, the farthest first. Those of one distance are ordered by their meshes, so that
/// it makes no difference how the scene lists its instances.
fn back_to_front(scene: &Scene, camera: &deferred_aa::Camera) -> Vec<Triangle> {
    let eye = camera.world_from_view.w_axis.truncate().as_dvec3();
    let back = camera.world_from_view.z_axis.truncate().as_dvec3();
    let parallel = camera.clip_from_view.row(3) == Vec4::W;
    let mut seen = Vec::new();
    for (index, instance) in scene.instances.iter().enumerate().filter(|(_, i)| scene.is_blended(i)) {
        let mesh = &scene.meshes[instance.mesh];
        let place = DMat4::from_translation(-eye) * instance.world_from_mesh.as_dmat4();
        let handedness = if place.determinant() < 0.0 { -1.0 } else { 1.0 };
        let double_sided = scene.materials[mesh.material].double_sided;
        let points: Vec<DVec3> = mesh.positions.iter().map(|p| place.transform_point3(p.as_dvec3())).collect();
        for (triangle, corners) in mesh.indices.as_chunks::<3>().0.iter().enumerate() {
            let [a, b, c] = corners.map(|i| points[i as usize]);
            let towards = if parallel { back } else { -a };
            if double_sided || (b - a).cross(c - a).dot(towards) * handedness > 0.0 {
                let distance = (a + b + c).dot(back) / -3.0;
                seen.push(Triangle { distance, mesh: instance.mesh, triangle, instance: index });
            }
        }
    }
    seen.sort_by(|a, b| {
        let places = (a.mesh, a.triangle, a.instance).cmp(&(b.mesh, b.triangle, b.instance));
        b.distance.total_cmp(&a.distance).then(places)
    });
    seen
}

fn depth(device: &wgpu::Device, width: u32, height: u32) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// The shader for a tier of textures.
pub(crate) fn source(textures: TextureTier) -> String {
    let (directives, table) = DeferredAa::texture_wgsl(textures);
    let own = include_str!("blend.wgsl");
    [directives, CONTRACT_WGSL, table, SHADING_WGSL, VERTICES_WGSL, FRAGMENT_WGSL, own].join("\n")
}

fn pipeline(
    device: &wgpu::Device,
    textures: TextureTier,
    layouts: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("blend"),
        source: wgpu::ShaderSource::Wgsl(source(textures).into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("blend"),
        bind_group_layouts: layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blend"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("raster_vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(Vertex::LAYOUT)],
        },
        // Which triangles face the camera is known from sorting them.
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(false),
            // Decals lie on what they are drawn over.
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("blend_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: TARGET_FORMAT,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
