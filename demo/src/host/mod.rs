//! The demo as a host: a scene, a node and a target, frame by frame.

pub mod blend;
mod enclosed;
pub mod gpu;
#[cfg(test)]
mod layouts;
pub mod mips;
pub mod raster;
pub mod rays;
mod textures;
pub mod upload;
pub mod visible;

use crate::picture::Picture;
use crate::scene::{Camera, Material, Scene, Sun};
use blend::Blend;
use deferred_aa::rays::{RayError, RayTier};
use deferred_aa::{
    Band, BuildError, CastingLight, Channels, DebugView, DeferredAa, Depth, Descriptor, Effect, Frame, GBuffer,
    GBufferTier, Ids, Needs, ObjectImportance, Pass, PlanWord, RecordError, Rect, Settings, Shading, SizeError,
    Statistics, SurfaceWord, Technique, TextureTier,
};
use glam::Vec3;
use gpu::Gpu;
use raster::{Raster, node_camera};
pub use raster::{SHADING_WGSL, TARGET_FORMAT};
use rays::Rays;
use upload::{GpuScene, UploadError};

/// The most textures of a scene on the binding tier.
pub const TEXTURE_CAPACITY: u32 = 1024;

/// The host's WGSL for scenes without textures.
pub const UNTEXTURED_WGSL: &str =
    concat!(include_str!("material.wgsl"), "\n", include_str!("untextured.wgsl"), "\n", include_str!("shading.wgsl"));

/// The options that are fixed for a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Samples along one side of a window.
    pub m: u32,
    /// How textures are reached.
    pub textures: TextureTier,
    /// How often the light loop runs.
    pub stall: u32,
    /// Anisotropy of texture reads, 1 to 16.
    pub anisotropy: u16,
    /// The tier that traces rays.
    pub rays: RayTier,
    /// Whether frames may trace any. Without, less is asked of the adapter.
    pub traces: bool,
    /// How the G-buffer keeps its samples.
    pub gbuffer: GBufferTier,
}

/// A host with a scene loaded.
#[derive(Debug)]
pub struct Host {
    /// The device.
    pub gpu: Gpu,
    /// The node.
    pub aa: DeferredAa,
    /// The scene as it was loaded, but that blended instances come last.
    pub scene: Scene,
    /// The scene on the GPU.
    pub uploaded: GpuScene,
    /// The options that it was built with.
    pub options: Options,
    /// The most bytes that the node may hold; it renders in bands then. `None`: the whole image at once.
    pub memory: Option<u64>,
    /// The most bytes that all textures and buffers of the device were seen to take.
    peak: u64,
    /// Materials that reflect or refract.
    reflective: Vec<u32>,
    /// Materials with a texture.
    textured: Vec<u32>,
    /// Importance of objects, for `Settings::selective.focused`.
    pub importance: Vec<ObjectImportance>,
    /// The scene for rays, there from the first frame that traces.
    pub rays: Option<Rays>,
    raster: Raster,
    /// What is drawn over the image, if the scene has any of it.
    blend: Option<Blend>,
    host_bind_group: wgpu::BindGroup,
    lighting: wgpu::Buffer,
    lighting_values: Lighting,
    target: wgpu::Texture,
    target_view: wgpu::TextureView,
    /// The camera of the G-buffer.
    shown: Option<deferred_aa::Camera>,
}

/// A rendered frame.
#[derive(Debug, Clone)]
pub struct Shot {
    /// The statistics of the node.
    pub statistics: Statistics,
    /// The G-buffer pass, in milliseconds.
    pub gbuffer_ms: Option<f64>,
}

/// A frame could not be rendered.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// The node could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The size is out of bounds.
    #[error("{}", too_large(.0))]
    Size(#[from] SizeError),
    /// The scene does not fit.
    #[error(transparent)]
    Upload(#[from] UploadError),
    /// The frame was refused.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The frame would trace rays.
    #[error(
        "the settings want rays, for which the adapter lacks limits; switch shadows, reflections and refraction off"
    )]
    NoRays,
    /// Rays can't be traced through the scene.
    #[error(transparent)]
    Rays(#[from] RayError),
    /// wgpu complained.
    #[error("the graphics driver refused the frame: {0}")]
    Device(String),
    /// Statistics did not arrive.
    #[error("the device returned no statistics; it may have been lost")]
    NoStatistics,
    /// The device is gone.
    #[error("the graphics device was lost ({0}); start again, with a smaller --size or --m if it was out of memory")]
    Lost(String),
    /// An image that a peer was not made for.
    #[error("{peer}: the image is {}x{}, the peers are for {}x{}: make them anew", image.0, image.1, size.0, size.1)]
    PeerSize {
        /// Its name.
        peer: &'static str,
        /// Width and height of the image.
        image: (u32, u32),
        /// Width and height that the peers are for.
        size: (u32, u32),
    },
    /// A peer does not stand beside the node here, and why.
    #[error("{0}")]
    NoPeer(String),
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Lighting {
    pub(crate) to_sun: [f32; 3],
    pub(crate) light_count: u32,
    pub(crate) sun: [f32; 3],
    pub(crate) stall: u32,
    pub(crate) zenith: [f32; 4],
    pub(crate) horizon: [f32; 4],
    pub(crate) ground: [f32; 4],
    pub(crate) camera: [f32; 3],
    pub(crate) sun_casts: u32,
}

/// The stored G-buffer of scenes without textures.
const UNTEXTURED: GBufferTier = GBufferTier::Stored(Channels { uv: false, tangent: false, ..Channels::ALL });

/// The stored G-buffer of a scene: what its shading reads.
pub fn stored(scene: &Scene) -> GBufferTier {
    if scene.textures.is_empty() { UNTEXTURED } else { GBufferTier::default() }
}

/// The radii of scenes in which the areas of triangles, which a visibility buffer's samples divide by, neither overflow
/// nor vanish.
const VISIBLE_RADII: std::ops::RangeInclusive<f32> = 1e-5..=1e9;

/// The G-buffer of a scene on an adapter: a visibility buffer wherever the adapter tells triangles apart.
pub fn gbuffer_tier(scene: &Scene, adapter: &wgpu::Adapter) -> GBufferTier {
    let has = adapter.features().contains(wgpu::Features::PRIMITIVE_INDEX);
    let radius = scene.bounds().map_or(1.0, |bounds| bounds.radius());
    if !has || !VISIBLE_RADII.contains(&radius) {
        return stored(scene);
    }
    let triangles = scene.meshes.iter().map(|mesh| mesh.indices.len() / 3).max().unwrap_or(0);
    GBufferTier::Visibility(Ids::for_scene(triangles as u32, scene.instances.len() as u32))
}

/// The G-buffer of a wanted kind that is best for a scene on an adapter, in nodes of these tiers: a stored one where a
/// visibility buffer needs more than the adapter has.
pub fn gbuffer_for(
    wanted: GBufferTier,
    scene: &Scene,
    adapter: &wgpu::Adapter,
    textures: TextureTier,
    rays: Option<RayTier>,
) -> GBufferTier {
    let best = match wanted {
        GBufferTier::Visibility(_) => gbuffer_tier(scene, adapter),
        GBufferTier::Stored(_) => return stored(scene),
    };
    let missing = DeferredAa::requirements(adapter, &descriptor(1, textures, rays, best)).missing;
    if missing.is_empty() { best } else { stored(scene) }
}

/// The lights that cast shadows in a frame: those of the scene that do, and the sun if it does or is asked to.
fn casting(scene: &Scene, shadows: Effect) -> Vec<CastingLight> {
    match shadows {
        Effect::Off => Vec::new(),
        Effect::Auto => rays::casting_lights(scene, scene.sun.is_some_and(|s| s.casts)),
        Effect::On => rays::casting_lights(scene, true),
    }
}

/// Whether frames of a scene trace rays with these settings.
pub fn traces(scene: &Scene, settings: &Settings) -> bool {
    let effects = [settings.shadows, settings.reflections, settings.refraction];
    let reflections = [settings.reflections, settings.refraction];
    effects.contains(&Effect::On)
        || !casting(scene, settings.shadows).is_empty()
        || (reflections.contains(&Effect::Auto) && !rays::reflective(scene).is_empty())
}

/// The descriptor of the demo's nodes.
pub fn descriptor(
    m: u32,
    textures: TextureTier,
    rays: impl Into<Option<RayTier>>,
    gbuffer: GBufferTier,
) -> Descriptor<'static> {
    let source = if gbuffer == UNTEXTURED { UNTEXTURED_WGSL } else { SHADING_WGSL };
    Descriptor {
        m,
        target_format: TARGET_FORMAT,
        gbuffer,
        shading: Shading { source, file: "demo/src/host/shading.wgsl" },
        textures,
        texture_capacity: TEXTURE_CAPACITY,
        rays: rays.into(),
    }
}

pub(crate) fn host_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let buffer = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        // The fragments of blended surfaces are lit by the same functions.
        visibility: wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let storage = wgpu::BufferBindingType::Storage { read_only: true };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("shading"),
        entries: &[buffer(0, wgpu::BufferBindingType::Uniform), buffer(1, storage), buffer(2, storage)],
    })
}

/// Makes a target with `TEXTURE_BINDING`, so that a pass of the host's own can read it.
fn target(device: &wgpu::Device, width: u32, height: u32) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TARGET_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    (texture, view)
}

impl Options {
    /// Options for pictures of this size: textures in arrays, no stall, an anisotropy of 16, rays in software and a
    /// stored G-buffer.
    pub fn new(width: u32, height: u32, m: u32) -> Self {
        let (textures, rays, gbuffer) = (TextureTier::Arrays, RayTier::Software, GBufferTier::default());
        Self { width, height, m, textures, stall: 1, anisotropy: 16, rays, traces: true, gbuffer }
    }

    /// The tier of the rays that frames may trace.
    pub fn traced(&self) -> Option<RayTier> {
        self.traces.then_some(self.rays)
    }

    /// The descriptor of a node with these options.
    pub fn descriptor(&self) -> Descriptor<'static> {
        descriptor(self.m, self.textures, self.traced(), self.gbuffer)
    }
}

/// In words of the command line.
fn too_large(e: &SizeError) -> String {
    match e {
        SizeError::TooLarge { width, height, m, limit } => format!(
            "{width}×{height} at m = {m} needs more than the {limit} samples a side that the adapter has room for; lower \
             --m or --size, or divide it: render --memory 2GB"
        ),
        e => e.to_string(),
    }
}

impl HostError {
    /// The device is gone, and with it all that is on it.
    pub fn is_loss(&self) -> bool {
        matches!(self, Self::Lost(_) | Self::NoStatistics)
    }
}

impl Host {
    /// Builds the node, uploads the scene.
    pub fn new(gpu: Gpu, scene: Scene, options: Options) -> Result<Self, HostError> {
        Self::within(gpu, scene, options, None)
    }

    /// [`new`](Self::new) for frames in bands, so that the node holds at most so many bytes.
    pub fn within(gpu: Gpu, mut scene: Scene, options: Options, memory: Option<u64>) -> Result<Self, HostError> {
        // Rays don't meet blended instances, and the others have the same numbers with and without them.
        let Scene { meshes, materials, instances, .. } = &mut scene;
        instances.sort_by_key(|i| materials[meshes[i.mesh].material].blended);
        let device = &gpu.device;
        let layout = host_layout(device);
        let mut aa = DeferredAa::new(device, &options.descriptor(), Some(&layout))?;
        if memory.is_none() {
            aa.resize(device, options.width, options.height)?;
        }
        let uploaded = GpuScene::new(device, &gpu.queue, &aa, &scene, options.anisotropy)?;
        let raster = Raster::new(device, &aa, options.textures, &scene, &uploaded);
        let size = (options.width, options.height);
        let blend = Blend::new(device, &aa, options.textures, &scene, &layout, size)?;
        let lighting = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("lighting"),
            size: size_of::<Lighting>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let values = Lighting {
            to_sun: [0.0; 3],
            light_count: uploaded.light_count,
            sun: [0.0; 3],
            stall: options.stall.max(1),
            zenith: scene.sky.zenith.extend(0.0).to_array(),
            horizon: scene.sky.horizon.extend(0.0).to_array(),
            ground: scene.sky.ground.extend(0.0).to_array(),
            camera: [0.0; 3],
            sun_casts: rays::sun_bit(&scene),
        };
        let host_bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shading"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: lighting.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: uploaded.lights.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: uploaded.materials.as_entire_binding() },
            ],
        });
        let (target, target_view) = target(device, options.width, options.height);
        let sun = scene.sun;
        let mut host = Self {
            aa,
            reflective: rays::reflective(&scene),
            textured: textured(&scene),
            importance: Vec::new(),
            scene,
            uploaded,
            options,
            memory,
            peak: 0,
            rays: None,
            raster,
            blend,
            host_bind_group,
            lighting,
            lighting_values: values,
            target,
            target_view,
            shown: None,
            gpu,
        };
        host.set_sun(sun);
        host.complaints()?;
        Ok(host)
    }

    /// Renders the G-buffer and records the node, then waits for both. The image is in the target: see
    /// [`picture`](Self::picture).
    pub fn frame(&mut self, camera: &Camera, settings: Settings) -> Result<Shot, HostError> {
        self.frame_with(node_camera(camera, self.options.width, self.options.height), settings)
    }

    /// [`frame`](Self::frame) by a camera that may be off-centre, such as part of another's picture.
    pub fn frame_with(&mut self, camera: deferred_aa::Camera, settings: Settings) -> Result<Shot, HostError> {
        let bands = self.bands(&settings)?;
        self.frame_of_bands(camera, settings, &bands, Self::raster, |_, _| ())
    }

    /// [`frame_with`](Self::frame_with) in these bands. `fill` makes the G-buffer of each, and `done` follows when the
    /// GPU has finished with it.
    pub fn frame_of_bands(
        &mut self,
        camera: deferred_aa::Camera,
        settings: Settings,
        bands: &[Option<Band>],
        mut fill: impl FnMut(&Self, &mut wgpu::CommandEncoder, &deferred_aa::Camera, Option<&Band>),
        mut done: impl FnMut(&Self, Option<&Band>),
    ) -> Result<Shot, HostError> {
        let mut gbuffer_ms = Some(0.0);
        for &band in bands {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            fill(self, &mut encoder, &camera, band.as_ref());
            self.shade(encoder, (camera, band), settings, DeferredAa::record)?;
            gbuffer_ms = gbuffer_ms.zip(self.raster.milliseconds(&self.gpu)).map(|(sum, ms)| sum + ms);
            self.peak = self.peak.max(self.gpu.bytes());
            done(self, band.as_ref());
        }
        let statistics = self.aa.statistics().ok_or(HostError::NoStatistics)?.clone();
        Ok(Shot { statistics, gbuffer_ms })
    }

    /// The bands of a frame with these settings; a single `None` if it is rendered as a whole.
    pub fn bands(&mut self, settings: &Settings) -> Result<Vec<Option<Band>>, HostError> {
        let Some(limit) = self.memory else { return Ok(vec![None]) };
        let shadows = casting(&self.scene, settings.shadows);
        let depth = self.depth(settings);
        let needs = Needs { shadows: &shadows, reflective: &self.reflective, depth, ..Default::default() };
        let size = (self.options.width, self.options.height);
        let bands = self.aa.resize_banded(&self.gpu.device, size, limit, settings, &needs)?;
        Ok(bands.into_iter().map(Some).collect())
    }

    /// Renders the scene into the node's G-buffer.
    fn raster(&self, encoder: &mut wgpu::CommandEncoder, camera: &deferred_aa::Camera, band: Option<&Band>) {
        self.raster_as(encoder, camera, band, true);
    }

    /// Renders the scene into the node's G-buffer, for a band in the viewport of the image where that is allowed and
    /// wanted, else with a cropped projection.
    pub fn raster_as(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        camera: &deferred_aa::Camera,
        band: Option<&Band>,
        by_viewport: bool,
    ) {
        if let Some(gbuffer) = self.aa.gbuffer() {
            let (queue, limits) = (&self.gpu.queue, self.gpu.device.limits());
            let viewport = band.filter(|_| by_viewport).and_then(|band| band.viewport(self.options.m, &limits));
            let cropped = band.filter(|_| viewport.is_none()).map(|band| band.crop() * camera.clip_from_view);
            let camera = deferred_aa::Camera { clip_from_view: cropped.unwrap_or(camera.clip_from_view), ..*camera };
            self.raster.record_in(queue, encoder, &self.scene, &self.uploaded, &camera, (gbuffer, viewport));
        }
    }

    /// The most bytes that the textures and buffers of the device took together after a frame or a band, as wgpu counts
    /// them.
    pub fn peak(&self) -> u64 {
        self.peak
    }

    /// [`frame`](Self::frame) that `record` records in place of [`DeferredAa::record`]: for graphs that order passes
    /// themselves.
    pub fn frame_by(
        &mut self,
        camera: &Camera,
        settings: Settings,
        record: impl FnOnce(&mut DeferredAa, &wgpu::Queue, &mut wgpu::CommandEncoder, &Frame<'_>) -> Result<(), RecordError>,
    ) -> Result<Statistics, HostError> {
        let camera = node_camera(camera, self.options.width, self.options.height);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.raster(&mut encoder, &camera, None);
        self.shade(encoder, (camera, None), settings, record)?;
        Ok(self.aa.statistics().ok_or(HostError::NoStatistics)?.clone())
    }

    /// [`frame`](Self::frame) over the last frame's G-buffer, which must be of the same camera: for many settings on
    /// one view.
    pub fn shade_again(&mut self, camera: &Camera, settings: Settings) -> Result<Shot, HostError> {
        if self.memory.is_some() {
            // The G-buffer may hold the last band alone.
            return self.frame(camera, settings);
        }
        let camera = node_camera(camera, self.options.width, self.options.height);
        Ok(Shot { gbuffer_ms: None, ..self.frame_of_bands(camera, settings, &[None], |_, _, _, _| (), |_, _| ())? })
    }

    /// Records the node over the image or a band of it, submits, waits.
    fn shade(
        &mut self,
        mut encoder: wgpu::CommandEncoder,
        (camera, band): (deferred_aa::Camera, Option<Band>),
        mut settings: Settings,
        record: impl FnOnce(&mut DeferredAa, &wgpu::Queue, &mut wgpu::CommandEncoder, &Frame<'_>) -> Result<(), RecordError>,
    ) -> Result<(), HostError> {
        settings.ray_bias = settings.ray_bias.max(self.gpu.least_ray_bias());
        self.shown = Some(camera);
        self.lit_for(&camera);
        let shadows = casting(&self.scene, settings.shadows);
        let traces = traces(&self.scene, &settings);
        if traces && !self.options.traces {
            return Err(HostError::NoRays);
        }
        let visible = matches!(self.options.gbuffer, GBufferTier::Visibility(_));
        if traces || visible {
            let rays = match &mut self.rays {
                Some(rays) if !traces || rays.scene.tier().is_some() => rays,
                none => {
                    let (device, queue) = (&self.gpu.device, &self.gpu.queue);
                    let tier = traces.then_some(self.options.rays);
                    let mut rays = Rays::new(device, queue, tier, visible, &self.scene)?;
                    if !shadows.is_empty() {
                        rays.notices.extend(enclosed::notices(&self.scene));
                    }
                    none.insert(rays)
                }
            };
            rays.update(&self.gpu.device, &self.gpu.queue, &mut encoder, camera.world_from_view.w_axis.truncate())?;
        }
        let rays = self.rays.as_ref().filter(|_| traces || visible).map(|r| &r.scene);
        let depth = self.depth(&settings);
        let blend = self.blend.as_ref().filter(|_| depth.is_some());
        let frame = Frame {
            needs: Needs {
                rays,
                shadows: &shadows,
                reflective: &self.reflective,
                textured: &self.textured,
                importance: &self.importance,
                depth,
            },
            settings,
            host_bind_group: Some(&self.host_bind_group),
            textures: Some(&self.uploaded.table),
            depth: blend.map(Blend::depth),
            band,
            statistics: true,
            ..Frame::new(camera, &self.target_view)
        };
        record(&mut self.aa, &self.gpu.queue, &mut encoder, &frame)?;
        if let Some(blend) = blend.filter(|_| band.is_none_or(|band| band.index + 1 == band.count)) {
            let scene = (&self.scene, &self.uploaded);
            let into = (&self.host_bind_group, &self.target_view);
            blend.record(&self.gpu.queue, &mut encoder, scene, &camera, into);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait();
        self.complaints()
    }

    /// Whether the pipelines of a frame with these settings are compiled.
    pub fn is_ready(&self, settings: Settings) -> bool {
        let shadows = casting(&self.scene, settings.shadows);
        self.aa.is_ready(&settings, &self.needs(&settings, &shadows))
    }

    /// What decides the passes of a frame.
    fn needs<'a>(&'a self, settings: &Settings, shadows: &'a [CastingLight]) -> Needs<'a> {
        let depth = self.depth(settings);
        Needs { shadows, reflective: &self.reflective, depth, ..Default::default() }
    }

    /// The depth that a frame also writes. Views of something else than the image are not drawn over.
    fn depth(&self, settings: &Settings) -> Option<Depth> {
        let blends = self.blend.is_some() && settings.view == DebugView::Image;
        blends.then_some(blend::DEPTH)
    }

    /// The passes of a frame with these settings.
    pub fn passes(&self, settings: &Settings) -> Vec<Pass> {
        let shadows = casting(&self.scene, settings.shadows);
        DeferredAa::passes(settings, &self.needs(settings, &shadows)).collect()
    }

    /// Changes the output size. The picture is lost.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), HostError> {
        if self.memory.is_none() {
            self.aa.resize(&self.gpu.device, width, height)?;
        }
        (self.target, self.target_view) = target(&self.gpu.device, width, height);
        if let Some(blend) = &mut self.blend {
            blend.resize(&self.gpu.device, width, height);
        }
        (self.options.width, self.options.height) = (width, height);
        self.complaints()
    }

    /// Runs the light loop this often from the next frame on, at least once.
    pub fn set_stall(&mut self, stall: u32) {
        self.options.stall = stall.max(1);
        self.lighting_values.stall = self.options.stall;
    }

    /// Lights the scene with this sun from the next frame on, or with none.
    pub fn set_sun(&mut self, sun: Option<Sun>) {
        self.scene.sun = sun;
        let (to_sun, irradiance) = sun.map_or((Vec3::Y, Vec3::ZERO), |s| (s.to_sun, s.irradiance));
        self.lighting_values.to_sun = to_sun.to_array();
        self.lighting_values.sun = irradiance.to_array();
    }

    /// Lights the scene with its first `count` lights only, from the next frame on.
    pub fn set_light_count(&mut self, count: u32) {
        self.lighting_values.light_count = count.min(self.uploaded.light_count);
    }

    /// The bind group of the host's WGSL, for a pass of another's that shades as `camera` sees it. Its layout is
    /// `host_layout`.
    pub(crate) fn lit_for(&mut self, camera: &deferred_aa::Camera) -> wgpu::BindGroup {
        self.lighting_values.camera = camera.world_from_view.w_axis.truncate().to_array();
        self.write_lighting();
        self.host_bind_group.clone()
    }

    fn write_lighting(&self) {
        self.gpu.queue.write_buffer(&self.lighting, 0, bytemuck::bytes_of(&self.lighting_values));
    }

    /// The target: linear HDR in [`TARGET_FORMAT`], the image of the last frame.
    pub fn target(&self) -> &wgpu::TextureView {
        &self.target_view
    }

    /// The target's content. Waits.
    pub fn picture(&self) -> Picture {
        let bytes = self.gpu.read_texture(&self.target, 8);
        let halves = bytes.as_chunks::<2>().0.iter().map(|&b| half::f16::from_le_bytes(b).to_f32());
        let rgba = halves.collect::<Vec<_>>().as_chunks::<4>().0.to_vec();
        Picture { width: self.options.width, height: self.options.height, rgba }
    }

    /// Pixels whose window holds two objects, materials or a crease: where aliasing lives. A crease is an angle between
    /// normals of more than 18°.
    pub fn edge_mask(&self) -> Vec<bool> {
        let surface = self.surfaces();
        if surface.is_empty() {
            return Vec::new();
        }
        let m = self.options.m as usize;
        let (width, height) = (self.options.width as usize, self.options.height as usize);
        let mut mask = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let sample = |i: usize| surface[(y * m + i / m) * width * m + x * m + i % m];
                let first = sample(0);
                let normal = octahedral(first[0]);
                mask.push((1..m * m).any(|i| {
                    let s = sample(i);
                    s[1] != first[1] || octahedral(s[0]).dot(normal) < 0.951
                }));
            }
        }
        mask
    }

    /// The surfaces of the last frame's G-buffer, rows from the top: normal (octahedral 16+16), material and object.
    /// Waits.
    pub fn surfaces(&self) -> Vec<[u32; 2]> {
        let Some(first) = self.aa.gbuffer().map(|gbuffer| gbuffer.color[0].texture()) else { return Vec::new() };
        let (GBufferTier::Visibility(ids), Some(camera)) = (self.options.gbuffer, &self.shown) else {
            return bytemuck::pod_collect_to_vec(&self.gpu.read_texture(first, 8));
        };
        let ids = match ids {
            Ids::Wide => bytemuck::pod_collect_to_vec(&self.gpu.read_texture(first, 8)),
            Ids::Narrow { triangle_bits } => {
                let words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.gpu.read_texture(first, 4));
                words.into_iter().map(|word| [word >> triangle_bits, word & ((1 << triangle_bits) - 1)]).collect()
            }
        };
        let width = (self.options.width * self.options.m) as usize;
        visible::surfaces(&self.scene, camera, &ids, &self.depths(), width)
    }

    /// The depth target of the last frame's G-buffer, rows from the top: reversed z, 0 is the sky. Waits.
    pub fn depths(&self) -> Vec<f32> {
        let read = |g: &GBuffer| self.gpu.read_texture(g.depth.texture(), 4);
        self.aa.gbuffer().map_or(Vec::new(), |g| bytemuck::pod_collect_to_vec(&read(g)))
    }

    /// k of each pixel in the last frame, whose technique is given; the number of lights with `Surfaces`.
    pub fn counts(&self, technique: Technique) -> Vec<u32> {
        self.counts_of(technique, [self.options.width, self.options.height])
    }

    fn counts_of(&self, technique: Technique, size: [u32; 2]) -> Vec<u32> {
        let uniform = |k| vec![k; (size[0] * size[1]) as usize];
        match (technique, self.aa.intermediates()) {
            (Technique::Full, _) => uniform(self.options.m * self.options.m),
            (Technique::Single, _) | (_, None) => uniform(1),
            (Technique::Surfaces, Some(passed)) => {
                let words = passed.surfaces.map_or(Vec::new(), |buffer| self.gpu.read_buffer(buffer));
                let words: Vec<SurfaceWord> = bytemuck::pod_collect_to_vec(&words);
                pixels(size).map(|(x, y)| words[passed.slots.pixel(x, y)].lights()).collect()
            }
            (_, Some(_)) => self.plan_of(size).into_iter().map(PlanWord::k).collect(),
        }
    }

    /// The last frame's plan, rows from the top: [`deferred_aa::Intermediates::plan`]. Waits.
    pub fn plan(&self) -> Vec<PlanWord> {
        self.plan_of([self.options.width, self.options.height])
    }

    fn plan_of(&self, size: [u32; 2]) -> Vec<PlanWord> {
        let Some(passed) = self.aa.intermediates() else { return Vec::new() };
        let plan: Vec<PlanWord> = bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(passed.plan));
        pixels(size).map(|(x, y)| plan[passed.slots.pixel(x, y)]).collect()
    }

    /// The rays that each sample of the last frame sent, which showed [`DebugView::Rays`]: pixel by pixel from the top,
    /// by rank. Empty where was traced. Waits.
    pub fn sent(&self, traced: [bool; 2]) -> Vec<Sent> {
        let Some(passed) = self.aa.intermediates().filter(|_| traced != [false; 2]) else { return Vec::new() };
        let read = |buffer: Option<&wgpu::Buffer>, is: bool| -> Vec<u32> {
            buffer.filter(|_| is).map_or(Vec::new(), |b| bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(b)))
        };
        let (shadows, reflections) = (read(passed.shadows, traced[0]), read(passed.reflections, traced[1]));
        let plan: Vec<PlanWord> = bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(passed.plan));
        let n = self.options.m * self.options.m;
        let (width, height) = (self.options.width, self.options.height);
        let mut sent = Vec::with_capacity((width * height * n) as usize);
        let [of_shadows, of_others] = passed.traced.counts();
        for (x, y) in pixels([width, height]) {
            sent.extend((0..n).map(|rank| {
                let Some(place) = passed.traced.place(&plan, x, y, rank) else { return Sent::default() };
                let shadow = shadows.get(of_shadows + place).copied().unwrap_or(0);
                let others = reflections.get(of_others + place).copied().unwrap_or(0);
                Sent { shadow: shadow as u8, mirrored: others as u8, refracted: (others >> 16) as u8 }
            }));
        }
        sent
    }

    /// [`counts`](Self::counts) of the last frame, which had these settings; its picture is gone then.
    pub fn sample_map(&mut self, camera: deferred_aa::Camera, settings: Settings) -> Result<Vec<u32>, HostError> {
        let lattices = settings.technique == Technique::MultiResolution && !settings.multi_resolution.supersampled;
        // Only a view writes down what was shaded.
        let views = lattices && settings.view == DebugView::Image;
        let settings = if views { Settings { view: DebugView::Levels, ..settings } } else { settings };
        let bands = self.bands(&settings)?;
        if views || bands.len() > 1 {
            let (width, height) = (self.options.width, self.options.height);
            let mut all = vec![0; (width * height) as usize];
            // The last frame's plan is that of its last band.
            self.frame_of_bands(camera, settings, &bands, Self::raster, |host, band| {
                let whole = Rect { x: 0, y: 0, width, height };
                let [output, raster] = band.map_or([whole; 2], |band| [band.output, band.raster]);
                let counts = host.counts_of(settings.technique, [raster.width, raster.height]);
                for (x, y) in (0..output.height).flat_map(|y| (0..output.width).map(move |x| (x, y))) {
                    let (left, top) = (output.x - raster.x + x, output.y - raster.y + y);
                    all[((output.y + y) * width + output.x + x) as usize] =
                        counts[(top * raster.width + left) as usize];
                }
            })?;
            return Ok(all);
        }
        Ok(self.counts(settings.technique))
    }

    fn complaints(&self) -> Result<(), HostError> {
        if let Some(why) = self.gpu.lost() {
            return Err(HostError::Lost(why));
        }
        self.gpu.complaint().map_or(Ok(()), |complaint| Err(HostError::Device(complaint)))
    }
}

/// Rays that a sample sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sent {
    /// Rays towards lights.
    pub shadow: u8,
    /// Rays that were reflected.
    pub mirrored: u8,
    /// Rays that were refracted.
    pub refracted: u8,
}

/// The materials that read a texture for more than their occlusion.
fn textured(scene: &Scene) -> Vec<u32> {
    let reads = |m: &Material| {
        let maps = [&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emissive_texture];
        maps.into_iter().any(Option::is_some)
    };
    (0..).zip(&scene.materials).filter(|(_, m)| reads(m)).map(|(i, _)| i).collect()
}

/// The unit vector of a 16+16-bit code of the G-buffer.
pub(crate) fn octahedral(code: u32) -> Vec3 {
    let snorm = |c: u32| (f32::from(c as u16 as i16) / 32767.0).max(-1.0);
    let (x, y) = (snorm(code), snorm(code >> 16));
    let z = 1.0 - x.abs() - y.abs();
    let fold = |a: f32, b: f32| if z >= 0.0 { a } else { (1.0 - b.abs()).copysign(a) };
    Vec3::new(fold(x, y), fold(y, x), z).normalize_or(Vec3::Z)
}

/// The pixels of an image, rows from the top.
fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}
