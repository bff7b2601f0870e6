//! A scene on the GPU.

use crate::host::textures::{self, Reading, Stored};
use crate::scene::{LightKind, Material, Scene, TextureRef};
use deferred_aa::{DeferredAa, MAX_CASTING_LIGHTS, TableError, TableTexture, TextureTable};
use glam::Vec3;

/// A mesh's place in the shared buffers.
#[derive(Debug, Clone, Copy)]
pub struct MeshRange {
    /// First index.
    pub first: u32,
    /// Indices.
    pub count: u32,
    /// Added to each index.
    pub base_vertex: i32,
}

/// Vertices, indices, materials and textures of a scene.
#[derive(Debug)]
pub struct GpuScene {
    /// [`Vertex`] after vertex.
    pub vertices: wgpu::Buffer,
    /// u32.
    pub indices: wgpu::Buffer,
    /// The ranges of the meshes, in the order of [`Scene::meshes`].
    pub meshes: Vec<MeshRange>,
    /// `Material` of material.wgsl.
    pub materials: wgpu::Buffer,
    /// `Light` of shading.wgsl.
    pub lights: wgpu::Buffer,
    /// The number of lights.
    pub light_count: u32,
    /// The table, by index of [`Scene::textures`].
    pub table: TextureTable,
    /// What was changed to fit, a line each.
    pub notices: Vec<String>,
    /// The host's textures: the binding tier reads them in place.
    _textures: Vec<wgpu::Texture>,
}

/// As raster.wgsl reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) tangent: [f32; 4],
    pub(crate) uv: [f32; 2],
    pub(crate) color: [u8; 4],
}

impl Vertex {
    /// Locations 0 to 4.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 5] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x2, 4 => Unorm8x4];

    /// A buffer of them.
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &Self::ATTRIBUTES,
    };
}

/// `Material` of material.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuMaterial {
    pub(crate) base_color: [f32; 4],
    pub(crate) emissive: [f32; 3],
    pub(crate) metallic: f32,
    pub(crate) roughness: f32,
    pub(crate) normal_scale: f32,
    pub(crate) occlusion_strength: f32,
    pub(crate) alpha_cutoff: f32,
    pub(crate) textures: [u32; 5],
    pub(crate) unlit: u32,
    pub(crate) transmission: f32,
    pub(crate) ior: f32,
    pub(crate) readings: [u32; 8],
    pub(crate) transforms: [[f32; 4]; 10],
    pub(crate) texels: [[f32; 4]; 5],
}

/// `Light` of shading.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuLight {
    pub(crate) position: [f32; 3],
    pub(crate) inverse_range: f32,
    pub(crate) intensity: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) direction: [f32; 3],
    pub(crate) spot_scale: f32,
    pub(crate) spot_offset: f32,
    /// Its shadow bit, 0 if it casts none.
    pub(crate) casts: u32,
    pub(crate) padding: [u32; 2],
}

/// The number of materials that a G-buffer tells apart: 16 bits of a sample.
const MOST_MATERIALS: usize = 1 << 16;

/// The scene does not fit the device.
#[derive(Debug, Clone, thiserror::Error)]
pub enum UploadError {
    /// The textures.
    #[error("the scene's textures: {0} (--textures bindings)")]
    Textures(#[from] TableError),
    /// The materials.
    #[error("the scene has {materials} materials, a G-buffer tells {MOST_MATERIALS} apart; merge those that are alike")]
    Materials {
        /// Their number.
        materials: usize,
    },
    /// A buffer.
    #[error("the scene's {what} take {bytes} bytes, the device allows {limit} a buffer; use a smaller scene")]
    Buffer {
        /// The buffer.
        what: &'static str,
        /// Its size in bytes.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// A picture.
    #[error("image '{name}' is {width}×{height}, the device allows {limit} a side; shrink it")]
    Image {
        /// Its name.
        name: String,
        /// The width in texels.
        width: u32,
        /// The height in texels.
        height: u32,
        /// The limit.
        limit: u32,
    },
}

impl GpuScene {
    /// Uploads a scene for a node with a texture tier. `anisotropy` is 1 to 16.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        aa: &DeferredAa,
        scene: &Scene,
        anisotropy: u16,
    ) -> Result<Self, UploadError> {
        if scene.materials.len() > MOST_MATERIALS {
            return Err(UploadError::Materials { materials: scene.materials.len() });
        }
        let mut vertices = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        let mut meshes = Vec::with_capacity(scene.meshes.len());
        for mesh in &scene.meshes {
            meshes.push(MeshRange {
                first: indices.len() as u32,
                count: mesh.indices.len() as u32,
                base_vertex: vertices.len() as i32,
            });
            indices.extend_from_slice(&mesh.indices);
            vertices.extend((0..mesh.positions.len()).map(|i| Vertex {
                position: mesh.positions[i].to_array(),
                normal: mesh.normals[i].to_array(),
                tangent: mesh.tangents[i].to_array(),
                uv: mesh.uvs[i].to_array(),
                color: color(mesh.colors[i]),
            }));
        }
        let limit = device.limits().max_texture_dimension_2d;
        if let Some(image) = scene.images.iter().find(|image| image.width.max(image.height) > limit) {
            let (name, width, height) = (image.name.clone(), image.width, image.height);
            return Err(UploadError::Image { name, width, height, limit });
        }
        let Stored { textures, samplers, readings, notices } = textures::store(device, queue, scene, anisotropy);
        let mut materials: Vec<_> = scene.materials.iter().map(|m| gpu_material(m, &readings)).collect();
        if materials.is_empty() {
            materials.push(bytemuck::Zeroable::zeroed());
        }
        let mut lights: Vec<_> = scene.lights.iter().map(gpu_light).collect();
        let casting = lights.iter_mut().zip(&scene.lights).filter(|(_, l)| l.casts).map(|(to, _)| to);
        for (bit, light) in casting.take(MAX_CASTING_LIGHTS - 1).enumerate() {
            light.casts = 1 << bit;
        }
        let light_count = lights.len() as u32;
        if lights.is_empty() {
            lights.push(bytemuck::Zeroable::zeroed());
        }
        let table_textures: Vec<_> =
            textures.iter().zip(samplers).map(|(texture, sampler)| TableTexture { texture, sampler }).collect();
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("upload") });
        let table = aa.texture_table(queue, &mut encoder, &table_textures)?;
        queue.submit([encoder.finish()]);
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            vertices: buffer(device, "vertices", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX)?,
            indices: buffer(device, "indices", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX)?,
            meshes,
            materials: buffer(device, "materials", bytemuck::cast_slice(&materials), storage)?,
            lights: buffer(device, "lights", bytemuck::cast_slice(&lights), storage)?,
            light_count,
            table,
            notices,
            _textures: textures,
        })
    }
}

fn buffer(
    device: &wgpu::Device,
    what: &'static str,
    bytes: &[u8],
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, UploadError> {
    let limit = device.limits().max_buffer_size;
    let size = (bytes.len() as u64).next_multiple_of(4).max(4);
    if size > limit {
        return Err(UploadError::Buffer { what, bytes: size, limit });
    }
    let made =
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: true });
    if let Ok(mut range) = made.get_mapped_range_mut(..) {
        range.slice(..bytes.len()).copy_from_slice(bytes);
    }
    made.unmap();
    Ok(made)
}

/// 8 bits a channel.
pub(crate) fn color(c: glam::Vec4) -> [u8; 4] {
    c.to_array().map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

fn gpu_material(m: &Material, readings: &[Reading]) -> GpuMaterial {
    let refs =
        [m.base_color_texture, m.metallic_roughness_texture, m.normal_texture, m.occlusion_texture, m.emissive_texture];
    let row = |v: Vec3| [v.x, v.y, v.z, 0.0];
    let rows = |r: Option<TextureRef>| r.map_or([[0.0; 4]; 2], |r| [row(r.u_row), row(r.v_row)]);
    let mut transforms = [[0.0; 4]; 10];
    for (pair, r) in transforms.as_chunks_mut::<2>().0.iter_mut().zip(refs) {
        *pair = rows(r);
    }
    let mut how = [0; 8];
    let mut texels = [[0.0; 4]; 5];
    for (map, r) in refs.iter().enumerate() {
        if let Some(r) = r {
            let reading = &readings[r.texture];
            (how[map], texels[map]) = (reading.how, reading.texels);
        }
    }
    GpuMaterial {
        base_color: m.base_color.to_array(),
        emissive: m.emissive.to_array(),
        metallic: m.metallic,
        roughness: m.roughness,
        normal_scale: m.normal_scale,
        occlusion_strength: m.occlusion_strength,
        alpha_cutoff: m.alpha_cutoff.unwrap_or(0.0),
        textures: refs.map(|r| r.map_or(u32::MAX, |r| r.texture as u32)),
        unlit: u32::from(m.unlit),
        transmission: m.transmission,
        // A thin wall bends nothing.
        ior: if m.volume { m.ior } else { 1.0 },
        readings: how,
        transforms,
        texels,
    }
}

fn gpu_light(l: &crate::scene::Light) -> GpuLight {
    // KHR_lights_punctual's recommended cone: scale and offset of the cosine.
    let (kind, scale, offset) = match l.kind {
        LightKind::Point => (0, 0.0, 1.0),
        LightKind::Spot { inner, outer } => {
            let scale = 1.0 / (inner.cos() - outer.cos()).max(0.001);
            (1, scale, -outer.cos() * scale)
        }
        LightKind::Directional => (2, 0.0, 1.0),
    };
    GpuLight {
        position: l.position.to_array(),
        inverse_range: if l.range.is_finite() && l.range > 0.0 { 1.0 / l.range } else { 0.0 },
        intensity: l.intensity.to_array(),
        kind,
        direction: l.direction.to_array(),
        spot_scale: scale,
        spot_offset: offset,
        casts: 0,
        padding: [0; 2],
    }
}
