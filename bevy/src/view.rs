//! The node of a camera, frame by frame.

use crate::bindings::{self, OfView, Shared};
use crate::component::DeferredAaState;
use crate::composite::CompositePipelines;
use crate::diagnostics::{Report, Reports};
use crate::error::DeferredAaError;
use crate::extract::ExtractedDeferredAa;
use crate::pack::PackPipeline;
use crate::program::{Composer, IMAGE_FORMAT, NEEDS, Program, ProgramKey, Programs, RootShader, node_error};
use bevy_core_pipeline::deferred::{DEFERRED_LIGHTING_PASS_ID_FORMAT, DEFERRED_PREPASS_FORMAT};
use bevy_core_pipeline::prepass::{MOTION_VECTOR_PREPASS_FORMAT, NORMAL_PREPASS_FORMAT};
use bevy_ecs::prelude::*;
use bevy_light::Skybox;
use bevy_math::UVec4;
use bevy_pbr::deferred::{DeferredLightingLayout, PbrDeferredLightingDepthId, SkipDeferredLighting};
use bevy_pbr::{MeshPipelineKey, ViewKeyCache};
use bevy_render::camera::ExtractedCamera;
use bevy_render::diagnostic::RecordDiagnostics;
use bevy_render::render_asset::RenderAssets;
use bevy_render::render_resource::StoreOp;
use bevy_render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy_render::texture::GpuImage;
use bevy_render::view::{ExtractedView, Msaa, ViewDepthStencilTexture, ViewTarget};
use bevy_tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use deferred_aa::glam::Mat4;
use deferred_aa::{Camera, DeferredAa, Frame, Settings, wgpu};
use std::sync::Arc;

/// A camera's node, and what it renders into.
#[derive(Component)]
pub struct ViewNode {
    node: DeferredAa,
    program: Arc<Program>,
    targets: Option<Targets>,
    /// Those of this frame, `None` if it is not anti-aliased.
    settings: Option<Settings>,
    /// The last settings whose pipelines were compiled.
    compiled: Settings,
    /// Settings whose pipelines are being compiled.
    compiling: Option<(Settings, Task<Result<(), DeferredAaError>>)>,
    statistics: bool,
    /// Why a frame with these settings could not be recorded.
    failed: Option<(Settings, DeferredAaError)>,
}

/// The textures of a size, beside the node's own.
pub struct Targets {
    /// The first pixel of the viewport in the camera's target.
    pub origin: [u32; 2],
    /// Of the viewport, in pixels.
    pub size: [u32; 2],
    /// Of the G-buffer.
    pub samples: [u32; 2],
    /// Bevy's deferred G-buffer.
    pub texels: wgpu::TextureView,
    pub lighting_passes: wgpu::TextureView,
    /// Normals and motion vectors, which the deferred pipelines of a camera with those prepasses write, too. Nothing
    /// reads them.
    pub unread: [Option<wgpu::TextureView>; 2],
    /// The node's depth.
    pub depth: wgpu::TextureView,
    /// The node's image, and the depth of its pixels.
    image: wgpu::TextureView,
    image_depth: wgpu::TextureView,
    /// `DeferredAaView` of shading.wgsl, which composite.wgsl reads, too.
    pub uniform: wgpu::Buffer,
    lighting_pass: u32,
    pack: wgpu::BindGroup,
    pub composite: wgpu::BindGroup,
    /// The bytes of all this.
    bytes: u64,
}

impl ViewNode {
    /// What this frame is rendered into, `None` if it is not anti-aliased.
    pub fn targets(&self) -> Option<&Targets> {
        self.targets.as_ref().filter(|_| self.settings.is_some())
    }
}

/// What all views are prepared with.
#[derive(bevy_ecs::system::SystemParam)]
pub struct Preparing<'w> {
    device: Res<'w, RenderDevice>,
    queue: Res<'w, RenderQueue>,
    composer: ResMut<'w, Composer>,
    programs: ResMut<'w, Programs>,
    root: Res<'w, RootShader>,
    lighting: Option<Res<'w, DeferredLightingLayout>>,
    keys: Res<'w, ViewKeyCache>,
    images: Res<'w, RenderAssets<GpuImage>>,
    pack: Res<'w, PackPipeline>,
    composite: ResMut<'w, CompositePipelines>,
    reports: Res<'w, Reports>,
}

type Views<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static ExtractedDeferredAa,
        &'static ExtractedCamera,
        &'static ExtractedView,
        &'static Msaa,
        Option<&'static PbrDeferredLightingDepthId>,
        Option<&'static Skybox>,
        Option<&'static mut ViewNode>,
    ),
>;

/// Decides for each camera whether this frame is anti-aliased, and makes what that needs.
pub fn prepare(mut commands: Commands, mut preparing: Preparing, mut views: Views) {
    for (entity, aa, camera, view, msaa, lighting_pass, skybox, mut node) in &mut views {
        let lighting_pass = lighting_pass.map_or(1, |id| id.get());
        let of = (aa, camera, view, msaa, u32::from(lighting_pass), skybox);
        let mut entity_commands = commands.entity(entity);
        let state = match ready(&mut preparing, of, node.as_deref_mut()) {
            Ok(Ready::Waiting) => DeferredAaState::Waiting,
            Ok(Ready::Kept) => DeferredAaState::Active,
            Ok(Ready::New(new)) => {
                entity_commands.insert(*new);
                DeferredAaState::Active
            }
            Err(e) => DeferredAaState::Refused(e),
        };
        match state {
            DeferredAaState::Active => entity_commands.insert(SkipDeferredLighting),
            DeferredAaState::Waiting => entity_commands.remove::<SkipDeferredLighting>(),
            // A node that failed is kept, so that it does not fail anew in every frame.
            DeferredAaState::Refused(_) if node.is_some_and(|node| node.failed.is_some()) => {
                entity_commands.remove::<SkipDeferredLighting>()
            }
            DeferredAaState::Refused(_) => entity_commands.remove::<(ViewNode, SkipDeferredLighting)>(),
        };
        preparing.reports.state(aa.camera, state);
    }
}

enum Ready {
    Waiting,
    /// The view's node is ready for the frame.
    Kept,
    New(Box<ViewNode>),
}

type OfCamera<'a> =
    (&'a ExtractedDeferredAa, &'a ExtractedCamera, &'a ExtractedView, &'a Msaa, u32, Option<&'a Skybox>);

fn ready(
    preparing: &mut Preparing,
    (aa, camera, view, msaa, lighting_pass, skybox): OfCamera<'_>,
    node: Option<&mut ViewNode>,
) -> Result<Ready, DeferredAaError> {
    if let Some(refused) = &aa.refused {
        return Err(refused.clone());
    }
    let settings = aa.settings.settings;
    settings.validate().map_err(node_error)?;
    let (Some(lighting), Some(&mesh), Some(size)) =
        (&preparing.lighting, preparing.keys.get(&view.retained_view_entity), camera.physical_viewport_size)
    else {
        return Ok(Ready::Waiting);
    };
    // Bevy turns multisampling off in the first frame, and a window may have no pixels.
    if *msaa != Msaa::Off || size.min_element() == 0 {
        return Ok(Ready::Waiting);
    }
    if mesh.contains(MeshPipelineKey::ATMOSPHERE) {
        return Err(DeferredAaError::Binding("the Atmosphere"));
    }
    let image = skybox.and_then(|skybox| preparing.images.get(skybox.image.as_ref()?));
    let cube = image.and_then(|image| image.texture_view_descriptor.as_ref()?.dimension);
    let key = ProgramKey { m: aa.settings.m, mesh, skybox: cube == Some(wgpu::TextureViewDimension::Cube) };
    let shared = (&mut *preparing.composer, &*preparing.root, &**lighting);
    let device = &preparing.device;
    let Some(program) = preparing.programs.get(key, &settings, device, shared)? else { return Ok(Ready::Waiting) };
    let node = node.filter(|node| Arc::ptr_eq(&node.program, &program));
    if let Some((with, e)) = node.as_ref().and_then(|node| node.failed.as_ref())
        && *with == settings
    {
        return Err(e.clone());
    }
    let device = device.wgpu_device();
    preparing.composite.prepare(device, view.target_format);

    let prepare = |node: &mut ViewNode| {
        node.settings = Some(node.compiled(settings)?);
        node.statistics = aa.settings.statistics;
        node.resize(
            preparing.device.wgpu_device(),
            &preparing.queue,
            view.viewport,
            (lighting_pass, mesh),
            (&preparing.pack, &preparing.composite),
        )
    };
    match node {
        Some(node) => {
            prepare(node)?;
            Ok(Ready::Kept)
        }
        None => {
            let mut node = ViewNode {
                node: program.node.for_another_view(),
                program,
                targets: None,
                settings: None,
                compiled: settings,
                compiling: None,
                statistics: false,
                failed: None,
            };
            prepare(&mut node)?;
            Ok(Ready::New(Box::new(node)))
        }
    }
}

impl ViewNode {
    /// These settings, or the last ones as long as the pipelines of these are being compiled behind the app's back.
    fn compiled(&mut self, settings: Settings) -> Result<Settings, DeferredAaError> {
        if self.node.is_ready(&settings, &NEEDS) {
            (self.compiled, self.compiling) = (settings, None);
            return Ok(settings);
        }
        match &mut self.compiling {
            Some((compiling, task)) if *compiling == settings => {
                if let Some(compiled) = block_on(poll_once(task)) {
                    self.compiling = None;
                    compiled.inspect_err(|e| self.failed = Some((settings, e.clone())))?;
                }
            }
            _ => {
                let program = self.program.clone();
                let compile = async move { program.node.warm_up(&settings, &NEEDS).map_err(node_error) };
                self.compiling = Some((settings, AsyncComputeTaskPool::get().spawn(compile)));
            }
        }
        Ok(self.compiled)
    }

    fn resize(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        viewport: UVec4,
        (lighting_pass, mesh): (u32, MeshPipelineKey),
        (pack, composite): (&PackPipeline, &CompositePipelines),
    ) -> Result<(), DeferredAaError> {
        let [x, y, width, height] = viewport.to_array();
        let (origin, size) = ([x, y], [width, height]);
        let made = self.targets.as_ref().is_some_and(|t| t.size == size);
        if !made {
            self.targets = None;
            self.node.resize(device, width, height).map_err(node_error)?;
            self.targets = Targets::new(device, &self.node, (size, mesh), (pack, composite));
        }
        let Some(targets) = &mut self.targets else { return Ok(()) };
        if !made || (targets.origin, targets.lighting_pass) != (origin, lighting_pass) {
            (targets.origin, targets.lighting_pass) = (origin, lighting_pass);
            let bytes: Vec<u8> = [x, y, lighting_pass, 0].into_iter().flat_map(u32::to_ne_bytes).collect();
            queue.write_buffer(&targets.uniform, 0, &bytes);
        }
        Ok(())
    }
}

impl Targets {
    fn new(
        device: &wgpu::Device,
        node: &DeferredAa,
        (size, mesh): ([u32; 2], MeshPipelineKey),
        (pack, composite): (&PackPipeline, &CompositePipelines),
    ) -> Option<Self> {
        let gbuffer = node.gbuffer()?;
        let samples = [gbuffer.width, gbuffer.height];
        let texture = |label, [width, height]: [u32; 2], format| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let texels = texture("deferred_aa_texels", samples, DEFERRED_PREPASS_FORMAT);
        let lighting_passes = texture("deferred_aa_lighting_passes", samples, DEFERRED_LIGHTING_PASS_ID_FORMAT);
        let prepasses = [
            (MeshPipelineKey::NORMAL_PREPASS, NORMAL_PREPASS_FORMAT),
            (MeshPipelineKey::MOTION_VECTOR_PREPASS, MOTION_VECTOR_PREPASS_FORMAT),
        ];
        let unread = prepasses
            .map(|(prepass, format)| mesh.contains(prepass).then(|| texture("deferred_aa_unread", samples, format)));
        let image = texture("deferred_aa_image", size, IMAGE_FORMAT);
        let image_depth = texture("deferred_aa_depth", size, deferred_aa::gbuffer::DEPTH_FORMAT);
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("deferred_aa_view"),
            size: 16,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let area = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        Some(Self {
            origin: [0; 2],
            size,
            samples,
            depth: gbuffer.depth.clone(),
            pack: pack.group(device, &texels, &lighting_passes),
            composite: composite.group(device, &image, &image_depth, &uniform),
            // 16 bytes of Bevy's texel, 1 of the lighting pass and 4 of what is not read; 8 of colour and 4 of depth.
            bytes: (17 + 4 * unread.iter().flatten().count() as u64) * area(samples) + 12 * area(size),
            texels,
            lighting_passes,
            unread,
            image,
            image_depth,
            uniform,
            lighting_pass: 0,
        })
    }
}

/// Shades the samples and draws the image over the camera's target.
pub fn shade(
    view: ViewQuery<(
        &ExtractedDeferredAa,
        &ExtractedView,
        &ViewTarget,
        &ViewDepthStencilTexture,
        OfView,
        &mut ViewNode,
    )>,
    shared: Shared,
    queue: Res<RenderQueue>,
    pack: Res<PackPipeline>,
    composite: Res<CompositePipelines>,
    reports: Res<Reports>,
    mut ctx: RenderContext,
) {
    let (aa, view, target, depth, of, mut node) = view.into_inner();
    let ViewNode { node, program, targets: Some(targets), settings: Some(settings), statistics, failed, .. } =
        &mut *node
    else {
        return;
    };
    let device = ctx.render_device().clone();
    let bound = match bindings::bind(device.wgpu_device(), program, targets, (&shared, &of)) {
        Ok(bound) => bound,
        Err(e) => {
            *failed = Some((*settings, e));
            return;
        }
    };
    let Some(gbuffer) = node.gbuffer() else { return };
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = ctx.command_encoder();
    pack.record(encoder, &targets.pack, gbuffer, diagnostics);

    let matrix = |m: bevy_math::Mat4| Mat4::from_cols_array(&m.to_cols_array());
    let [offsets, second_offsets] = &bound.offsets;
    let frame = Frame {
        settings: *settings,
        // Bevy's lighting is exposed already.
        exposure: 1.0,
        host_bind_group: Some(&bound.groups[0]),
        second_bind_group: Some(&bound.groups[1]),
        host_offsets: [offsets, second_offsets],
        needs: NEEDS,
        depth: Some(&targets.image_depth),
        statistics: *statistics,
        ..Frame::new(
            Camera {
                world_from_view: matrix(view.world_from_view.to_matrix()),
                clip_from_view: matrix(view.clip_from_view),
            },
            &targets.image,
        )
    };
    let span = diagnostics.time_span(encoder, "deferred_aa_shade");
    let recorded = node.record(&queue, encoder, &frame);
    span.end(encoder);
    if let Err(e) = recorded {
        *failed = Some((*settings, node_error(e)));
        return;
    }
    composite.record(
        encoder,
        targets,
        target.main_texture_format(),
        target.get_unsampled_color_attachment(),
        depth.get_attachment(StoreOp::Store),
        diagnostics,
    );
    reports.frame(aa.camera, Report { statistics: node.statistics().cloned(), bytes: targets.bytes + bytes(node) });
}

fn bytes(node: &DeferredAa) -> u64 {
    let memory = node.memory();
    memory.gbuffer + memory.scratch + memory.rays
}

/// Drops what belongs to a device that was lost.
pub fn forget(mut commands: Commands, nodes: Query<Entity, With<ViewNode>>) {
    for entity in &nodes {
        commands.entity(entity).remove::<(ViewNode, SkipDeferredLighting)>();
    }
}

/// No frame is rendered with what an earlier one was prepared for.
pub fn finish(mut nodes: Query<&mut ViewNode>) {
    for mut node in &mut nodes {
        node.settings = None;
    }
}
