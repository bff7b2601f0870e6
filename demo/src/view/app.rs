//! The viewer without its window: what it shows, what it wants from the renderer, what becomes of what that says.

use super::controls;
use super::input::dialog::Dialog;
use super::judge::{Case, Verdict};
use super::renderer::{Event, Lights, Opened, Rendered, Source, Wanted};
use super::report_process::Report;
use super::state::{Comparison, Kept, Look, Side, Status};
use super::threads::Threads;
use crate::host::Options;
use crate::scene::{Camera, Sun};
use egui::Context;
use std::path::PathBuf;

/// Frames of each side that are measured.
pub const FRAMES: u32 = 5;

/// Height of an open list, in points: all debug views at once.
const TALLEST: f32 = 600.0;

/// What the viewer starts with.
#[derive(Debug, Clone)]
pub struct Start {
    /// The scene to open.
    pub source: Source,
    /// The camera, in place of the scene's own.
    pub camera: Option<Camera>,
    /// What is fixed for the node.
    pub options: Options,
    /// Part of the adapter's name.
    pub adapter: Option<String>,
    /// The settings and places that were remembered.
    pub kept: Kept,
    /// The file where they are remembered.
    pub kept_at: Option<PathBuf>,
    /// Screen pixels along a side of a picture's pixel, where the picture matches the window's size.
    pub fill: Option<u32>,
    /// The most pixels of a picture that matches the window: [`fill`](Self::fill) is chosen by them.
    pub most_pixels: Option<u32>,
}

/// The viewer.
pub struct App {
    pub(super) threads: Threads,
    kept_at: Option<PathBuf>,
    /// What is remembered from one start to the next.
    pub kept: Kept,
    /// The sides left and right of the divider.
    pub sides: [Side; 2],
    /// The side whose settings the controls show.
    pub edited: usize,
    pub(super) source: (Source, u64),
    start_camera: Option<Camera>,
    /// The scene, once it is there.
    pub opened: Option<Opened>,
    /// The camera that the scene is seen from.
    pub camera: Option<Camera>,
    /// How often it went elsewhere at once.
    pub cuts: u64,
    /// The options as wanted; the renderer may have others until it is done, or for good.
    pub options: Options,
    /// Screen pixels along a side of a picture's pixel, where the picture matches the window's size.
    pub fill: Option<u32>,
    /// The value that nobody has chosen, and that is not remembered.
    pub(super) usual_fill: Option<u32>,
    /// Until the place is known, by which the usual value is chosen.
    pub(super) most_pixels: Option<u32>,
    /// The size of that place, in pixels.
    pub place: [u32; 2],
    /// The lights.
    pub lights: Lights,
    /// What the pictures are held against, and what came of it.
    pub comparison: Comparison,
    /// How the picture is looked at.
    pub look: Look,
    /// What the renderer is at, and what it has said.
    pub status: Status,
    /// What is asked for in a window of its own.
    pub dialog: Option<Dialog>,
    pub(super) report: Option<Report>,
    /// The window is not seen.
    pub hidden: bool,
}

impl App {
    /// Starts the renderer. Nothing is shown before [`ui`](Self::ui).
    pub fn new(ctx: &Context, start: Start) -> std::io::Result<Self> {
        let Start { source, camera, options, adapter, kept, kept_at, fill, most_pixels } = start;
        let lights = kept.lights();
        let usual_fill = if kept.fill.is_none() { fill } else { None };
        let wanted = Wanted {
            scene: (source.clone(), 1),
            view: None,
            cuts: 0,
            sides: [None, None],
            frames: FRAMES,
            reference: kept.reference,
            paused: false,
            quit: false,
        };
        let threads = Threads::start(ctx, wanted, options, adapter)?;
        ctx.all_styles_mut(|style| {
            style.spacing.combo_height = TALLEST;
            style.spacing.default_area_size.y = TALLEST;
        });
        ctx.set_zoom_factor(kept.zoom);
        if let Some(dark) = kept.dark {
            ctx.set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
        }
        Ok(Self {
            threads,
            kept_at,
            sides: kept.recipes().map(Side::new),
            kept,
            edited: 0,
            source: (source, 1),
            start_camera: camera,
            opened: None,
            camera: None,
            cuts: 0,
            options,
            fill,
            usual_fill,
            most_pixels,
            place: [options.width, options.height],
            lights,
            comparison: Comparison::default(),
            look: Look::default(),
            status: Status::opening(),
            dialog: None,
            report: None,
            hidden: false,
        })
    }

    /// A line for the log.
    pub fn say(&mut self, message: impl Into<String>) {
        self.status.say(message.into());
    }

    /// Takes what the renderer and the judge have said.
    pub fn receive(&mut self, ctx: &Context) {
        for (side, name) in self.sides.iter_mut().zip(["left", "right"]) {
            if side.painted != self.look.tone {
                side.paint(ctx, name, self.look.tone);
            }
        }
        while let Some(event) = self.threads.event() {
            self.heard(ctx, event);
        }
        while let Some(verdict) = self.threads.verdict() {
            self.judged(ctx, &verdict);
        }
        if self.threads.have_ended() && self.status.failed.is_none() {
            self.status.failed = Some("the renderer ended".to_owned());
        }
    }

    pub(super) fn heard(&mut self, ctx: &Context, event: Event) {
        match event {
            Event::Opened(opened) => {
                for notice in &opened.notices {
                    self.status.note(notice);
                }
                let camera = self.start_camera.take().or(opened.cameras.first().copied());
                self.camera = camera;
                self.lights.sun = None;
                self.comparison.reference = None;
                self.say(format!("opened {} on {}", opened.source.name, opened.adapter.name));
                self.kept.remember(&opened.source.name);
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
                self.sides[side].show(ctx, ["left", "right"][side], self.look.tone, rendered);
                self.hold_against(side);
            }
            Event::Measured(side, view, recipe, shot) => {
                self.sides[side].measured(&view, &recipe, shot);
                self.try_point(side);
            }
            Event::Sent(side, view, recipe, sent) => self.sides[side].counted(&view, &recipe, sent),
            Event::Full(view, shot) => self.comparison.measured_full(&view, shot),
            Event::Refused(side, recipe, why) => {
                if self.sides[side].recipe == recipe {
                    let known = self.sides[side].refused.replace(why.clone());
                    if known.as_ref() == Some(&why) {
                        // So it was before the camera moved.
                        return;
                    }
                }
                self.say(format!("{}: {why}", ["left", "right"][side]));
            }
            Event::Progress(done, all) => self.comparison.progress = Some((done, all)),
            Event::Reference(view, settings, picture) => {
                self.comparison.reference = Some((view, settings, picture));
                self.comparison.progress = None;
                (0..2).for_each(|side| self.hold_against(side));
            }
            Event::Busy(with) => self.status.is_at(with),
            Event::Recovered(why) => self.say(format!("the graphics device was lost ({why}) and is there again")),
            Event::NotBuilt(options, why) => {
                if self.options == options {
                    self.say(format!("not possible: {why}"));
                    self.dialog = Some(Dialog::Trouble("These settings can't run on this GPU".to_owned(), why));
                }
            }
            Event::Failed(why) => {
                self.save();
                self.status.failed = Some(why);
            }
        }
    }

    /// Sends a side's picture to the judge, if it is what it stays and the reference is of the same view.
    fn hold_against(&mut self, side: usize) {
        let judged = |r: &&Rendered| r.recipe.is_image() && r.unsettled == 0;
        let Some(rendered) = self.sides[side].rendered.as_deref().filter(judged) else { return };
        if let Some(reference) = self.comparison.reference_of(&rendered.view) {
            self.threads.judge.measure(Case { side, picture: rendered.picture.clone(), reference });
        }
    }

    fn judged(&mut self, ctx: &Context, verdict: &Verdict) {
        let side = verdict.case.side;
        let present = self.comparison.is_held_against(&verdict.case.reference);
        if present && self.sides[side].judged(ctx, ["left error", "right error"][side], verdict) {
            if let Err(why) = &verdict.quality {
                self.say(format!("no quality: {why}"));
            }
            self.try_point(side);
        }
    }

    /// The plot gains the side's point, or its newer figures.
    fn try_point(&mut self, side: usize) {
        self.comparison.try_point(&self.sides[side], self.kept.reference);
    }

    /// Whether a side's picture is what its settings give, or was refused.
    pub fn shown_is_wanted(&self, side: usize) -> bool {
        let s = &self.sides[side];
        s.refused.is_some() || s.rendered.as_ref().is_some_and(|r| r.recipe == s.recipe)
    }

    /// Whether a side is to be seen.
    pub fn shows(&self, side: usize) -> bool {
        self.look.alone.map_or(self.kept.split || side == self.edited, |alone| alone == side)
    }

    /// Looks at the scene from elsewhere at once.
    pub fn cut_to(&mut self, camera: Camera) {
        if self.camera != Some(camera) {
            self.camera = Some(camera);
            self.cuts += 1;
        }
    }

    /// Opens a scene in place of the present one, which stays if that fails.
    pub fn open(&mut self, name: &str) {
        self.source = (Source { name: name.to_owned(), index: None }, self.source.1 + 1);
        self.say(format!("opening {name}"));
    }

    /// The name of the scene that is shown.
    pub fn scene_name(&self) -> &str {
        self.opened.as_ref().map_or(&self.source.0.name, |opened| &opened.source.name)
    }

    /// The sun that shines.
    pub fn sun(&self) -> Option<Sun> {
        self.lights.sun.or(self.opened.as_ref().and_then(|opened| opened.sun))
    }

    /// Remembers.
    pub fn save(&mut self) {
        self.kept.settings = [0, 1].map(|side| self.sides[side].recipe.settings);
        self.kept.makers = [0, 1].map(|side| self.sides[side].recipe.maker);
        self.kept.m = self.options.m;
        self.kept.stall = self.lights.stall;
        self.kept.fill = self.fill.filter(|_| self.fill != self.usual_fill);
        self.kept.size = self.fill.is_none().then_some([self.options.width, self.options.height]);
        if let Some(path) = self.kept_at.clone()
            && let Err(e) = self.kept.save(&path)
        {
            self.say(format!("{}: {e}: nothing will be remembered", path.display()));
        }
    }

    /// Sets one control of a side, as its widget does. An error says what the library has against it.
    pub fn set(&mut self, side: usize, path: &str, value: serde_json::Value) -> Result<(), String> {
        let settings = controls::with(&self.sides[side].recipe.settings, path, value)?;
        self.sides[side].set(settings, path);
        Ok(())
    }
}
