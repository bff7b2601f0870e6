//! What a user does in a session.

use super::super::renderer::Reference;
use super::super::tour::Tour;
use super::Rig;
use crate::host::Options;
use deferred_aa::DebugView;
use egui::{Event, Modifiers, PointerButton, pos2};
use serde_json::json;
use std::time::{Duration, Instant};

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
    let before = rig.app.sides[0].recipe.settings;
    rig.app.set(0, "windowed.luminance_scale", json!(7)).unwrap();
    let after = rig.app.sides[0].recipe.settings;
    rig.until("the new setting's picture", |app| app.shown_is_wanted(0));
    rig.key(egui::Key::Z, Modifiers::COMMAND);
    assert_eq!(rig.app.sides[0].recipe.settings, before);
    rig.key(egui::Key::Y, Modifiers::COMMAND);
    assert_eq!(rig.app.sides[0].recipe.settings, after);
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

/// What keys do, buttons over the picture do too.
#[test]
fn buttons_over_the_picture_show_views_with_legends() {
    let mut rig = Rig::new("flat");
    rig.until("both sides against the reference", |app| app.sides.iter().all(|s| s.quality.is_some()));
    let button = |rig: &Rig, name: &str| rig.texts().find(|(text, at)| *text == name && at.x > 330.0).unwrap().1;
    for (name, view, legend) in [
        ("Samples", DebugView::Count, "shaded samples a pixel"),
        ("Decided by", DebugView::Decided, "what decided the number of samples"),
    ] {
        let at = button(&rig, name);
        rig.click(at);
        rig.until("the view", |app| (0..2).all(|side| app.shown_is_wanted(side)));
        rig.frame();
        assert!(rig.app.sides.iter().all(|side| side.recipe.settings.view == view), "{name}");
        assert!(rig.texts().any(|(text, _)| text == legend), "{legend}");
    }
    // Again, it is the image.
    let at = button(&rig, "Decided by");
    rig.click(at);
    rig.until("the image", |app| (0..2).all(|side| app.shown_is_wanted(side) && app.sides[side].error.is_some()));
    assert_eq!(rig.app.sides[0].recipe.settings.view, DebugView::Image);
    let at = button(&rig, "Error");
    rig.click(at);
    rig.frame();
    assert!(rig.app.look.show_error && rig.texts().any(|(text, _)| text == "1/64"));
    let at = button(&rig, "Split");
    rig.click(at);
    assert!(rig.app.shows(0) && !rig.app.shows(1));
    let at = button(&rig, "Panel");
    rig.click(at);
    assert!(!rig.app.look.panels);
}

#[test]
fn the_camera_frames_orbits_and_is_locked() {
    let mut rig = Rig::new("spheres");
    rig.app.kept.reference = Reference::Off;
    rig.until("a picture", |app| app.sides[0].rendered.is_some());
    rig.frame();
    let home = rig.app.camera.unwrap();
    let middle = rig.app.look.rect.center();
    rig.events.push(Event::PointerMoved(middle));
    rig.key(egui::Key::F, Modifiers::NONE);
    let framed = rig.app.camera.unwrap();
    assert_ne!(framed, home);
    rig.key(egui::Key::O, Modifiers::NONE);
    let button = |pos, pressed| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    };
    let drag = |rig: &mut Rig| {
        let start = middle + egui::vec2(40.0, 60.0);
        let end = start + egui::vec2(80.0, 0.0);
        for events in [
            vec![Event::PointerMoved(start), button(start, true)],
            vec![Event::PointerMoved(end)],
            vec![button(end, false)],
        ] {
            rig.events = events;
            rig.frame();
        }
    };
    drag(&mut rig);
    let turned = rig.app.camera.unwrap();
    assert!(turned.target == framed.target && turned.eye != framed.eye);
    rig.key(egui::Key::L, Modifiers::NONE);
    drag(&mut rig);
    rig.key(egui::Key::F, Modifiers::NONE);
    assert_eq!(rig.app.camera, Some(turned));
}
