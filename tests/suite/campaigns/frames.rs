//! Random settings, sizes, window sizes, scenes and needs, frame after frame in one process: no complaint of wgpu, finite
//! images, statistics that add up, and memory that comes back.

use super::random::Random;
use super::settings::settings;
use super::{Campaign, is_soak, resident};
use crate::harness::{Rig, SHOW_USER, Sample, noise, rgba8, target};
use deferred_aa::glam::Vec3;
use deferred_aa::{
    DeferredAa, Depth, Effect, Frame, GBufferTier, Goal, Ids, Needs, ObjectImportance, RecordError, Settings,
    Statistics, Technique, gbuffer, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use deferred_aa_demo::host::{Host, HostError, Options, gbuffer_for};
use deferred_aa_demo::scene::builtin;
use std::time::Duration;

pub const CAMPAIGN: Campaign = Campaign {
    name: "frames",
    share: 0.4,
    few: 4,
    // Software drivers take minutes to compile all that traces.
    limit: Duration::from_secs(1800),
    start: || {
        let mut memory = Flat::default();
        Box::new(move |seed| {
            let frames = session(seed);
            memory.check();
            frames
        })
    },
};

/// The most samples along a side.
const MOST_SAMPLES: u32 = 144;

/// The memory of the process, which grows with the first sessions and then no more.
#[derive(Default)]
struct Flat {
    sessions: u32,
    settled: u64,
}

impl Flat {
    /// Sessions after which all that is kept for good is there.
    const FIRST: u32 = 16;
    /// What allocators may keep of one session or another.
    const SLACK: u64 = 128 << 20;

    fn check(&mut self) {
        let Some(bytes) = resident().filter(|_| is_soak()) else { return };
        self.sessions += 1;
        if self.sessions <= Self::FIRST {
            self.settled = self.settled.max(bytes);
        }
        let Self { sessions, settled } = self;
        assert!(bytes <= *settled + Self::SLACK, "{bytes} bytes after {sessions} sessions, {settled} after the first");
    }
}

/// Something that renders frames of any size.
pub trait Stage {
    /// Settings that it can render, like these.
    fn adapt(&self, settings: Settings) -> Settings;
    fn m(&self) -> u32;
    fn node(&self) -> &DeferredAa;
    fn resize(&mut self, size: [u32; 2]);
    /// The statistics and the image of a frame.
    fn frame(&mut self, settings: Settings, extras: &Extras) -> Result<(Statistics, Vec<[f32; 4]>), RecordError>;
}

/// Frames of one node; returns how many. One node in 16 traces rays through a scene.
fn session(seed: u32) -> u64 {
    let mut random = Random::new(seed);
    if seed.is_multiple_of(16) || !is_soak() && seed == 4 {
        let visible = random.once_in(2);
        let frames = if is_soak() { 100 } else { 4 };
        run(&mut Traced::new(&mut random, visible), &mut random, frames)
    } else {
        let frames = if is_soak() { 1000 } else { 40 };
        run(&mut Plain::new(&mut random), &mut random, frames)
    }
}

fn run(stage: &mut dyn Stage, random: &mut Random, frames: u64) -> u64 {
    let held = at_rest(stage);
    let mut size = [5, 4];
    for _ in 0..frames {
        if random.once_in(4) {
            size = any_size(random, stage.m());
            stage.resize(size);
        }
        frame(stage, random, size);
    }
    assert_eq!(at_rest(stage), held, "bytes of the node");
    frames
}

/// A size of few samples; now and then a strip.
fn any_size(random: &mut Random, m: u32) -> [u32; 2] {
    let most = (MOST_SAMPLES / m).min(70);
    match random.below(8) {
        0 => [1, 1 + random.below(most)],
        1 => [1 + random.below(2 * most), 1 + random.below(9)],
        _ => [(); 2].map(|()| 1 + random.below(most)),
    }
}

/// What the node holds after the same frame of the same size.
fn at_rest(stage: &mut dyn Stage) -> [u64; 3] {
    // From another size, as one that stays keeps what earlier frames have added.
    stage.resize([4, 5]);
    stage.resize([5, 4]);
    let extras = Extras { exposure: 1.0, depth: None, checks: false, objects: Vec::new() };
    // What `Selective` and rays have once made stays.
    let (shadows, reflections) = (Effect::On, Effect::On);
    for technique in [Technique::Selective, Technique::Single] {
        let settings = Settings { technique, shadows, reflections, ..Default::default() };
        stage.frame(stage.adapt(settings), &extras).expect("a frame");
    }
    let memory = stage.node().memory();
    [memory.gbuffer, memory.scratch, memory.rays]
}

/// Renders a random frame and checks what came of it.
fn frame(stage: &mut dyn Stage, random: &mut Random, size: [u32; 2]) {
    let settings = stage.adapt(settings(random));
    let extras = Extras::new(random);
    let told = format!("m = {}, {size:?}, {settings:?}, {extras:?}", stage.m());
    let (statistics, image) = match stage.frame(settings, &extras) {
        Ok(shown) => shown,
        Err(refusal) => {
            assert!(is_expected(&refusal), "{refusal}: {told}");
            return;
        }
    };
    let bad = image.iter().position(|pixel| pixel.iter().any(|c| !c.is_finite()));
    assert_eq!(bad, None, "{told}");
    assert_adds_up(&statistics, &settings, (stage.m(), size), &told);
    // A goal changes the next frame's effort.
    if settings.goal.is_none() && random.once_in(4) {
        let (_, again) = stage.frame(settings, &extras).expect("a frame");
        assert!(again == image, "the same frame twice differs: {told}");
    }
}

/// Whether settings that lie in their ranges may still be refused for this.
fn is_expected(refusal: &RecordError) -> bool {
    matches!(refusal, RecordError::Shifted(_) | RecordError::Coarsest { .. })
}

/// What a frame has besides its settings.
#[derive(Debug)]
pub struct Extras {
    exposure: f32,
    /// The depth that the frame also writes, unless the host asks for its own.
    depth: Option<Depth>,
    checks: bool,
    objects: Vec<ObjectImportance>,
}

impl Extras {
    fn new(random: &mut Random) -> Self {
        let objects = random.below(4);
        Self {
            exposure: random.magnitude(0.01, 100.0),
            depth: random.pick(&[None, Some(Depth::Nearest), Some(Depth::Farthest), Some(Depth::First)]),
            checks: random.once_in(8),
            objects: (0..objects).map(|object| ObjectImportance { object, importance: random.unit() }).collect(),
        }
    }

    /// A view to write depth to.
    fn depth_view(&self, device: &wgpu::Device, target: &wgpu::Texture) -> wgpu::TextureView {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("depth"),
            size: target.size(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: gbuffer::DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        texture.create_view(&Default::default())
    }

    /// Records the frame with all of this.
    fn record(
        &self,
        aa: &mut DeferredAa,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), RecordError> {
        let view = self.depth_view(device, frame.target.texture());
        let mut frame = Frame { exposure: self.exposure, ..*frame };
        if frame.needs.depth.is_none() {
            frame.needs.depth = self.depth;
            frame.depth = self.depth.map(|_| &view);
        }
        if self.checks {
            aa.check_input(queue, encoder, &frame)?;
        }
        aa.record(queue, encoder, &frame)
    }
}

fn assert_adds_up(s: &Statistics, settings: &Settings, (m, [width, height]): (u32, [u32; 2]), told: &str) {
    let (pixels, n) = (u64::from(width * height), u64::from(m * m));
    let told = format!("{s:?}: {told}");
    assert_eq!(s.histogram_k.len() as u64, n, "{told}");
    let windows: u64 = s.histogram_k.iter().map(|&count| u64::from(count)).sum();
    let samples: u64 = (1..).zip(&s.histogram_k).map(|(k, &count)| k * u64::from(count)).sum();
    assert!((s.mean_k - s.shaded as f64 / pixels as f64).abs() < 1e-9, "{told}");
    assert!((s.ratio - s.mean_k / n as f64).abs() < 1e-9, "{told}");
    match settings.technique {
        Technique::Full => assert_eq!((s.shaded, windows), (pixels * n, pixels), "{told}"),
        Technique::Single => assert_eq!((s.shaded, windows), (pixels, pixels), "{told}"),
        Technique::Windowed => {
            assert_eq!(windows, pixels, "{told}");
            assert_eq!(s.decided.sum(), pixels, "{told}");
            let audits = matches!(settings.goal, Some(Goal::Error(_)));
            assert!(s.shaded == samples || audits && s.shaded >= samples, "{samples} planned, {told}");
        }
        Technique::Reconstructed | Technique::Selective => assert_eq!(windows, pixels, "{told}"),
        Technique::MultiResolution | Technique::Surfaces => assert!(windows <= pixels, "{told}"),
    }
}

// ---- Without rays ----

/// A synthetic G-buffer.
struct Plain {
    rig: Rig,
    seed: u32,
    target: wgpu::Texture,
}

impl Plain {
    fn new(random: &mut Random) -> Self {
        let rig = Rig::new(if is_soak() { 1 + random.below(8) } else { 2 }, 5, 4, SHOW_USER);
        let target = target(&rig.gpu, wgpu::TextureFormat::Rgba32Float, [5, 4]);
        Self { rig, seed: random.bits(), target }
    }
}

impl Stage for Plain {
    fn adapt(&self, settings: Settings) -> Settings {
        let (shadows, reflections, refraction) = (Effect::Off, Effect::Off, Effect::Off);
        Settings { shadows, reflections, refraction, ..settings }
    }

    fn m(&self) -> u32 {
        self.rig.aa.m()
    }

    fn node(&self) -> &DeferredAa {
        &self.rig.aa
    }

    fn resize(&mut self, [width, height]: [u32; 2]) {
        let Rig { gpu, aa, .. } = &mut self.rig;
        aa.resize(&gpu.device, width, height).expect("a size");
        self.target = target(gpu, wgpu::TextureFormat::Rgba32Float, [width, height]);
        let seed = self.seed;
        self.rig.fill(|x, y| busy(seed, x, y));
    }

    fn frame(&mut self, settings: Settings, extras: &Extras) -> Result<(Statistics, Vec<[f32; 4]>), RecordError> {
        let Rig { gpu, aa, camera, .. } = &mut self.rig;
        let view = self.target.create_view(&Default::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let needs = Needs { textured: &[0, 2], importance: &extras.objects, ..Default::default() };
        let frame = Frame { settings, needs, statistics: true, ..Frame::new(*camera, &view) };
        extras.record(aa, (&gpu.device, &gpu.queue), &mut encoder, &frame)?;
        gpu.queue.submit([encoder.finish()]);
        let image = bytemuck::pod_collect_to_vec(&gpu.read_texture(&self.target, 16));
        let statistics = aa.statistics().expect("statistics").clone();
        assert_eq!(gpu.take_errors(), Vec::<String>::new(), "{settings:?}");
        Ok((statistics, image))
    }
}

/// Planes, steps, curved normals, several materials, sky and noise.
fn busy(seed: u32, x: u32, y: u32) -> Sample {
    let object = 1 + x / 13 + y / 17 * 5;
    let of = |i: u32| noise(seed.wrapping_add(object * 8 + i));
    if of(0) < 0.15 {
        return Sample::SKY;
    }
    let [fx, fy] = [x as f32, y as f32];
    Sample {
        depth: 0.02 + 0.2 * of(1) + fx * 1e-5 * of(2),
        normal: Vec3::new((fx * of(3) * 0.1).sin(), (fy * of(4) * 0.1).cos() * 0.5, 1.0).normalize(),
        material: object % 3,
        object,
        user: rgba8(of(5), of(6), noise(x / 3 + y * 977), 1.0),
        ..Default::default()
    }
}

// ---- With rays ----

/// The demo's host with a random scene. Pipelines that trace take software drivers seconds to compile, so that all frames
/// of one have its technique and its kinds of rays.
pub struct Traced {
    pub host: Host,
    kinds: Settings,
}

impl Traced {
    pub fn new(random: &mut Random, visible: bool) -> Self {
        Self { host: host(random, visible), kinds: settings(random) }
    }
}

fn host(random: &mut Random, visible: bool) -> Host {
    let names = ["shadows", "mirrors", "cornell", "flat", "empty"];
    let scene = builtin::builtin(random.pick(&names[..if is_soak() { 5 } else { 2 }])).expect("built in");
    let m = 2;
    let adapter = crate::visibility::adapter();
    let wanted = if visible { GBufferTier::Visibility(Ids::Wide) } else { GBufferTier::default() };
    let [width, height] = any_size(random, m);
    let plain = Options { anisotropy: 4, ..Options::new(width, height, m) };
    let gbuffer = gbuffer_for(wanted, &scene, &adapter, plain.textures, plain.traced());
    let options = Options { gbuffer, ..plain };
    let gpu = Gpu::new(adapter, &options.descriptor()).expect("a device");
    Host::new(gpu, scene, options).expect("a host")
}

impl Stage for Traced {
    fn adapt(&self, settings: Settings) -> Settings {
        let Settings { technique, execution, shadows, reflections, refraction, .. } = self.kinds;
        Settings { technique, execution, shadows, reflections, refraction, ..settings }
    }

    fn m(&self) -> u32 {
        self.host.options.m
    }

    fn node(&self) -> &DeferredAa {
        &self.host.aa
    }

    fn resize(&mut self, [width, height]: [u32; 2]) {
        self.host.resize(width, height).expect("a size");
    }

    fn frame(&mut self, settings: Settings, extras: &Extras) -> Result<(Statistics, Vec<[f32; 4]>), RecordError> {
        let host = &mut self.host;
        let (camera, device) = (host.scene.default_camera(), host.gpu.device.clone());
        host.importance.clone_from(&extras.objects);
        let shot = host.frame_by(&camera, settings, |aa, queue, encoder, frame| {
            extras.record(aa, (&device, queue), encoder, frame)
        });
        match shot {
            Ok(statistics) => Ok((statistics, host.picture().rgba)),
            Err(HostError::Record(refusal)) => Err(refusal),
            Err(error) => panic!("{error}: {settings:?}"),
        }
    }
}
