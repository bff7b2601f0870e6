//! Renders a scene into the node's G-buffer.

use crate::host::upload::{GpuScene, Vertex};
use crate::scene::{Camera, Lens, Scene};
use deferred_aa::{DeferredAa, GBuffer, GBufferTier, TextureTier};
use glam::camera::rh::{proj::directx, view::look_at_mat4};
use glam::{DMat4, DVec3, Mat4, Vec2, Vec3, Vec4};

/// The host's WGSL.
pub const SHADING_WGSL: &str =
    concat!(include_str!("material.wgsl"), "\n", include_str!("textured.wgsl"), "\n", include_str!("shading.wgsl"));

/// The format of the target: linear HDR, as most engines have it.
pub const TARGET_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The WGSL that places the vertices of instances.
pub(crate) const VERTICES_WGSL: &str = include_str!("vertices.wgsl");

/// Pipelines and per-frame buffers.
#[derive(Debug)]
pub struct Raster {
    /// By mask, double-sided, mirrored.
    pipelines: [wgpu::RenderPipeline; 8],
    bind_group: wgpu::BindGroup,
    view: wgpu::Buffer,
    instances: wgpu::Buffer,
    draws: Vec<Draw>,
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
}

#[derive(Debug, Clone, Copy)]
struct Draw {
    pipeline: usize,
    mesh: usize,
    instance: u32,
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct View {
    pub(crate) clip_from_relative: [[f32; 4]; 4],
    pub(crate) orthographic: [f32; 4],
}

impl View {
    pub(crate) fn of(camera: &deferred_aa::Camera) -> Self {
        let mut rotation = camera.world_from_view;
        rotation.w_axis = Vec4::W;
        let back = camera.world_from_view.z_axis.truncate();
        let orthographic = f32::from(u8::from(camera.clip_from_view.row(3) == Vec4::W));
        Self {
            clip_from_relative: (camera.clip_from_view * rotation.transpose()).to_cols_array_2d(),
            orthographic: back.extend(orthographic).to_array(),
        }
    }
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Instance {
    pub(crate) rows: [[f32; 4]; 3],
    pub(crate) material: u32,
    pub(crate) object: u32,
    pub(crate) handedness: f32,
    pub(crate) padding: u32,
}

/// The camera as the node takes it, for an output of this aspect.
pub fn node_camera(camera: &Camera, width: u32, height: u32) -> deferred_aa::Camera {
    let aspect = width as f32 / height as f32;
    let view_from_world = look_at_mat4(camera.eye, camera.target, camera.up);
    let clip_from_view = match camera.lens {
        Lens::Perspective { fov_y } => directx::perspective_infinite_reverse(fov_y, aspect, camera.near),
        Lens::Orthographic { half_height, far } => {
            let half_width = half_height * aspect;
            // Near and far swapped: reversed z.
            directx::orthographic(-half_width, half_width, -half_height, half_height, far, camera.near)
        }
    };
    let mut world_from_view = view_from_world.inverse();
    // The inverse of a far-away look-at loses digits in the translation, which is the eye itself.
    world_from_view.w_axis = camera.eye.extend(1.0);
    deferred_aa::Camera { world_from_view, clip_from_view }
}

/// The camera of a picture that is `size` pixels of the picture of `camera`, from `at` on, in pixels of its `full`
/// size. The samples keep their places to a fraction of a pixel, so that a shift by part of a pixel gives samples in
/// between.
pub fn crop(camera: deferred_aa::Camera, full: Vec2, at: Vec2, size: Vec2) -> deferred_aa::Camera {
    let scale = full / size;
    let shift = (full - 2.0 * at) / size - 1.0;
    let crop = Mat4::from_cols(
        Vec4::new(scale.x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, scale.y, 0.0, 0.0),
        Vec4::Z,
        Vec4::new(shift.x, -shift.y, 0.0, 1.0),
    );
    deferred_aa::Camera { clip_from_view: crop * camera.clip_from_view, ..camera }
}

impl Raster {
    /// Compiles the pipelines and lays out the draws.
    pub fn new(device: &wgpu::Device, aa: &DeferredAa, textures: TextureTier, scene: &Scene, gpu: &GpuScene) -> Self {
        let storage = |binding, visibility| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("raster"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: both,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                },
                storage(1, both),
                storage(2, wgpu::ShaderStages::FRAGMENT),
            ],
        });
        let tier = aa.gbuffer_tier();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("raster"),
            source: wgpu::ShaderSource::Wgsl(source(textures, tier).into()),
        });
        // An opaque triangle of a visibility buffer needs nothing of a vertex but its position.
        let entries = match tier {
            GBufferTier::Stored(_) => [("raster_vertex", "raster_opaque"), ("raster_vertex", "raster_mask")],
            GBufferTier::Visibility(_) => [("ids_vertex", "ids_opaque"), ("raster_vertex", "ids_mask")],
        };
        let targets = tier.color_targets();
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("raster"),
            bind_group_layouts: &[Some(&layout), aa.texture_layout()],
            immediate_size: 0,
        });
        let pipeline = |key: usize| {
            let (mask, double_sided, mirrored) = (key & 1 != 0, key & 2 != 0, key & 4 != 0);
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("raster"),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(entries[usize::from(mask)].0),
                    compilation_options: Default::default(),
                    buffers: &[Some(Vertex::LAYOUT)],
                },
                primitive: wgpu::PrimitiveState {
                    front_face: if mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
                    cull_mode: (!double_sided).then_some(wgpu::Face::Back),
                    ..Default::default()
                },
                depth_stencil: Some(GBuffer::depth_state()),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entries[usize::from(mask)].1),
                    compilation_options: Default::default(),
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let mut draws: Vec<_> = (0..)
            .zip(&scene.instances)
            .filter(|(_, i)| !scene.is_blended(i))
            .map(|(index, i)| {
                let material = &scene.materials[scene.meshes[i.mesh].material];
                let key = usize::from(material.alpha_cutoff.is_some())
                    | usize::from(material.double_sided) << 1
                    | usize::from(i.world_from_mesh.determinant() < 0.0) << 2;
                Draw { pipeline: key, mesh: i.mesh, instance: index }
            })
            .collect();
        draws.sort_by_key(|d| (d.pipeline, d.instance));
        let view = buffer(device, "view", size_of::<View>() as u64, wgpu::BufferUsages::UNIFORM);
        let instances = buffer(
            device,
            "instances",
            (size_of::<Instance>() * scene.instances.len().max(1)) as u64,
            wgpu::BufferUsages::STORAGE,
        );
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("raster"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: instances.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: gpu.materials.as_entire_binding() },
            ],
        });
        let queries = device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| {
            let set = device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("raster"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            });
            let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
            (set, buffer(device, "raster timestamps", 16, usage))
        });
        Self { pipelines: std::array::from_fn(pipeline), bind_group, view, instances, draws, queries }
    }

    /// Records the G-buffer pass.
    pub fn record(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        gpu: &GpuScene,
        camera: &deferred_aa::Camera,
        target: &GBuffer,
    ) {
        self.record_in(queue, encoder, scene, gpu, camera, (target, None));
    }

    /// Records the G-buffer pass, in a viewport in samples in place of the whole target.
    pub fn record_in(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        gpu: &GpuScene,
        camera: &deferred_aa::Camera,
        (target, viewport): (&GBuffer, Option<[f32; 4]>),
    ) {
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&View::of(camera)));
        queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&instances(scene, camera)));

        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("gbuffer"),
            color_attachments: &target.color_attachments(),
            depth_stencil_attachment: Some(target.depth_attachment()),
            timestamp_writes: self.queries.as_ref().map(|(query_set, _)| wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        if let Some([x, y, width, height]) = viewport {
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
        }
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.set_bind_group(1, gpu.table.bind_group(), &[]);
        pass.set_vertex_buffer(0, gpu.vertices.slice(..));
        pass.set_index_buffer(gpu.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut bound = None;
        for draw in &self.draws {
            if bound != Some(draw.pipeline) {
                pass.set_pipeline(&self.pipelines[draw.pipeline]);
                bound = Some(draw.pipeline);
            }
            let mesh = gpu.meshes[draw.mesh];
            pass.draw_indexed(mesh.first..mesh.first + mesh.count, mesh.base_vertex, draw.instance..draw.instance + 1);
        }
        drop(pass);
        if let Some((set, resolved)) = &self.queries {
            encoder.resolve_query_set(set, 0..2, resolved, 0);
        }
    }

    /// Milliseconds of the last finished pass, if the device has timestamps. Waits for the GPU.
    pub fn milliseconds(&self, gpu: &crate::host::gpu::Gpu) -> Option<f64> {
        let (_, resolved) = self.queries.as_ref()?;
        let bytes = gpu.read_buffer(resolved);
        let ticks: Vec<u64> = bytes.as_chunks::<8>().0.iter().map(|&b| u64::from_le_bytes(b)).collect();
        Some(ticks[1].saturating_sub(ticks[0]) as f64 * f64::from(gpu.queue.get_timestamp_period()) * 1e-6)
    }
}

/// The shader for a tier of textures and of the G-buffer.
pub(crate) fn source(textures: TextureTier, tier: GBufferTier) -> String {
    let (directives, table) = DeferredAa::texture_wgsl(textures);
    let (enable, own) = match tier {
        GBufferTier::Stored(_) => ("", include_str!("raster_stored.wgsl")),
        GBufferTier::Visibility(_) => ("enable primitive_index;", include_str!("raster_ids.wgsl")),
    };
    let pack = tier.pack_wgsl();
    let (material, raster) = (include_str!("material.wgsl"), include_str!("raster.wgsl"));
    [enable, directives, &pack, table, material, VERTICES_WGSL, raster, own].join("\n")
}

/// A buffer that each frame writes.
pub(crate) fn buffer(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// The instances of a scene before a camera.
pub(crate) fn instances(scene: &Scene, camera: &deferred_aa::Camera) -> Vec<Instance> {
    let eye = camera.world_from_view.w_axis.truncate().as_dvec3();
    scene.instances.iter().map(|i| instance(scene, i, eye)).collect()
}

/// Camera-relative in f64, so that a scene far from the origin keeps its digits.
fn instance(scene: &Scene, i: &crate::scene::Instance, eye: DVec3) -> Instance {
    let relative = (DMat4::from_translation(-eye) * i.world_from_mesh.as_dmat4()).as_mat4();
    let handedness = if i.world_from_mesh.determinant() < 0.0 { -1.0 } else { 1.0 };
    Instance {
        rows: [0, 1, 2].map(|r| relative.row(r).to_array()),
        material: scene.meshes[i.mesh].material as u32,
        object: u32::from(i.object),
        handedness,
        padding: 0,
    }
}

/// A camera from six numbers, as on the command line.
pub fn look_at(eye: Vec3, target: Vec3, fov_y: f32, near: f32) -> Camera {
    let along = (target - eye).normalize_or(Vec3::NEG_Z);
    let up = if along.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
    Camera { eye, target, up, lens: Lens::Perspective { fov_y }, near }
}
