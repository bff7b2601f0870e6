//! What every part of a report works with: the device, the scene, the folder, the user who may be waiting or stop it.

use super::ReportError;
use super::fingerprint::Fingerprint;
use super::folder::{Folder, Subject};
use crate::host::gpu::Gpu;
use crate::host::raster::node_camera;
use crate::host::{self, Host, Options, Shot};
use crate::measure::stats::Adapter;
use crate::scene::{Camera, Scene};
use deferred_aa::rays::RayTier;
use deferred_aa::{GBufferTier, Settings, TextureTier};
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a report is asked for.
#[derive(Debug, Clone)]
pub struct Request {
    /// The command line as it was typed.
    pub command: String,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Sides of windows, each once.
    pub ms: Vec<u32>,
    /// Names of [`super::plan::TECHNIQUES`] and [`super::plan::PEERS`].
    pub techniques: Vec<&'static str>,
    /// How often the light loop runs.
    pub stall: u32,
    /// Fewer settings, samples and points.
    pub quick: bool,
    /// Measured frames of each entry.
    pub frames: u32,
    /// How textures are reached.
    pub textures: TextureTier,
    /// The tier that traces rays.
    pub rays: RayTier,
    /// The kind of G-buffer; each scene has the best of it.
    pub gbuffer: GBufferTier,
    /// Anisotropy of texture reads, 1 to 16.
    pub anisotropy: u16,
    /// Objects that the focused rows of the papers' tables are about; the one in the middle if there is none.
    pub focus: Vec<u16>,
    /// The settings that entries have in common.
    pub base: Settings,
    /// Whether to take up what is finished in the folder.
    pub resume: bool,
    /// The folder where truths are kept; the user's cache folder if not given.
    pub cache: Option<PathBuf>,
}

impl Request {
    /// What its report is of.
    pub fn subject(&self, scene: &Scene) -> Subject {
        let Self { command, width, height, stall, .. } = self;
        Subject { command: command.clone(), scene: scene.name.clone(), width: *width, height: *height, stall: *stall }
    }
}

/// The share of a part in the seconds of a whole report, about: as measured on Sponza and atrium.
fn part_weight(part: &str) -> f64 {
    match part {
        "m = 1" => 1.0,
        "m = 2" => 6.0,
        "m = 3" => 10.0,
        part if part.starts_with("m = ") => 20.0,
        "truth" | "papers" => 15.0,
        "bounds" => 2.0,
        "flicker" => 25.0,
        "executions" => 12.0,
        "goals" => 8.0,
        "cost: stall" => 9.0,
        part if part.starts_with("cost") => 3.0,
        "page" => 0.5,
        _ => 4.0,
    }
}

/// A report under way.
#[derive(Debug)]
pub struct Session {
    /// The request.
    pub request: Request,
    /// The device.
    pub gpu: Gpu,
    /// The scene.
    pub scene: Scene,
    /// The camera that the scene is seen from.
    pub view: Camera,
    /// The folder for results.
    pub folder: Folder,
    /// The hash of what all results depend on.
    pub fingerprint: Fingerprint,
    /// The seconds that parts took.
    pub seconds: BTreeMap<String, f64>,
    bar: ProgressBar,
    parts: Vec<String>,
    done: BTreeSet<String>,
    /// Parts that rendered something, and were not taken up from an earlier run.
    worked: BTreeSet<String>,
    /// Whether the notices about the scene were said.
    noted: AtomicBool,
}

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C ends the report after the frame under way, and a second one at once.
pub fn stop_on_interrupt() {
    // Fails where a handler is set already: then that one rules.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
}

impl Session {
    /// A session with these parts of work to come, the page last.
    pub fn new(request: Request, gpu: Gpu, scene: Scene, view: Camera, folder: Folder, parts: Vec<String>) -> Self {
        let mut fingerprint = Fingerprint::of_scene(&scene);
        let adapter = Adapter::of(&gpu);
        let Settings { shadows, reflections, refraction, .. } = request.base;
        fingerprint.text(&(shadows, reflections, refraction, request.rays, request.gbuffer));
        fingerprint.text(&(view, request.width, request.height, request.anisotropy, request.textures, adapter));
        // Hidden where stderr is no terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} [{elapsed}] {prefix}{msg}, frame {pos}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self {
            request,
            gpu,
            scene,
            view,
            folder,
            fingerprint,
            seconds: BTreeMap::new(),
            bar,
            parts,
            done: BTreeSet::new(),
            worked: BTreeSet::new(),
            noted: AtomicBool::new(false),
        }
    }

    /// Runs a part of the report, times it and shows its name.
    pub fn part<T>(
        &mut self,
        name: &str,
        run: impl FnOnce(&mut Self) -> Result<T, ReportError>,
    ) -> Result<T, ReportError> {
        let start = Instant::now();
        let place = self.parts.iter().position(|part| part == name).map_or(0, |i| i + 1);
        let to_go = self.to_go(place).map_or(String::new(), |left| format!(", {left}"));
        let line = format!("{place}/{} {name}{to_go}", self.parts.len());
        if self.bar.is_hidden() {
            eprintln!("{line}");
        }
        self.bar.set_message(line);
        self.bar.set_position(0);
        let result = run(self);
        *self.seconds.entry(name.to_owned()).or_default() += start.elapsed().as_secs_f64();
        if result.is_ok() {
            self.done.insert(name.to_owned());
        }
        if self.bar.position() > 0 {
            self.worked.insert(name.to_owned());
        }
        result
    }

    /// About how long the parts from `place` on will take, by what those before took. `None` before any is done.
    fn to_go(&self, place: usize) -> Option<String> {
        let done = self.parts.iter().take(place.saturating_sub(1)).filter(|part| self.worked.contains(*part));
        let (weight, seconds) = done.fold((0.0, 0.0), |(weight, seconds), part| {
            (weight + part_weight(part), seconds + self.seconds.get(part).copied().unwrap_or(0.0))
        });
        let left: f64 = self.parts.iter().skip(place.saturating_sub(1)).map(|part| part_weight(part)).sum();
        (weight > 0.0).then(|| match left * seconds / weight {
            seconds if seconds < 90.0 => format!("about {:.0} s to go", seconds.max(1.0)),
            seconds => format!("about {:.0} min to go", seconds / 60.0),
        })
    }

    /// Whether this part of work is to be done.
    pub fn wants(&self, part: &str) -> bool {
        self.parts.iter().any(|p| p == part)
    }

    /// The parts that were not finished, but for the entries, which have names of their own, and the page.
    pub fn left(&self) -> impl Iterator<Item = String> {
        let counts = |part: &&String| !part.starts_with("m = ") && *part != "page" && !self.done.contains(*part);
        self.parts.iter().filter(counts).cloned()
    }

    /// The camera as the node takes it, at the request's size.
    pub fn camera(&self) -> deferred_aa::Camera {
        node_camera(&self.view, self.request.width, self.request.height)
    }

    /// A host of the scene as it is.
    pub fn host(&self, m: u32) -> Result<Host, ReportError> {
        let Request { width, height, .. } = self.request;
        self.host_of(self.scene.clone(), m, (width, height))
    }

    /// A host of a variant of the scene, at another size.
    pub fn host_of(&self, scene: Scene, m: u32, (width, height): (u32, u32)) -> Result<Host, ReportError> {
        let Request { textures, stall, anisotropy, rays, gbuffer, .. } = self.request;
        let gbuffer = host::gbuffer_for(gbuffer, &scene, &self.gpu.adapter, textures, Some(rays));
        let options = Options { width, height, m, textures, stall, anisotropy, rays, traces: true, gbuffer };
        let host = Host::new(self.gpu.clone(), scene, options)?;
        if !self.noted.swap(true, Ordering::Relaxed) {
            host.scene.notices.iter().chain(&host.uploaded.notices).for_each(|notice| self.note(notice));
        }
        Ok(host)
    }

    /// A frame, unless the user wants no more.
    pub fn frame(&self, host: &mut Host, settings: Settings) -> Result<Shot, ReportError> {
        self.tick()?;
        Ok(host.frame(&self.view, settings)?)
    }

    /// One step done; an error where the user wants no more.
    pub fn tick(&self) -> Result<(), ReportError> {
        self.bar.inc(1);
        if STOP.load(Ordering::Relaxed) { Err(ReportError::Interrupted) } else { Ok(()) }
    }

    /// A line on stderr.
    pub fn note(&self, text: &str) {
        self.bar.suspend(|| eprintln!("note: {text}"));
    }

    /// The bar goes.
    pub fn done(&self) {
        self.bar.finish_and_clear();
    }

    /// No GPU: only ratios of times count, and sizes are kept small.
    pub fn software(&self) -> bool {
        self.gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }
}
