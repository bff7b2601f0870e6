//! The node that a host creates, resizes and records.

use crate::TILE;
use crate::goal::Controller;
use crate::gpu::bands::{Layout, MOST_SAMPLES};
use crate::gpu::binding::frame_layout;
use crate::gpu::buffers::NodeBuffers;
use crate::gpu::loans::{Lent, Loans};
use crate::gpu::modules::binds_host;
use crate::gpu::pipelines::{self, Build, PipelineKind, Pipelines};
use crate::gpu::readback::collector::{Collector, Recorded};
use crate::gpu::readback::input_check::InputCheck;
use crate::gpu::recording::{Binds, ReadyPass, ReadyStage, Recording, Run};
use crate::gpu::resources::{SizedResources, Within, binding_limit, check_size};
use crate::gpu::shape::{Kind, shape};
use crate::gpu::sizes::{self, FIXED, Results, Shape, workgroups};
use crate::gpu::step::{Pass, Step, used_parts};
use crate::gpu::uniforms::audited::Audited;
use crate::gpu::uniforms::casting::{CastSamples, CastingUniform};
use crate::gpu::uniforms::frame::{FrameUniform, flag};
use crate::gpu::uniforms::lattice::{LatticeStep, LatticeSteps, StepUniform};
use crate::host::band::{Band, Rect};
use crate::host::check::{InputMistake, InputReport, encodes};
use crate::host::descriptor::{Descriptor, Shading};
use crate::host::error::{BuildError, LendError, RecordError, ShadingError, SizeError, TableError};
use crate::host::frame::{Camera, Frame};
use crate::host::gbuffer::{Channels, DEPTH_FORMAT, GBuffer, GBufferTier, Ids};
use crate::host::graph::{Grid, Part, PartInfo, PassInfo, PassKind, Resource, Stage};
use crate::host::intermediates::Intermediates;
use crate::host::needs::{Needs, RayInputs};
use crate::host::plan::Slots;
use crate::host::requirements::{self, Memory, Requirements};
use crate::host::shader::Shader;
use crate::host::statistics::Statistics;
use crate::host::table::{TableTexture, Tables, TextureTable, TextureTier};
use crate::host::traced::Traced;
use crate::passes::depth;
use crate::passes::first::FIRST;
use crate::rays::RayScene;
use crate::settings::{Settings, Technique};
use crate::techniques::{self, Effort};
use crate::wgsl::{self, HostSource};
use crate::window::MAX_M;
use std::sync::Arc;

/// Adaptive supersampling of a deferred frame: a node for a host's frame graph.
///
/// ```text
/// let mut aa = DeferredAa::new(&device, &descriptor, Some(&layout))?;
/// aa.resize(&device, width, height)?;
/// // each frame: render into aa.gbuffer(), then
/// aa.record(&queue, &mut encoder, &frame)?;
/// ```
///
/// The node never submits to the queue and never waits for the GPU. After [`resize`](Self::resize) and the first frame
/// of a technique it allocates no GPU resource.
#[derive(Debug)]
pub struct DeferredAa {
    pipelines: Arc<Pipelines>,
    tables: Option<Tables>,
    buffers: NodeBuffers,
    resources: Option<SizedResources>,
    /// From the last frame, until its resources go.
    prepared: Option<Prepared>,
    collector: Collector,
    /// Created by the first check.
    check: Option<InputCheck>,
    controller: Controller,
    /// The last frame that was begun.
    begun: Option<Begun>,
    frame: u64,
    /// The number of frames and bands so far, for the slots of their constants.
    recorded: u64,
}

/// What all bands of a frame share, and the band that comes next.
#[derive(Debug)]
struct Begun {
    camera: Camera,
    settings: Settings,
    exposure: f32,
    effort: Option<Effort>,
    audited: Audited,
    next: u32,
}

/// What the passes of a frame are recorded from, and what it depends on.
#[derive(Debug)]
struct Prepared {
    steps: Vec<Step>,
    shape: Shape,
    /// Generation of the ray scene, if the frame has one.
    scene: Option<u64>,
    /// The inputs that the pipelines were compiled for.
    set: RayInputs,
    passes: Vec<ReadyPass>,
}

impl DeferredAa {
    /// Returns the features, limits and memory that a node with this descriptor needs, and what the adapter lacks.
    /// Creates nothing.
    pub fn requirements(adapter: &wgpu::Adapter, descriptor: &Descriptor<'_>) -> Requirements {
        Requirements::of(adapter, descriptor)
    }

    /// Checks the host's WGSL and builds the node. `host_layout` is the layout of the host's bind group, `None` if its
    /// WGSL binds nothing. Pipelines are compiled when a frame first needs them; [`warm_up`](Self::warm_up) compiles
    /// them ahead.
    pub fn new(
        device: &wgpu::Device,
        descriptor: &Descriptor<'_>,
        host_layout: Option<&wgpu::BindGroupLayout>,
    ) -> Result<Self, BuildError> {
        Self::with_groups(device, descriptor, [host_layout, None])
    }

    /// Builds the node as [`new`](Self::new) does, for a host that binds at [`HOST_GROUP`](crate::HOST_GROUP) and at
    /// [`SECOND_HOST_GROUP`](crate::SECOND_HOST_GROUP), in this order: for instance uniforms in one group and binding
    /// arrays in the other, as wgpu allows no group to have both. A second layout needs [`TextureTier::None`].
    pub fn with_groups(
        device: &wgpu::Device,
        descriptor: &Descriptor<'_>,
        host_layouts: [Option<&wgpu::BindGroupLayout>; 2],
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
        if let Some(Ids::Narrow { triangle_bits }) = descriptor.gbuffer.ids().filter(|ids| !ids.fits(0, 0)) {
            return Err(BuildError::TriangleBits(triangle_bits));
        }
        if let GBufferTier::Stored(channels) = descriptor.gbuffer {
            host.check_channels(file, channels)?;
            if let (Some(_), Channels { geometric_normal: false, .. }) = (descriptor.rays, channels) {
                return Err(BuildError::RayChannel);
            }
        }
        let tables = Tables::new(device, descriptor.textures, descriptor.texture_capacity);
        let [host_layout, second_layout] = host_layouts.map(|layout| layout.cloned());
        if tables.is_some() && second_layout.is_some() {
            return Err(BuildError::SecondGroup);
        }
        let build = Build {
            device: device.clone(),
            m: descriptor.m,
            host,
            target_format: descriptor.target_format,
            gbuffer: descriptor.gbuffer,
            rays: descriptor.rays,
            frame_layouts: RayInputs::ALL.map(|inputs| frame_layout(device, descriptor.gbuffer, inputs)),
            second_layout: tables.as_ref().map(|t| t.layout.clone()).or(second_layout),
            host_layout,
        };
        let pipelines = Pipelines::new(build);
        // Compiled now, so that a layout that does not fit the WGSL is an error here and not in the first frame.
        pipelines.try_host(&FIRST)?;
        Ok(Self::on(Arc::new(pipelines), tables))
    }

    fn on(pipelines: Arc<Pipelines>, tables: Option<Tables>) -> Self {
        let device = &pipelines.build.device;
        Self {
            buffers: NodeBuffers::new(device),
            collector: Collector::new(device),
            pipelines,
            tables,
            resources: None,
            prepared: None,
            check: None,
            controller: Controller::default(),
            begun: None,
            frame: 0,
            recorded: 0,
        }
    }

    /// A second node of the same descriptor, for another view: it shares the compiled pipelines and nothing else. It has
    /// no size yet.
    pub fn for_another_view(&self) -> Self {
        Self::on(self.pipelines.clone(), self.tables.clone())
    }

    /// Checks WGSL as [`new`](Self::new) does, without a device, for a host that reloads its shaders.
    pub fn check_shading(
        shading: Shading<'_>,
        textures: TextureTier,
        features: wgpu::Features,
    ) -> Result<(), ShadingError> {
        HostSource::check(shading.source, shading.file, textures, features).map(|_| ())
    }

    /// The number of samples along one side of a window.
    pub fn m(&self) -> u32 {
        self.build().m
    }

    /// How the G-buffer keeps its samples.
    pub fn gbuffer_tier(&self) -> GBufferTier {
        self.build().gbuffer
    }

    fn build(&self) -> &Build {
        &self.pipelines.build
    }

    /// Creates the G-buffer and all other resources for an output of `width` × `height` pixels. Does nothing if the
    /// node already has that size. If it fails, the node keeps its former size and resources.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) -> Result<(), SizeError> {
        check_size([width, height], self.build().m, &device.limits())?;
        self.make(device, Layout { image: [width, height], size: [width, height] })?;
        if let Some(resources) = &mut self.resources {
            resources.within = None;
        }
        Ok(())
    }

    /// Divides an output of `width` × `height` pixels into bands, so that all that the node holds for frames with these
    /// settings and needs takes at most `limit` bytes and nothing exceeds the limits of the device, and creates the
    /// resources of one band. Returns the bands, a single one if the whole image fits; with a `limit` of `u64::MAX`
    /// only the device limits them.
    ///
    /// For each band in turn the host rasters [`Band::raster`] into the [`gbuffer`](Self::gbuffer), with the projection
    /// of [`Band::crop`] or the viewport of [`Band::viewport`], and records a frame that has the band as
    /// [`Frame::band`]. Between two submits there may be up to 64 bands. The image equals that of a single frame bit
    /// for bit, if the samples do and each band has room for the results of all its rays ([`Settings::ray_samples`]). It
    /// is complete after the last band; then its statistics are read back, too, and the effort of a goal may move.
    ///
    /// A call with the same arguments as the last one does nothing; call it before every frame whose settings or needs
    /// may have changed. Other bands withdraw all [loans](Self::lend). Not counted are the host's own resources, those
    /// of a [`RayScene`], and what wgpu and the driver add. If it fails, the node keeps its former size and resources.
    pub fn resize_banded(
        &mut self,
        device: &wgpu::Device,
        (width, height): (u32, u32),
        limit: u64,
        settings: &Settings,
        needs: &Needs<'_>,
    ) -> Result<Vec<Band>, SizeError> {
        let (m, image) = (self.build().m, [width, height]);
        if width == 0 || height == 0 {
            return Err(SizeError::Empty { width, height });
        }
        if image.iter().any(|&side| side.checked_mul(m).is_none_or(|samples| samples > MOST_SAMPLES)) {
            return Err(SizeError::Samples { width, height, m, limit: MOST_SAMPLES });
        }
        let inputs = RayInputs::of(settings, needs);
        let steps = steps(settings, needs);
        let apron = techniques::of(settings.technique).apron(settings, inputs);
        let within = Within {
            limit,
            apron,
            shape: self.shape(Layout { image, size: [TILE; 2] }, settings, inputs),
            parts: used_parts(&steps),
        };
        if let Some(resources) = self.resources.as_ref().filter(|made| made.within.as_ref() == Some(&within)) {
            return Ok(resources.layout().bands(apron));
        }
        let bytes = |layout: Layout| {
            let shape = self.shape(layout, settings, inputs);
            shape.bytes_held(&within.parts) + NodeBuffers::most_bytes() + Collector::most_bytes(steps.len())
        };
        let limits = device.limits();
        let fits = |size: [u32; 2]| {
            if size.iter().any(|side| side * m > limits.max_texture_dimension_2d) {
                return false;
            }
            let layout = Layout { image, size };
            let shape = self.shape(layout, settings, inputs);
            let largest = within.parts.iter().chain(&FIXED).map(|&part| shape.buffer_bytes(part)).max();
            largest.is_none_or(|bytes| bytes <= binding_limit(device)) && bytes(layout) <= limit
        };
        let Some(layout) = Layout::fit(image, apron, fits) else {
            let layout = Layout::least(image, apron);
            return Err(SizeError::Limit { width, height, m, limit, least: bytes(layout) });
        };
        let bands = layout.bands(apron);
        self.make(device, layout)?;
        if bands.len() > 1 {
            self.buffers.hold_bands();
        }
        if let Some(resources) = &mut self.resources {
            // Other frames may have needed parts that these do not.
            resources.keep_only(&within.parts);
            resources.within = Some(within);
        }
        self.prepared = None;
        Ok(bands)
    }

    /// Makes the resources of a layout, unless the node has them.
    fn make(&mut self, device: &wgpu::Device, layout: Layout) -> Result<(), SizeError> {
        if self.resources.as_ref().is_some_and(|resources| resources.layout() == layout) {
            return Ok(());
        }
        let m = self.build().m;
        let scope = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let shape = self.shape(layout, &Settings::default(), RayInputs::default());
        let resources = SizedResources::new(device, &shape, Loans::default(), None);
        if let Some(e) = pipelines::ready(scope.pop()) {
            let tier = self.build().gbuffer;
            let bytes = sizes::gbuffer_bytes(layout.size, m, tier) + sizes::scratch_bytes(layout.size);
            let [width, height] = layout.size;
            return Err(SizeError::OutOfMemory { width, height, m, bytes, message: e.to_string() });
        }
        self.prepared = None;
        self.begun = None;
        self.resources = Some(resources);
        Ok(())
    }

    fn shape(&self, layout: Layout, settings: &Settings, inputs: RayInputs) -> Shape {
        let &Build { m, target_format, gbuffer, .. } = self.build();
        shape(Kind { m, target_format, gbuffer }, layout, settings, inputs)
    }

    /// Lists the textures and buffers that a frame with these settings and needs reads and writes at the present size,
    /// except those that the host binds itself ([`Resource::Host`], [`Resource::Rays`]). Empty before the first
    /// [`resize`](Self::resize).
    pub fn parts(&self, settings: &Settings, needs: &Needs<'_>) -> Vec<PartInfo> {
        let Some(resources) = &self.resources else { return Vec::new() };
        let inputs = RayInputs::of(settings, needs);
        let shape = self.shape(resources.layout(), settings, inputs);
        let steps = steps(settings, needs);
        let passes = || steps.iter().map(|step| step.info(settings, inputs));
        let uses = |resource| passes().any(|pass| pass.reads.contains(resource) || pass.writes.contains(resource));
        let bound = used_parts(&steps);
        let in_frame = |part: &Part| match part.resource() {
            // A frame uses either the list of pixels or the list of samples.
            Resource::List => bound.contains(part),
            resource => uses(resource),
        };
        let info = |part: Part| {
            let kind = shape.kind(part)?;
            Some(PartInfo { part, resource: part.resource(), kind, lifetime: part.lifetime() })
        };
        Part::ALL.into_iter().filter(in_frame).filter_map(info).collect()
    }

    /// Lends the node memory for some of its [parts](Self::parts); the node drops its own memory for these. This is for
    /// a host whose graph places resources that are not alive at the same time in the same memory.
    ///
    /// A call replaces all earlier loans, and an empty slice withdraws them. It recreates all bind groups, so do not
    /// call it every frame. The content of the parts is lost, except for attachments of the G-buffer that are lent
    /// neither before nor after the call. A [`resize`](Self::resize) to another size withdraws all loans.
    ///
    /// The host must make sure that parts which share memory are never alive at the same time ([`PartInfo::lifetime`]);
    /// this is not checked. Lists, lattices and ray results are created when a frame first needs them, and memory lent
    /// for them is used from then on.
    pub fn lend(&mut self, device: &wgpu::Device, lent: &[Lent<'_>]) -> Result<(), LendError> {
        let resources = self.resources.as_ref().ok_or(LendError::NoSize)?;
        let inputs = RayInputs { shadows: true, reflections: true };
        // The least that any frame needs of a part; a frame that needs more of it refuses the loan.
        let single = Settings { technique: Technique::Single, ..Settings::default() };
        let shape = self.shape(resources.layout(), &single, inputs);
        let loans = Loans::new(lent, &shape, binding_limit(device))?;
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let binding = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let lent = SizedResources::new(device, &shape, loans, Some(resources));
        lent.try_binding(device);
        let refused = [pipelines::ready(binding.pop()), pipelines::ready(memory.pop())];
        if let Some(e) = refused.into_iter().flatten().next() {
            return Err(LendError::Refused(pipelines::one_line(&e)));
        }
        self.prepared = None;
        self.resources = Some(lent);
        Ok(())
    }

    /// The attachments to render the scene into, `None` before the first [`resize`](Self::resize).
    pub fn gbuffer(&self) -> Option<&GBuffer> {
        self.resources.as_ref().map(|resources| &resources.gbuffer)
    }

    /// The resources that the passes use between them, for tools and tests. `None` before the first
    /// [`resize`](Self::resize).
    pub fn intermediates(&self) -> Option<Intermediates<'_>> {
        let resources = self.resources.as_ref()?;
        Some(Intermediates {
            first: resources.texture(Part::First)?,
            color: resources.texture(Part::Color)?,
            plan: resources.buffer(Part::Plan)?,
            slots: Slots::new(resources.size[0], resources.size[1]),
            pixel_list: resources.buffer(Part::PixelListEntries),
            sample_list: resources.buffer(Part::SampleListEntries),
            traced: self.traced(resources),
            shadows: resources.buffer(Part::Shadows),
            tile_lists: resources.buffer(Part::Tiles),
            reflections: resources.buffer(Part::Reflections),
            lattices: resources.buffer(Part::LatticePoints).zip(resources.buffer(Part::LatticeColors)).map(Into::into),
            surfaces: resources.buffer(Part::SurfaceMasks),
        })
    }

    /// Where the results of the last frame's rays lie.
    fn traced(&self, resources: &SizedResources) -> Traced {
        let settings = self.begun.as_ref().map_or_else(Settings::default, |begun| begun.settings);
        let shape = self.shape(resources.layout(), &settings, RayInputs::default());
        let Results { ranks, planned, audited, words } = shape.results;
        let slots = Slots::new(resources.size[0], resources.size[1]);
        let of_frame = self.begun.as_ref().filter(|_| audited > 0 && resources.size == resources.image);
        let audited = of_frame.map(|begun| (begun.audited, audited));
        Traced { slots, settings, m: shape.m, ranks, planned: planned as usize, words: words as usize, audited }
    }

    /// The GPU memory in bytes that the node holds at the present size, without lent memory.
    pub fn memory(&self) -> Memory {
        let rays = self.buffers.rays_held();
        let Some(resources) = &self.resources else { return Memory { gbuffer: 0, scratch: 0, rays } };
        let memory = Memory::of(Part::ALL.into_iter().map(|part| (part, resources.held(part))));
        Memory { scratch: memory.scratch + self.buffers.marks_held(), rays: memory.rays + rays, ..memory }
    }

    /// The layout of [`TextureTable::bind_group`], for the host's own pipelines, at `@group(1)`.
    pub fn texture_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        self.tables.as_ref().map(|t| &t.layout)
    }

    /// The WGSL of `daa_texture` for the host's own pipelines: a directive that must come first in the module, and the
    /// functions and bindings.
    pub fn texture_wgsl(tier: TextureTier) -> (&'static str, &'static str) {
        (wgsl::directives(tier), wgsl::table_chunk(tier))
    }

    /// Builds a table of the host's textures: `daa_texture(i, ..)` reads `textures[i]`. On [`TextureTier::Arrays`] the
    /// encoder receives commands that copy the textures, so submit it before they are destroyed. Build a new table when
    /// textures are added or removed.
    pub fn texture_table(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        textures: &[TableTexture<'_>],
    ) -> Result<TextureTable, TableError> {
        let tables = self.tables.as_ref().ok_or(TableError::NoTier)?;
        tables.table(&self.build().device, queue, encoder, textures)
    }

    /// Compiles the pipelines for frames with these settings and needs, so that no such frame waits for the compiler.
    /// If it is called with the most that any frame may need, frames that need less never stall either: their own
    /// pipelines are compiled on a thread, and until those are ready the larger set is used, which gives the same
    /// image.
    pub fn warm_up(&self, settings: &Settings, needs: &Needs<'_>) -> Result<(), RecordError> {
        settings.validate()?;
        let inputs = RayInputs::of(settings, needs);
        self.pipelines.warm_up(&steps(settings, needs), inputs)
    }

    /// Whether the pipelines for frames with these settings and needs are compiled. Until then such a frame uses a
    /// larger set of pipelines if [`warm_up`](Self::warm_up) or an earlier frame has compiled one; otherwise it waits
    /// for the compiler.
    pub fn is_ready(&self, settings: &Settings, needs: &Needs<'_>) -> bool {
        let inputs = RayInputs::of(settings, needs);
        self.pipelines.ready(&steps(settings, needs), inputs)
    }

    /// The passes that a frame with these settings and needs records, in order.
    pub fn passes(settings: &Settings, needs: &Needs<'_>) -> impl Iterator<Item = Pass> + use<> {
        let inputs = RayInputs::of(settings, needs);
        passes(settings, inputs, steps(settings, needs))
    }

    /// The shaders of those passes, in order, for a host that does not use wgpu and translates and compiles them
    /// itself, as the demo's command `shaders` does. This is slow: each shader is also compiled here to check it.
    pub fn shaders(&self, settings: &Settings, needs: &Needs<'_>) -> Result<Vec<(PassInfo, Vec<Shader>)>, RecordError> {
        settings.validate()?;
        let inputs = RayInputs::of(settings, needs);
        let all = passes(settings, inputs, steps(settings, needs));
        let shaders = |pass: Pass| {
            let shaders = self.build().shaders(&pass.step, pass.info.name, inputs)?;
            Ok((pass.info, shaders))
        };
        all.map(shaders).collect()
    }

    /// Records all passes of a frame and the copies of its statistics. If it fails, nothing is recorded.
    ///
    /// A frame may be one of the bands of an image, see [`resize_banded`](Self::resize_banded).
    ///
    /// For several views in a frame, use a node for each, or one node for all: then the host renders the G-buffer anew
    /// between two calls, for a view of another size after a [`resize`](Self::resize). The limits of one node between
    /// two submits are:
    /// - At most 16 frames may be recorded, or 64 bands of frames; the next would overwrite the constants of the first.
    /// - All of them use [`Needs::textured`], [`Needs::importance`] and [`Needs::reflective`] of the last one.
    /// - All that trace one [`RayScene`](RayScene) use its last [update](RayScene::update),
    ///   and a scene is updated for one camera. Views with rays need a scene each or a submit each.
    pub fn record(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RecordError> {
        let recording = self.begin(queue, encoder, frame)?;
        recording.record_all(encoder);
        recording.finish(queue, encoder);
        Ok(())
    }

    /// Begins a frame whose passes the host records itself, among its own passes or with its own profiler. Record each
    /// of [`passes`](Self::passes) once, in their order or in any order that [`PassInfo`](crate::PassInfo) allows, then
    /// call [`Recording::finish`]. `encoder` receives the commands that clear those of the [`parts`](Self::parts) that
    /// live from the beginning of the frame; submit it before the encoders of the passes.
    pub fn begin<'a>(
        &'a mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &'a Frame<'a>,
    ) -> Result<Recording<'a>, RecordError> {
        let settings = &frame.settings;
        settings.validate()?;
        let technique = techniques::of(settings.technique);
        let (m, layout) = (self.build().m, self.resources.as_ref().ok_or(RecordError::NoSize)?.layout());
        let inputs = RayInputs::of(settings, &frame.needs);
        technique.check(settings, &frame.needs, layout.image, m)?;
        let band = band(frame, layout, technique.apron(settings, inputs))?;
        let (at, drawn) = self.check_target(frame, &band)?;
        let begins = band.index == 0;
        let (effort, audited) = if begins {
            self.begin_frame(settings, layout.image, settings.technique.follows_goals())
        } else {
            let begun = self.begun.as_ref().filter(|begun| begun.next > 0);
            let next = begun.map_or(0, |begun| begun.next);
            match begun.filter(|_| next == band.index) {
                None => return Err(RecordError::BandOrder { index: band.index, next }),
                Some(begun) if !begun.is_of(frame) => return Err(RecordError::BandDiffers(band.index)),
                Some(begun) => (begun.effort, begun.audited),
            }
        };
        let mut uniform = FrameUniform::new(frame, &band, at, audited)?;
        uniform.set_order(m, &technique.order(settings, m));
        technique.uniform(settings, m, effort, &mut uniform);
        uniform.flag(flag::WHOLE_HOOK, self.build().host.shades_whole());
        let shape = self.shape(layout, settings, inputs);
        uniform.results = shape.results.into();
        self.check_scene(frame, uniform.camera_position.into())?;
        let samples = layout.image.map(|side| side * m);
        let casting = self.casting(frame, inputs, uniform.camera_position.into(), samples)?;
        let steps = steps(settings, &frame.needs);
        self.prepare(frame, steps, &shape)?;
        let Self { buffers, resources, prepared, collector, pipelines, .. } = self;
        let resources = resources.as_ref().ok_or(RecordError::NoSize)?;
        let ready = prepared.as_ref().map_or(&[][..], |prepared| &prepared.passes);

        // From here on nothing fails.
        if technique.reads_marks() {
            buffers.write_marks(queue, &frame.needs);
        }
        if casting.is_some() {
            buffers.write_reflective(queue, frame.needs.reflective);
        }
        self.frame += u64::from(begins);
        self.recorded += 1;
        let &Frame { camera, settings, exposure, .. } = frame;
        let next = if band.index + 1 < band.count { band.index + 1 } else { 0 };
        self.begun = Some(Begun { camera, settings, exposure, effort, audited, next });
        let slot = self.recorded % buffers.slots();
        buffers.frames.write(queue, slot, 0, &uniform);
        let step = |lattices: &LatticeSteps, at| lattices.step(at).placed([band.raster.x, band.raster.y], band.image);
        if let Some(lattices) = &shape.lattices {
            write_lattices(buffers, queue, slot, ready, |at| step(lattices, at));
        }
        if let Some(casting) = &casting {
            let step = |at| shape.lattices.as_ref().map(|lattices| step(lattices, at));
            write_casting(buffers, queue, slot, ready, casting, (step, shape.rays));
        }
        resources.clear(encoder, &shape, begins);
        let recorded = (frame.statistics || effort.is_some()).then(|| {
            if begins {
                collector.reserve(&pipelines.build.device, ready.len(), band.count);
            }
            let audits = |ready: &ReadyPass| ready.pass.info.kind == PassKind::Audit;
            Recorded {
                frame: self.frame,
                technique: settings.technique,
                band,
                m,
                effort: effort.map(|e| e.effort),
                audited: ready.iter().any(audits).then_some(audited),
                passes: ready.iter().map(|ready| (ready.pass.info.name, ready.pass.info.kind)).collect(),
            }
        });
        Ok(Recording { frame, drawn, resources, buffers, collector, slot, passes: ready, recorded })
    }

    /// Reads what has arrived of earlier frames, and returns the effort and the audited tiles of the next one.
    fn begin_frame(&mut self, settings: &Settings, image: [u32; 2], scales: bool) -> (Option<Effort>, Audited) {
        self.collector.poll(&mut self.controller);
        self.controller.follow(settings, image, scales);
        let (effort, step) = (self.controller.effort(), self.controller.step());
        let effort = effort.map(|effort| Effort { effort, step });
        let audited = Audited { step: effort.map_or(0.0, |e| e.step), ..Audited::of(self.frame + 1, image) };
        (effort, audited)
    }

    /// Makes ready what the passes of a frame are recorded from: pipelines, memory and bind groups. Nothing is left to
    /// do where the frame before had the same.
    fn prepare(&mut self, frame: &Frame<'_>, steps: Vec<Step>, shape: &Shape) -> Result<(), RecordError> {
        let inputs = shape.inputs;
        let visible = self.build().gbuffer.ids().is_some();
        let scene = frame.needs.rays.filter(|_| inputs.any() || visible).map(RayScene::generation);
        // While pipelines of a larger set serve, the frame's own may come at any time.
        let is_same = |p: &Prepared| p.steps == steps && p.shape == *shape && p.scene == scene && p.set == inputs;
        if self.prepared.as_ref().is_some_and(is_same) {
            return Ok(());
        }
        self.prepared = None;
        let settings = &frame.settings;
        let set = self.pipelines.serve(&steps, inputs)?;
        let Self { pipelines, tables, buffers, resources, .. } = self;
        let build = &pipelines.build;
        let resources = resources.as_mut().ok_or(RecordError::NoSize)?;
        let execution = techniques::of(settings.technique).execution(settings);
        resources.ensure(&build.device, shape, &used_parts(&steps), execution)?;
        let make_ready = |pass: Pass| {
            let data = pass.step.pass;
            let stage = |stage: &'static Stage| {
                let pipeline = pipelines.get(data, stage, set)?;
                let group = resources.group(build, (data, stage), &pipeline, buffers, frame.needs.rays);
                let run = match (pipeline.kind, stage.grid) {
                    (PipelineKind::Render(pipeline), _) => Run::Draw(pipeline),
                    (PipelineKind::Compute(pipeline), Grid::Indirect { part, offset }) => {
                        let groups = resources.buffer(part).ok_or(RecordError::Unmade(pass.info.name))?;
                        Run::Indirect(pipeline, groups.clone(), offset)
                    }
                    (PipelineKind::Compute(pipeline), grid) => {
                        // Every frame of a size audits as many tiles.
                        let audited = Some(Audited::of(0, shape.image));
                        let groups = workgroups(grid, (shape.size, shape.image), build.m, pass.info.lattice, audited);
                        Run::Direct(pipeline, groups.ok_or(RecordError::Unmade(pass.info.name))?)
                    }
                };
                Ok(ReadyStage { stage, group, run })
            };
            let stages = data.stages.iter().map(stage).collect::<Result<_, RecordError>>()?;
            let (found, compiled) = if data.reads_found() { (inputs, set) } else { Default::default() };
            let hosts = binds_host(data.module.base, &build.host);
            let binds = Binds {
                table: hosts && tables.is_some(),
                second: hosts && tables.is_none() && build.second_layout.is_some(),
                host: hosts && build.host_layout.is_some(),
            };
            let frame = resources.frame(build, buffers, found, compiled, frame.needs.rays);
            Ok(ReadyPass { pass, frame, binds, stages })
        };
        let passes = passes(settings, inputs, steps.clone()).map(make_ready).collect::<Result<_, RecordError>>()?;
        self.prepared = Some(Prepared { steps, shape: *shape, scene, set, passes });
        Ok(())
    }

    /// Checks that the image fits the frame's target, and that the frame has the bind groups of the host's WGSL.
    /// Returns the place of the image in the target, and the pixels that the band draws, `None` if these are all.
    fn check_target(&self, frame: &Frame<'_>, band: &Band) -> Result<([u32; 2], Option<Rect>), RecordError> {
        let [width, height] = band.image;
        let target = frame.target.texture();
        let (target_width, target_height) = (target.width(), target.height());
        if let Some(viewport) = frame.viewport
            && ([viewport.width, viewport.height] != band.image || !viewport.fits([target_width, target_height]))
        {
            return Err(RecordError::Viewport { viewport, width, height, target_width, target_height });
        }
        if frame.viewport.is_none() && !has_level(target, band.image) {
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
        let whole = frame.viewport.map_or(band.image, |_| [target_width, target_height]);
        check_depth(frame, whole)?;
        if self.build().host_layout.is_some() && frame.host_bind_group.is_none() {
            return Err(RecordError::HostBindGroup);
        }
        if self.tables.is_some() && frame.textures.is_none() {
            return Err(RecordError::Textures);
        }
        if self.tables.is_none() && self.build().second_layout.is_some() && frame.second_bind_group.is_none() {
            return Err(RecordError::SecondBindGroup);
        }
        let image = frame.viewport.unwrap_or(Rect::of(band.image));
        let Rect { x, y, width, height } = band.output;
        let drawn = Rect { x: image.x + x, y: image.y + y, width, height };
        Ok(([image.x, image.y], (drawn != Rect::of(whole)).then_some(drawn)))
    }

    /// Checks that the frame has what a visibility buffer is read with.
    fn check_scene(&self, frame: &Frame<'_>, camera: glam::Vec3) -> Result<(), RecordError> {
        let Some(ids) = self.build().gbuffer.ids() else { return Ok(()) };
        let scene = frame.needs.rays.filter(|scene| scene.visibility_buffers().is_some());
        let scene = scene.ok_or(RecordError::NoVisibleScene)?;
        if scene.camera() != camera {
            return Err(RecordError::RayCamera { scene: scene.camera(), camera });
        }
        let [triangles, instances] = scene.most_ids();
        if !ids.fits(triangles, instances) {
            return Err(RecordError::Ids { ids, triangles, instances });
        }
        Ok(())
    }

    /// The lights that cast shadows, `None` if the frame traces nothing. Checks what tracing needs.
    fn casting(
        &self,
        frame: &Frame<'_>,
        inputs: RayInputs,
        camera: glam::Vec3,
        samples: [u32; 2],
    ) -> Result<Option<CastingUniform>, RecordError> {
        if !inputs.any() {
            return Ok(None);
        }
        let node = self.build().rays.ok_or(RecordError::NoRays)?;
        let scene = frame.needs.rays.ok_or(RecordError::NoRayScene)?;
        if scene.tier() != Some(node) {
            return Err(RecordError::RayTier { scene: scene.tier(), node });
        }
        if scene.camera() != camera {
            return Err(RecordError::RayCamera { scene: scene.camera(), camera });
        }
        let mut casting = CastingUniform::new(if inputs.shadows { frame.needs.shadows } else { &[] }, camera)?;
        if let GBufferTier::Stored(_) = self.build().gbuffer {
            casting.bias = (f64::from(frame.settings.ray_bias) * frame.camera.sample_width(samples)) as f32;
        }
        Ok(Some(casting))
    }

    /// Checks the frame's camera and the content of the G-buffer for probable mistakes;
    /// [`input_report`](Self::input_report) has the result some frames later. `encoder` must come after the host's
    /// rendering. The check is a pass over all samples that a finished program does not need: call it in debug builds
    /// or on a key. A call while a check is under way does nothing.
    pub fn check_input(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RecordError> {
        let layout = self.resources.as_ref().ok_or(RecordError::NoSize)?.layout();
        let technique = techniques::of(frame.settings.technique);
        let apron = technique.apron(&frame.settings, RayInputs::of(&frame.settings, &frame.needs));
        let band = band(frame, layout, apron)?;
        let mut uniform = FrameUniform::new(frame, &band, [0; 2], Audited::of(self.frame, band.image))?;
        self.check_scene(frame, uniform.camera_position.into())?;
        let Self { pipelines, buffers, resources, .. } = self;
        let build = &pipelines.build;
        let resources = resources.as_mut().ok_or(RecordError::NoSize)?;
        uniform.set_order(build.m, &technique.order(&frame.settings, build.m));
        let check = self.check.get_or_insert_with(|| InputCheck::new(&build.device));
        check.poll(build.m);
        if !check.is_free() {
            return Ok(());
        }
        let mut mistakes = Vec::new();
        if !frame.camera.is_reversed() {
            mistakes.push(InputMistake::ProjectionNotReversed);
        }
        let target = build.target_format;
        if target.is_srgb() && encodes(&build.host.source) {
            mistakes.push(InputMistake::EncodedTwice { target });
        }
        // This slot lies beyond those of the frames.
        let slot = buffers.slots();
        buffers.frames.write(queue, slot, 0, &uniform);
        let group = resources.frame(build, buffers, RayInputs::default(), RayInputs::default(), frame.needs.rays);
        check.record(encoder, pipelines, (&group, buffers.frames.offset(slot, 0)), resources.size, mistakes)
    }

    /// The report of the newest [check](Self::check_input) that has arrived. Never waits; a `submit` or `poll` of the
    /// host completes the transfer.
    pub fn input_report(&mut self) -> Option<&InputReport> {
        let m = self.build().m;
        let check = self.check.as_mut()?;
        check.poll(m);
        check.report()
    }

    /// The statistics of the newest frame whose counters have arrived, some frames after it was submitted with
    /// [`Frame::statistics`]. Never waits; a `submit` or `poll` of the host completes the transfer.
    pub fn statistics(&mut self) -> Option<&Statistics> {
        self.collector.poll(&mut self.controller);
        self.collector.latest()
    }
}

impl Begun {
    /// Whether a band belongs to the frame.
    fn is_of(&self, frame: &Frame<'_>) -> bool {
        self.camera == frame.camera && self.settings == frame.settings && self.exposure == frame.exposure
    }
}

/// Whether a level of the texture has this size. The host chooses which one its view shows, which wgpu does not tell.
fn has_level(texture: &wgpu::Texture, size: [u32; 2]) -> bool {
    (0..texture.mip_level_count()).any(|level| {
        let level = texture.size().mip_level_size(level, texture.dimension());
        [level.width, level.height] == size
    })
}

/// Checks the frame's depth view, which has the size of the target.
fn check_depth(frame: &Frame<'_>, [width, height]: [u32; 2]) -> Result<(), RecordError> {
    let depth = match (frame.needs.depth, frame.depth) {
        (None, None) => return Ok(()),
        (Some(_), Some(view)) => view.texture(),
        (needed, _) => return Err(RecordError::Depth { needed: needed.is_some() }),
    };
    if !has_level(depth, [width, height]) {
        let (depth_width, depth_height) = (depth.width(), depth.height());
        return Err(RecordError::DepthSize { depth_width, depth_height, width, height });
    }
    if depth.format() != DEPTH_FORMAT {
        return Err(RecordError::DepthFormat(depth.format()));
    }
    if depth.sample_count() != 1 {
        return Err(RecordError::DepthSamples(depth.sample_count()));
    }
    if !depth.usage().contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
        return Err(RecordError::DepthUsage);
    }
    Ok(())
}

/// The passes of a frame, in order.
fn steps(settings: &Settings, needs: &Needs<'_>) -> Vec<Step> {
    let mut steps = techniques::steps(settings, RayInputs::of(settings, needs));
    steps.extend(needs.depth.map(|depth| Step::from(depth::of(depth))));
    steps
}

/// The band of a frame, checked; the whole image if the node has no bands.
fn band(frame: &Frame<'_>, layout: Layout, apron: u32) -> Result<Band, RecordError> {
    let [width, height] = layout.size;
    match frame.band {
        None if layout.size != layout.image => Err(RecordError::NoBand { width, height }),
        None => {
            let whole = Rect::of(layout.image);
            Ok(Band { index: 0, count: 1, image: layout.image, output: whole, raster: whole })
        }
        Some(band) if layout.band(apron, band.index) == Some(band) => Ok(band),
        Some(Band { index, count, .. }) => Err(RecordError::Band { index, count }),
    }
}

fn passes(settings: &Settings, inputs: RayInputs, steps: Vec<Step>) -> impl Iterator<Item = Pass> + use<> {
    let settings = *settings;
    let info = move |step: &Step| step.info(&settings, inputs);
    steps.into_iter().enumerate().map(move |(index, step)| Pass { info: info(&step), step, index })
}

/// Writes the constants of the passes over lattices.
fn write_lattices(
    buffers: &NodeBuffers,
    queue: &wgpu::Queue,
    slot: u64,
    ready: &[ReadyPass],
    step: impl Fn(LatticeStep) -> StepUniform,
) {
    for at in ready.iter().filter_map(|ready| ready.pass.step.lattice) {
        buffers.steps().write(queue, slot, at.index(), &step(at));
    }
}

/// Writes the constants of the passes that cast rays.
fn write_casting(
    buffers: &NodeBuffers,
    queue: &wgpu::Queue,
    slot: u64,
    ready: &[ReadyPass],
    casting: &CastingUniform,
    (step, keeps): (impl Fn(LatticeStep) -> Option<StepUniform>, bool),
) {
    for pass in ready {
        let Some(samples) = pass.pass.step.samples else { continue };
        let step = samples.step().and_then(&step);
        // The debug view of rays shows those of the image, without the audit's.
        let keeps = u32::from(keeps && samples != CastSamples::Audited);
        let uniform = CastingUniform { samples: samples.code(), keeps, step: step.unwrap_or_default(), ..*casting };
        buffers.casting().write(queue, slot, samples.index(), &uniform);
    }
}
