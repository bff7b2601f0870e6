//! A scene on the GPU.

use crate::host::mips;
use crate::scene::{LightKind, Material, Scene, Texture, TextureRef, Wrap};
use deferred_aa::{DeferredAa, MAX_CASTING_LIGHTS, MAX_CLASSES, TableError, TableSampler, TableTexture, TextureTable};
use glam::Vec3;
use std::collections::HashMap;

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
    pub(crate) transforms: [[f32; 4]; 10],
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
    #[error("the scene's textures: {0}")]
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
        let mut materials: Vec<_> = scene.materials.iter().map(gpu_material).collect();
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
        let (textures, notices) = upload_textures(device, queue, scene)?;
        let table_textures: Vec<_> = scene
            .textures
            .iter()
            .zip(&textures)
            .map(|(t, texture)| TableTexture { texture, sampler: sampler(t, anisotropy) })
            .collect();
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

fn gpu_material(m: &Material) -> GpuMaterial {
    let refs =
        [m.base_color_texture, m.metallic_roughness_texture, m.normal_texture, m.occlusion_texture, m.emissive_texture];
    let row = |v: Vec3| [v.x, v.y, v.z, 0.0];
    let rows = |r: Option<TextureRef>| r.map_or([[0.0; 4]; 2], |r| [row(r.u_row), row(r.v_row)]);
    let mut transforms = [[0.0; 4]; 10];
    for (pair, r) in transforms.as_chunks_mut::<2>().0.iter_mut().zip(refs) {
        *pair = rows(r);
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
        transforms,
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

fn sampler(t: &Texture, anisotropy: u16) -> TableSampler {
    let address = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    TableSampler { address_u: address(t.wrap_u), address_v: address(t.wrap_v), nearest: t.nearest, anisotropy }
}

/// One texture for each image in each colour space that is asked for, and where needed resized so that the array tier
/// has few enough classes; on both tiers alike, so that both give the same picture.
fn upload_textures(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    scene: &Scene,
) -> Result<(Vec<wgpu::Texture>, Vec<String>), UploadError> {
    let limit = device.limits().max_texture_dimension_2d;
    for image in &scene.images {
        if image.width > limit || image.height > limit {
            let (name, width, height) = (image.name.clone(), image.width, image.height);
            return Err(UploadError::Image { name, width, height, limit });
        }
    }
    let natural: Vec<_> =
        scene.textures.iter().map(|t| (scene.images[t.image].width, scene.images[t.image].height)).collect();
    let (sizes, notices) = common_sizes(&scene.textures, &natural);
    let mut made: HashMap<(usize, bool, (u32, u32)), wgpu::Texture> = HashMap::new();
    let mut jobs: Vec<_> = scene.textures.iter().zip(&sizes).map(|(t, &size)| (t.image, t.srgb, size)).collect();
    jobs.sort_unstable();
    jobs.dedup();
    let next = std::sync::atomic::AtomicUsize::new(0);
    let chains = std::sync::Mutex::new(Vec::with_capacity(jobs.len()));
    std::thread::scope(|threads| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            threads.spawn(|| {
                while let Some(&(image, srgb, (w, h))) =
                    jobs.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed))
                {
                    let picture = &scene.images[image];
                    let levels = if (w, h) == (picture.width, picture.height) {
                        mips::chain(w, h, &picture.rgba, srgb)
                    } else {
                        mips::chain(
                            w,
                            h,
                            &mips::resize(picture.width, picture.height, &picture.rgba, srgb, (w, h)),
                            srgb,
                        )
                    };
                    if let Ok(mut all) = chains.lock() {
                        all.push(((image, srgb, (w, h)), levels));
                    }
                }
            });
        }
    });
    for (key, levels) in chains.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        made.insert(key, texture(device, queue, &levels, key.1));
    }
    let textures = scene.textures.iter().zip(&sizes).map(|(t, &size)| made[&(t.image, t.srgb, size)].clone()).collect();
    Ok((textures, notices))
}

/// The sizes to upload, so that textures fall into at most [`MAX_CLASSES`] classes: as they are if they do, else the
/// pair of sizes whose union costs the fewest texels is enlarged to it, again and again.
fn common_sizes(textures: &[Texture], natural: &[(u32, u32)]) -> (Vec<(u32, u32)>, Vec<String>) {
    let mut sizes = natural.to_vec();
    let mut notices = Vec::new();
    let class = |t: &Texture, size: (u32, u32)| (t.srgb, t.wrap_u, t.wrap_v, t.nearest, size);
    loop {
        let mut classes: HashMap<_, u64> = HashMap::new();
        for (t, &size) in textures.iter().zip(&sizes) {
            *classes.entry(class(t, size)).or_default() += 1;
        }
        if classes.len() <= MAX_CLASSES {
            break;
        }
        let area = |(w, h): (u32, u32)| u64::from(w) * u64::from(h);
        let keys: Vec<_> = classes.keys().copied().collect();
        let merge = keys
            .iter()
            .flat_map(|a| keys.iter().map(move |b| (a, b)))
            .filter(|(a, b)| a != b && (a.0, a.1, a.2, a.3) == (b.0, b.1, b.2, b.3))
            .map(|(a, b)| {
                let union = (a.4.0.max(b.4.0), a.4.1.max(b.4.1));
                let cost = (area(union) - area(a.4)) * classes[a] + (area(union) - area(b.4)) * classes[b];
                (cost, *a, *b, union)
            })
            .min();
        // Samplers alone make too many classes: the table will say so.
        let Some((_, a, b, union)) = merge else { break };
        for (t, size) in textures.iter().zip(&mut sizes) {
            if class(t, *size) == a || class(t, *size) == b {
                *size = union;
            }
        }
    }
    let resized = sizes.iter().zip(natural).filter(|(a, b)| a != b).count();
    if resized > 0 {
        notices.push(format!("{resized} textures were enlarged so that all fall into {MAX_CLASSES} classes"));
    }
    (sizes, notices)
}

fn texture(device: &wgpu::Device, queue: &wgpu::Queue, levels: &[mips::Level], srgb: bool) -> wgpu::Texture {
    let extent = |l: &mips::Level| wgpu::Extent3d { width: l.width, height: l.height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("scene texture"),
        size: extent(&levels[0]),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: if srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    for (mip, level) in (0..).zip(levels) {
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: mip, ..texture.as_image_copy() },
            &level.rgba,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(level.width * 4), rows_per_image: None },
            extent(level),
        );
    }
    texture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_sizes_become_few_classes() {
        let textures: Vec<_> = (0..12)
            .map(|image| Texture {
                image,
                srgb: image % 2 == 0,
                wrap_u: Wrap::Repeat,
                wrap_v: Wrap::Repeat,
                nearest: false,
            })
            .collect();
        let natural: Vec<_> = (0..12).map(|i| (16 << (i / 2), 16 + 3 * i)).collect();
        let (sizes, notices) = common_sizes(&textures, &natural);
        let classes: std::collections::HashSet<_> = textures.iter().zip(&sizes).map(|(t, s)| (t.srgb, s)).collect();
        assert!(classes.len() <= MAX_CLASSES);
        assert!(sizes.iter().zip(&natural).all(|(a, b)| a.0 >= b.0 && a.1 >= b.1));
        assert_eq!(notices.len(), 1);
    }
}
