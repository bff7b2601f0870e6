//! The bind groups of Bevy's lighting, as `prepare_mesh_view_bind_groups` of bevy_pbr makes them, for compute shaders.

use crate::error::DeferredAaError;
use crate::program::{Group, Program, own};
use crate::view::Targets;
use bevy_asset::AssetId;
use bevy_core_pipeline::core_3d::DEPTH_PREPASS_TEXTURE_SUPPORTED;
use bevy_core_pipeline::prepass::ViewPrepassTextures;
use bevy_core_pipeline::skybox::SkyboxUniforms;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_image::Image;
use bevy_light::{EnvironmentMapLight, IrradianceVolume, Skybox};
use bevy_pbr::contact_shadows::{ContactShadowsBuffer, ViewContactShadowsUniformOffset};
use bevy_pbr::{
    AreaLightLuts, Bluenoise, DfgLut, FogMeta, GlobalClusterableObjectMeta, LightMeta, LightProbesBuffer,
    RenderViewLightProbes, ScreenSpaceAmbientOcclusionResources, ScreenSpaceReflectionsBuffer, ShadowSamplers,
    ViewClusterBindings, ViewFogUniformOffset, ViewLightProbesUniformOffset, ViewLightsUniformOffset,
    ViewScreenSpaceReflectionsUniformOffset, ViewShadowBindings, get_bindings,
};
use bevy_render::extract_component::{ComponentUniforms, DynamicUniformIndex};
use bevy_render::globals::GlobalsBuffer;
use bevy_render::render_asset::RenderAssets;
use bevy_render::render_resource::TextureView;
use bevy_render::texture::{FallbackImage, GpuImage};
use bevy_render::view::{ViewUniformOffset, ViewUniforms};
use deferred_aa::wgpu;

/// The resources that Bevy's lighting binds for all cameras.
#[derive(SystemParam)]
pub struct Shared<'w> {
    views: Res<'w, ViewUniforms>,
    lights: Res<'w, LightMeta>,
    clustered: Res<'w, GlobalClusterableObjectMeta>,
    globals: Res<'w, GlobalsBuffer>,
    probes: Res<'w, LightProbesBuffer>,
    fogs: Res<'w, FogMeta>,
    reflections: Res<'w, ScreenSpaceReflectionsBuffer>,
    contact_shadows: Res<'w, ContactShadowsBuffer>,
    samplers: Res<'w, ShadowSamplers>,
    noise: Res<'w, Bluenoise>,
    area_lights: Res<'w, AreaLightLuts>,
    dfg: Res<'w, DfgLut>,
    skyboxes: Res<'w, ComponentUniforms<SkyboxUniforms>>,
    images: Res<'w, RenderAssets<GpuImage>>,
    fallback: Res<'w, FallbackImage>,
}

/// The components that Bevy's lighting binds for a camera.
#[derive(QueryData)]
pub struct OfView {
    shadows: &'static ViewShadowBindings,
    clusters: &'static ViewClusterBindings,
    occlusion: Option<&'static ScreenSpaceAmbientOcclusionResources>,
    prepass: Option<&'static ViewPrepassTextures>,
    environment: Option<&'static RenderViewLightProbes<EnvironmentMapLight>>,
    irradiance: Option<&'static RenderViewLightProbes<IrradianceVolume>>,
    view: &'static ViewUniformOffset,
    lights: &'static ViewLightsUniformOffset,
    probes: &'static ViewLightProbesUniformOffset,
    fog: Option<&'static ViewFogUniformOffset>,
    reflections: Option<&'static ViewScreenSpaceReflectionsUniformOffset>,
    contact_shadows: Option<&'static ViewContactShadowsUniformOffset>,
    skybox: Option<(&'static Skybox, &'static DynamicUniformIndex<SkyboxUniforms>)>,
}

/// Both bind groups of a frame with their dynamic offsets.
pub struct Bound {
    pub groups: [wgpu::BindGroup; 2],
    pub offsets: [Vec<u32>; 2],
}

/// A resource of a binding.
enum Found<'a> {
    One(wgpu::BindingResource<'a>),
    View(&'a wgpu::TextureView),
    Owned(TextureView),
    Views(Vec<&'a wgpu::TextureView>),
}

fn skybox<'a>(shared: &'a Shared<'_>, of: &OfViewItem<'_, '_>) -> Option<&'a GpuImage> {
    let (skybox, _) = of.skybox?;
    let image = shared.images.get(skybox.image.as_ref()?)?;
    // Bevy draws no other.
    let dimension = image.texture_view_descriptor.as_ref()?.dimension?;
    (dimension == wgpu::TextureViewDimension::Cube).then_some(image)
}

/// Binds what a program reads.
pub fn bind<'a>(
    device: &wgpu::Device,
    program: &Program,
    targets: &'a Targets,
    (shared, of): (&'a Shared<'_>, &'a OfViewItem<'_, '_>),
) -> Result<Bound, DeferredAaError> {
    let [first, second] = &program.groups;
    let mut offsets = [Vec::new(), Vec::new()];
    let main = group(device, first, &mut offsets[0], |entry| main(entry.binding, shared, of, targets))?;
    let arrays = group(device, second, &mut offsets[1], |entry| arrays(entry, shared, of))?;
    Ok(Bound { groups: [main, arrays], offsets })
}

fn group<'a>(
    device: &wgpu::Device,
    group: &Group,
    offsets: &mut Vec<u32>,
    find: impl Fn(&wgpu::BindGroupLayoutEntry) -> Result<(Found<'a>, Option<u32>), DeferredAaError>,
) -> Result<wgpu::BindGroup, DeferredAaError> {
    let mut found = Vec::with_capacity(group.entries.len());
    for entry in &group.entries {
        let (resource, offset) = find(entry)?;
        offsets.extend(offset);
        found.push((entry.binding, resource));
    }
    let entries: Vec<_> = found
        .iter()
        .map(|(binding, found)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: match found {
                Found::One(resource) => resource.clone(),
                Found::View(view) => wgpu::BindingResource::TextureView(view),
                Found::Owned(view) => wgpu::BindingResource::TextureView(view),
                Found::Views(views) => wgpu::BindingResource::TextureViewArray(views),
            },
        })
        .collect();
    Ok(device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("deferred_aa_lighting"),
        layout: &group.layout,
        entries: &entries,
    }))
}

/// The resource of a binding of Bevy's first group, or of ours behind it, and its dynamic offset.
fn main<'a>(
    binding: u32,
    shared: &'a Shared<'_>,
    of: &'a OfViewItem<'_, '_>,
    targets: &'a Targets,
) -> Result<(Found<'a>, Option<u32>), DeferredAaError> {
    use Found::{One, Owned, View};
    let missing = |what| DeferredAaError::Binding(what);
    let dynamic = |resource: Option<wgpu::BindingResource<'a>>, offset: Option<u32>, what| {
        let both = resource.zip(offset).ok_or(missing(what))?;
        Ok((One(both.0), Some(both.1)))
    };
    let buffer = |resource: Option<wgpu::BindingResource<'a>>, what| {
        resource.map(|resource| (One(resource), None)).ok_or(missing(what))
    };
    let sampler = |sampler: &'a wgpu::Sampler| Ok((One(wgpu::BindingResource::Sampler(sampler)), None));
    let texture = |view: &'a wgpu::TextureView| Ok((View(view), None));
    let lookup = |image: AssetId<Image>, or: &'a GpuImage| shared.images.get(image).unwrap_or(or);
    match binding {
        0 => dynamic(shared.views.uniforms.binding(), Some(of.view.offset), "the view's uniforms"),
        1 => dynamic(shared.lights.view_gpu_lights.binding(), Some(of.lights.offset), "the lights"),
        2 => texture(&of.shadows.point_light_depth_texture_view),
        3 => sampler(&shared.samplers.point_light_comparison_sampler),
        5 => texture(&of.shadows.directional_light_depth_texture_view),
        6 => sampler(&shared.samplers.directional_light_comparison_sampler),
        8 => buffer(shared.clustered.gpu_clustered_lights.binding(), "the clustered lights"),
        9 => buffer(of.clusters.clusterable_object_index_lists_binding(), "the lists of clusters"),
        10 => buffer(of.clusters.offsets_and_counts_binding(), "the clusters"),
        11 => buffer(shared.globals.buffer.binding(), "the globals"),
        12 => dynamic(shared.probes.binding(), Some(**of.probes), "the light probes"),
        13 => dynamic(shared.fogs.gpu_fogs.binding(), of.fog.map(|fog| fog.offset), "the fog"),
        15 => dynamic(shared.reflections.binding(), of.reflections.map(|o| **o), "screen-space reflections"),
        16 => dynamic(shared.contact_shadows.0.binding(), of.contact_shadows.map(|o| o.0), "contact shadows"),
        17 => {
            let resources = of.occlusion.ok_or(missing("ambient occlusion"))?;
            texture(&resources.screen_space_ambient_occlusion_texture.default_view)
        }
        20..=23 if DEPTH_PREPASS_TEXTURE_SUPPORTED => {
            let [depth, normal, motion, deferred] = get_bindings(of.prepass);
            let view = [depth, normal, motion, deferred].into_iter().nth(binding as usize - 20).flatten();
            Ok((Owned(view.ok_or(missing("a prepass texture"))?), None))
        }
        31..=33 => Err(missing("the Atmosphere")),
        34 => texture(&lookup(shared.noise.texture.id(), &shared.fallback.d2_array).texture_view),
        35 => texture(&lookup(shared.area_lights.image.id(), &shared.fallback.d2_array).texture_view),
        36 => sampler(&lookup(shared.area_lights.image.id(), &shared.fallback.d2_array).sampler),
        37 => texture(&lookup(shared.dfg.texture.id(), &shared.fallback.d2).texture_view),
        38 => sampler(&lookup(shared.dfg.texture.id(), &shared.fallback.d2).sampler),
        own::TEXELS => texture(&targets.texels),
        own::VIEW => Ok((One(targets.uniform.as_entire_binding()), None)),
        own::SKYBOX => texture(&skybox(shared, of).ok_or(missing("the skybox"))?.texture_view),
        own::SKYBOX_SAMPLER => sampler(&skybox(shared, of).ok_or(missing("the skybox"))?.sampler),
        own::SKYBOX_SETTINGS => {
            let offset = of.skybox.map(|(_, index)| index.index());
            dynamic(shared.skyboxes.uniforms().binding(), offset, "the skybox")
        }
        _ => Err(missing("a binding that this version of the plugin does not know")),
    }
}

/// The resource of a binding of Bevy's second group: light probes.
fn arrays<'a>(
    entry: &wgpu::BindGroupLayoutEntry,
    shared: &'a Shared<'_>,
    of: &'a OfViewItem<'_, '_>,
) -> Result<(Found<'a>, Option<u32>), DeferredAaError> {
    let fallback = match entry.binding {
        0..=2 => &shared.fallback.cube,
        3..=4 => &shared.fallback.d3,
        _ => return Err(DeferredAaError::Binding("clustered decals")),
    };
    let environment = || of.environment.iter().flat_map(|probes| &probes.binding_index_to_textures);
    let irradiance = || of.irradiance.iter().flat_map(|probes| &probes.binding_index_to_textures);
    let ids: Vec<AssetId<Image>> = match entry.binding {
        0 => environment().map(|ids| ids.diffuse).collect(),
        1 => environment().map(|ids| ids.specular).collect(),
        2 => environment().flat_map(|ids| [ids.diffuse, ids.specular]).collect(),
        _ => irradiance().copied().collect(),
    };
    let images = ids.iter().map(|id| shared.images.get(*id));
    if matches!(entry.binding, 2 | 4) {
        // All probes are read through the sampler of the first image that is there.
        let sampler = &images.flatten().next().unwrap_or(fallback).sampler;
        return Ok((Found::One(wgpu::BindingResource::Sampler(sampler)), None));
    }
    let mut views: Vec<&wgpu::TextureView> = images.map(|image| &*image.unwrap_or(fallback).texture_view).collect();
    let found = match entry.count {
        Some(count) => {
            // Some backends want every place of an array filled.
            views.resize(count.get() as usize, &*fallback.texture_view);
            Found::Views(views)
        }
        None => Found::View(views.first().copied().unwrap_or(&fallback.texture_view)),
    };
    Ok((found, None))
}
