//! What all cameras of one kind share: Bevy's lighting composed into the hooks of a node, and the node's pipelines.

use crate::error::DeferredAaError;
use bevy_asset::{AssetEvent, AssetId, AssetServer, Assets, Handle, load_embedded_asset};
use bevy_ecs::prelude::*;
use bevy_pbr::MeshPipelineKey;
use bevy_pbr::deferred::DeferredLightingLayout;
use bevy_platform::collections::HashMap;
use bevy_platform::collections::hash_map::Entry;
use bevy_render::Extract;
use bevy_render::render_resource::SpecializedRenderPipeline;
use bevy_render::renderer::RenderDevice;
use bevy_shader::{Shader, ShaderCache, ShaderCacheError, ShaderCacheSource, ShaderDefVal};
use bevy_tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use deferred_aa::{
    BuildError, Channels, DeferredAa, Depth, Descriptor, GBufferTier, HOST_GROUP, Needs, SECOND_HOST_GROUP, Settings,
    Shading, TextureTier, wgpu,
};
use std::sync::Arc;

/// What the node's G-buffer keeps; the rest is in Bevy's own texels.
pub const GBUFFER: GBufferTier = GBufferTier::Stored(Channels { user: true, ..Channels::NONE });

/// The format of the node's image.
pub const IMAGE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What the node writes besides the image: the depth that what Bevy draws over it is tested against. The nearest of a
/// pixel, so that the skybox leaves pixels at an edge alone.
pub const NEEDS: Needs<'static> =
    Needs { depth: Some(Depth::Nearest), rays: None, shadows: &[], reflective: &[], textured: &[], importance: &[] };

/// The bindings of our own WGSL in the host's group, beyond those of Bevy's.
pub mod own {
    pub const TEXELS: u32 = 100;
    pub const VIEW: u32 = 101;
    pub const SKYBOX: u32 = 102;
    pub const SKYBOX_SAMPLER: u32 = 103;
    pub const SKYBOX_SETTINGS: u32 = 104;
}

/// shading.wesl.
#[derive(Resource)]
pub struct RootShader(pub Handle<Shader>);

pub fn root_shader(world: &World) -> Handle<Shader> {
    load_embedded_asset!(world.resource::<AssetServer>(), "shading.wesl")
}

/// Composes shaders as Bevy's pipeline cache does, which keeps the text to itself.
#[derive(Resource)]
pub struct Composer {
    cache: ShaderCache<String, ()>,
    definitions: Vec<ShaderDefVal>,
    /// Whether all shaders are still to be read, as after a lost device.
    fresh: bool,
}

impl FromWorld for Composer {
    fn from_world(world: &mut World) -> Self {
        let buffers = world.resource::<RenderDevice>().limits().max_storage_buffers_per_shader_stage;
        let at_least =
            |n: u32| ShaderDefVal::Bool(format!("AVAILABLE_STORAGE_BUFFER_BINDINGS__GE_{n}").into(), buffers >= n);
        let text = |_: &(), source: ShaderCacheSource<'_>, _: &_| match source {
            ShaderCacheSource::Wgsl(text) => Ok(text),
            ShaderCacheSource::SpirV(_) => Err(ShaderCacheError::ProcessShaderError("SPIR-V can't be joined".into())),
        };
        // Those of `PipelineCache::new` on native platforms.
        let count = ShaderDefVal::UInt("AVAILABLE_STORAGE_BUFFER_BINDINGS".into(), buffers);
        Self { cache: ShaderCache::new((), text), definitions: vec![count, at_least(3), at_least(6)], fresh: true }
    }
}

/// Follows the app's shaders. What was composed of a changed one is composed again.
pub fn extract_shaders(
    mut composer: ResMut<Composer>,
    mut programs: ResMut<Programs>,
    shaders: Extract<Res<Assets<Shader>>>,
    mut events: Extract<MessageReader<AssetEvent<Shader>>>,
) {
    let composer = &mut *composer;
    let (mut changed, mut removed) = (Vec::new(), Vec::new());
    let mut set = |id: AssetId<Shader>, shader: &Shader| {
        let mut shader = shader.clone();
        shader.shader_defs.splice(0..0, composer.definitions.iter().cloned());
        changed.extend(composer.cache.set_shader(id, shader));
    };
    if std::mem::take(&mut composer.fresh) {
        shaders.iter().for_each(|(id, shader)| set(id, shader));
        events.clear();
    }
    for event in events.read() {
        match *event {
            AssetEvent::Added { id } | AssetEvent::Modified { id } => {
                if let Some(shader) = shaders.get(id) {
                    set(id, shader);
                }
            }
            AssetEvent::Removed { id } => removed.push(id),
            AssetEvent::Unused { .. } | AssetEvent::LoadedWithDependencies { .. } => {}
        }
    }
    changed.extend(removed.into_iter().flat_map(|id| composer.cache.remove(id)));
    programs.forget(&changed);
}

/// What a program depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ProgramKey {
    pub m: u32,
    pub mesh: MeshPipelineKey,
    pub skybox: bool,
}

/// The pipelines of a node, and the layouts of the groups that Bevy's lighting binds.
pub struct Program {
    /// Never sized: views are made from it.
    pub node: DeferredAa,
    pub groups: [Group; 2],
}

/// A bind group of the host.
pub struct Group {
    pub layout: wgpu::BindGroupLayout,
    pub entries: Vec<wgpu::BindGroupLayoutEntry>,
}

enum State {
    Building(Task<Result<Program, DeferredAaError>>),
    Ready(Arc<Program>),
    Failed(DeferredAaError),
}

/// All programs by what they depend on.
#[derive(Resource, Default)]
pub struct Programs {
    states: HashMap<ProgramKey, State>,
    /// The keys by the number under which the composer knows them.
    numbers: Vec<ProgramKey>,
}

impl Programs {
    /// Drops the programs with these numbers; views let go of theirs when they get another.
    fn forget(&mut self, numbers: &[usize]) {
        for number in numbers {
            if let Some(key) = self.numbers.get(*number) {
                self.states.remove(key);
            }
        }
    }

    /// The program of a key: `None` while its shaders load or its pipelines compile.
    pub fn get(
        &mut self,
        key: ProgramKey,
        settings: &Settings,
        device: &RenderDevice,
        (composer, root, lighting): (&mut Composer, &RootShader, &DeferredLightingLayout),
    ) -> Result<Option<Arc<Program>>, DeferredAaError> {
        let mut entry = match self.states.entry(key) {
            Entry::Occupied(entry) => entry,
            Entry::Vacant(entry) => {
                let number = self.numbers.iter().position(|k| *k == key).unwrap_or_else(|| {
                    self.numbers.push(key);
                    self.numbers.len() - 1
                });
                let Some(source) = compose(key, number, (composer, root, lighting)).transpose() else {
                    return Ok(None);
                };
                let state = match source {
                    Ok(source) => State::Building(build(source, key.m, *settings, device.wgpu_device().clone())),
                    Err(e) => State::Failed(e),
                };
                entry.insert_entry(state)
            }
        };
        if let State::Building(task) = entry.get_mut()
            && let Some(built) = block_on(poll_once(task))
        {
            entry.insert(match built {
                Ok(program) => State::Ready(Arc::new(program)),
                Err(e) => State::Failed(e),
            });
        }
        match entry.get() {
            State::Building(_) => Ok(None),
            State::Ready(program) => Ok(Some(program.clone())),
            State::Failed(e) => Err(e.clone()),
        }
    }
}

/// The WGSL of the hooks and the entries of both groups.
struct Source {
    text: String,
    entries: [Vec<wgpu::BindGroupLayoutEntry>; 2],
}

/// Composes the hooks; `None` while shaders are loading.
fn compose(
    key: ProgramKey,
    number: usize,
    (composer, root, lighting): (&mut Composer, &RootShader, &DeferredLightingLayout),
) -> Result<Option<Source>, DeferredAaError> {
    // What Bevy's own deferred lighting of this camera would be compiled with.
    let mut bevys = lighting.specialize(key.mesh);
    let definitions: Vec<ShaderDefVal> = bevys
        .fragment
        .as_mut()
        .map(|fragment| std::mem::take(&mut fragment.shader_defs))
        .unwrap_or_default()
        .into_iter()
        // The buffer of decals is Bevy's own.
        .filter(|def| !is(def, "CLUSTERED_DECALS_ARE_USABLE") && !is(def, "LIGHT_TEXTURES"))
        .collect();
    let bevy = match composer.cache.get(number, root.0.id(), &definitions) {
        Ok(text) => text,
        Err(ShaderCacheError::ShaderNotLoaded(_) | ShaderCacheError::ShaderImportNotYetAvailable) => return Ok(None),
        Err(e) => return Err(DeferredAaError::Compose(e.to_string())),
    };
    // The node has group 0, so Bevy's first group is the host's first and its second the host's second.
    let bevy = bevy.replace("@group(0)", &format!("@group({HOST_GROUP})"));
    let skybox = if key.skybox { include_str!("skybox.wgsl") } else { "" };
    let text = [&bevy, include_str!("shading.wgsl"), skybox].join("\n");
    let group = |index: usize, number: u32| {
        let bevys = bevys.layout.get(index).map_or(&[][..], |layout| &layout.entries);
        let read = |entry: &&wgpu::BindGroupLayoutEntry| {
            text.contains(&format!("@group({number}) @binding({})", entry.binding))
        };
        let computes = |entry: &wgpu::BindGroupLayoutEntry| wgpu::BindGroupLayoutEntry {
            visibility: wgpu::ShaderStages::COMPUTE,
            ..*entry
        };
        bevys.iter().filter(read).map(computes).collect::<Vec<_>>()
    };
    let mut entries = [group(0, HOST_GROUP), group(1, SECOND_HOST_GROUP)];
    entries[0].extend(own_entries(key.skybox));
    Ok(Some(Source { text, entries }))
}

fn is(definition: &ShaderDefVal, name: &str) -> bool {
    let (ShaderDefVal::Bool(key, _) | ShaderDefVal::Int(key, _) | ShaderDefVal::UInt(key, _)) = definition;
    key == name
}

fn own_entries(skybox: bool) -> Vec<wgpu::BindGroupLayoutEntry> {
    use wgpu::TextureSampleType::{Float, Uint};
    let entry =
        |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None };
    let texture =
        |sample_type, view_dimension| wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    let uniform = |has_dynamic_offset| wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset,
        min_binding_size: None,
    };
    let mut entries =
        vec![entry(own::TEXELS, texture(Uint, wgpu::TextureViewDimension::D2)), entry(own::VIEW, uniform(false))];
    if skybox {
        entries.extend([
            entry(own::SKYBOX, texture(Float { filterable: true }, wgpu::TextureViewDimension::Cube)),
            entry(own::SKYBOX_SAMPLER, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(own::SKYBOX_SETTINGS, uniform(true)),
        ]);
    }
    entries
}

/// Builds the node and compiles the pipelines of these settings behind the app's back.
fn build(source: Source, m: u32, settings: Settings, device: wgpu::Device) -> Task<Result<Program, DeferredAaError>> {
    AsyncComputeTaskPool::get().spawn(async move {
        let groups = source.entries.map(|entries| Group {
            layout: device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("deferred_aa_lighting"),
                entries: &entries,
            }),
            entries,
        });
        let descriptor = Descriptor {
            m,
            gbuffer: GBUFFER,
            textures: TextureTier::None,
            ..Descriptor::new(IMAGE_FORMAT, Shading { source: &source.text, file: "bevy_deferred_aa/shading" })
        };
        let layouts = groups.each_ref().map(|group| Some(&group.layout));
        let node = DeferredAa::with_groups(&device, &descriptor, layouts).map_err(|e| match e {
            BuildError::Missing(missing) => DeferredAaError::Adapter(missing),
            e => node_error(e),
        })?;
        // What these settings can't have is said when a frame has them; others may do.
        let _ = node.warm_up(&settings, &NEEDS);
        Ok(Program { node, groups })
    })
}

pub fn node_error(e: impl ToString) -> DeferredAaError {
    DeferredAaError::Node(e.to_string())
}
