//! The node: knows the order of the frame's passes, and nobody else does.

use crate::audit::{self, Audit, Audited};
use crate::bounce::{self, Bounce};
use crate::effects::{self, CastingUniform, Needs, Traced};
use crate::error::{BuildError, RecordError, ShadingError, SizeError, TableError};
use crate::first::{self, First};
use crate::frame::{Frame, FrameUniform};
use crate::gbuffer::GBuffer;
use crate::goal::Controller;
use crate::list::{self, Lists};
use crate::listed::{self, Listed, Listing};
use crate::max_filter::{self, MaxFilter};
use crate::metrics::{self, Metrics};
use crate::pipeline::{self, Build, PassInfo};
use crate::plan::{self, Plan};
use crate::rays::RayTier;
use crate::reconstruct::{self, Reconstruct};
use crate::requirements::{self, Memory, Requirements};
use crate::resolve::{Resolve, Source};
use crate::scratch::{self, List, ListKind, Scratch};
use crate::settings::{DebugView, Execution, Goal, Settings, Technique};
use crate::shade::{self, Shade, Variant};
use crate::statistics::{Collector, MAX_PASSES, Recorded, Statistics};
use crate::table::{TableTexture, Tables, TextureTable, TextureTier};
use crate::trace::Trace;
use crate::traces::{Samples, Traces};
use crate::view::{self, View};
use crate::wgsl::{self, HostSource};
use crate::window::MAX_M;

/// The host's shading code.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a> {
    /// WGSL: `fn shade(s: DaaSample) -> vec4f`, or `fn material(s: DaaSample) -> DaaMaterial` and
    /// `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`, linear radiance and alpha. Optional
    /// `fn sky(s: DaaSample) -> vec4f` where there is no surface; without it the sky is transparent black. For rays, optional
    /// `fn bounce(s: DaaSample) -> DaaBounce`, what a surface reflects and refracts, and `fn solid(material: u32, uv: vec2f) ->
    /// bool`, where a masked mesh stops a ray. Its resources
    /// are bound at [`HOST_GROUP`](crate::HOST_GROUP). `shaders/contract.wgsl` has all that it may use.
    pub source: &'a str,
    /// What errors call it.
    pub file: &'a str,
}

/// What is fixed when a node is built.
#[derive(Debug, Clone, Copy)]
pub struct Descriptor<'a> {
    /// Samples along one side of a pixel's window, 1 to 8. Higher: better edges and textures; G-buffer memory and raster
    /// time grow with m².
    pub m: u32,
    /// Of the view that frames are written to: float (HDR, linear), unorm or sRGB (clamped to 1).
    pub target_format: wgpu::TextureFormat,
    /// The host's WGSL.
    pub shading: Shading<'a>,
    /// How `daa_texture` reaches textures.
    pub textures: TextureTier,
    /// Most textures of a table on [`TextureTier::Bindings`].
    pub texture_capacity: u32,
    /// Who traces rays, if any frame may ever ask for them.
    pub rays: Option<RayTier>,
}

impl<'a> Descriptor<'a> {
    /// m = 4, no textures, no rays.
    pub fn new(target_format: wgpu::TextureFormat, shading: Shading<'a>) -> Self {
        Self { m: 4, target_format, shading, textures: TextureTier::None, texture_capacity: 0, rays: None }
    }
}

/// Adaptive supersampling of a deferred frame: a node for a host's frame graph.
///
/// ```text
/// let mut aa = DeferredAa::new(&device, &descriptor, Some(&layout))?;
/// aa.resize(&device, width, height)?;
/// // each frame: render into aa.gbuffer(), then
/// aa.record(&queue, &mut encoder, &frame)?;
/// ```
///
/// It never submits and never waits. After [`resize`](Self::resize) and the first frame of a technique it allocates no
/// GPU resource.
#[derive(Debug)]
pub struct DeferredAa {
    build: Build,
    tables: Option<Tables>,
    first: First,
    metrics: Metrics,
    max_filter: MaxFilter,
    plan: Plan,
    lists: Lists,
    shade: Shade,
    listed: Listed,
    reconstruct: Reconstruct,
    resolve: Resolve,
    view: View,
    audit: Audit,
    tracer: Option<Tracer>,
    uniforms: wgpu::Buffer,
    sized: Option<Sized>,
    collector: Collector,
    controller: Controller,
    frame: u64,
}

/// What traces, in a node that may.
#[derive(Debug)]
struct Tracer {
    tier: RayTier,
    trace: Trace,
    bounce: Bounce,
    /// `DaaCasting`, a slot for each frame and each [`Samples`]; from the first frame that traces.
    lights: Option<wgpu::Buffer>,
    /// The materials that send rays, as they were last written; from the first frame that has some.
    bouncing: Option<(Vec<u32>, wgpu::Buffer)>,
}

/// What goes with a size.
#[derive(Debug)]
struct Sized {
    scratch: Scratch,
    /// By [`Traced::index`], each from the first frame that needs it.
    frames: [Option<wgpu::BindGroup>; Traced::COUNT],
    traced: Option<SizedTraces>,
    first: wgpu::BindGroup,
    metrics: wgpu::BindGroup,
    max_filter: wgpu::BindGroup,
    plan: wgpu::BindGroup,
    shade: wgpu::BindGroup,
    reconstruct: wgpu::BindGroup,
    resolve: wgpu::BindGroup,
    view: wgpu::BindGroup,
    audit: wgpu::BindGroup,
    /// By [`ListKind`], each from the first frame that needs it.
    lists: [Option<SizedList>; 2],
}

/// What rays find, and what binds it with the scene of a generation.
#[derive(Debug)]
struct SizedTraces {
    traces: Traces,
    bound: Option<BoundTraces>,
}

#[derive(Debug)]
struct BoundTraces {
    generation: u64,
    trace: Option<wgpu::BindGroup>,
    bounce: Option<wgpu::BindGroup>,
}

/// A list and what binds it.
#[derive(Debug)]
struct SizedList {
    list: List,
    fill: wgpu::BindGroup,
    shade: listed::Bound,
}

/// What the passes hand to each other. All can be copied from.
#[derive(Debug, Clone, Copy)]
pub struct Intermediates<'a> {
    /// S, `Rgba32Float`, w×h.
    pub first: &'a wgpu::Texture,
    /// The means of windows with k > 1, `Rgba32Float`, w×h; elsewhere what was there before.
    pub color: &'a wgpu::Texture,
    /// The plan of [`Technique::Windowed`]: a word for each pixel of each tile, k in bits 0 to 7, the deciding metric in
    /// bits 8 to 15 (0 nothing, 1 depth, 2 normal, 3 luminance, 4 identity), the samples of the tile before this window's
    /// in bits 16 to 31. See [`plan_index`](Self::plan_index).
    pub plan: &'a wgpu::Buffer,
    /// Tiles along x and y.
    pub tiles: [u32; 2],
    /// Slots of the plan by k, once [`Execution::Sorted`] or [`Execution::Bucketed`] ran; see `reference::list`.
    pub pixel_list: Option<&'a wgpu::Buffer>,
    /// The samples beyond the first, once [`Execution::Packed`] ran; see `reference::list`.
    pub sample_list: Option<&'a wgpu::Buffer>,
    /// The shadow bits of all samples, rank by rank in the order of the plan, once a frame traced; of those that were not
    /// traced what was there before.
    pub shadows: Option<&'a wgpu::Buffer>,
    /// What they reflect and refract, likewise: codes of shared_exponent.wgsl, 0 where nothing was traced.
    pub secondary: Option<&'a wgpu::Buffer>,
}

impl Intermediates<'_> {
    /// Where in the plan a pixel's word lies.
    pub fn plan_index(&self, x: u32, y: u32) -> usize {
        let tile = (y / crate::TILE) * self.tiles[0] + x / crate::TILE;
        (tile * crate::TILE * crate::TILE + (y % crate::TILE) * crate::TILE + x % crate::TILE) as usize
    }
}

/// A pass of the frame, in the order in which [`DeferredAa::passes`] yields it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pass {
    /// What it is called, reads and writes.
    pub info: PassInfo,
    step: Step,
    index: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Trace(Samples),
    Bounce(Samples),
    First,
    Metrics,
    MaxFilter,
    Plan,
    List(ListKind),
    Shade(Variant),
    Listed(Listing),
    Reconstruct,
    Resolve(Source),
    View { first: bool, planned: bool },
    Audit,
}

/// Uniform slots: as many frames may be recorded between two submits.
const UNIFORM_SLOTS: u64 = 16;
const UNIFORM_STRIDE: u64 = (size_of::<FrameUniform>() as u64).next_multiple_of(256);
const LIGHTS_STRIDE: u64 = (size_of::<CastingUniform>() as u64).next_multiple_of(256);

/// The frame, top to bottom.
fn order(settings: &Settings, traced: Traced) -> [Option<Step>; MAX_PASSES] {
    let planned = settings.technique == Technique::Windowed;
    let first = settings.technique != Technique::Full || settings.view == DebugView::First;
    let (shade, source) = match (settings.technique, settings.execution) {
        (Technique::Full, _) => (Some(Step::Shade(Variant::Full)), Source::Color),
        (Technique::Single, _) => (None, Source::First),
        (Technique::Windowed, execution) => (Some(execute(execution)), Source::ByPlan),
        (Technique::Reconstructed, _) => (Some(Step::Reconstruct), Source::Color),
    };
    let list = match shade {
        Some(Step::Listed(listing)) => Some(Step::List(listing.kind())),
        _ => None,
    };
    let filtered = planned && settings.execution == Execution::MaxFiltered;
    let audited = planned && matches!(settings.goal, Some(Goal::Error(_)));
    let trace = |samples, when| (when && traced.shadows).then_some(Step::Trace(samples));
    let bounce = |samples, when| (when && traced.secondary).then_some(Step::Bounce(samples));
    let before = if settings.technique == Technique::Full { Samples::Full } else { Samples::First };
    let reconstructs = settings.technique == Technique::Reconstructed;
    let beyond = if reconstructs { Samples::Geometric } else { Samples::Planned };
    [
        trace(before, true),
        bounce(before, true),
        first.then_some(Step::First),
        planned.then_some(Step::Metrics),
        filtered.then_some(Step::MaxFilter),
        planned.then_some(Step::Plan),
        trace(beyond, planned || reconstructs),
        bounce(beyond, planned || reconstructs),
        list,
        shade,
        Some(match settings.view {
            DebugView::Image => Step::Resolve(source),
            _ => Step::View { first, planned: planned || reconstructs },
        }),
        // Behind the image, which does not wait for it.
        trace(Samples::Audited, audited),
        bounce(Samples::Audited, audited),
        audited.then_some(Step::Audit),
    ]
}

fn execute(execution: Execution) -> Step {
    match execution {
        Execution::Loop | Execution::MaxFiltered => Step::Shade(Variant::Loop),
        Execution::Tiled => Step::Shade(Variant::Tiled),
        Execution::Bucketed => Step::Listed(Listing::Bucketed),
        Execution::Sorted => Step::Listed(Listing::Sorted),
        Execution::Packed => Step::Listed(Listing::Packed),
    }
}

impl Step {
    /// Whether the host's code runs in it.
    fn shades(self) -> bool {
        matches!(
            self,
            Self::Bounce(_) | Self::First | Self::Shade(_) | Self::Listed(_) | Self::Reconstruct | Self::Audit
        )
    }

    fn info(self, traced: Traced) -> PassInfo {
        let traced = traced.any();
        match self {
            Self::Trace(samples) => samples.info(),
            Self::Bounce(samples) => bounce::info(samples),
            Self::First if traced => first::INFO_TRACED,
            Self::First => first::INFO,
            Self::Metrics => metrics::INFO,
            Self::MaxFilter => max_filter::INFO,
            Self::Plan => plan::INFO,
            Self::List(_) => list::INFO,
            Self::Listed(_) if traced => listed::INFO_TRACED,
            Self::Listed(_) => listed::INFO,
            Self::Shade(Variant::Full) if traced => shade::INFO_FULL_TRACED,
            Self::Shade(Variant::Full) => shade::INFO_FULL,
            Self::Shade(_) if traced => shade::INFO_TRACED,
            Self::Shade(_) => shade::INFO,
            Self::Reconstruct if traced => reconstruct::INFO_TRACED,
            Self::Reconstruct => reconstruct::INFO,
            Self::Resolve(source) => source.info(),
            Self::View { first, planned } => view::info(first, planned),
            Self::Audit if traced => audit::INFO_TRACED,
            Self::Audit => audit::INFO,
        }
    }
}

impl DeferredAa {
    /// What a node with this descriptor needs of a device, and what this adapter can't give. Creates nothing.
    pub fn requirements(adapter: &wgpu::Adapter, descriptor: &Descriptor<'_>) -> Requirements {
        Requirements::of(adapter, descriptor)
    }

    /// Checks the host's WGSL and builds the node. `host_layout` is the layout of the host's bind group, `None` if its WGSL
    /// binds nothing. Pipelines are compiled when a frame first needs them; [`warm_up`](Self::warm_up) does it ahead.
    pub fn new(
        device: &wgpu::Device,
        descriptor: &Descriptor<'_>,
        host_layout: Option<&wgpu::BindGroupLayout>,
    ) -> Result<Self, BuildError> {
        if !(1..=MAX_M).contains(&descriptor.m) {
            return Err(BuildError::WindowSize(descriptor.m));
        }
        let missing = requirements::missing(device, descriptor);
        if !missing.is_empty() {
            return Err(BuildError::Missing(missing));
        }
        let float = matches!(
            descriptor.target_format.sample_type(None, Some(device.features())),
            Some(wgpu::TextureSampleType::Float { .. })
        );
        let usages = descriptor.target_format.guaranteed_format_features(device.features()).allowed_usages;
        if !float || !usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
            return Err(BuildError::TargetFormat(descriptor.target_format));
        }
        let Shading { source, file } = descriptor.shading;
        let host = HostSource::check(source, file, descriptor.textures, device.features())?;
        let tables = Tables::new(device, descriptor.textures, descriptor.texture_capacity);
        let build = Build {
            device: device.clone(),
            m: descriptor.m,
            host,
            target_format: descriptor.target_format,
            frame_layouts: Traced::ALL.map(|traced| frame_layout(device, traced)),
            table_layout: tables.as_ref().map(|t| t.layout.clone()),
            host_layout: host_layout.cloned(),
        };
        let aa = Self {
            tables,
            first: First::new(device),
            metrics: Metrics::new(device),
            max_filter: MaxFilter::new(device),
            plan: Plan::new(device),
            lists: Lists::new(device),
            shade: Shade::new(device),
            listed: Listed::new(device),
            reconstruct: Reconstruct::new(device),
            resolve: Resolve::new(device),
            view: View::new(device),
            audit: Audit::new(device),
            tracer: descriptor.rays.map(|tier| Tracer {
                tier,
                trace: Trace::new(device, tier),
                bounce: Bounce::new(device, tier),
                lights: None,
                bouncing: None,
            }),
            uniforms: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("daa frame"),
                size: UNIFORM_STRIDE * UNIFORM_SLOTS,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            sized: None,
            collector: Collector::new(device),
            controller: Controller::default(),
            frame: 0,
            build,
        };
        // A layout that does not fit the WGSL shows here, not in the first frame.
        aa.first.pipeline(&aa.build, Traced::default())?;
        Ok(aa)
    }

    /// Checks WGSL as [`new`](Self::new) does, without a device: for a host that reloads its shaders.
    pub fn check_shading(
        shading: Shading<'_>,
        textures: TextureTier,
        features: wgpu::Features,
    ) -> Result<(), ShadingError> {
        HostSource::check(shading.source, shading.file, textures, features).map(|_| ())
    }

    /// Samples along one side of a window.
    pub fn m(&self) -> u32 {
        self.build.m
    }

    /// Makes the G-buffer and all that goes with an output of `width` × `height` pixels. Nothing happens if it has that
    /// size; what was there before is kept if it fails.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) -> Result<(), SizeError> {
        let size = [width, height];
        if self.sized.as_ref().is_some_and(|s| s.scratch.size == size) {
            return Ok(());
        }
        let m = self.build.m;
        check_size(size, m, &device.limits())?;
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let scratch = Scratch::new(device, size, m);
        if let Some(e) = pipeline::ready(scope.pop()) {
            let bytes = scratch::gbuffer_bytes(size, m) + scratch::scratch_bytes(size);
            return Err(SizeError::OutOfMemory { width, height, m, bytes, message: e.to_string() });
        }
        self.sized = Some(Sized {
            frames: [
                Some(bind_frame(device, &self.build.frame_layouts[0], &self.uniforms, &scratch.gbuffer, [None, None])),
                None,
                None,
                None,
            ],
            traced: None,
            first: self.first.bind(device, &scratch),
            metrics: self.metrics.bind(device, &scratch),
            max_filter: self.max_filter.bind(device, &scratch),
            plan: self.plan.bind(device, &scratch),
            shade: self.shade.bind(device, &scratch),
            reconstruct: self.reconstruct.bind(device, &scratch),
            resolve: self.resolve.bind(device, &scratch),
            view: self.view.bind(device, &scratch),
            audit: self.audit.bind(device, &scratch),
            lists: [None, None],
            scratch,
        });
        Ok(())
    }

    /// The attachments to render the scene into. `None` before the first [`resize`](Self::resize).
    pub fn gbuffer(&self) -> Option<&GBuffer> {
        self.sized.as_ref().map(|s| &s.scratch.gbuffer)
    }

    /// What the passes hand to each other, for tools and tests. `None` before the first [`resize`](Self::resize).
    pub fn intermediates(&self) -> Option<Intermediates<'_>> {
        self.sized.as_ref().map(|s| Intermediates {
            first: s.scratch.first.texture(),
            color: s.scratch.color.texture(),
            plan: &s.scratch.plan,
            tiles: scratch::tiles(s.scratch.size),
            pixel_list: s.lists[ListKind::Pixels as usize].as_ref().map(|l| &l.list.list),
            sample_list: s.lists[ListKind::Samples as usize].as_ref().map(|l| &l.list.list),
            shadows: s.traced.as_ref().and_then(|t| t.traces.shadows.as_ref()),
            secondary: s.traced.as_ref().and_then(|t| t.traces.secondary.as_ref()),
        })
    }

    /// Bytes of GPU memory held for the present size.
    pub fn memory(&self) -> Memory {
        let size = self.sized.as_ref().map_or([0, 0], |s| s.scratch.size);
        Memory {
            gbuffer: scratch::gbuffer_bytes(size, self.build.m),
            scratch: if size == [0, 0] { 0 } else { scratch::scratch_bytes(size) + self.list_bytes(size) },
            rays: self.ray_bytes(),
        }
    }

    fn ray_bytes(&self) -> u64 {
        let traces = self.sized.as_ref().and_then(|s| s.traced.as_ref()).map_or(0, |t| t.traces.held());
        let Some(tracer) = &self.tracer else { return traces };
        let lights = tracer.lights.as_ref().map_or(0, wgpu::Buffer::size);
        traces + lights + tracer.bouncing.as_ref().map_or(0, |(_, buffer)| buffer.size())
    }

    fn list_bytes(&self, size: [u32; 2]) -> u64 {
        let made = |kind: ListKind| self.sized.as_ref().is_some_and(|s| s.lists[kind as usize].is_some());
        let kinds = [ListKind::Pixels, ListKind::Samples].into_iter().filter(|&kind| made(kind));
        kinds.flat_map(|kind| List::bytes(kind, size, self.build.m)).sum()
    }

    /// The layout of [`TextureTable::bind_group`], for the host's own pipelines, at `@group(1)`.
    pub fn texture_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        self.tables.as_ref().map(|t| &t.layout)
    }

    /// WGSL of `daa_texture` for the host's own pipelines: a directive that goes before all else, and the chunk.
    pub fn texture_wgsl(tier: TextureTier) -> (&'static str, &'static str) {
        (wgsl::directives(tier), wgsl::table_chunk(tier))
    }

    /// A table of the host's textures: `daa_texture(i, ..)` reads `textures[i]`. On [`TextureTier::Arrays`] the encoder
    /// receives copies, so submit it before the textures go. Make a new table when textures come or go.
    pub fn texture_table(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        textures: &[TableTexture<'_>],
    ) -> Result<TextureTable, TableError> {
        let tables = self.tables.as_ref().ok_or(TableError::NoTier)?;
        tables.table(&self.build.device, queue, encoder, textures)
    }

    /// Compiles what frames with these settings and needs want, so that none of them has to.
    pub fn warm_up(&self, settings: &Settings, needs: &Needs<'_>) -> Result<(), RecordError> {
        settings.validate()?;
        let traced = Traced::of(settings, needs);
        for step in order(settings, traced).into_iter().flatten() {
            match step {
                Step::Trace(_) => {
                    let tracer = self.tracer.as_ref().ok_or(RecordError::NoRays)?;
                    tracer.trace.pipeline(&self.build, tracer.tier)?;
                }
                Step::Bounce(_) => {
                    let tracer = self.tracer.as_ref().ok_or(RecordError::NoRays)?;
                    if !self.build.host.bounces {
                        return Err(RecordError::NoBounce);
                    }
                    tracer.bounce.pipeline(&self.build, tracer.tier)?;
                }
                Step::First => drop(self.first.pipeline(&self.build, traced)?),
                Step::Metrics => drop(self.metrics.pipeline(&self.build)?),
                Step::MaxFilter => drop(self.max_filter.pipeline(&self.build)?),
                Step::Plan => drop(self.plan.pipeline(&self.build)?),
                Step::List(kind) => self.lists.warm_up(&self.build, kind)?,
                Step::Listed(listing) => self.listed.warm_up(&self.build, listing, traced)?,
                Step::Shade(variant) => drop(self.shade.pipeline(&self.build, variant, traced)?),
                Step::Reconstruct => drop(self.reconstruct.pipeline(&self.build, traced)?),
                Step::Resolve(source) => drop(self.resolve.pipeline(&self.build, source)?),
                Step::View { .. } => drop(self.view.pipeline(&self.build)?),
                Step::Audit => drop(self.audit.pipeline(&self.build, traced)?),
            }
        }
        Ok(())
    }

    /// The passes that a frame with these settings and needs records, in order.
    pub fn passes(settings: &Settings, needs: &Needs<'_>) -> impl Iterator<Item = Pass> + use<> {
        let traced = Traced::of(settings, needs);
        let steps = order(settings, traced).into_iter().flatten();
        steps.enumerate().map(move |(index, step)| Pass { info: step.info(traced), step, index })
    }

    /// Records the frame: all its passes, and the copies of its statistics. Nothing is recorded if it fails. At most 16
    /// frames of one node may be recorded between two submits: the next would take the first one's constants.
    pub fn record(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RecordError> {
        let recording = self.begin(queue, encoder, frame)?;
        for pass in Self::passes(&frame.settings, &frame.needs) {
            recording.record(encoder, pass);
        }
        recording.finish(queue, encoder);
        Ok(())
    }

    /// Begins a frame whose passes the host records itself, between its own or under its own profiler: each of
    /// [`passes`](Self::passes) once, in their order, then [`Recording::finish`].
    pub fn begin<'a>(
        &'a mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &'a Frame<'a>,
    ) -> Result<Recording<'a>, RecordError> {
        frame.settings.validate()?;
        let sized = self.sized.as_ref().ok_or(RecordError::NoSize)?;
        let [width, height] = sized.scratch.size;
        let target = frame.target.texture();
        let (target_width, target_height) = (target.width(), target.height());
        // Views of other mips are the host's affair: only a texture that can't hold the image is refused.
        if target.mip_level_count() == 1 && (target_width, target_height) != (width, height) {
            return Err(RecordError::TargetSize { target_width, target_height, width, height });
        }
        let node = self.build.target_format;
        if target.format().remove_srgb_suffix() != node.remove_srgb_suffix() {
            return Err(RecordError::TargetFormat { target: target.format(), node });
        }
        if !target.usage().contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
            return Err(RecordError::TargetUsage);
        }
        if self.build.host_layout.is_some() && frame.host_bind_group.is_none() {
            return Err(RecordError::HostBindGroup);
        }
        if self.tables.is_some() && frame.textures.is_none() {
            return Err(RecordError::Textures);
        }
        let size = sized.scratch.size;
        let mut audited = Audited::of(self.frame + 1, size);
        self.collector.poll(&mut self.controller);
        self.controller.follow(&frame.settings, size);
        let effort = self.controller.effort();
        let mut settings = frame.settings;
        if let Some(effort) = effort {
            audited.step = self.controller.step();
            audited.least_below = settings.windowed.at_effort(effort - audited.step, self.build.m).least_samples;
            settings.windowed = settings.windowed.at_effort(effort, self.build.m);
        }
        let uniform = FrameUniform::new(&Frame { settings, ..*frame }, size, self.build.m, audited)?;
        let lights = self.casting(frame, uniform.camera_position.into())?;
        self.warm_up(&frame.settings, &frame.needs)?;
        self.make_list(&frame.settings)?;
        self.make_traces(queue, frame)?;
        let sized = self.sized.as_ref().ok_or(RecordError::NoSize)?;

        self.frame += 1;
        let offset = self.frame % UNIFORM_SLOTS * UNIFORM_STRIDE;
        queue.write_buffer(&self.uniforms, offset, bytemuck::bytes_of(&uniform));
        let lights_offset = self.frame % UNIFORM_SLOTS * Samples::COUNT * LIGHTS_STRIDE;
        let buffer = self.tracer.as_ref().and_then(|t| t.lights.as_ref());
        encoder.clear_buffer(&sized.scratch.statistics, 0, None);
        let mut recorded = Recorded::new(self.frame, frame.settings.technique, size, self.build.m);
        recorded.effort = effort;
        for pass in Self::passes(&frame.settings, &frame.needs) {
            recorded.push(pass.info.name);
            if let (Step::Trace(samples) | Step::Bounce(samples), Some(lights), Some(buffer)) =
                (pass.step, lights, buffer)
            {
                let uniform = CastingUniform { samples: samples as u32, ..lights };
                let offset = lights_offset + samples as u64 * LIGHTS_STRIDE;
                queue.write_buffer(buffer, offset, bytemuck::bytes_of(&uniform));
            }
            recorded.audited = recorded.audited.or((pass.step == Step::Audit).then_some(audited));
        }
        let collects = frame.statistics || effort.is_some();
        let traced = Traced::of(&frame.settings, &frame.needs);
        let offsets = [offset as u32, lights_offset as u32];
        Ok(Recording { aa: self, frame, offsets, traced, recorded, audited, collects })
    }

    /// The lights, if the frame traces; checks what it needs for that.
    fn casting(&self, frame: &Frame<'_>, camera: glam::Vec3) -> Result<Option<CastingUniform>, RecordError> {
        let traced = Traced::of(&frame.settings, &frame.needs);
        if !traced.any() {
            return Ok(None);
        }
        let node = self.tracer.as_ref().ok_or(RecordError::NoRays)?.tier;
        let scene = frame.needs.rays.ok_or(RecordError::NoRayScene)?;
        if scene.tier() != node {
            return Err(RecordError::RayTier { scene: scene.tier(), node });
        }
        if scene.camera() != camera {
            return Err(RecordError::RayCamera { scene: scene.camera(), camera });
        }
        CastingUniform::new(if traced.shadows { frame.needs.shadows } else { &[] }, camera).map(Some)
    }

    /// Makes what rays find room in, in the first frame that traces, and binds the frame's scene.
    fn make_traces(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>) -> Result<(), RecordError> {
        let traced = Traced::of(&frame.settings, &frame.needs);
        let (Some(tracer), Some(sized), Some(scene)) = (&mut self.tracer, &mut self.sized, frame.needs.rays) else {
            return Ok(());
        };
        if !traced.any() {
            return Ok(());
        }
        let (device, m, size) = (&self.build.device, self.build.m, sized.scratch.size);
        let lights = tracer.lights.get_or_insert_with(|| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("daa casting lights"),
                size: LIGHTS_STRIDE * UNIFORM_SLOTS * Samples::COUNT,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        let bytes = Traces::bytes(size, m);
        let refused = |why| Err(RecordError::Traces { width: size[0], height: size[1], m, bytes, why });
        let limits = device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > limit {
            return refused(format!("the device binds {limit}"));
        }
        let made = sized.traced.get_or_insert_with(|| SizedTraces {
            traces: Traces { lights: lights.clone(), shadows: None, secondary: None },
            bound: None,
        });
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let added = made.traces.make(device, size, m, traced);
        if let Some(e) = pipeline::ready(scope.pop()) {
            sized.traced = None;
            return refused(e.to_string());
        }
        let bouncing = match &mut tracer.bouncing {
            Some((written, buffer)) => {
                let words = effects::bouncing(frame.needs.bounces);
                if *written != words {
                    queue.write_buffer(buffer, 0, bytemuck::cast_slice(&words));
                    *written = words;
                }
                Some(&*buffer)
            }
            none if traced.secondary => {
                let words = effects::bouncing(frame.needs.bounces);
                let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("daa bouncing materials"),
                    size: effects::BOUNCING_BYTES,
                    usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                });
                queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
                Some(&none.insert((words, buffer)).1)
            }
            _ => None,
        };
        if added || made.bound.as_ref().is_none_or(|bound| bound.generation != scene.generation()) {
            made.bound = Some(BoundTraces {
                generation: scene.generation(),
                trace: tracer.trace.bind(device, &sized.scratch, &made.traces, scene),
                bounce: bouncing.and_then(|b| tracer.bounce.bind(device, &sized.scratch, &made.traces, scene, b)),
            });
        }
        let layout = &self.build.frame_layouts[traced.index()];
        let (uniforms, gbuffer) = (&self.uniforms, &sized.scratch.gbuffer);
        sized.frames[traced.index()].get_or_insert_with(|| {
            let shadows = made.traces.shadows.as_ref().filter(|_| traced.shadows);
            let secondary = made.traces.secondary.as_ref().filter(|_| traced.secondary);
            bind_frame(device, layout, uniforms, gbuffer, [shadows, secondary])
        });
        Ok(())
    }

    /// Makes the list of an execution that has one, in the first frame that asks for it.
    fn make_list(&mut self, settings: &Settings) -> Result<(), RecordError> {
        let kind = order(settings, Traced::default()).into_iter().flatten().find_map(|step| match step {
            Step::List(kind) => Some(kind),
            _ => None,
        });
        let (Some(kind), Some(sized)) = (kind, &mut self.sized) else { return Ok(()) };
        if sized.lists[kind as usize].is_some() {
            return Ok(());
        }
        let (device, m, size) = (&self.build.device, self.build.m, sized.scratch.size);
        let bytes = List::bytes(kind, size, m);
        let largest = bytes.into_iter().max().unwrap_or(0);
        let refused = |bytes, why| {
            let execution = settings.execution;
            Err(RecordError::List { execution, width: size[0], height: size[1], m, bytes, why })
        };
        let limits = device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if largest > limit {
            return refused(largest, format!("the device binds {limit}"));
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let list = List::new(device, kind, size, m);
        if let Some(e) = pipeline::ready(scope.pop()) {
            return refused(bytes.iter().sum(), e.to_string());
        }
        sized.lists[kind as usize] = Some(SizedList {
            fill: self.lists.bind(device, &sized.scratch, &list),
            shade: self.listed.bind(device, &sized.scratch, &list),
            list,
        });
        Ok(())
    }

    /// What the newest frame did whose counters have arrived, some frames after it was submitted with
    /// [`Frame::statistics`]. Never waits; the host's `submit` or `poll` moves it on.
    pub fn statistics(&mut self) -> Option<&Statistics> {
        self.collector.poll(&mut self.controller);
        self.collector.latest()
    }
}

/// A frame under way. Dropped without [`finish`](Self::finish), it has no statistics.
#[derive(Debug)]
pub struct Recording<'a> {
    aa: &'a mut DeferredAa,
    frame: &'a Frame<'a>,
    /// Into the frame's constants and lights.
    offsets: [u32; 2],
    traced: Traced,
    recorded: Recorded,
    audited: Audited,
    /// Statistics are asked for, or the goal needs them.
    collects: bool,
}

impl Recording<'_> {
    /// Records one pass.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, pass: Pass) {
        let aa = &*self.aa;
        let Some(sized) = &aa.sized else { return };
        let Some(frame) = &sized.frames[0] else { return };
        let timestamps = aa.collector.timestamps(pass.index).filter(|_| self.collects);
        // `begin` has compiled them all.
        match pass.step {
            Step::Resolve(source) => {
                let pipeline = aa.resolve.pipeline(&aa.build, source).ok();
                self.fullscreen(encoder, pass, pipeline, (frame, &sized.resolve), timestamps);
            }
            Step::View { .. } => {
                let pipeline = aa.view.pipeline(&aa.build).ok();
                self.fullscreen(encoder, pass, pipeline, (frame, &sized.view), timestamps);
            }
            _ => self.compute(encoder, pass, sized, timestamps),
        }
    }

    fn compute(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        sized: &Sized,
        timestamps: Option<(&wgpu::QuerySet, u32, u32)>,
    ) {
        let aa = &*self.aa;
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.info.name),
            timestamp_writes: timestamps.map(|(query_set, begin, end)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }),
        });
        // Only those who shade the frame's samples read what was traced.
        let traces = matches!(pass.step, Step::Trace(_) | Step::Bounce(_));
        let traced = if pass.step.shades() && !traces { self.traced } else { Traced::default() };
        compute.set_bind_group(0, &sized.frames[traced.index()], &[self.offsets[0]]);
        if pass.step.shades() || (matches!(pass.step, Step::Trace(_)) && aa.build.host.solid) {
            if let Some(table) = self.frame.textures.filter(|_| aa.tables.is_some()) {
                compute.set_bind_group(1, &table.bind_group, &[]);
            }
            if aa.build.host_layout.is_some() {
                compute.set_bind_group(crate::HOST_GROUP, self.frame.host_bind_group, &[]);
            }
        }
        let tiles = scratch::tiles(sized.scratch.size);
        let (pipeline, own, [x, y]) = match pass.step {
            Step::Trace(samples) | Step::Bounce(samples) => {
                let Some(tracer) = &aa.tracer else { return };
                let Some(bound) = sized.traced.as_ref().and_then(|t| t.bound.as_ref()) else { return };
                let (pipeline, group) = match pass.step {
                    Step::Bounce(_) => (tracer.bounce.pipeline(&aa.build, tracer.tier), &bound.bounce),
                    _ => (tracer.trace.pipeline(&aa.build, tracer.tier), &bound.trace),
                };
                let (Ok(pipeline), Some(group)) = (pipeline, group) else { return };
                let [x, y] = match samples {
                    Samples::Audited => Audit::groups(self.audited, sized.scratch.size),
                    _ => tiles,
                };
                compute.set_pipeline(pipeline);
                compute.set_bind_group(3, group, &[self.offsets[1] + samples as u32 * LIGHTS_STRIDE as u32]);
                return compute.dispatch_workgroups(x, y, 1);
            }
            Step::First => (aa.first.pipeline(&aa.build, traced), &sized.first, tiles),
            Step::Metrics => (aa.metrics.pipeline(&aa.build), &sized.metrics, tiles),
            Step::MaxFilter => {
                let groups = sized.scratch.size.map(|side| side.div_ceil(max_filter::REACH));
                (aa.max_filter.pipeline(&aa.build), &sized.max_filter, groups)
            }
            // A workgroup plans 64 tiles.
            Step::Plan => (aa.plan.pipeline(&aa.build), &sized.plan, [(tiles[0] * tiles[1]).div_ceil(64), 1]),
            Step::Shade(variant) => (aa.shade.pipeline(&aa.build, variant, traced), &sized.shade, tiles),
            Step::Reconstruct => (aa.reconstruct.pipeline(&aa.build, traced), &sized.reconstruct, tiles),
            Step::Audit => {
                let groups = Audit::groups(self.audited, sized.scratch.size);
                (aa.audit.pipeline(&aa.build, traced), &sized.audit, groups)
            }
            Step::List(kind) => {
                let Some(made) = &sized.lists[kind as usize] else { return };
                compute.set_bind_group(3, &made.fill, &[]);
                return aa.lists.dispatch(&mut compute, &aa.build, kind, sized.scratch.size);
            }
            Step::Listed(listing) => {
                let Some(made) = &sized.lists[listing.kind() as usize] else { return };
                let size = sized.scratch.size;
                return aa.listed.dispatch(&mut compute, &aa.build, (listing, traced), &made.list, &made.shade, size);
            }
            Step::Resolve(_) | Step::View { .. } => return,
        };
        let Ok(pipeline) = pipeline else { return };
        compute.set_pipeline(pipeline);
        compute.set_bind_group(3, own, &[]);
        compute.dispatch_workgroups(x, y, 1);
    }

    fn fullscreen(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        pipeline: Option<&wgpu::RenderPipeline>,
        (frame, own): (&wgpu::BindGroup, &wgpu::BindGroup),
        timestamps: Option<(&wgpu::QuerySet, u32, u32)>,
    ) {
        let Some(pipeline) = pipeline else { return };
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass.info.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.frame.target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: timestamps.map(|(query_set, begin, end)| wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        render.set_pipeline(pipeline);
        render.set_bind_group(0, frame, &[self.offsets[0]]);
        render.set_bind_group(3, own, &[]);
        render.draw(0..3, 0..1);
    }

    /// Ends the frame: its statistics are on their way if [`Frame::statistics`] asks for them.
    pub fn finish(self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder) {
        if let (true, Some(sized)) = (self.collects, &self.aa.sized) {
            let (counters, audits) = (&sized.scratch.statistics, &self.aa.audit.errors);
            self.aa.collector.collect(queue, encoder, counters, audits, self.recorded);
        }
    }
}

fn check_size(size: [u32; 2], m: u32, limits: &wgpu::Limits) -> Result<(), SizeError> {
    let [width, height] = size;
    if width == 0 || height == 0 {
        return Err(SizeError::Empty { width, height });
    }
    let limit = limits.max_texture_dimension_2d;
    if size.iter().any(|side| side.checked_mul(m).is_none_or(|samples| samples > limit)) {
        return Err(SizeError::TooLarge { width, height, m, limit });
    }
    let (bytes, limit) =
        (scratch::plan_bytes(size), limits.max_storage_buffer_binding_size.min(limits.max_buffer_size));
    if bytes > limit {
        return Err(SizeError::Buffer { width, height, bytes, limit });
    }
    Ok(())
}

fn frame_layout(device: &wgpu::Device, traced: Traced) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT;
    let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    };
    let mut entries = vec![
        wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: wgpu::BufferSize::new(size_of::<FrameUniform>() as u64),
            },
            count: None,
        },
        texture(1, wgpu::TextureSampleType::Depth),
        texture(2, wgpu::TextureSampleType::Uint),
        texture(3, wgpu::TextureSampleType::Uint),
        texture(4, wgpu::TextureSampleType::Uint),
    ];
    for (binding, has) in [(5, traced.shadows), (6, traced.secondary)] {
        if has {
            entries.push(pipeline::entry::buffer(binding, wgpu::ShaderStages::COMPUTE, true));
        }
    }
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("daa frame"), entries: &entries })
}

fn bind_frame(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniforms: &wgpu::Buffer,
    gbuffer: &GBuffer,
    traced: [Option<&wgpu::Buffer>; 2],
) -> wgpu::BindGroup {
    let view = |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
    let mut entries = vec![
        wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: uniforms,
                offset: 0,
                size: wgpu::BufferSize::new(size_of::<FrameUniform>() as u64),
            }),
        },
        view(1, &gbuffer.depth),
        view(2, &gbuffer.color[0]),
        view(3, &gbuffer.color[1]),
        view(4, &gbuffer.color[2]),
    ];
    for (binding, buffer) in (5..).zip(traced) {
        entries.extend(buffer.map(|b| wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() }));
    }
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("daa frame"), layout, entries: &entries })
}
