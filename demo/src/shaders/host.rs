//! The layout of a host's bind group, from its WGSL.

use super::bindings::length;
use deferred_aa::{CONTRACT_WGSL, DeferredAa, HOST_GROUP, Shading, ShadingError, TextureTier};
use naga::{AddressSpace, ImageClass, ImageDimension, StorageAccess, TypeInner};
use std::num::NonZeroU32;

/// Of what the shading declares in the host's group; `None` if it declares nothing there.
pub fn layout(
    device: &wgpu::Device,
    shading: Shading<'_>,
    textures: TextureTier,
) -> Result<Option<wgpu::BindGroupLayout>, ShadingError> {
    DeferredAa::check_shading(shading, textures, device.features())?;
    let (directives, table) = DeferredAa::texture_wgsl(textures);
    let joined = [directives, shading.source, CONTRACT_WGSL, table].join("\n");
    // What was checked parses.
    let Ok(module) = naga::front::wgsl::parse_str(&joined) else { return Ok(None) };
    let globals = module.global_variables.iter();
    let mut entries: Vec<_> = globals.filter_map(|(_, variable)| entry(&module, variable)).collect();
    entries.sort_by_key(|e| e.binding);
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("host"), entries: &entries };
    Ok((!entries.is_empty()).then(|| device.create_bind_group_layout(&descriptor)))
}

fn entry(module: &naga::Module, variable: &naga::GlobalVariable) -> Option<wgpu::BindGroupLayoutEntry> {
    let binding = variable.binding.filter(|b| b.group == HOST_GROUP)?.binding;
    let count = length(module, variable).and_then(NonZeroU32::new);
    let inner = match &module.types[variable.ty].inner {
        TypeInner::BindingArray { base, .. } => &module.types[*base].inner,
        inner => inner,
    };
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let ty = match (variable.space, inner) {
        (AddressSpace::Uniform, _) => buffer(wgpu::BufferBindingType::Uniform),
        (AddressSpace::Storage { access }, _) => {
            buffer(wgpu::BufferBindingType::Storage { read_only: !access.contains(StorageAccess::STORE) })
        }
        (_, TypeInner::Sampler { comparison: true }) => {
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison)
        }
        (_, TypeInner::Sampler { .. }) => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        (_, TypeInner::AccelerationStructure { vertex_return }) => {
            wgpu::BindingType::AccelerationStructure { vertex_return: *vertex_return }
        }
        (_, &TypeInner::Image { dim, arrayed, class }) => image(dim, arrayed, class),
        _ => return None,
    };
    Some(wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count })
}

fn image(dim: ImageDimension, arrayed: bool, class: ImageClass) -> wgpu::BindingType {
    let view_dimension = match (dim, arrayed) {
        (ImageDimension::D1, _) => wgpu::TextureViewDimension::D1,
        (ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
        (ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
        (ImageDimension::D3, _) => wgpu::TextureViewDimension::D3,
        (ImageDimension::Cube, false) => wgpu::TextureViewDimension::Cube,
        (ImageDimension::Cube, true) => wgpu::TextureViewDimension::CubeArray,
    };
    let (sample_type, multisampled) = match class {
        ImageClass::Sampled { kind: naga::ScalarKind::Sint, multi } => (wgpu::TextureSampleType::Sint, multi),
        ImageClass::Sampled { kind: naga::ScalarKind::Uint, multi } => (wgpu::TextureSampleType::Uint, multi),
        ImageClass::Sampled { multi, .. } => (wgpu::TextureSampleType::Float { filterable: !multi }, multi),
        ImageClass::Depth { multi } => (wgpu::TextureSampleType::Depth, multi),
        ImageClass::Storage { format, access } => {
            let stores = access.contains(StorageAccess::STORE);
            let access = match (access.contains(StorageAccess::LOAD), stores) {
                (true, true) => wgpu::StorageTextureAccess::ReadWrite,
                (true, false) => wgpu::StorageTextureAccess::ReadOnly,
                _ => wgpu::StorageTextureAccess::WriteOnly,
            };
            let format = wgpu_naga_bridge::map_storage_format_from_naga(format);
            return wgpu::BindingType::StorageTexture { access, format, view_dimension };
        }
        ImageClass::External => return wgpu::BindingType::ExternalTexture,
    };
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled }
}
