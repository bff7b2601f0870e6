//! The viewer without a window, driven by tests.

mod labels;
mod memory;
mod session;
mod sides;
mod trouble;

use super::app::{App, Start};
use super::renderer::{Reference, Source};
use super::state::Kept;
use crate::host::Options;
use deferred_aa::{Settings, Technique};
use egui::{Context, DroppedFile, DroppedFileHandle, Event, Modifiers, PointerButton, Pos2, RawInput, Rect};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The viewer without a window.
pub struct Rig {
    pub ctx: Context,
    pub app: App,
    pub events: Vec<Event>,
    pub dropped: Vec<DroppedFileHandle>,
    pub screen: egui::Vec2,
    /// Pixels of the screen for a point.
    pub scale: f32,
    /// What the last frame painted.
    pub shapes: Vec<egui::epaint::ClippedShape>,
}

#[derive(Debug)]
pub struct Dropped(pub PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

impl Rig {
    pub fn new(scene: &str) -> Self {
        Self::kept_at(scene, Kept::default(), None)
    }

    pub fn kept_at(scene: &str, kept: Kept, kept_at: Option<PathBuf>) -> Self {
        let ctx = Context::default();
        let options = Options::new(48, 27, 2);
        let source = Source { name: scene.to_owned(), index: None };
        let start =
            Start { source, camera: None, options, adapter: None, kept, kept_at, fill: None, most_pixels: None };
        let app = App::new(&ctx, start).unwrap();
        Self {
            ctx,
            app,
            events: Vec::new(),
            dropped: Vec::new(),
            screen: egui::vec2(1280.0, 800.0),
            scale: 1.0,
            shapes: Vec::new(),
        }
    }

    pub fn frame(&mut self) {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.screen));
        let mut input = RawInput {
            screen_rect,
            events: std::mem::take(&mut self.events),
            dropped_files: std::mem::take(&mut self.dropped),
            focused: true,
            ..Default::default()
        };
        input.viewports.entry(egui::ViewportId::ROOT).or_default().native_pixels_per_point = Some(self.scale);
        let Self { ctx, app, .. } = self;
        let mut output = ctx.run_ui(input, |ui| app.ui(ui));
        // Nobody paints them.
        output.textures_delta.clear();
        self.shapes = output.shapes;
    }

    /// The texts on the screen and where they are: what is scrolled out of sight is not.
    pub fn texts(&self) -> impl Iterator<Item = (&str, Pos2)> {
        self.shapes.iter().filter_map(|clipped| match &clipped.shape {
            egui::Shape::Text(shape) => {
                let middle = shape.visual_bounding_rect().center();
                clipped.clip_rect.contains(middle).then(|| (shape.galley.text(), middle))
            }
            _ => None,
        })
    }

    /// Frames until it is so, at most a minute of them.
    pub fn until(&mut self, what: &str, so: impl Fn(&App) -> bool) {
        let start = Instant::now();
        while !so(&self.app) {
            self.frame();
            assert!(self.app.status.failed.is_none(), "{:?}", self.app.status.failed);
            assert!(start.elapsed() < Duration::from_secs(60), "{what} did not come: {:?}", self.app.status.messages);
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    pub fn key(&mut self, key: egui::Key, modifiers: Modifiers) {
        let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        self.events = vec![event(true), event(false)];
        self.frame();
    }

    pub fn click(&mut self, pos: Pos2) {
        self.events.push(Event::PointerMoved(pos));
        self.frame();
        for pressed in [true, false] {
            let button = PointerButton::Primary;
            self.events.push(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
            self.frame();
        }
    }
}

/// Nothing that takes long.
pub fn plain() -> Kept {
    let single = Settings { technique: Technique::Single, ..Settings::default() };
    let mut kept = Kept::default();
    (kept.settings, kept.reference, kept.split) = ([single; 2], Reference::Off, false);
    kept
}
