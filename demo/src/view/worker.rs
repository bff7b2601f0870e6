//! The renderer behind the window, on a thread and a device of its own: however long a frame, a compilation or a reference takes,
//! the window answers.
//!
//! The window says what it wants, not what to do: the thread compares that with what it has, and does the most urgent thing that
//! is missing, one frame at a time. So nothing queues up while a slider moves.

use crate::host::gpu::{self, Gpu};
use crate::host::raster::node_camera;
use crate::host::{self, Host, HostError, Options, Sent, Shot};
use crate::measure::reference::{self, MovedFrames};
use crate::measure::stats::Stats;
use crate::pass_kind;
use crate::picture::Picture;
use crate::scene::open::open;
use crate::scene::{Camera, Scene, Sun};
use deferred_aa::rays::RayTier;
use deferred_aa::{DebugView, DeferredAa, Pass, Settings, Technique, TextureTier};
use glam::Vec3;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// What is opened, by [`open`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    /// A built-in scene or a file.
    pub name: String,
    /// Of a file with several.
    pub index: Option<usize>,
}

/// The lights, as the user has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lights {
    /// How often the light loop runs, from 1.
    pub stall: u32,
    /// The scene's first lights that shine; all if more than there are.
    pub count: u32,
    /// In place of the scene's own.
    pub sun: Option<Sun>,
}

/// What the reference is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// None, and no quality.
    Off,
    /// Full supersampling at this m: what the technique left out.
    #[default]
    Grid,
    /// 8 × 8 samples a pixel.
    Truth64,
    /// 16 × 16.
    Truth256,
    /// 32 × 32.
    Truth1024,
}

impl Reference {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Off, Self::Grid, Self::Truth64, Self::Truth256, Self::Truth1024];

    /// On the screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Grid => "full supersampling at this m",
            Self::Truth64 => "truth, 64 samples a pixel",
            Self::Truth256 => "truth, 256 samples a pixel",
            Self::Truth1024 => "truth, 1024 samples a pixel",
        }
    }

    /// Samples along one side of a pixel: a multiple of m.
    fn side(self, m: u32) -> Option<u32> {
        let side = match self {
            Self::Off => return None,
            Self::Grid => m,
            Self::Truth64 => 8,
            Self::Truth256 => 16,
            Self::Truth1024 => 32,
        };
        Some(side.next_multiple_of(m))
    }
}

/// All that a picture depends on but its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Counts up with every scene that is opened.
    pub opening: u64,
    /// What is fixed for a node.
    pub options: Options,
    /// What shines.
    pub lights: Lights,
    /// From where.
    pub camera: Camera,
}

/// What the window wants.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// The scene, and how many were opened.
    pub scene: (Source, u64),
    /// What to look at, once the scene is there.
    pub view: Option<View>,
    /// What is on either side of the divider.
    pub sides: [Option<Settings>; 2],
    /// Frames to measure of each.
    pub frames: u32,
    /// What they are held against.
    pub reference: Reference,
    /// Nothing is rendered while the window is not seen.
    pub paused: bool,
    /// The thread ends.
    pub quit: bool,
}

/// A picture, and what it cost.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// Of what.
    pub view: Arc<View>,
    /// By what.
    pub settings: Settings,
    /// The target.
    pub picture: Arc<Picture>,
    /// What is compared: the picture, or where a debug view is shown, the picture that it is of.
    pub shot: Shot,
    /// The plan's words, row by row; empty where the technique has none.
    pub plan: Arc<Vec<u32>>,
    /// Everything that is counted, as `render` writes it.
    pub stats: Option<Arc<Stats>>,
    /// The passes of the frame, and those that it would pay for if its scene called for every effect.
    pub passes: [Vec<Pass>; 2],
}

/// What the thread says.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are a few a second")]
pub enum Event {
    /// A scene is there. The old one is gone.
    Opened(Box<Opened>),
    /// It could not be opened: the old one stays.
    NotOpened(u64, String),
    /// A side's picture.
    Picture(usize, Box<Rendered>),
    /// A further frame of the same, measured.
    Measured(usize, Arc<View>, Settings, Shot),
    /// The rays that each sample of a side's picture sent, as [`Host::sent`] has them.
    Sent(usize, Arc<View>, Settings, Arc<Vec<Sent>>),
    /// A side's settings were refused; its last picture stays.
    Refused(usize, Settings, String),
    /// Parts of the reference that are done, of all.
    Progress(u32, u32),
    /// The reference.
    Reference(Arc<View>, Settings, Arc<Picture>),
    /// What is under way, "" if nothing.
    Busy(&'static str),
    /// The device was lost and is there again.
    Recovered(String),
    /// The node can't be built as wanted: the old one stays.
    NotBuilt(Options, String),
    /// Nothing can be rendered any more.
    Failed(String),
}

/// What the window must know of a scene.
#[derive(Debug)]
pub struct Opened {
    /// Which one this is.
    pub opening: u64,
    /// As given.
    pub source: Source,
    /// Its views, the default one first.
    pub cameras: Vec<Camera>,
    /// Half the diagonal of its box, metres.
    pub radius: f32,
    /// Lights but the sun.
    pub lights: u32,
    /// Its sun.
    pub sun: Option<Sun>,
    /// What was ignored, replaced or repaired.
    pub notices: Vec<String>,
    /// Who renders.
    pub adapter: Adapter,
    /// On what.
    #[cfg(test)]
    pub device: wgpu::Device,
}

/// Who renders, and what it can't.
#[derive(Debug, Clone, Default)]
pub struct Adapter {
    /// As the driver says.
    pub name: String,
    /// What the binding tier lacks; nothing if it is there.
    pub no_bindings: Option<String>,
    /// What the ray query lacks.
    pub no_ray_query: Option<String>,
    /// Without them no goal in milliseconds.
    pub has_timestamps: bool,
    /// The longest side of a G-buffer.
    pub longest: u32,
}

#[derive(Debug)]
struct Shared {
    wanted: Mutex<Wanted>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Wanted> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The thread's handle. Dropped, it ends the thread after the frame under way.
#[derive(Debug)]
pub struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts it. `wake` is called after each event.
    pub fn start(
        wanted: Wanted,
        options: Options,
        adapter: Option<String>,
        events: Sender<Event>,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared { wanted: Mutex::new(wanted), changed: Condvar::new() });
        let own = shared.clone();
        let thread = std::thread::Builder::new().name("renderer".to_owned()).spawn(move || {
            super::step_back();
            let say = move |event| {
                // The window may be gone.
                let _ = events.send(event);
                wake();
            };
            Renderer::new(own, options, adapter, Box::new(say)).run();
        })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Says what is wanted from now on.
    pub fn want(&self, change: impl FnOnce(&mut Wanted)) {
        change(&mut self.shared.lock());
        self.shared.changed.notify_one();
    }

    /// Whether it ended.
    pub fn ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.want(|wanted| wanted.quit = true);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The mean of moved frames.
struct Slices {
    view: Arc<View>,
    settings: Settings,
    kind: Reference,
    frames: MovedFrames,
}

/// What a side has.
struct Side {
    view: Arc<View>,
    settings: Settings,
    measured: u32,
    /// There are rays, and which sample sends them is not said yet.
    owes_rays: bool,
}

struct Renderer {
    shared: Arc<Shared>,
    say: Box<dyn Fn(Event)>,
    adapter: Option<String>,
    options: Options,
    host: Option<Host>,
    /// Of the host's scene, and of the last one tried.
    opening: u64,
    tried: u64,
    /// Options that could not be had, so that they are not tried again and again.
    refused: Option<Options>,
    lights: Option<Lights>,
    own_sun: Option<Sun>,
    sides: [Option<Side>; 2],
    /// Whose G-buffer is there.
    filled: Option<Arc<View>>,
    slices: Option<Slices>,
    finished: Option<(Arc<View>, Settings, Reference)>,
    busy: &'static str,
    recoveries: u32,
}

/// Devices that are lost once more without a frame between.
const MOST_RECOVERIES: u32 = 3;

impl Renderer {
    fn new(shared: Arc<Shared>, options: Options, adapter: Option<String>, say: Box<dyn Fn(Event)>) -> Self {
        Self {
            shared,
            say,
            adapter,
            options,
            host: None,
            opening: 0,
            tried: 0,
            refused: None,
            lights: None,
            own_sun: None,
            sides: [None, None],
            filled: None,
            slices: None,
            finished: None,
            busy: "",
            recoveries: 0,
        }
    }

    fn run(&mut self) {
        loop {
            let wanted = self.shared.lock().clone();
            if wanted.quit {
                return;
            }
            match self.step(&wanted) {
                Ok(true) => {}
                Ok(false) => {
                    self.busy("");
                    let mut guard = self.shared.lock();
                    while same(&guard, &wanted) && !guard.quit {
                        guard = self.shared.changed.wait(guard).unwrap_or_else(PoisonError::into_inner);
                    }
                }
                Err(lost) => match self.recover(&lost) {
                    Ok(()) => (self.say)(Event::Recovered(lost)),
                    Err(e) => {
                        (self.say)(Event::Failed(format!("{lost}; and it could not be had again: {e}")));
                        return;
                    }
                },
            }
        }
    }

    fn busy(&mut self, with: &'static str) {
        if self.busy != with {
            self.busy = with;
            (self.say)(Event::Busy(with));
        }
    }

    /// The most urgent thing; whether there was one. An error is a lost device.
    fn step(&mut self, wanted: &Wanted) -> Result<bool, String> {
        if wanted.scene.1 != self.tried {
            self.tried = wanted.scene.1;
            self.busy("opening");
            self.open(&wanted.scene.0, wanted.scene.1)?;
            return Ok(true);
        }
        let Some(view) = wanted.view.as_ref().filter(|view| view.opening == self.opening && !wanted.paused) else {
            return Ok(false);
        };
        if self.host.is_none() {
            return Ok(false);
        }
        if view.options != self.options && self.refused != Some(view.options) {
            self.busy("building");
            self.rebuild(view.options)?;
            return Ok(true);
        }
        let view = View { options: self.options, ..view.clone() };
        if self.lights != Some(view.lights) {
            self.light(view.lights);
        }
        let view = match &self.filled {
            Some(filled) if **filled == view => filled.clone(),
            _ => Arc::new(view),
        };
        for side in 0..2 {
            let Some(settings) = wanted.sides[side] else { continue };
            let has = self.sides[side].as_ref().is_some_and(|s| *s.view == *view && s.settings == settings);
            if !has {
                self.render(side, view, settings)?;
                return Ok(true);
            }
        }
        // The sides in turn, so that they are measured alike.
        let measures = |side: &usize| wanted.sides[*side].is_some() && self.measured(*side) < wanted.frames;
        if let Some(side) = (0..2).filter(measures).min_by_key(|&side| self.measured(side)) {
            self.busy("measuring");
            self.measure(side)?;
            return Ok(true);
        }
        let owes =
            |side: &usize| wanted.sides[*side].is_some() && self.sides[*side].as_ref().is_some_and(|s| s.owes_rays);
        if let Some(side) = (0..2).find(owes) {
            self.busy("counting rays");
            self.count_rays(side)?;
            return Ok(true);
        }
        let Some(base) = wanted.sides[0].or(wanted.sides[1]) else { return Ok(false) };
        self.slice(view, reference::truth(base), wanted.reference)
    }

    fn measured(&self, side: usize) -> u32 {
        self.sides[side].as_ref().map_or(0, |s| s.measured)
    }

    fn open(&mut self, source: &Source, opening: u64) -> Result<(), String> {
        let no = |renderer: &Self, e: String| {
            (renderer.say)(Event::NotOpened(opening, e));
            Ok(())
        };
        let scene = match open(&source.name, source.index) {
            Ok(scene) => scene,
            Err(e) => return no(self, e.to_string()),
        };
        let own_sun = scene.sun;
        let host = match self.host_of(scene, self.options) {
            Ok(host) => host,
            Err(e) => return no(self, e),
        };
        let notices = host.scene.notices.iter().chain(&host.uploaded.notices).cloned().collect();
        let own = host.scene.default_camera();
        let others = host.scene.cameras.iter().copied().filter(|c| *c != own);
        let opened = Opened {
            opening,
            source: source.clone(),
            cameras: std::iter::once(own).chain(others).collect(),
            radius: host.scene.bounds().map_or(1.0, |b| b.radius()),
            lights: host.uploaded.light_count,
            sun: own_sun,
            notices,
            adapter: about(&host.gpu),
            #[cfg(test)]
            device: host.gpu.device.clone(),
        };
        self.own_sun = own_sun;
        self.opening = opening;
        self.take(host);
        (self.say)(Event::Opened(Box::new(opened)));
        Ok(())
    }

    fn host_of(&self, scene: Scene, options: Options) -> Result<Host, String> {
        let descriptor = host::descriptor(options.m, options.textures, options.rays);
        let adapter = match &self.host {
            Some(host) => host.gpu.adapter.clone(),
            None => gpu::choose(self.adapter.as_deref()).map_err(|e| e.to_string())?,
        };
        let gpu = Gpu::new(adapter, &descriptor).map_err(|e| e.to_string())?;
        Host::new(gpu, scene, options).map_err(|e| e.to_string())
    }

    fn take(&mut self, host: Host) {
        self.options = host.options;
        self.host = Some(host);
        self.lights = None;
        self.refused = None;
        self.forget();
    }

    /// What was rendered before.
    fn forget(&mut self) {
        self.sides = [None, None];
        self.filled = None;
        self.slices = None;
        self.finished = None;
    }

    fn rebuild(&mut self, options: Options) -> Result<(), String> {
        let Some(host) = &mut self.host else { return Ok(()) };
        let built = if (Options { width: options.width, height: options.height, ..self.options }) == options {
            // The node stays.
            let resized = host.resize(options.width, options.height).map_err(lost_or);
            match resized {
                Ok(()) => {
                    self.options = options;
                    self.forget();
                    return Ok(());
                }
                Err(e) => Err(e?),
            }
        } else {
            let scene = host.scene.clone();
            self.host_of(scene, options)
        };
        match built {
            Ok(host) => self.take(host),
            Err(e) => {
                self.refused = Some(options);
                (self.say)(Event::NotBuilt(options, e));
            }
        }
        Ok(())
    }

    fn light(&mut self, lights: Lights) {
        if let Some(host) = &mut self.host {
            host.set_stall(lights.stall);
            host.set_light_count(lights.count);
            host.set_sun(lights.sun.or(self.own_sun));
            self.lights = Some(lights);
        }
    }

    fn render(&mut self, side: usize, view: Arc<View>, settings: Settings) -> Result<(), String> {
        let ready = self.host.as_ref().is_some_and(|host| host.is_ready(settings));
        self.busy(if ready { "rendering" } else { "compiling" });
        let fresh = self.filled.as_ref().is_none_or(|filled| *filled != view);
        let Some(host) = &mut self.host else { return Ok(()) };
        let shot = if fresh { host.frame(&view.camera, settings) } else { host.shade_again(&view.camera, settings) };
        self.sides[side] = Some(Side { view: view.clone(), settings, measured: 0, owes_rays: false });
        let shot = match shot.map_err(lost_or) {
            Ok(shot) => shot,
            Err(e) => {
                (self.say)(Event::Refused(side, settings, e?));
                return Ok(());
            }
        };
        self.filled = Some(view.clone());
        self.recoveries = 0;
        if let Some(own) = &mut self.sides[side] {
            own.owes_rays = settings.goal.is_none() && casts(&shot) != [false; 2];
        }
        let planned = !matches!(settings.technique, Technique::Full | Technique::Single);
        let rendered = Rendered {
            picture: Arc::new(host.picture()),
            plan: Arc::new(if planned { host.plan() } else { Vec::new() }),
            stats: Stats::new(host, settings, std::slice::from_ref(&shot), None).map(Arc::new),
            passes: [host.passes(&settings), host.passes(&every_effect(settings))],
            view,
            settings,
            shot,
        };
        (self.say)(Event::Picture(side, Box::new(rendered)));
        Ok(())
    }

    fn measure(&mut self, side: usize) -> Result<(), String> {
        let (Some(host), Some(own)) = (&mut self.host, &mut self.sides[side]) else { return Ok(()) };
        own.measured += 1;
        // With its G-buffer, whose time counts too.
        match host.frame(&own.view.camera, own.settings) {
            Ok(shot) => (self.say)(Event::Measured(side, own.view.clone(), own.settings, shot)),
            // What was refused has been said with the picture.
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// The same frame once more, that shows its rays and so writes them down.
    fn count_rays(&mut self, side: usize) -> Result<(), String> {
        let (Some(host), Some(own)) = (&mut self.host, &mut self.sides[side]) else { return Ok(()) };
        own.owes_rays = false;
        let settings = Settings { view: DebugView::Rays, ..own.settings };
        let fresh = self.filled.as_ref() != Some(&own.view);
        let camera = &own.view.camera;
        let shot = if fresh { host.frame(camera, settings) } else { host.shade_again(camera, settings) };
        match shot {
            Ok(shot) => {
                self.filled = Some(own.view.clone());
                let sent = Arc::new(host.sent(casts(&shot)));
                (self.say)(Event::Sent(side, own.view.clone(), own.settings, sent));
            }
            // Twice the memory may be too much; the picture is there.
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// Renders one more frame of the reference; whether there was one to render.
    fn slice(&mut self, view: Arc<View>, settings: Settings, kind: Reference) -> Result<bool, String> {
        let m = view.options.m;
        let Some(side) = kind.side(m) else { return Ok(false) };
        if self.finished.as_ref().is_some_and(|(v, s, k)| *v == view && *s == settings && *k == kind) {
            return Ok(false);
        }
        let (width, height) = (view.options.width, view.options.height);
        let fits = |s: &Slices| s.view == view && s.settings == settings && s.kind == kind;
        if !self.slices.as_ref().is_some_and(fits) {
            let frames = MovedFrames::new((width, height), side, m);
            self.slices = Some(Slices { view: view.clone(), settings, kind, frames });
        }
        self.busy("computing the reference");
        let (Some(host), Some(slices)) = (&mut self.host, &mut self.slices) else { return Ok(false) };
        let moved = slices.frames.moved(node_camera(&view.camera, width, height));
        self.filled = None;
        if let Err(e) = host.frame_with(moved, settings).map_err(lost_or) {
            let e = e?;
            self.finished = Some((view, settings, kind));
            self.slices = None;
            (self.say)(Event::Refused(0, settings, format!("the reference: {e}")));
            return Ok(true);
        }
        slices.frames.add(&host.picture());
        let (done, all) = slices.frames.progress();
        (self.say)(Event::Progress(done, all));
        if done == all {
            let picture = slices.frames.mean();
            self.finished = Some((view.clone(), settings, kind));
            self.slices = None;
            (self.say)(Event::Reference(view, settings, Arc::new(picture)));
        }
        Ok(true)
    }

    /// A device in place of one that is gone.
    fn recover(&mut self, lost: &str) -> Result<(), String> {
        self.recoveries += 1;
        if self.recoveries > MOST_RECOVERIES {
            return Err(format!("{lost}, {MOST_RECOVERIES} times in a row"));
        }
        let Some(host) = self.host.take() else { return Err("there is no scene".to_owned()) };
        let scene = host.scene.clone();
        drop(host);
        let host = self.host_of(scene, self.options)?;
        self.take(host);
        Ok(())
    }
}

/// Whether a frame casts shadow rays, and others.
pub fn casts(shot: &Shot) -> [bool; 2] {
    let any = |is: fn(&str) -> bool| shot.statistics.passes.iter().any(|pass| is(pass.name));
    [any(pass_kind::traces_shadows), any(pass_kind::bounces)]
}

/// What settings would record if every effect were called for.
fn every_effect(settings: Settings) -> Settings {
    use deferred_aa::Effect::On;
    Settings { shadows: On, reflections: On, refraction: On, ..settings }
}

/// A lost device ends the step; anything else is a message.
fn lost_or(e: HostError) -> Result<String, String> {
    if e.is_loss() { Err(e.to_string()) } else { Ok(e.to_string()) }
}

/// Whether both want the same.
pub fn same(a: &Wanted, b: &Wanted) -> bool {
    (&a.scene, &a.view, &a.sides, a.frames, a.reference, a.paused)
        == (&b.scene, &b.view, &b.sides, b.frames, b.reference, b.paused)
}

fn about(gpu: &Gpu) -> Adapter {
    let lacks = |textures, rays| {
        let missing = DeferredAa::requirements(&gpu.adapter, &host::descriptor(4, textures, rays)).missing;
        (!missing.is_empty()).then(|| missing.join(", "))
    };
    Adapter {
        name: gpu.adapter.get_info().name,
        no_bindings: lacks(TextureTier::Bindings, RayTier::Software),
        no_ray_query: lacks(TextureTier::Arrays, RayTier::Query),
        has_timestamps: gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        longest: gpu.device.limits().max_texture_dimension_2d,
    }
}

/// The direction towards a sun: azimuth from +x towards +z, elevation above the horizon, degrees.
pub fn to_sun(azimuth: f32, elevation: f32) -> Vec3 {
    let (a, e) = (azimuth.to_radians(), elevation.to_radians());
    Vec3::new(a.cos() * e.cos(), e.sin(), a.sin() * e.cos())
}

/// What a debug view shows is no image to judge.
pub fn is_image(settings: &Settings) -> bool {
    settings.view == DebugView::Image
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    /// A device that is lost as soon as it is there is not asked for for ever.
    #[test]
    fn recoveries_end() {
        let wanted = Wanted {
            scene: (Source::default(), 0),
            view: None,
            sides: [None, None],
            frames: 0,
            reference: Reference::Off,
            paused: false,
            quit: false,
        };
        let shared = Arc::new(Shared { wanted: Mutex::new(wanted), changed: Condvar::new() });
        let (say, _events) = channel();
        let options = Options {
            width: 8,
            height: 8,
            m: 1,
            textures: TextureTier::Arrays,
            stall: 1,
            anisotropy: 1,
            rays: RayTier::Software,
        };
        let mut renderer = Renderer::new(shared, options, None, Box::new(move |event| drop(say.send(event))));
        renderer.open(&Source { name: "empty".to_owned(), index: None }, 1).unwrap();
        for _ in 0..MOST_RECOVERIES {
            assert_eq!(renderer.recover("gone"), Ok(()));
        }
        assert!(renderer.recover("gone").unwrap_err().contains("3 times in a row"));
    }
}
