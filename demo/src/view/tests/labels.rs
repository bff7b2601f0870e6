//! Texts have room, however large they are.

use super::super::input::dialog::{self, Dialog};
use super::super::renderer::{Maker, Recipe};
use super::{Rig, plain};
use deferred_aa::{DebugView, Settings, Technique};
use egui::{Modifiers, Vec2, vec2};

/// Text of twice the size is a window of half as many points.
#[test]
fn large_text_leaves_room_for_the_picture() {
    let mut rig = Rig::kept_at("empty", plain(), None);
    rig.until("a picture", |app| app.sides[0].rendered.is_some());
    rig.screen = vec2(640.0, 400.0);
    (0..3).for_each(|_| rig.frame());
    assert!(rig.app.place[0] > 160, "{:?}", rig.app.place);
    rig.key(egui::Key::P, Modifiers::NONE);
    rig.frame();
    assert!(rig.app.place[0] > 600, "{:?}", rig.app.place);
}

#[test]
fn the_picture_has_most_of_the_window_at_start() {
    let mut rig = Rig::new("flat");
    rig.until("two points", |app| app.comparison.tried.len() == 2);
    for (screen, least) in [(vec2(1440.0, 900.0), 0.6), (vec2(1024.0, 700.0), 0.45)] {
        rig.screen = screen;
        (0..3).for_each(|_| rig.frame());
        let [width, height] = rig.app.place.map(|side| side as f32);
        let share = width * height / (screen.x * screen.y);
        assert!(share >= least, "{share} of {screen}");
        println!("{share:.3} of {screen}");
    }
}

/// The sizes of a window in points, at each size of the text.
fn screens() -> impl Iterator<Item = (f32, Vec2)> {
    let windows = [vec2(1440.0, 900.0), vec2(1024.0, 700.0)];
    let scales = [0.75, 1.0, 1.25, 1.5, 2.0, 2.5];
    scales.into_iter().flat_map(move |scale| windows.map(|window| (scale, window / scale)))
}

/// What is cut off: shortened, or with an end that is not seen. Texts that are scrolled out of sight are not.
fn cut(rig: &Rig) -> Vec<String> {
    let mut cut = Vec::new();
    for clipped in &rig.shapes {
        let egui::Shape::Text(shape) = &clipped.shape else { continue };
        let (text, seen) = (shape.galley.text(), clipped.clip_rect);
        let rect = shape.visual_bounding_rect();
        if text.trim().is_empty() || rect.bottom() <= seen.top() || rect.top() >= seen.bottom() {
            continue;
        }
        let sides = seen.left().max(0.0) - 1.0..=seen.right().min(rig.screen.x) + 1.0;
        if shape.galley.elided || !sides.contains(&rect.left()) || !sides.contains(&rect.right()) {
            cut.push(format!("{text:?} at {rect:?} in {seen:?}"));
        }
    }
    cut
}

fn hold(rig: &mut Rig, scale: f32, screen: Vec2, what: &str) {
    (rig.screen, rig.scale) = (screen, scale);
    (0..3).for_each(|_| rig.frame());
    assert_eq!(cut(rig), Vec::<String>::new(), "{what} at {scale}, {screen} points");
    assert!(rig.texts().count() > 10, "{what}");
}

#[test]
fn no_text_is_cut_off_at_any_size() {
    let mut rig = Rig::new("flat");
    rig.until("both sides against the reference", |app| app.sides.iter().all(|s| s.quality.is_some()));
    for (scale, screen) in screens() {
        hold(&mut rig, scale, screen, "the start");
    }
    let lights = rig.app.lights;
    // All groups open, in a window that is high enough for them.
    let screen = vec2(1440.0, 6000.0);
    rig.screen = screen;
    (0..3).for_each(|_| rig.frame());
    for name in ["Other techniques", "Rays and weights", "Picture and node", "Lights", "Time by pass"]
        .into_iter()
        .chain(["Samples and memory", "Accuracy", "Messages"])
        .chain(["Full", "Single", "Windowed", "Reconstructed", "Selective", "MultiResolution", "Surfaces"])
    {
        let at = rig.texts().filter(|(text, at)| *text == name && at.x < 320.0 && at.y < 5700.0);
        if let Some((_, at)) = at.last() {
            rig.click(at);
            (0..30).for_each(|_| rig.frame());
        }
    }
    assert!(rig.texts().any(|(text, _)| text == "anisotropy"), "{:?}", rig.texts().collect::<Vec<_>>());
    // Controls that are only looked at change nothing.
    assert_eq!((rig.app.lights, rig.app.sides[0].steps()), (lights, (0, 0)));
    for technique in Technique::ALL {
        rig.app.sides[0].take(Recipe::node(Settings { technique, ..Settings::default() }), "technique");
        for (scale, screen) in screens() {
            hold(&mut rig, scale, vec2(screen.x, 6000.0), &format!("{technique:?}"));
        }
    }
    for maker in Maker::OTHERS {
        rig.app.sides[0].take(Recipe { maker, ..Recipe::default() }, "technique");
        for (scale, screen) in screens() {
            hold(&mut rig, scale, vec2(screen.x, 6000.0), &format!("{maker:?}"));
        }
    }
}

#[test]
fn no_legend_and_no_dialog_is_cut_off() {
    let mut rig = Rig::new("flat");
    rig.until("both sides against the reference", |app| app.sides.iter().all(|s| s.quality.is_some()));
    let dialogs = || {
        let why = "no node can be built from what is wanted, as the adapter lacks a feature".to_owned();
        let trouble = Dialog::Trouble("These settings can't run on this GPU".to_owned(), why);
        [dialog::open("flat"), dialog::save_settings(), dialog::report(), Dialog::Keys, trouble]
    };
    for (i, _) in dialogs().iter().enumerate() {
        for (scale, screen) in screens() {
            rig.app.dialog = Some(dialogs()[i].clone());
            hold(&mut rig, scale, screen, &format!("dialog {i}"));
        }
    }
    rig.app.dialog = None;
    rig.app.look.show_error = true;
    for (scale, screen) in screens() {
        hold(&mut rig, scale, screen, "the error");
    }
    rig.app.look.show_error = false;
    for view in DebugView::ALL {
        rig.app.show_view(view);
        rig.until("the view", |app| app.shown_is_wanted(0) && app.shown_is_wanted(1));
        for (scale, screen) in screens() {
            hold(&mut rig, scale, screen, &format!("{view:?}"));
        }
    }
}
