//! A scripted run: every control through its range, on every technique, each held until its picture is there.

use super::app::App;
use super::controls::{self, Kind};
use super::renderer::Reference;
use super::state::Side;
use deferred_aa::{SettingScale, Settings, Technique};
use serde_json::{Value, json};

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
        for technique in Technique::ALL {
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
        if let Some(why) = &app.status.failed {
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
        Kind::Slider(range) if range.scale == SettingScale::Whole => {
            let (least, most) = (range.least as i64, range.most as i64);
            vec![json!(least), json!((least + most) / 2), json!(most)]
        }
        Kind::Slider(range) => {
            let middle = match range.scale {
                SettingScale::Logarithmic => (range.least.max(1e-4) * range.most).sqrt(),
                _ => range.least.midpoint(range.most),
            };
            [range.least, middle, range.most].map(|v| json!(v)).to_vec()
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
    use crate::view::renderer;
    use crate::view::{Kept, Source, Start};
    use egui::{Context, DroppedFile, DroppedFileHandle, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2};
    use std::path::{Path, PathBuf};
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    /// The viewer without a window.
    struct Rig {
        ctx: Context,
        app: App,
        events: Vec<Event>,
        dropped: Vec<DroppedFileHandle>,
        screen: egui::Vec2,
        /// What the last frame painted.
        shapes: Vec<egui::epaint::ClippedShape>,
    }

    #[derive(Debug)]
    struct Dropped(PathBuf);

    impl DroppedFile for Dropped {
        fn path(&self) -> &Path {
            &self.0
        }

        fn bytes(&self) -> Result<Vec<u8>, String> {
            std::fs::read(&self.0).map_err(|e| e.to_string())
        }
    }

    impl Rig {
        fn new(scene: &str) -> Self {
            Self::kept_at(scene, Kept::default(), None)
        }

        fn kept_at(scene: &str, kept: Kept, kept_at: Option<PathBuf>) -> Self {
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
                shapes: Vec::new(),
            }
        }

        fn frame(&mut self) {
            let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.screen));
            let input = RawInput {
                screen_rect,
                events: std::mem::take(&mut self.events),
                dropped_files: std::mem::take(&mut self.dropped),
                focused: true,
                ..Default::default()
            };
            let Self { ctx, app, .. } = self;
            let mut output = ctx.run_ui(input, |ui| app.ui(ui));
            // Nobody paints them.
            output.textures_delta.clear();
            self.shapes = output.shapes;
        }

        /// The texts on the screen and where they are: what is scrolled out of sight is not.
        fn texts(&self) -> impl Iterator<Item = (&str, Pos2)> {
            self.shapes.iter().filter_map(|clipped| match &clipped.shape {
                egui::Shape::Text(shape) => {
                    let middle = shape.visual_bounding_rect().center();
                    clipped.clip_rect.contains(middle).then(|| (shape.galley.text(), middle))
                }
                _ => None,
            })
        }

        /// Frames until it is so, at most a minute of them.
        fn until(&mut self, what: &str, so: impl Fn(&App) -> bool) {
            let start = Instant::now();
            while !so(&self.app) {
                self.frame();
                assert!(self.app.status.failed.is_none(), "{:?}", self.app.status.failed);
                assert!(
                    start.elapsed() < Duration::from_secs(60),
                    "{what} did not come: {:?}",
                    self.app.status.messages
                );
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
        assert!(rig.app.comparison.tried.len() == 2 && rig.app.saved().contains(&"trace"), "{:?}", rig.app.saved());
        // Space flips, B takes the divider away and brings it back, brackets move it.
        assert!(rig.app.shows(0) && rig.app.shows(1));
        rig.key(egui::Key::Space, Modifiers::NONE);
        assert_eq!(rig.app.look.alone, Some(1));
        rig.key(egui::Key::Space, Modifiers::NONE);
        assert_eq!(rig.app.look.alone, Some(0));
        rig.key(egui::Key::B, Modifiers::NONE);
        assert!(rig.app.shows(0) && rig.app.shows(1));
        rig.key(egui::Key::B, Modifiers::NONE);
        assert!(rig.app.shows(0) && !rig.app.shows(1));
        rig.key(egui::Key::B, Modifiers::NONE);
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
        // What is larger than its place is moved, by keys and by the right button, up to its rim; the camera stays.
        rig.key(egui::Key::ArrowLeft, Modifiers::NONE);
        rig.frame();
        assert_eq!(rig.app.look.pan, egui::Vec2::ZERO);
        rig.app.look.scale = Some(30.0);
        rig.key(egui::Key::ArrowLeft, Modifiers::NONE);
        assert_eq!(rig.app.look.pan, egui::vec2(40.0, 0.0));
        let middle = pos2(640.0, 400.0);
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Secondary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        for events in [
            vec![Event::PointerMoved(middle), button(middle, true)],
            vec![Event::PointerMoved(middle + egui::vec2(9.0, 5.0))],
            vec![Event::PointerMoved(middle + egui::vec2(9e3, 5.0))],
            vec![button(middle, false)],
        ] {
            rig.events = events;
            rig.frame();
        }
        let room = (48.0 * 30.0 - rig.app.place[0] as f32) / 2.0;
        assert_eq!((rig.app.look.pan, rig.app.camera), (egui::vec2(room, 5.0), home));
        rig.app.look.scale = None;
        // All debug views are in the list, to the last; Escape closes it.
        let rays = |rig: &Rig| rig.texts().filter(|(text, _)| *text == "rays").count();
        let closed = rays(&rig);
        let list = rig.texts().find(|(text, _)| *text == "image").unwrap().1;
        rig.click(list);
        rig.frame();
        assert_eq!(rays(&rig), closed + 1);
        rig.key(egui::Key::Escape, Modifiers::NONE);
        rig.frame();
        assert_eq!(rays(&rig), closed);
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
            assert!(rig.app.status.messages.iter().any(|m| m.contains(wrong)), "{:?}", rig.app.status.messages);
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
        // With textures, whose coordinates make the largest target.
        let mut rig = Rig::new("checker");
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
        assert!(rig.app.status.messages.iter().any(|m| m.starts_with("not possible")), "{:?}", rig.app.status.messages);
    }

    /// Text of twice the size is a window of half as many points.
    #[test]
    fn large_text_leaves_room_for_the_picture() {
        let mut rig = Rig::kept_at("empty", plain(), None);
        rig.until("a picture", |app| app.sides[0].rendered.is_some());
        rig.screen = egui::vec2(640.0, 400.0);
        (0..3).for_each(|_| rig.frame());
        assert!(rig.app.place[0] > 160, "{:?}", rig.app.place);
        rig.key(egui::Key::P, Modifiers::NONE);
        rig.frame();
        assert!(rig.app.place[0] > 600, "{:?}", rig.app.place);
    }

    /// Nothing that takes long.
    fn plain() -> Kept {
        let single = Settings { technique: Technique::Single, ..Settings::default() };
        let mut kept = Kept::default();
        (kept.settings, kept.reference, kept.split) = ([single; 2], Reference::Off, false);
        kept
    }

    /// Whether this process runs a test of this module alone, so that its memory is the test's; else it starts such a
    /// process.
    fn is_alone(test: &str) -> bool {
        const ALONE: &str = "DEFERRED_AA_TEST_ALONE";
        if std::env::var_os(ALONE).is_some() {
            return true;
        }
        let name = format!("{}::{test}", module_path!().split_once("::").unwrap().1);
        let mut command = std::process::Command::new(std::env::current_exe().unwrap());
        let run = command.args(["--exact", &name, "--nocapture"]).env(ALONE, "1").output().unwrap();
        let said = String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success() && said.contains("1 passed"), "{said}");
        false
    }

    /// Resident MiB; nothing where the system doesn't say.
    fn resident() -> Option<f64> {
        let text = std::fs::read_to_string("/proc/self/statm").ok()?;
        text.split(' ').nth(1)?.parse::<f64>().ok().map(|pages| pages * 4096.0 / f64::from(1 << 20))
    }

    /// What is allocated on the scene's device, bytes.
    fn on_device(app: &App) -> Option<u64> {
        Some(app.opened.as_ref()?.device.generate_allocator_report()?.total_allocated_bytes)
    }

    #[test]
    fn resizing_two_hundred_times_keeps_memory_flat() {
        if !is_alone("resizing_two_hundred_times_keeps_memory_flat") {
            return;
        }
        let mut rig = Rig::kept_at("flat", plain(), None);
        rig.until("a picture", |app| app.sides[0].rendered.is_some());
        let mut seen = Vec::new();
        for i in 0..=200u32 {
            let (width, height) = (20 + i * 37 % 45, 11 + i * 23 % 31);
            rig.app.options = Options { width, height, ..rig.app.options };
            rig.until("the new picture", move |app| {
                app.sides[0].rendered.as_ref().is_some_and(|r| (r.picture.width, r.picture.height) == (width, height))
            });
            // The same size each time.
            if i % 45 == 0 && i > 0 {
                seen.push((on_device(&rig.app), resident()));
            }
        }
        let (first, last) = (seen[0], *seen.last().unwrap());
        assert_eq!(rig.app.status.messages.len(), 1, "{:?}", rig.app.status.messages);
        if let (Some(first), Some(last)) = (first.0, last.0) {
            assert!(last <= first + (1 << 20), "bytes on the device: {seen:?}");
        }
        if let (Some(first), Some(last)) = (first.1, last.1) {
            assert!(last < first + 24.0, "MiB: {seen:?}");
        }
        println!("{seen:?}");
    }

    /// Each scene has a device and pipelines of its own, so each time takes a while: as often as is wanted by an
    /// environment variable.
    #[test]
    fn moving_between_scenes_keeps_memory_flat() {
        if !is_alone("moving_between_scenes_keeps_memory_flat") {
            return;
        }
        let often = std::env::var("DEFERRED_AA_OPENINGS").map_or(20, |n| n.parse::<u64>().unwrap());
        let mut rig = Rig::kept_at("flat", plain(), None);
        let mut seen = Vec::new();
        for i in 0..often {
            let name = ["flat", "empty"][i as usize % 2];
            if i > 0 {
                rig.app.open(name);
            }
            rig.until("the scene's picture", move |app| {
                let of = app.sides[0].rendered.as_ref().map(|r| r.view.opening);
                app.scene_name() == name && of == Some(i + 1)
            });
            if i % 2 == 0 {
                seen.push(resident().unwrap_or(0.0));
            }
        }
        assert!(rig.app.dialog.is_none());
        println!("MiB: {seen:?}");
        // The first few fill what the driver and the allocator keep, and when these give memory back is their affair:
        // the least of a half counts. Measured over 50 openings: 0.1 MiB more with each two.
        let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
        let (early, late) = seen[3..].split_at((seen.len() - 3) / 2);
        assert!(least(late) < least(early) + 20.0, "MiB: {seen:?}");
    }

    #[test]
    fn a_lost_device_is_replaced() {
        let mut rig = Rig::kept_at("flat", plain(), None);
        for round in 1..4 {
            rig.until("a picture", |app| app.sides[0].rendered.is_some() && app.shown_is_wanted(0));
            let before = rig.app.sides[0].rendered.as_ref().unwrap().picture.clone();
            // The first one's device, which is gone from the second round on: that troubles nobody.
            rig.app.opened.as_ref().unwrap().device.destroy();
            rig.app.set(0, "windowed.luminance_scale", json!(round)).unwrap();
            rig.until("a picture again", |app| app.shown_is_wanted(0));
            assert_eq!(rig.app.sides[0].rendered.as_ref().unwrap().picture.rgba, before.rgba, "round {round}");
            let lost = rig.app.status.messages.iter().filter(|m| m.contains("the graphics device was lost")).count();
            assert_eq!(lost, 1, "{:?}", rig.app.status.messages);
        }
    }

    #[test]
    fn a_renderer_that_ends_leaves_a_message_and_the_settings() {
        let folder = std::env::temp_dir().join(format!("deferred-aa-ended-{}", std::process::id()));
        let path = folder.join("view.json");
        let mut rig = Rig::kept_at("flat", plain(), Some(path.clone()));
        rig.until("a picture", |app| app.sides[0].rendered.is_some());
        rig.app.set(0, "windowed.luminance_scale", json!(12)).unwrap();
        let ctx = rig.ctx.clone();
        rig.app.heard(&ctx, renderer::Event::Failed("the device is gone for good".to_owned()));
        rig.frame();
        assert_eq!(rig.app.status.failed.as_deref(), Some("the device is gone for good"));
        let (kept, trouble) = Kept::load(&path);
        assert_eq!((kept.settings[0].windowed.luminance_scale, trouble), (12.0, None));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn dropped_files_open_and_bad_ones_leave_the_scene() {
        let folder = std::env::temp_dir().join(format!("deferred-aa-dropped-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let bad = write("bad.gltf", "{ this is none }");
        let positions = (0..3).flat_map(|i| [i as f32 % 2.0, i as f32 / 2.0, 0.0]).flat_map(f32::to_le_bytes);
        std::fs::write(folder.join("triangle.bin"), positions.collect::<Vec<u8>>()).unwrap();
        let good = write(
            "triangle.gltf",
            r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"triangle.bin","byteLength":36}],
            "bufferViews":[{"buffer":0,"byteLength":36}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#,
        );
        let mut rig = Rig::kept_at("flat", plain(), None);
        rig.until("a picture", |app| app.sides[0].rendered.is_some());
        rig.dropped = vec![Arc::new(Dropped(bad))];
        rig.until("the reason", |app| app.dialog.is_some());
        assert!(
            rig.app.status.messages.iter().any(|m| m.starts_with("not opened") && m.contains("bad.gltf")),
            "{:?}",
            rig.app.status.messages
        );
        assert_eq!(rig.app.scene_name(), "flat");
        rig.key(egui::Key::Escape, Modifiers::NONE);
        rig.dropped = vec![Arc::new(Dropped(good.clone()))];
        rig.until("its picture", |app| {
            app.sides[0].rendered.as_ref().is_some_and(|r| r.view.opening == 3) && app.shown_is_wanted(0)
        });
        assert_eq!(rig.app.scene_name(), good.to_string_lossy());
        std::fs::remove_dir_all(folder).unwrap();
    }

    /// Its command line is one that `report` takes, of the view that is seen; what it has against it is shown.
    #[test]
    fn a_report_is_of_the_view_and_its_trouble_is_shown() {
        let mut rig = Rig::kept_at("flat", plain(), None);
        rig.until("a picture", |app| app.sides[0].rendered.is_some());
        let folder = std::env::temp_dir().join("deferred-aa-no-report");
        let arguments = rig.app.report_arguments(&folder);
        let line = std::iter::once("deferred-aa-demo".to_owned()).chain(arguments.clone());
        let parsed = <crate::commands::Cli as clap::Parser>::try_parse_from(line).map(|cli| format!("{cli:?}"));
        let parsed = parsed.unwrap_or_else(|e| panic!("{e}"));
        let out = format!("{folder:?}");
        for part in ["Report", "\"flat\"", "size: (48, 27)", "m: [2]", "quick: true", &out] {
            assert!(parsed.contains(part), "{part} in {parsed}");
        }
        // This process is no viewer, and says so.
        rig.app.begin_report(&folder);
        rig.until("the trouble", |app| app.dialog.is_some());
        let said = rig.app.status.messages.last().unwrap();
        assert!(said.contains("the report ended with") && said.contains("quick"), "{said}");
        // In the same frame: no other may come before the next input.
        assert!(rig.texts().any(|(text, _)| text.contains("the report ended with")));
    }

    #[test]
    fn rays_of_each_sample_are_those_of_the_frame() {
        let mut rig = Rig::new("mirrors");
        rig.app.kept.reference = Reference::Off;
        rig.until("rays of both sides", |app| app.sides.iter().all(|s| s.sent.is_some()));
        for side in &rig.app.sides {
            let counted = &side.rendered.as_ref().unwrap().shot.statistics;
            let sum = |of: fn(&crate::host::Sent) -> u8| {
                side.sent.as_ref().unwrap().iter().map(|s| u32::from(of(s))).sum::<u32>()
            };
            let found = [sum(|s| s.shadow), sum(|s| s.mirrored), sum(|s| s.refracted)];
            assert_eq!(found, [counted.shadow_rays, counted.reflection_rays, counted.refraction_rays]);
            assert!(found.iter().all(|&rays| rays > 0), "{found:?}");
        }
    }
}
