//! A scripted run: every control through its range, on every technique, each held until its picture is there.

use super::app::App;
use super::controls::{self, Kind, Scale};
use super::side::Side;
use super::worker::Reference;
use deferred_aa::{Settings, Technique};
use serde_json::{Value, json};

const TECHNIQUES: [Technique; 6] = [
    Technique::Full,
    Technique::Single,
    Technique::Windowed,
    Technique::Reconstructed,
    Technique::Selective,
    Technique::MultiResolution,
];

/// One after the other.
#[derive(Debug)]
pub struct Tour {
    steps: Vec<(Settings, String)>,
    next: usize,
    /// What was wrong, and at which step.
    pub faults: Vec<String>,
}

impl Default for Tour {
    fn default() -> Self {
        Self::new()
    }
}

impl Tour {
    /// At its beginning.
    pub fn new() -> Self {
        let mut steps = Vec::new();
        for technique in TECHNIQUES {
            let base = Settings { technique, ..Side::defaults() };
            steps.push((base, format!("{technique:?}")));
            for control in controls::all().iter().filter(|c| c.path != "technique") {
                for value in values(&control.kind) {
                    match controls::with(&base, &control.path, value.clone()) {
                        Ok(settings) => steps.push((settings, format!("{technique:?}, {} = {value}", control.path))),
                        Err(e) => steps.push((base, format!("{technique:?}, {} = {value}: {e}", control.path))),
                    }
                }
            }
        }
        Self { steps, next: 0, faults: Vec::new() }
    }

    /// Steps that are done, and all.
    #[cfg(test)]
    pub fn progress(&self) -> (usize, usize) {
        (self.next, self.steps.len())
    }

    /// Goes on if the last step's picture is there; whether all is done.
    pub fn advance(&mut self, app: &mut App) -> bool {
        if let Some(why) = &app.failed {
            self.faults.push(why.clone());
            return true;
        }
        if self.next == 0 {
            app.kept.reference = Reference::Off;
            app.kept.split = false;
            app.edited = 0;
        } else if !app.shown_is_wanted(0) {
            return false;
        } else {
            self.look(app);
        }
        let Some((settings, _)) = self.steps.get(self.next) else { return true };
        app.sides[0].set(*settings, "tour");
        app.sync();
        self.next += 1;
        false
    }

    /// At the last step's picture.
    fn look(&mut self, app: &App) {
        let step = &self.steps[self.next - 1].1;
        let side = &app.sides[0];
        if let Some(why) = &side.refused {
            self.faults.push(format!("{step}: {why}"));
        } else if let Some(rendered) = &side.rendered {
            let bad = rendered.picture.not_finite();
            let counted = rendered.shot.statistics.not_finite;
            if bad > 0 || counted > 0 {
                self.faults.push(format!("{step}: {bad} pixels and {counted} samples are not finite"));
            }
        }
    }
}

fn values(kind: &Kind) -> Vec<Value> {
    match kind {
        Kind::Slider(range) if range.scale == Scale::Whole => {
            let (least, most) = (range.least as i64, range.most as i64);
            vec![json!(least), json!((least + most) / 2), json!(most)]
        }
        Kind::Slider(range) => {
            let middle = match range.scale {
                Scale::Logarithmic => (range.least.max(1e-4) * range.most).sqrt(),
                _ => range.least.midpoint(range.most),
            };
            [range.least, middle, range.most].map(|v| json!(v as f32)).to_vec()
        }
        Kind::Switch => vec![json!(true), json!(false)],
        Kind::Choice(choices) => choices.iter().map(|(name, _)| json!(name)).collect(),
        Kind::Goal => vec![json!({ "error": 0.01 }), json!({ "time": 5.0 })],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::Options;
    use crate::view::{Kept, Source, Start};
    use deferred_aa::TextureTier;
    use deferred_aa::rays::RayTier;
    use egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2};
    use std::time::{Duration, Instant};

    /// The viewer without a window.
    struct Rig {
        ctx: Context,
        app: App,
        events: Vec<Event>,
    }

    impl Rig {
        fn new(scene: &str) -> Self {
            let ctx = Context::default();
            let options = Options {
                width: 48,
                height: 27,
                m: 2,
                textures: TextureTier::Arrays,
                stall: 1,
                anisotropy: 16,
                rays: RayTier::Software,
            };
            let source = Source { name: scene.to_owned(), index: None };
            let kept = Kept::default();
            let start = Start { source, camera: None, options, adapter: None, kept, kept_at: None, fill: false };
            let app = App::new(&ctx, start).unwrap();
            Self { ctx, app, events: Vec::new() }
        }

        fn frame(&mut self) {
            let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1280.0, 800.0)));
            let input =
                RawInput { screen_rect, events: std::mem::take(&mut self.events), focused: true, ..Default::default() };
            let Self { ctx, app, .. } = self;
            let mut output = ctx.run_ui(input, |ui| app.ui(ui));
            // Nobody paints them.
            output.textures_delta.clear();
        }

        /// Frames until it is so, at most a minute of them.
        fn until(&mut self, what: &str, so: impl Fn(&App) -> bool) {
            let start = Instant::now();
            while !so(&self.app) {
                self.frame();
                assert!(self.app.failed.is_none(), "{:?}", self.app.failed);
                assert!(start.elapsed() < Duration::from_secs(60), "{what} did not come: {:?}", self.app.messages);
                std::thread::sleep(Duration::from_millis(1));
            }
        }

        fn key(&mut self, key: egui::Key, modifiers: Modifiers) {
            let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
            self.events = vec![event(true), event(false)];
            self.frame();
        }

        fn click(&mut self, pos: Pos2) {
            self.events.push(Event::PointerMoved(pos));
            self.frame();
            for pressed in [true, false] {
                let button = PointerButton::Primary;
                self.events.push(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
                self.frame();
            }
        }
    }

    #[test]
    fn every_control_moves_through_its_range_on_every_technique() {
        let mut rig = Rig::new("cornell");
        rig.until("the scene", |app| app.opened.is_some());
        let mut tour = Tour::new();
        let mut last = Instant::now();
        let mut seen = 0;
        while !tour.advance(&mut rig.app) {
            rig.frame();
            if tour.progress().0 != seen {
                (seen, last) = (tour.progress().0, Instant::now());
            }
            assert!(last.elapsed() < Duration::from_secs(120), "step {seen} of {} hangs", tour.progress().1);
            std::thread::sleep(Duration::from_micros(300));
        }
        assert!(tour.progress().1 > 900, "{:?}", tour.progress());
        assert_eq!(tour.faults, Vec::<String>::new());
    }

    #[test]
    fn a_session_with_keys_and_a_click() {
        let mut rig = Rig::new("flat");
        rig.until("both sides against the reference", |app| app.sides.iter().all(|s| s.quality.is_some()));
        assert!(rig.app.tried.len() == 2 && rig.app.saved().contains(&"trace"), "{:?}", rig.app.saved());
        // Space flips, B takes the divider away and brings it back, brackets move it.
        assert!(rig.app.shows(0) && rig.app.shows(1));
        rig.key(egui::Key::Space, Modifiers::NONE);
        assert_eq!(rig.app.alone, Some(1));
        rig.key(egui::Key::Space, Modifiers::NONE);
        assert_eq!(rig.app.alone, Some(0));
        rig.key(egui::Key::B, Modifiers::NONE);
        rig.key(egui::Key::B, Modifiers::NONE);
        assert!(rig.app.shows(0) && rig.app.shows(1));
        rig.key(egui::Key::CloseBracket, Modifiers::NONE);
        assert!((rig.app.kept.divider - 0.52).abs() < 1e-6);
        // A setting, undone and done again.
        let before = rig.app.sides[0].settings;
        rig.app.set(0, "windowed.luminance_scale", json!(7)).unwrap();
        let after = rig.app.sides[0].settings;
        rig.until("the new setting's picture", |app| app.shown_is_wanted(0));
        rig.key(egui::Key::Z, Modifiers::COMMAND);
        assert_eq!(rig.app.sides[0].settings, before);
        rig.key(egui::Key::Y, Modifiers::COMMAND);
        assert_eq!(rig.app.sides[0].settings, after);
        assert!(rig.app.set(0, "windowed.luminance_scale", json!(-7)).unwrap_err().contains("must lie in"));
        // Keys fly, unless the camera is frozen.
        let home = rig.app.camera;
        rig.events.push(Event::Key {
            key: egui::Key::W,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        });
        rig.until("another place", |app| app.camera != home);
        rig.key(egui::Key::W, Modifiers::NONE);
        rig.key(egui::Key::Home, Modifiers::NONE);
        assert_eq!(rig.app.camera, home);
        // The first text of the bar opens the dialog, Escape closes it.
        rig.click(pos2(30.0, 14.0));
        assert!(rig.app.dialog.is_some());
        rig.key(egui::Key::Escape, Modifiers::NONE);
        assert!(rig.app.dialog.is_none());
    }

    #[test]
    fn a_scene_that_is_none_leaves_the_old_one() {
        let mut rig = Rig::new("flat");
        rig.until("the scene", |app| app.opened.is_some());
        for wrong in ["/nowhere/scene.glb", "atriun"] {
            rig.app.open(wrong);
            rig.app.dialog = None;
            rig.until("the reason", |app| app.dialog.is_some());
            assert!(rig.app.messages.iter().any(|m| m.contains(wrong)), "{:?}", rig.app.messages);
            assert_eq!(rig.app.scene_name(), "flat");
        }
        rig.app.dialog = None;
        rig.app.open("checker");
        rig.until("the other scene", |app| {
            app.scene_name() == "checker" && app.opened.as_ref().is_some_and(|o| o.opening == 4)
        });
    }

    #[test]
    fn m_and_size_change_under_way() {
        let mut rig = Rig::new("flat");
        rig.until("a picture", |app| app.sides[0].rendered.is_some());
        for (width, height, m) in [(20, 11, 2), (1, 1, 4), (33, 17, 3)] {
            rig.app.options = Options { width, height, m, ..rig.app.options };
            rig.until("the new picture", move |app| {
                app.sides[0]
                    .rendered
                    .as_ref()
                    .is_some_and(|r| (r.picture.width, r.picture.height, r.view.options.m) == (width, height, m))
            });
        }
        // More than the device has: refused, and what was there goes on.
        rig.app.options = Options { width: 16_384, height: 16_384, m: 8, ..rig.app.options };
        rig.until("the reason", |app| app.dialog.is_some());
        assert!(rig.app.messages.iter().any(|m| m.starts_with("not possible")), "{:?}", rig.app.messages);
    }
}
