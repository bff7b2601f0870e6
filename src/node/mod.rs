//! The node: knows the order of the frame's passes, and nobody else does.

mod order;
mod pipelines;
mod recording;
mod sized;

use crate::audit::Audited;
use crate::check::{self, Check, InputMistake, InputReport};
use crate::effects::{CastingUniform, Needs, Traced};
use crate::error::{BuildError, LendError, RecordError, ShadingError, SizeError, TableError};
use crate::frame::{Frame, FrameUniform};
use crate::gbuffer::GBuffer;
use crate::goal::Controller;
use crate::lattice::{Place, StepUniform, Steps, Use};
use crate::loans::{Lent, Loans};
use crate::pipeline::{self, Build, PassInfo, Resource};
use crate::rays::RayTier;
use crate::requirements::{self, Memory, Requirements};
use crate::resources::{Part, PartInfo, Shape};
use crate::scratch::{self, List, ListKind, Scratch};
use crate::select::Marks;
use crate::settings::{Pattern, Settings, Technique};
use crate::shader::{Shader, Shaders};
use crate::statistics::{Collector, Recorded, Statistics};
use crate::table::{TableTexture, Tables, TextureTable, TextureTier};
use crate::traces::{Kept, Samples};
use crate::wgsl::{self, HostSource};
use crate::window::MAX_M;
use order::{Step, order};
use pipelines::Pipelines;
use sized::{RayBuffers, Sized, binding_limit, check_size, frame_layout};
use std::sync::Arc;

pub use order::Pass;
pub use recording::Recording;

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
    pipelines: Arc<Pipelines>,
    tables: Option<Tables>,
    uniforms: wgpu::Buffer,
    rays: Option<RayBuffers>,
    marks: Option<Marks>,
    /// `DaaStep`, a slot for each frame and step, from the first frame that refines lattices.
    steps: Option<wgpu::Buffer>,
    sized: Option<Sized>,
    collector: Collector,
    /// From the first check.
    check: Option<Check>,
    controller: Controller,
    frame: u64,
}

/// What the passes hand to each other. All can be copied from.
#[derive(Debug, Clone, Copy)]
pub struct Intermediates<'a> {
    /// S, `Rgba32Float`, w×h.
    pub first: &'a wgpu::Texture,
    /// The means of windows with k > 1, `Rgba32Float`, w×h; elsewhere what was there before.
    pub color: &'a wgpu::Texture,
    /// The plan of [`Technique::Windowed`](crate::Technique::Windowed): a word for each pixel of each tile, k in bits 0 to 7, the deciding metric in
    /// bits 8 to 15 (0 nothing, 1 depth, 2 normal, 3 luminance, 4 identity), the samples of the tile before this window's
    /// in bits 16 to 31. See [`plan_index`](Self::plan_index). Of [`Technique::Selective`]: k likewise, what the threshold of the
    /// first active quadrant is for in bits 8 to 15 (0: none is active, else as in [`Statistics::quadrants`], from 1), active
    /// quadrants in bits 16 to 19, as [`window::quadrants`](crate::window::quadrants) has them.
    pub plan: &'a wgpu::Buffer,
    /// Tiles along x and y.
    pub tiles: [u32; 2],
    /// Slots of the plan by k, once [`Execution::Sorted`](crate::Execution::Sorted) or
    /// [`Execution::Bucketed`](crate::Execution::Bucketed) ran; see `reference::list`.
    pub pixel_list: Option<&'a wgpu::Buffer>,
    /// The samples beyond the first, once [`Execution::Packed`](crate::Execution::Packed) ran; see `reference::list`.
    pub sample_list: Option<&'a wgpu::Buffer>,
    /// The shadow bits of all samples, rank by rank in the order of the plan, once a frame traced; of those that were not
    /// traced what was there before. Behind them, once a frame showed [`DebugView::Rays`](crate::DebugView::Rays), how many rays
    /// each sample sent, likewise.
    pub shadows: Option<&'a wgpu::Buffer>,
    /// The tiles in which rays were wanted, once a frame traced: `DaaTileLists` of classify.wgsl, two classes of four words, of
    /// which the first counts, then the tiles of either, then a word for each tile, bit 0 with a surface, bit 1 with one that sends
    /// rays.
    pub tile_lists: Option<&'a wgpu::Buffer>,
    /// What they reflect and refract, likewise: codes of shared_exponent.wgsl, 0 where nothing was traced. Behind them, once
    /// [`Technique::Selective`] ran, what the rays of first samples met: `daa_secondary_hit` of secondary.wgsl, word by word.
    /// From word 6 behind the codes, counted in ranks, once a frame showed [`DebugView::Rays`](crate::DebugView::Rays), the rays that each
    /// sample sent: mirrored ones, and refracted ones · 2¹⁶.
    pub secondary: Option<&'a wgpu::Buffer>,
    /// The words of the points of all lattices, once [`Technique::MultiResolution`] ran: `daa_point_word` of lattice.wgsl; see
    /// `reference::multi_resolution`. And the colours of those that are shaded.
    pub lattices: Option<[&'a wgpu::Buffer; 2]>,
}

impl Intermediates<'_> {
    /// Where in the plan a pixel's word lies.
    pub fn plan_index(&self, x: u32, y: u32) -> usize {
        let tile = (y / crate::TILE) * self.tiles[0] + x / crate::TILE;
        (tile * crate::TILE * crate::TILE + (y % crate::TILE) * crate::TILE + x % crate::TILE) as usize
    }
}

/// Uniform slots: as many frames may be recorded between two submits.
const UNIFORM_SLOTS: u64 = 16;
const UNIFORM_STRIDE: u64 = (size_of::<FrameUniform>() as u64).next_multiple_of(256);
const STEP_STRIDE: u64 = (size_of::<StepUniform>() as u64).next_multiple_of(256);
const STEPS: u64 = 2 * Place::COUNT as u64;
const LIGHTS_STRIDE: u64 = (size_of::<CastingUniform>() as u64).next_multiple_of(256);

/// Of a frame's steps.
fn step_slot(of: Use, place: Place) -> u64 {
    of as u64 * Place::COUNT as u64 + place as u64
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
            shaders: Shaders::default(),
        };
        let aa = Self {
            tables,
            uniforms: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("daa frame"),
                // The last one is the check's.
                size: UNIFORM_STRIDE * (UNIFORM_SLOTS + 1),
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            rays: None,
            marks: None,
            steps: None,
            sized: None,
            collector: Collector::new(device),
            check: None,
            controller: Controller::default(),
            frame: 0,
            pipelines: Arc::new(Pipelines::new(build, descriptor.rays)),
        };
        // A layout that does not fit the WGSL shows here, not in the first frame.
        aa.pipelines.first.pipeline(&aa.pipelines.build, Traced::default())?;
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
        self.build().m
    }

    fn build(&self) -> &Build {
        &self.pipelines.build
    }

    /// Makes the G-buffer and all that goes with an output of `width` × `height` pixels. Nothing happens if it has that
    /// size; what was there before is kept if it fails.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) -> Result<(), SizeError> {
        let size = [width, height];
        if self.sized.as_ref().is_some_and(|s| s.scratch.size == size) {
            return Ok(());
        }
        let m = self.build().m;
        check_size(size, m, &device.limits())?;
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let loans = Loans::default();
        let scratch = Scratch::new(device, size, m, &loans, None);
        if let Some(e) = pipeline::ready(scope.pop()) {
            let bytes = scratch::gbuffer_bytes(size, m) + scratch::scratch_bytes(size);
            return Err(SizeError::OutOfMemory { width, height, m, bytes, message: e.to_string() });
        }
        self.sized = Some(Sized::new(&self.pipelines, &self.uniforms, scratch, loans));
        Ok(())
    }

    /// The parts of all that a frame with these settings and needs reads and writes, at the present size, but for what the host
    /// binds itself ([`Resource::Host`](crate::Resource::Host), [`Resource::Rays`](crate::Resource::Rays)). Empty before the
    /// first [`resize`](Self::resize).
    pub fn parts(&self, settings: &Settings, needs: &Needs<'_>) -> Vec<PartInfo> {
        let Some(sized) = &self.sized else { return Vec::new() };
        let shape = self.shape(sized.scratch.size, settings, Traced::of(settings, needs));
        let mut used = Vec::new();
        let mut list = None;
        for pass in Self::passes(settings, needs) {
            used.extend(pass.info.reads.iter().chain(pass.info.writes).copied());
            if let Step::List(kind) = pass.step {
                list = Some(kind);
            }
        }
        let in_list = |part| list.is_some_and(|kind| Part::of_list(kind).contains(&part));
        let in_frame = |part: &Part| match part.resource() {
            Resource::List => in_list(*part),
            resource => used.contains(&resource),
        };
        let info = |part: Part| {
            let kind = part.kind(&shape)?;
            Some(PartInfo { part, resource: part.resource(), kind, lifetime: part.lifetime() })
        };
        Part::ALL.into_iter().filter(in_frame).filter_map(info).collect()
    }

    fn shape<'a>(&self, size: [u32; 2], settings: &'a Settings, traced: Traced) -> Shape<'a> {
        let build = self.build();
        Shape { size, m: build.m, target_format: build.target_format, settings, traced }
    }

    /// Lends the node memory for some of its [parts](Self::parts), in place of its own, which it drops. For a host whose graph
    /// gives the same memory to resources that do not live at the same time. It replaces all that was lent before: an empty slice
    /// takes all back. Not for a steady frame, as it binds everything anew. What was in the parts is lost, but for attachments of the
    /// G-buffer that are neither lent now nor were before. [`resize`](Self::resize) to another size ends it.
    ///
    /// The host sees to it that no two parts that share memory live at once ([`PartInfo::lifetime`]); no error tells it if they
    /// do. Lists, lattices and rays are made when a frame first needs them: what is lent for them is taken then.
    pub fn lend(&mut self, device: &wgpu::Device, lent: &[Lent<'_>]) -> Result<(), LendError> {
        let sized = self.sized.as_ref().ok_or(LendError::NoSize)?;
        let size = sized.scratch.size;
        let traced = Traced { shadows: true, secondary: true };
        let settings = Settings::default();
        let loans = Loans::new(lent, &self.shape(size, &settings, traced), binding_limit(device))?;
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let binding = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let scratch = Scratch::new(device, size, self.build().m, &loans, Some((&sized.scratch, &sized.loans)));
        let bound = Sized::new(&self.pipelines, &self.uniforms, scratch, loans);
        let refused = [pipeline::ready(binding.pop()), pipeline::ready(memory.pop())];
        if let Some(e) = refused.into_iter().flatten().next() {
            return Err(LendError::Refused(pipeline::one_line(&e)));
        }
        self.sized = Some(bound);
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
            tile_lists: s.traced.as_ref().map(|t| &t.traces.tiles),
            secondary: s.traced.as_ref().and_then(|t| t.traces.secondary.as_ref()),
            lattices: s.lattices.as_ref().map(|l| [&l.lattices.points, &l.lattices.colors]),
        })
    }

    /// Bytes of GPU memory held for the present size, without what is lent.
    pub fn memory(&self) -> Memory {
        let rays = self.rays.as_ref().map_or(0, RayBuffers::held);
        let Some(sized) = &self.sized else { return Memory { gbuffer: 0, scratch: 0, rays } };
        let (size, m, loans) = (sized.scratch.size, self.build().m, &sized.loans);
        let all = Settings::default();
        let shape = self.shape(size, &all, Traced::default());
        let own = |part: Part| loans.own(part, part.kind(&shape).map_or(0, |kind| kind.bytes()));
        let fixed = [Part::First, Part::Color, Part::Counts, Part::Plan, Part::Counters].map(own);
        let marks = if self.marks.is_some() { Marks::BYTES } else { 0 };
        let lattices = sized.lattices.as_ref().map_or(0, |l| l.lattices.held(loans));
        let made =
            [ListKind::Pixels, ListKind::Samples].into_iter().filter(|&kind| sized.lists[kind as usize].is_some());
        let lists = made.flat_map(|kind| Part::of_list(kind).iter().zip(List::bytes(kind, size, m)));
        let lists = lists.map(|(&part, bytes)| loans.own(part, bytes)).sum::<u64>();
        Memory {
            gbuffer: Part::GBUFFER.map(own).iter().sum(),
            scratch: fixed.iter().sum::<u64>() + marks + lattices + lists,
            rays: rays + sized.traced.as_ref().map_or(0, |t| t.traces.held(loans)),
        }
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
        tables.table(&self.build().device, queue, encoder, textures)
    }

    /// Compiles what frames with these settings and needs want, so that none of them has to. Called with the most that any
    /// frame may need, none that needs less waits either: its own pipelines are compiled on a thread, and until they are there
    /// those of the most serve, to the same image.
    pub fn warm_up(&self, settings: &Settings, needs: &Needs<'_>) -> Result<(), RecordError> {
        settings.validate()?;
        self.pipelines.warm_up(settings, Traced::of(settings, needs))
    }

    /// Whether the pipelines of frames with these settings and needs are compiled. Until then such a frame takes those of a
    /// larger set, if [`warm_up`](Self::warm_up) or a frame before it compiled that; else it waits for the compiler.
    pub fn is_ready(&self, settings: &Settings, needs: &Needs<'_>) -> bool {
        let traced = Traced::of(settings, needs);
        self.pipelines.ready(settings, traced, traced)
    }

    /// The passes that a frame with these settings and needs records, in order.
    pub fn passes(settings: &Settings, needs: &Needs<'_>) -> impl Iterator<Item = Pass> + use<> {
        let traced = Traced::of(settings, needs);
        let steps = order(settings, traced).into_iter().flatten();
        steps.enumerate().map(move |(index, step)| Pass { info: step.info(traced), step, index })
    }

    /// The shaders of those passes, in order: for a host that is not on wgpu, and translates and compiles them by itself. The demo's
    /// command `shaders` does so. Slow: each is compiled here too, as its only check.
    pub fn shaders(&self, settings: &Settings, needs: &Needs<'_>) -> Result<Vec<(PassInfo, Vec<Shader>)>, RecordError> {
        settings.validate()?;
        self.pipelines.shaders(settings, Traced::of(settings, needs))
    }

    /// Records the frame: all its passes, and the copies of its statistics. Nothing is recorded if it fails.
    ///
    /// Several views a frame: a node each, or one node for all of them, the host rendering the G-buffer anew between two
    /// [`record`](Self::record)s, of another size after a [`resize`](Self::resize). At most 16 frames of one node may be recorded
    /// between two submits: the next would take the first one's constants. Of these all get the last one's
    /// [`Needs::textured`], [`Needs::importance`] and [`Needs::bounces`]; and of one [`RayScene`](crate::rays::RayScene), which
    /// knows one camera, all the last [update](crate::rays::RayScene::update): views with rays take a scene each, or a submit each.
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
    /// [`passes`](Self::passes) once, in their order or in one that [`PassInfo`](crate::PassInfo) allows, then
    /// [`Recording::finish`]. Clears, by this encoder, what of [`parts`](Self::parts) lives from the beginning: submit it before
    /// those of the passes.
    pub fn begin<'a>(
        &'a mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &'a Frame<'a>,
    ) -> Result<Recording<'a>, RecordError> {
        frame.settings.validate()?;
        if frame.settings.technique == Technique::Selective {
            Marks::check(frame.needs.textured, frame.needs.importance)?;
        }
        let sized = self.sized.as_ref().ok_or(RecordError::NoSize)?;
        let [width, height] = sized.scratch.size;
        let target = frame.target.texture();
        let (target_width, target_height) = (target.width(), target.height());
        // Which level a view shows is the host's affair: only a texture that can't hold the image is refused.
        let mut levels = (0..target.mip_level_count()).map(|level| {
            let size = target.size().mip_level_size(level, target.dimension());
            (size.width, size.height)
        });
        if !levels.any(|level| level == (width, height)) {
            return Err(RecordError::TargetSize { target_width, target_height, width, height });
        }
        let node = self.build().target_format;
        if target.format().remove_srgb_suffix() != node.remove_srgb_suffix() {
            return Err(RecordError::TargetFormat { target: target.format(), node });
        }
        if target.sample_count() != 1 {
            return Err(RecordError::TargetSamples(target.sample_count()));
        }
        if !target.usage().contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
            return Err(RecordError::TargetUsage);
        }
        if self.build().host_layout.is_some() && frame.host_bind_group.is_none() {
            return Err(RecordError::HostBindGroup);
        }
        if self.tables.is_some() && frame.textures.is_none() {
            return Err(RecordError::Textures);
        }
        let size = sized.scratch.size;
        if frame.settings.technique == Technique::MultiResolution {
            self.check_lattices(&frame.settings, size)?;
        }
        let mut audited = Audited::of(self.frame + 1, size);
        self.collector.poll(&mut self.controller);
        self.controller.follow(&frame.settings, size);
        let effort = self.controller.effort();
        let mut settings = frame.settings;
        if let Some(effort) = effort {
            audited.step = self.controller.step();
            audited.least_below = settings.windowed.at_effort(effort - audited.step, self.build().m).least_samples;
            settings.windowed = settings.windowed.at_effort(effort, self.build().m);
        }
        let uniform = FrameUniform::new(&Frame { settings, ..*frame }, size, self.build().m, audited)?;
        let lights = self.casting(frame, uniform.camera_position.into())?;
        let traced = Traced::of(&frame.settings, &frame.needs);
        let set = self.pipelines.serve(&frame.settings, traced)?;
        let sized = self.sized.as_mut().ok_or(RecordError::NoSize)?;
        sized.make_list(&self.pipelines, &frame.settings)?;
        let selects = frame.settings.technique == Technique::Selective;
        let steps = Steps::new(&frame.settings.multi_resolution, size, traced.rays());
        if frame.settings.technique == Technique::MultiResolution {
            let device = &self.pipelines.build.device;
            let buffer = self.steps.get_or_insert_with(|| {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("daa steps"),
                    size: STEP_STRIDE * STEPS * UNIFORM_SLOTS,
                    usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            });
            sized.make_lattices(&self.pipelines, buffer, &steps)?;
        }
        if selects {
            let marks = self.marks.get_or_insert_with(|| Marks::new(&self.pipelines.build.device));
            sized.make_select(&self.pipelines, marks);
            marks.write(queue, frame.needs.textured, frame.needs.importance);
        }
        if let (Some(tracing), Some(scene), true) = (&self.pipelines.tracing, frame.needs.rays, traced.any()) {
            let lights_bytes = LIGHTS_STRIDE * UNIFORM_SLOTS * Samples::COUNT;
            let buffers = self.rays.get_or_insert_with(|| RayBuffers::new(&self.pipelines.build.device, lights_bytes));
            let kept = Kept::of(&frame.settings);
            sized.make_traces(&self.pipelines, tracing, buffers, scene, traced, kept)?;
            buffers.write_bouncing(queue, frame.needs.bounces);
            if let Some(made) = &sized.traced {
                made.traces.clear(encoder, (size, self.pipelines.build.m), traced, kept);
            }
        }
        sized.make_frame(&self.pipelines.build, &self.uniforms, traced, set);

        self.frame += 1;
        let offset = self.frame % UNIFORM_SLOTS * UNIFORM_STRIDE;
        queue.write_buffer(&self.uniforms, offset, bytemuck::bytes_of(&uniform));
        let lights_offset = self.frame % UNIFORM_SLOTS * Samples::COUNT * LIGHTS_STRIDE;
        encoder.clear_buffer(&sized.scratch.statistics, 0, None);
        let mut recorded = Recorded::new(self.frame, frame.settings.technique, size, self.pipelines.build.m);
        recorded.effort = effort;
        let steps_offset = self.frame % UNIFORM_SLOTS * STEPS * STEP_STRIDE;
        for pass in Self::passes(&frame.settings, &frame.needs) {
            recorded.push(pass.info.name);
            if let (Step::Trace(samples) | Step::Bounce(samples), Some(lights), Some(buffers)) =
                (pass.step, lights, &self.rays)
            {
                let step = match samples {
                    Samples::Points(place) => *steps.step(Use::Rays, place),
                    _ => StepUniform::default(),
                };
                // The audit's are not the image's.
                let keeps = u32::from(Kept::of(&frame.settings).rays && samples != Samples::Audited);
                let uniform = CastingUniform { samples: samples.code(), keeps, step, ..lights };
                let offset = lights_offset + samples.index() * LIGHTS_STRIDE;
                queue.write_buffer(&buffers.lights, offset, bytemuck::bytes_of(&uniform));
            }
            let refined = match pass.step {
                Step::Refine(of, place) => Some((of, place)),
                Step::Points(place) => Some((Use::Shading, place)),
                _ => None,
            };
            if let (Some((of, place)), Some(buffer)) = (refined, &self.steps) {
                let offset = steps_offset + step_slot(of, place) * STEP_STRIDE;
                queue.write_buffer(buffer, offset, bytemuck::bytes_of(steps.step(of, place)));
            }
            recorded.audited = recorded.audited.or((pass.step == Step::Audit).then_some(audited));
        }
        let collects = frame.statistics || effort.is_some();
        let offsets = [offset as u32, lights_offset as u32];
        let steps_offset = steps_offset as u32;
        Ok(Recording { aa: self, frame, offsets, traced, set, steps, steps_offset, recorded, audited, collects })
    }

    /// Whether the lattices fit the image, and the node.
    fn check_lattices(&self, settings: &Settings, [width, height]: [u32; 2]) -> Result<(), RecordError> {
        let lattices = &settings.multi_resolution;
        let most = width.max(height).ilog2();
        for (lattice, coarsest) in [("shading", lattices.shading.coarsest), ("rays", lattices.rays.coarsest)] {
            if coarsest > most {
                return Err(RecordError::Coarsest { lattice, coarsest, width, height, most });
            }
        }
        match lattices.shading.pattern {
            pattern @ (Pattern::Triangular | Pattern::Equilateral) if self.build().m == 1 => {
                Err(RecordError::Shifted(pattern))
            }
            _ => Ok(()),
        }
    }

    /// The lights, if the frame traces; checks what it needs for that.
    fn casting(&self, frame: &Frame<'_>, camera: glam::Vec3) -> Result<Option<CastingUniform>, RecordError> {
        let traced = Traced::of(&frame.settings, &frame.needs);
        if !traced.any() {
            return Ok(None);
        }
        let node = self.pipelines.tracing.as_ref().ok_or(RecordError::NoRays)?.tier;
        let scene = frame.needs.rays.ok_or(RecordError::NoRayScene)?;
        if scene.tier() != node {
            return Err(RecordError::RayTier { scene: scene.tier(), node });
        }
        if scene.camera() != camera {
            return Err(RecordError::RayCamera { scene: scene.camera(), camera });
        }
        CastingUniform::new(if traced.shadows { frame.needs.shadows } else { &[] }, camera).map(Some)
    }

    /// Checks the G-buffer, as it is when the encoder gets there, and the frame for what is probably a mistake:
    /// [`input_report`](Self::input_report) has it some frames later. A pass over all samples that nobody needs in a
    /// program that works: for debug builds, or for a key. While a check is under way another does nothing.
    pub fn check_input(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RecordError> {
        let sized = self.sized.as_ref().ok_or(RecordError::NoSize)?;
        let size = sized.scratch.size;
        let (build, Some(group)) = (&self.pipelines.build, &sized.frames[0]) else { return Ok(()) };
        let uniform = FrameUniform::new(frame, size, build.m, Audited::of(self.frame, size))?;
        let check = self.check.get_or_insert_with(|| Check::new(&build.device));
        check.poll(build.m);
        if !check.is_free() {
            return Ok(());
        }
        let mut mistakes = Vec::new();
        if !frame.camera.is_reversed() {
            mistakes.push(InputMistake::ProjectionNotReversed);
        }
        let target = build.target_format;
        if target.is_srgb() && check::encodes(&build.host.source) {
            mistakes.push(InputMistake::EncodedTwice { target });
        }
        let offset = UNIFORM_SLOTS * UNIFORM_STRIDE;
        queue.write_buffer(&self.uniforms, offset, bytemuck::bytes_of(&uniform));
        check.record(encoder, build, (group, offset as u32), size, mistakes)?;
        Ok(())
    }

    /// What the newest [check](Self::check_input) has found that has arrived. Never waits; the host's `submit` or `poll` moves
    /// it on.
    pub fn input_report(&mut self) -> Option<&InputReport> {
        let m = self.build().m;
        let check = self.check.as_mut()?;
        check.poll(m);
        check.report()
    }

    /// What the newest frame did whose counters have arrived, some frames after it was submitted with
    /// [`Frame::statistics`]. Never waits; the host's `submit` or `poll` moves it on.
    pub fn statistics(&mut self) -> Option<&Statistics> {
        self.collector.poll(&mut self.controller);
        self.collector.latest()
    }
}
