//! The viewer without its window: what it shows, what it wants from the renderer, what becomes of what that says.

use super::dialog::{self, Dialog};
use super::judge::{Case, Judge, Verdict};
use super::kept::Kept;
use super::side::Side;
use super::worker::{Event, Lights, Opened, Reference, Source, View, Wanted, Worker, is_image};
use super::{controls, fly, rust_source};
use crate::host::Options;
use crate::picture::Picture;
use crate::scene::{Camera, Sun};
use crate::settings_file;
use deferred_aa::{DebugView, Settings};
use egui::{Context, Key, Modifiers, Ui};
use glam::Vec3;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Frames of each side that are measured.
const FRAMES: u32 = 5;

/// Most lines of the log.
const MOST_MESSAGES: usize = 200;

/// How far an arrow key moves the picture, in points.
const PAN: f32 = 40.0;

/// Of an open list, in points: all debug views at once.
const TALLEST: f32 = 600.0;

/// Of the zoom's buttons.
const ZOOM: &str = "Pixels of the screen for one of the picture. One that is larger than its place is moved by the arrow keys, or \
                    dragged with the right button.";

/// With what it starts.
#[derive(Debug, Clone)]
pub struct Start {
    /// What is opened.
    pub source: Source,
    /// In place of the scene's own camera.
    pub camera: Option<Camera>,
    /// What is fixed for the node.
    pub options: Options,
    /// Part of the adapter's name.
    pub adapter: Option<String>,
    /// What was remembered.
    pub kept: Kept,
    /// Where it is remembered.
    pub kept_at: Option<PathBuf>,
    /// The picture is as large as its place in the window.
    pub fill: bool,
}

/// A point of the plot of error against time.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// That gave it.
    pub settings: Settings,
    /// Samples along one side of a window.
    pub m: u32,
    /// Of the node's passes, milliseconds.
    pub ms: f64,
    /// PSNR against the reference.
    pub db: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// Samples a pixel.
    pub mean_k: f64,
}

/// Under way, in a process of its own.
struct Report {
    child: Child,
    folder: PathBuf,
    /// What it says is wrong, read as it comes, so that it never waits for a reader.
    errors: Option<JoinHandle<String>>,
}

/// The viewer.
pub struct App {
    worker: Worker,
    events: Receiver<Event>,
    judge: Judge,
    verdicts: Receiver<Verdict>,
    kept_at: Option<PathBuf>,
    /// Remembered.
    pub kept: Kept,
    /// Left and right of the divider.
    pub sides: [Side; 2],
    /// Whose settings the controls show.
    pub edited: usize,
    /// Only this side is shown.
    pub alone: Option<usize>,
    source: (Source, u64),
    /// The scene, once it is there.
    pub opened: Option<Opened>,
    /// From where it is seen.
    pub camera: Option<Camera>,
    /// No key and no drag moves the camera.
    pub frozen: bool,
    /// As wanted; the renderer may have others until it is done, or for good.
    pub options: Options,
    /// The picture is as large as its place in the window.
    pub fill: bool,
    /// Of that place, in pixels.
    pub place: [u32; 2],
    /// What shines.
    pub lights: Lights,
    /// What pictures are held against, once it is there.
    pub reference: Option<(Arc<View>, Settings, Arc<Picture>)>,
    /// Its frames that are done, of all.
    pub progress: Option<(u32, u32)>,
    /// Of this view and reference.
    pub tried: Vec<Tried>,
    tried_of: Option<(Arc<View>, Reference)>,
    /// The newest last.
    pub messages: Vec<String>,
    /// What the renderer is at.
    pub busy: &'static str,
    busy_since: Instant,
    /// Controls and costs are shown.
    pub panels: bool,
    /// Where a picture is wrong, in place of it.
    pub show_error: bool,
    /// Around the pointer.
    pub magnify: bool,
    /// Pixels of the screen for one of the picture; it fits its place if not given.
    pub scale: Option<f32>,
    /// How far its centre lies from that of its place, in points, where it is larger.
    pub pan: egui::Vec2,
    /// What is asked for in a window of its own.
    pub dialog: Option<Dialog>,
    report: Option<Report>,
    /// Nothing will be rendered any more, and why.
    pub failed: Option<String>,
    /// The window is not seen.
    pub hidden: bool,
    sent: Option<Box<Wanted>>,
    start_camera: Option<Camera>,
    hears: bool,
}

impl App {
    /// Starts the renderer. Nothing is shown before [`ui`](Self::ui).
    pub fn new(ctx: &Context, start: Start) -> std::io::Result<Self> {
        let Start { source, camera, options, adapter, kept, kept_at, fill } = start;
        let lights = kept.lights();
        let wanted = Wanted {
            scene: (source.clone(), 1),
            view: None,
            sides: [None, None],
            frames: FRAMES,
            reference: kept.reference,
            paused: false,
            quit: false,
        };
        let (say, events) = channel();
        let waker = ctx.clone();
        let worker = Worker::start(wanted, options, adapter, say, move || waker.request_repaint())?;
        let (say, verdicts) = channel();
        let waker = ctx.clone();
        let judge = Judge::start(say, move || waker.request_repaint())?;
        ctx.all_styles_mut(|style| {
            style.spacing.combo_height = TALLEST;
            style.spacing.default_area_size.y = TALLEST;
        });
        ctx.set_zoom_factor(kept.zoom);
        if let Some(dark) = kept.dark {
            ctx.set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
        }
        Ok(Self {
            worker,
            events,
            judge,
            verdicts,
            kept_at,
            sides: kept.settings.map(Side::new),
            kept,
            edited: 0,
            alone: None,
            source: (source, 1),
            opened: None,
            camera: None,
            frozen: false,
            options,
            fill,
            place: [options.width, options.height],
            lights,
            reference: None,
            progress: None,
            tried: Vec::new(),
            tried_of: None,
            messages: Vec::new(),
            busy: "opening",
            busy_since: Instant::now(),
            panels: true,
            show_error: false,
            magnify: false,
            scale: None,
            pan: egui::Vec2::ZERO,
            dialog: None,
            report: None,
            failed: None,
            hidden: false,
            sent: None,
            start_camera: camera,
            hears: true,
        })
    }

    /// A frame of the window.
    pub fn ui(&mut self, ui: &mut Ui) {
        self.receive(ui.ctx());
        self.watch_report(ui.ctx());
        self.keys(ui);
        egui::Panel::top("bar").show(ui, |ui| self.bar(ui));
        egui::Panel::bottom("log").show(ui, |ui| self.log(ui));
        if self.panels {
            // Large text must leave room for the picture: what a panel has no room for, it scrolls.
            let widest = ui.available_width() * 0.35;
            let [settings, cost] = [360f32, 380.0].map(|points| points.min(widest));
            let panel = egui::Panel::left("settings").default_size(settings).max_size(widest);
            panel.show(ui, |ui| self.settings(ui));
            egui::Panel::right("cost").default_size(cost).max_size(widest).show(ui, |ui| self.cost(ui));
        }
        egui::CentralPanel::default().show(ui, |ui| self.picture(ui));
        self.dialogs(ui);
        self.sync();
    }

    /// A line for the log.
    pub fn say(&mut self, message: impl Into<String>) {
        self.messages.push(message.into());
        if self.messages.len() > MOST_MESSAGES {
            self.messages.remove(0);
        }
    }

    /// Takes what the renderer and the judge have said.
    pub fn receive(&mut self, ctx: &Context) {
        while let Ok(event) = self.events.try_recv() {
            self.heard(ctx, event);
        }
        while let Ok(verdict) = self.verdicts.try_recv() {
            self.judged(ctx, &verdict);
        }
        if self.hears && self.worker.ended() {
            self.hears = false;
            if self.failed.is_none() {
                self.failed = Some("the renderer ended".to_owned());
            }
        }
    }

    pub(super) fn heard(&mut self, ctx: &Context, event: Event) {
        match event {
            Event::Opened(opened) => {
                for notice in &opened.notices {
                    self.messages.push(format!("note: {notice}"));
                }
                let camera = self.start_camera.take().or(opened.cameras.first().copied());
                self.camera = camera;
                self.lights.sun = None;
                self.reference = None;
                self.say(format!("opened {} on {}", opened.source.name, opened.adapter.name));
                self.opened = Some(*opened);
            }
            Event::NotOpened(opening, why) => {
                if let Some(opened) = self.opened.as_ref().filter(|_| opening == self.source.1) {
                    // The old scene stays.
                    self.source.0 = opened.source.clone();
                }
                self.say(format!("not opened: {why}"));
                self.dialog = Some(Dialog::Trouble("The scene could not be opened".to_owned(), why));
            }
            Event::Picture(side, rendered) => {
                let settings = rendered.settings;
                self.sides[side].show(ctx, ["left", "right"][side], rendered);
                if is_image(&settings) {
                    self.hold_against(side);
                }
            }
            Event::Measured(side, view, settings, shot) => {
                self.sides[side].measured(&view, &settings, shot);
                self.try_point(side);
            }
            Event::Sent(side, view, settings, sent) => self.sides[side].counted(&view, &settings, sent),
            Event::Refused(side, settings, why) => {
                if self.sides[side].settings == settings {
                    self.sides[side].refused = Some(why.clone());
                }
                self.say(format!("{}: {why}", ["left", "right"][side]));
            }
            Event::Progress(done, all) => self.progress = Some((done, all)),
            Event::Reference(view, settings, picture) => {
                self.reference = Some((view, settings, picture));
                self.progress = None;
                (0..2).for_each(|side| self.hold_against(side));
            }
            Event::Busy(with) => (self.busy, self.busy_since) = (with, Instant::now()),
            Event::Recovered(why) => self.say(format!("the graphics device was lost ({why}) and is there again")),
            Event::NotBuilt(options, why) => {
                if self.options == options {
                    self.say(format!("not possible: {why}"));
                    self.dialog = Some(Dialog::Trouble("The node can't be built so".to_owned(), why));
                }
            }
            Event::Failed(why) => {
                self.save();
                self.failed = Some(why);
            }
        }
    }

    /// Sends a side's picture to the judge, if the reference is of the same view.
    fn hold_against(&mut self, side: usize) {
        let (Some(rendered), Some((view, _, reference))) = (&self.sides[side].rendered, &self.reference) else {
            return;
        };
        if *rendered.view == **view && is_image(&rendered.settings) {
            let (picture, reference) = (rendered.picture.clone(), reference.clone());
            self.judge.measure(Case { side, picture, reference });
        }
    }

    fn judged(&mut self, ctx: &Context, verdict: &Verdict) {
        let side = verdict.case.side;
        let present = self.reference.as_ref().is_some_and(|(_, _, r)| Arc::ptr_eq(r, &verdict.case.reference));
        if present && self.sides[side].judged(ctx, ["left error", "right error"][side], verdict) {
            if let Err(why) = &verdict.quality {
                self.say(format!("no quality: {why}"));
            }
            self.try_point(side);
        }
    }

    /// The plot gains the side's point, or its newer figures.
    fn try_point(&mut self, side: usize) {
        let (Some(rendered), Some(quality)) = (&self.sides[side].rendered, self.sides[side].quality) else { return };
        let (Some(ms), Some(db), Some(flip)) = (self.sides[side].node_ms(), quality.psnr_db, quality.flip_mean) else {
            return;
        };
        let of = |view: &View| View { options: Options { m: 0, ..view.options }, ..view.clone() };
        let same = self
            .tried_of
            .as_ref()
            .is_some_and(|(view, kind)| of(view) == of(&rendered.view) && (*kind == self.kept.reference));
        if !same {
            self.tried.clear();
            self.tried_of = Some((rendered.view.clone(), self.kept.reference));
        }
        let (settings, m) = (rendered.settings, rendered.view.options.m);
        let point = Tried { settings, m, ms, db, flip, mean_k: rendered.shot.statistics.mean_k };
        match self.tried.iter_mut().find(|t| t.m == m && t.settings == settings) {
            Some(tried) => *tried = point,
            None => self.tried.push(point),
        }
    }

    /// Whether a side's picture is what its settings give, or was refused.
    pub fn shown_is_wanted(&self, side: usize) -> bool {
        let s = &self.sides[side];
        s.refused.is_some() || s.rendered.as_ref().is_some_and(|r| r.settings == s.settings)
    }

    /// Whether a side is to be seen.
    pub fn shows(&self, side: usize) -> bool {
        self.alone.map_or(self.kept.split || side == self.edited, |alone| alone == side)
    }

    /// Tells the renderer what is wanted, if that has changed.
    pub fn sync(&mut self) {
        let size = if self.fill { self.place } else { [self.options.width, self.options.height] };
        self.options = Options { width: size[0].max(1), height: size[1].max(1), ..self.options };
        let view = self.opened.as_ref().zip(self.camera).map(|(opened, camera)| View {
            opening: opened.opening,
            options: self.options,
            lights: self.lights,
            camera,
        });
        // Both are rendered where they can be flipped between.
        let wanted = |side: usize| {
            (self.kept.split || self.alone.is_some() || self.shows(side)).then_some(self.sides[side].settings)
        };
        let next = Wanted {
            scene: self.source.clone(),
            view,
            sides: [wanted(0), wanted(1)],
            frames: FRAMES,
            reference: self.kept.reference,
            paused: self.hidden,
            quit: false,
        };
        let same = self.sent.as_deref().is_some_and(|sent| super::worker::same(sent, &next));
        if !same {
            self.sent = Some(Box::new(next.clone()));
            self.worker.want(|wanted| *wanted = next);
        }
    }

    /// Opens a scene in place of the present one, which stays if that fails.
    pub fn open(&mut self, name: &str) {
        self.source = (Source { name: name.to_owned(), index: None }, self.source.1 + 1);
        self.say(format!("opening {name}"));
    }

    /// Of the scene that is shown.
    pub fn scene_name(&self) -> &str {
        self.opened.as_ref().map_or(&self.source.0.name, |opened| &opened.source.name)
    }

    /// What the renderer is at, and for how long where that makes one wonder.
    pub fn busy_text(&self) -> String {
        match self.busy_since.elapsed().as_secs() {
            0..3 => format!("{}…", self.busy),
            seconds => format!("{}… {seconds} s", self.busy),
        }
    }

    /// The sun that shines.
    pub fn sun(&self) -> Option<Sun> {
        self.lights.sun.or(self.opened.as_ref().and_then(|opened| opened.sun))
    }

    /// Remembers.
    pub fn save(&mut self) {
        self.kept.settings = [self.sides[0].settings, self.sides[1].settings];
        self.kept.m = self.options.m;
        self.kept.stall = self.lights.stall;
        self.kept.size = (!self.fill).then_some([self.options.width, self.options.height]);
        if let Some(path) = self.kept_at.clone()
            && let Err(e) = self.kept.save(&path)
        {
            self.say(format!("{}: {e}: nothing will be remembered", path.display()));
        }
    }

    fn keys(&mut self, ui: &Ui) {
        let ctx = ui.ctx();
        for file in ctx.input(|i| i.raw.dropped_files.clone()) {
            self.open(&file.path().to_string_lossy());
        }
        let pressed = |modifiers, key| ctx.input_mut(|i| i.consume_key(modifiers, key));
        if pressed(Modifiers::COMMAND, Key::O) {
            self.dialog = Some(dialog::open(self.scene_name()));
        }
        if pressed(Modifiers::COMMAND, Key::S) {
            self.dialog = Some(dialog::save_settings());
        }
        if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z) || pressed(Modifiers::COMMAND, Key::Y) {
            self.sides[self.edited].redo();
        }
        if pressed(Modifiers::COMMAND, Key::Z) {
            self.sides[self.edited].undo();
        }
        if pressed(Modifiers::NONE, Key::F1) {
            self.dialog = Some(Dialog::Keys);
        }
        // Without a dialog it closes a list.
        if self.dialog.is_some() && pressed(Modifiers::NONE, Key::Escape) {
            self.dialog = None;
        }
        if self.dialog.is_some() || ctx.egui_wants_keyboard_input() || ctx.memory(|m| m.focused().is_some()) {
            return;
        }
        if pressed(Modifiers::NONE, Key::Space) {
            self.alone = match self.alone {
                Some(side) => Some(1 - side),
                None => Some(1 - self.edited),
            };
        }
        if pressed(Modifiers::NONE, Key::B) {
            self.alone = None;
            self.kept.split = !self.kept.split;
        }
        for (key, by) in [(Key::OpenBracket, -0.02), (Key::CloseBracket, 0.02)] {
            if pressed(Modifiers::NONE, key) {
                self.kept.divider = (self.kept.divider + by).clamp(0.0, 1.0);
            }
        }
        for (key, by) in [
            (Key::ArrowLeft, egui::vec2(PAN, 0.0)),
            (Key::ArrowRight, egui::vec2(-PAN, 0.0)),
            (Key::ArrowUp, egui::vec2(0.0, PAN)),
            (Key::ArrowDown, egui::vec2(0.0, -PAN)),
        ] {
            if pressed(Modifiers::NONE, key) {
                self.pan += by;
            }
        }
        let switches = [
            (Key::F, &mut self.frozen),
            (Key::Z, &mut self.magnify),
            (Key::X, &mut self.show_error),
            (Key::P, &mut self.panels),
        ];
        for (key, value) in switches {
            if pressed(Modifiers::NONE, key) {
                *value = !*value;
            }
        }
        for (key, view) in
            [(Key::Num1, DebugView::Image), (Key::Num2, DebugView::Count), (Key::Num3, DebugView::Decided)]
        {
            if pressed(Modifiers::NONE, key) {
                let settings = Settings { view, ..self.sides[self.edited].settings };
                self.sides[self.edited].set(settings, "view");
            }
        }
        if pressed(Modifiers::NONE, Key::Home) {
            self.camera = self.opened.as_ref().and_then(|opened| opened.cameras.first().copied());
        }
        self.fly(ctx);
    }

    fn fly(&mut self, ctx: &Context) {
        let (Some(camera), Some(opened), false) = (self.camera, &self.opened, self.frozen) else { return };
        let way = ctx.input(|i| {
            let axis = |plus, minus| f32::from(i8::from(i.key_down(plus))) - f32::from(i8::from(i.key_down(minus)));
            let plain = !i.modifiers.command && !i.modifiers.alt;
            let way = Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
            // A window that slept must not jump.
            let seconds = i.stable_dt.min(0.1);
            if plain { way * seconds * if i.modifiers.shift { 4.0 } else { 1.0 } } else { Vec3::ZERO }
        });
        if way != Vec3::ZERO {
            self.camera = Some(fly::moved(camera, way * opened.radius * 0.25));
            ctx.request_repaint();
        }
    }

    fn bar(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Open…").on_hover_text("Ctrl+O, or drop a file").clicked() {
                self.dialog = Some(dialog::open(self.scene_name()));
            }
            ui.menu_button("Settings", |ui| {
                if ui.button("Save…   Ctrl+S").clicked() {
                    self.dialog = Some(dialog::save_settings());
                    ui.close();
                }
                if ui.button("Load…").clicked() {
                    self.dialog = Some(dialog::load_settings());
                    ui.close();
                }
                if ui.button("Copy as Rust").clicked() {
                    ui.ctx().copy_text(rust_source::of(&self.sides[self.edited].settings));
                    self.say("the settings are in the clipboard, as Rust");
                    ui.close();
                }
            });
            if ui.button("Save image…").clicked() {
                self.dialog = Some(dialog::save_image());
            }
            let running = self.report.is_some();
            let report = ui.add_enabled(!running, egui::Button::new("Report…"));
            if report.on_hover_text("Measures every technique on this view, in a process of its own").clicked() {
                self.dialog = Some(dialog::report());
            }
            ui.separator();
            let mut dark = ui.visuals().dark_mode;
            if ui.selectable_label(dark, "Dark").clicked() {
                dark = !dark;
                ui.ctx().set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
                self.kept.dark = Some(dark);
            }
            for (text, factor) in [("A−", 1.0 / 1.1), ("A+", 1.1)] {
                if ui.button(text).on_hover_text("Smaller or larger text: Ctrl+minus, Ctrl+plus").clicked() {
                    ui.ctx().set_zoom_factor((ui.ctx().zoom_factor() * factor).clamp(0.3, 4.0));
                }
            }
            self.kept.zoom = ui.ctx().zoom_factor().clamp(0.3, 4.0);
            if ui.button("Keys").on_hover_text("F1").clicked() {
                self.dialog = Some(Dialog::Keys);
            }
            ui.separator();
            for (scale, name) in [(None, "fit"), (Some(1.0), "1:1"), (Some(2.0), "2:1"), (Some(4.0), "4:1")] {
                let label = ui.selectable_label(self.scale == scale, name);
                if label.on_hover_text(ZOOM).clicked() {
                    self.scale = scale;
                }
            }
            ui.separator();
            ui.label(self.scene_name());
            if !self.busy.is_empty() {
                // Nothing that turns: where the CPU draws, that takes as much of it as the frame that is waited for.
                ui.label(self.busy_text());
                ui.ctx().request_repaint_after(Duration::from_millis(500));
            }
        });
    }

    fn log(&mut self, ui: &mut Ui) {
        if let Some(why) = &self.failed {
            ui.colored_label(
                ui.visuals().error_fg_color,
                format!("{why}. Settings are saved; start the viewer again."),
            );
        }
        let last = self.messages.last().map_or("", String::as_str);
        egui::CollapsingHeader::new(last).id_salt("messages").show(ui, |ui| {
            egui::ScrollArea::vertical().max_height(160.0).stick_to_bottom(true).show(ui, |ui| {
                for message in &self.messages {
                    ui.label(message);
                }
            });
        });
    }

    fn dialogs(&mut self, ui: &Ui) {
        let Some(mut dialog) = self.dialog.take() else { return };
        match dialog.show(ui.ctx()) {
            dialog::Answer::None => self.dialog = Some(dialog),
            dialog::Answer::Closed => {}
            dialog::Answer::Open(name) => self.open(&name),
            dialog::Answer::SaveSettings(path) => {
                let saved = settings_file::save(&path, &self.sides[self.edited].settings);
                self.said(saved.map(|()| format!("saved {}", path.display())));
            }
            dialog::Answer::LoadSettings(path) => match settings_file::load(&path) {
                Ok(settings) => {
                    self.sides[self.edited].set(settings, "file");
                    self.say(format!("loaded {}", path.display()));
                }
                Err(e) => self.said::<settings_file::SettingsFileError>(Err(e)),
            },
            dialog::Answer::SaveImage(path) => self.save_image(&path),
            dialog::Answer::Report(folder) => self.begin_report(&folder),
        }
    }

    /// What was done, or why not, where it is seen.
    fn said<E: std::fmt::Display>(&mut self, outcome: Result<String, E>) {
        match outcome {
            Ok(done) => self.say(done),
            Err(e) => {
                self.say(e.to_string());
                self.dialog = Some(Dialog::Trouble("That did not work".to_owned(), e.to_string()));
            }
        }
    }

    fn save_image(&mut self, path: &Path) {
        let Some(rendered) = &self.sides[self.edited].rendered else {
            return self.said::<&str>(Err("there is no picture yet"));
        };
        let exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        let picture = rendered.picture.clone();
        let saved = if exr { picture.write_exr(path) } else { picture.write_png(path) };
        self.said(saved.map(|()| format!("saved {}", path.display())));
    }

    /// The command line of a report of what is seen.
    pub fn report_arguments(&self, folder: &Path) -> Vec<String> {
        let Options { width, height, m, anisotropy, .. } = self.options;
        let mut all: Vec<String> = ["report", "--quick", "--scene"].map(str::to_owned).to_vec();
        all.push(self.scene_name().to_owned());
        if let Some(index) = self.opened.as_ref().and_then(|o| o.source.index) {
            all.extend(["--scene-index".to_owned(), index.to_string()]);
        }
        all.extend(["--size".to_owned(), format!("{width}x{height}"), "-m".to_owned(), m.to_string()]);
        if let Some(Camera { eye, target, lens: crate::scene::Lens::Perspective { fov_y }, .. }) = self.camera {
            let fov = fov_y.to_degrees();
            let numbers = [eye.x, eye.y, eye.z, target.x, target.y, target.z, fov].map(|v| v.to_string());
            all.extend(["--camera".to_owned(), numbers.join(",")]);
        }
        all.extend(["--stall".to_owned(), self.lights.stall.to_string()]);
        all.extend(["--anisotropy".to_owned(), anisotropy.to_string()]);
        all.extend(["--out".to_owned(), folder.to_string_lossy().into_owned()]);
        all
    }

    pub(super) fn begin_report(&mut self, folder: &Path) {
        let arguments = self.report_arguments(folder);
        let begun = std::env::current_exe()
            .and_then(|exe| Command::new(exe).args(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn());
        match begun {
            Ok(mut child) => {
                let errors = child.stderr.take().map(|mut stderr| {
                    std::thread::spawn(move || {
                        let mut said = Vec::new();
                        // What was read before an error is what there is.
                        let _ = stderr.read_to_end(&mut said);
                        String::from_utf8_lossy(&said).into_owned()
                    })
                });
                self.report = Some(Report { child, folder: folder.to_owned(), errors });
                self.say(format!("measuring in a process of its own: {}", arguments.join(" ")));
            }
            Err(e) => self.said::<std::io::Error>(Err(e)),
        }
    }

    fn watch_report(&mut self, ctx: &Context) {
        let Some(report) = &mut self.report else { return };
        match report.child.try_wait() {
            Ok(None) => ctx.request_repaint_after(Duration::from_millis(500)),
            Ok(Some(status)) => {
                let page = report.folder.join("report.html");
                let errors = report.errors.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
                self.report = None;
                if status.success() {
                    self.say(format!("the report is there: {}", page.display()));
                } else {
                    let why = errors.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
                    self.said::<String>(Err(format!("the report ended with {status}: {why}")));
                }
            }
            Err(e) => {
                self.report = None;
                self.said::<std::io::Error>(Err(e));
            }
        }
    }

    /// Sets one control of a side, as its widget does. An error says what the library has against it.
    pub fn set(&mut self, side: usize, path: &str, value: serde_json::Value) -> Result<(), String> {
        let settings = controls::with(&self.sides[side].settings, path, value)?;
        self.sides[side].set(settings, path);
        Ok(())
    }
}

impl Drop for App {
    fn drop(&mut self) {
        if let Some(report) = &mut self.report {
            // It has its own progress to resume from.
            let _ = report.child.kill();
            let _ = report.child.wait();
        }
    }
}
