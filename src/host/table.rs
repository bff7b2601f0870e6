//! The texture table, which `daa_texture(index, uv, ddx, ddy)` reads.

use crate::host::error::TableError;
use std::collections::HashMap;
use std::num::NonZeroU32;

/// How shaders reach the host's textures. Both kinds of table give the same image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum TextureTier {
    /// No table: `daa_texture` does not exist.
    None,
    /// Array textures, one for each class of textures with the same size, format, mip count and sampler, at most
    /// [`MAX_CLASSES`]. Textures are copied into the arrays. Works within the default limits of WebGPU.
    #[default]
    Arrays,
    /// A binding array of the host's own textures. Needs [`BINDING_FEATURES`].
    Bindings,
}

/// The number of array textures of [`TextureTier::Arrays`]. With the crate's own five, it leaves the host four of the
/// sixteen sampled textures that WebGPU allows per stage.
pub const MAX_CLASSES: usize = 7;

/// The most different samplers of [`TextureTier::Bindings`].
pub const MAX_SAMPLERS: usize = 32;

/// The features that [`TextureTier::Bindings`] needs from the device.
pub const BINDING_FEATURES: wgpu::Features = wgpu::Features::TEXTURE_BINDING_ARRAY
    .union(wgpu::Features::SAMPLED_TEXTURE_AND_STORAGE_BUFFER_ARRAY_NON_UNIFORM_INDEXING);

/// A texture of the table.
#[derive(Debug, Clone, Copy)]
pub struct TableTexture<'a> {
    /// A two-dimensional texture with one layer and one sample, in a filterable float format, with its mip chain. It
    /// needs the usage `COPY_SRC` on the array tier and `TEXTURE_BINDING` on the binding tier.
    pub texture: &'a wgpu::Texture,
    /// How the texture is read.
    pub sampler: TableSampler,
}

/// How a texture of the table is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TableSampler {
    /// The address mode along u.
    pub address_u: wgpu::AddressMode,
    /// The address mode along v.
    pub address_v: wgpu::AddressMode,
    /// Reads the nearest texel of the nearest mip instead of a trilinear, anisotropic mean.
    pub nearest: bool,
    /// The greatest anisotropy, 1 to 16. Higher: sharper at grazing angles, more texel reads. Ignored where
    /// [`nearest`](Self::nearest) is set.
    pub anisotropy: u16,
}

impl Default for TableSampler {
    fn default() -> Self {
        Self {
            address_u: wgpu::AddressMode::Repeat,
            address_v: wgpu::AddressMode::Repeat,
            nearest: false,
            anisotropy: 16,
        }
    }
}

/// The host's textures by index, for the crate's passes and, on request, for passes of the host.
#[derive(Debug)]
pub struct TextureTable {
    pub(crate) bind_group: wgpu::BindGroup,
    bytes: u64,
}

impl TextureTable {
    /// The table's bind group, for `@group(1)` of a host's pipeline that is made with
    /// [`DeferredAa::texture_layout`](crate::DeferredAa::texture_layout), for instance to test alpha while rasterising.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// The bytes of texels that the table itself holds: the copies on the array tier, 0 on the binding tier.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// The number of classes of the array tier that the textures fall into. A table takes at most [`MAX_CLASSES`].
pub fn classes(textures: &[TableTexture<'_>]) -> usize {
    textures.iter().map(Class::of).collect::<std::collections::HashSet<_>>().len()
}

/// A class of the array tier: its textures share an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Class {
    width: u32,
    height: u32,
    mips: u32,
    format: wgpu::TextureFormat,
    sampler: TableSampler,
}

impl Class {
    fn of(t: &TableTexture<'_>) -> Self {
        Self {
            width: t.texture.width(),
            height: t.texture.height(),
            mips: t.texture.mip_level_count(),
            format: t.texture.format(),
            sampler: t.sampler,
        }
    }
}

/// Creates the tables of one tier, which share a bind group layout.
#[derive(Debug, Clone)]
pub(crate) struct Tables {
    pub layout: wgpu::BindGroupLayout,
    tier: TextureTier,
    capacity: u32,
}

impl Tables {
    pub fn new(device: &wgpu::Device, tier: TextureTier, capacity: u32) -> Option<Self> {
        let visibility = wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let slots = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let texture = |binding, view_dimension, count| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension,
                multisampled: false,
            },
            count,
        };
        let sampler = |binding, count| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            count,
        };
        let mut entries = vec![slots];
        match tier {
            TextureTier::None => return None,
            TextureTier::Arrays => {
                for i in 0..MAX_CLASSES as u32 {
                    entries.push(texture(1 + i, wgpu::TextureViewDimension::D2Array, None));
                    entries.push(sampler(1 + MAX_CLASSES as u32 + i, None));
                }
            }
            TextureTier::Bindings => {
                entries.push(texture(1, wgpu::TextureViewDimension::D2, NonZeroU32::new(capacity)));
                entries.push(sampler(2, NonZeroU32::new(MAX_SAMPLERS as u32)));
            }
        }
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa textures"),
            entries: &entries,
        });
        Some(Self { layout, tier, capacity })
    }

    pub fn table(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        textures: &[TableTexture<'_>],
    ) -> Result<TextureTable, TableError> {
        let most = match self.tier {
            TextureTier::Bindings => self.capacity as usize,
            _ => MAX_CLASSES * device.limits().max_texture_array_layers as usize,
        };
        if textures.len() > most {
            return Err(TableError::Capacity { textures: textures.len(), most });
        }
        for (index, t) in textures.iter().enumerate() {
            self.check(device, t).map_err(|problem| TableError::Texture { index, problem })?;
        }
        match self.tier {
            TextureTier::Bindings => self.bindings(device, queue, textures),
            _ => self.arrays(device, queue, encoder, textures),
        }
    }

    fn check(&self, device: &wgpu::Device, t: &TableTexture<'_>) -> Result<(), String> {
        let usage = match self.tier {
            TextureTier::Bindings => wgpu::TextureUsages::TEXTURE_BINDING,
            _ => wgpu::TextureUsages::COPY_SRC,
        };
        let texture = t.texture;
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        if texture.dimension() != wgpu::TextureDimension::D2 || texture.depth_or_array_layers() != 1 {
            return Err("is not a single 2D image; give each layer as a texture of its own".into());
        }
        if texture.sample_count() != 1 {
            return Err("is multisampled; resolve it first".into());
        }
        if texture.format().sample_type(None, Some(device.features())) != Some(filterable) {
            return Err(format!("is {:?}, which can't be filtered; convert it", texture.format()));
        }
        if !texture.usage().contains(usage) {
            return Err(format!("lacks {usage:?}; create it with that usage"));
        }
        if !(1..=16).contains(&t.sampler.anisotropy) {
            return Err(format!("has anisotropy {}; it must lie in 1 to 16", t.sampler.anisotropy));
        }
        Ok(())
    }

    fn arrays(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        textures: &[TableTexture<'_>],
    ) -> Result<TextureTable, TableError> {
        let most_layers = device.limits().max_texture_array_layers as usize;
        // Arrays are in the order of their first textures. A class gets another array where one is full.
        let mut arrays: Vec<(Class, Vec<usize>)> = Vec::new();
        let mut open: HashMap<Class, usize> = HashMap::new();
        let mut slots = Vec::with_capacity(textures.len());
        for (index, t) in textures.iter().enumerate() {
            let class = Class::of(t);
            let at = match open.get(&class) {
                Some(&at) if arrays[at].1.len() < most_layers => at,
                _ => {
                    arrays.push((class, Vec::new()));
                    open.insert(class, arrays.len() - 1);
                    arrays.len() - 1
                }
            };
            slots.push((at as u32) << 16 | arrays[at].1.len() as u32);
            arrays[at].1.push(index);
        }
        if arrays.len() > MAX_CLASSES {
            return Err(TableError::Classes { classes: arrays.len(), most: MAX_CLASSES });
        }
        let mut bytes = 0;
        let mut views = Vec::with_capacity(MAX_CLASSES);
        let mut samplers = Vec::with_capacity(MAX_CLASSES);
        for (class, members) in &arrays {
            let array = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("daa texture class"),
                size: wgpu::Extent3d {
                    width: class.width,
                    height: class.height,
                    depth_or_array_layers: members.len() as u32,
                },
                mip_level_count: class.mips,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: class.format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            });
            for (layer, &index) in members.iter().enumerate() {
                bytes += copy_into_layer(encoder, textures[index].texture, &array, layer as u32);
            }
            views.push(array_view(&array));
            samplers.push(make_sampler(device, class.sampler));
        }
        let (white, _) = white(device, queue);
        let spare_view = array_view(&white);
        let spare_sampler = make_sampler(device, TableSampler::default());
        let slot_buffer = slot_buffer(device, queue, &slots);
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: slot_buffer.as_entire_binding() }];
        for i in 0..MAX_CLASSES {
            entries.push(wgpu::BindGroupEntry {
                binding: 1 + i as u32,
                resource: wgpu::BindingResource::TextureView(views.get(i).unwrap_or(&spare_view)),
            });
            entries.push(wgpu::BindGroupEntry {
                binding: (1 + MAX_CLASSES + i) as u32,
                resource: wgpu::BindingResource::Sampler(samplers.get(i).unwrap_or(&spare_sampler)),
            });
        }
        Ok(TextureTable { bind_group: self.bind(device, &entries), bytes })
    }

    fn bindings(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        textures: &[TableTexture<'_>],
    ) -> Result<TextureTable, TableError> {
        let mut kinds: Vec<TableSampler> = Vec::new();
        let mut slots = Vec::with_capacity(textures.len());
        for (index, t) in textures.iter().enumerate() {
            let kind = kinds.iter().position(|&k| k == t.sampler).unwrap_or_else(|| {
                kinds.push(t.sampler);
                kinds.len() - 1
            });
            slots.push((kind as u32) << 16 | index as u32);
        }
        if kinds.len() > MAX_SAMPLERS {
            return Err(TableError::Classes { classes: kinds.len(), most: MAX_SAMPLERS });
        }
        let default_view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let mut views: Vec<_> = textures.iter().map(|t| default_view(t.texture)).collect();
        let (white, white_view) = white(device, queue);
        drop(white);
        views.resize(self.capacity as usize, white_view);
        let mut samplers: Vec<_> = kinds.iter().map(|&k| make_sampler(device, k)).collect();
        let spare = make_sampler(device, TableSampler::default());
        samplers.resize(MAX_SAMPLERS, spare);
        let slot_buffer = slot_buffer(device, queue, &slots);
        let view_refs: Vec<_> = views.iter().collect();
        let sampler_refs: Vec<_> = samplers.iter().collect();
        let entries = [
            wgpu::BindGroupEntry { binding: 0, resource: slot_buffer.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureViewArray(&view_refs) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::SamplerArray(&sampler_refs) },
        ];
        Ok(TextureTable { bind_group: self.bind(device, &entries), bytes: 0 })
    }

    fn bind(&self, device: &wgpu::Device, entries: &[wgpu::BindGroupEntry<'_>]) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa textures"),
            layout: &self.layout,
            entries,
        })
    }
}

/// Copies all mips of a texture into one layer of an array. Returns their bytes.
fn copy_into_layer(
    encoder: &mut wgpu::CommandEncoder,
    texture: &wgpu::Texture,
    array: &wgpu::Texture,
    layer: u32,
) -> u64 {
    let (block_width, block_height) = texture.format().block_dimensions();
    let block_bytes = u64::from(texture.format().block_copy_size(None).unwrap_or(0));
    let mut bytes = 0;
    for mip in 0..texture.mip_level_count() {
        // Blocks of compressed formats are copied whole, even where a mip is smaller than a block.
        let width = (texture.width() >> mip).max(1).next_multiple_of(block_width);
        let height = (texture.height() >> mip).max(1).next_multiple_of(block_height);
        let at = |texture, z| wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: mip,
            origin: wgpu::Origin3d { x: 0, y: 0, z },
            aspect: wgpu::TextureAspect::All,
        };
        encoder.copy_texture_to_texture(
            at(texture, 0),
            at(array, layer),
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        bytes += u64::from(width / block_width) * u64::from(height / block_height) * block_bytes;
    }
    bytes
}

fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

fn make_sampler(device: &wgpu::Device, s: TableSampler) -> wgpu::Sampler {
    let filter = if s.nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
    let mipmap_filter = if s.nearest { wgpu::MipmapFilterMode::Nearest } else { wgpu::MipmapFilterMode::Linear };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("daa sampler"),
        address_mode_u: s.address_u,
        address_mode_v: s.address_v,
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter,
        // Anisotropy needs every filter to be linear.
        anisotropy_clamp: if s.nearest { 1 } else { s.anisotropy },
        ..Default::default()
    })
}

/// A white texel, for unused places of a table.
fn white(device: &wgpu::Device, queue: &wgpu::Queue) -> (wgpu::Texture, wgpu::TextureView) {
    let size = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("daa white"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), &[255; 4], layout, size);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    (texture, view)
}

/// The place of each texture by its index. Never empty: reads of an empty table return white.
fn slot_buffer(device: &wgpu::Device, queue: &wgpu::Queue, slots: &[u32]) -> wgpu::Buffer {
    let white = [0];
    let slots = if slots.is_empty() { &white } else { slots };
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("daa texture slots"),
        size: size_of_val(slots) as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    queue.write_buffer(&buffer, 0, bytemuck::cast_slice(slots));
    buffer
}
