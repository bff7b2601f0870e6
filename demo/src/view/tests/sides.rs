//! What a side may show.

use super::super::renderer::{Maker, Recipe, Reference};
use super::Rig;
use crate::measure::quality::IDENTICAL_DB;
use crate::peers::msaa::Samples;
use deferred_aa::{Settings, Technique};

#[test]
fn a_side_may_be_a_peer_or_the_reference() {
    let mut rig = Rig::new("fence");
    rig.until("both sides against the reference", |app| app.sides.iter().all(|s| s.quality.is_some()));
    let of = |maker| Recipe { maker, ..Recipe::default() };
    for maker in [Maker::Fxaa, Maker::Smaa, Maker::Taa, Maker::Msaa(Samples::Four)] {
        rig.app.sides[1].take(of(maker), of(maker).peer().unwrap().name());
        rig.until("the peer's picture", |app| app.shown_is_wanted(1) && app.sides[1].quality.is_some());
        let side = &rig.app.sides[1];
        let shown = side.rendered.as_ref().unwrap();
        let own = of(maker).peer().unwrap().name();
        assert!(shown.shot.statistics.passes.iter().any(|pass| pass.name == own), "{own}");
        assert_eq!((shown.shot.statistics.mean_k, shown.unsettled), (1.0, 0));
        assert!(side.quality.unwrap().psnr_db.unwrap() < IDENTICAL_DB);
    }
    rig.app.sides[1].take(of(Maker::Reference), "reference");
    rig.until("the reference", |app| app.shown_is_wanted(1) && app.sides[1].quality.is_some());
    assert!(rig.app.sides[1].quality.unwrap().psnr_db.unwrap() >= IDENTICAL_DB);
    // Another kind of it has another picture.
    let before = rig.app.sides[1].rendered.as_ref().unwrap().picture.clone();
    rig.app.kept.reference = Reference::Truth64;
    rig.until("the truth", |app| app.sides[1].rendered.as_ref().is_some_and(|r| r.picture.rgba != before.rgba));
    let truth = rig.app.sides[1].rendered.as_ref().unwrap().picture.clone();
    assert!(rig.app.comparison.is_held_against(&truth));
    // Undo brings back the peers, the last one first.
    for maker in [Maker::Msaa(Samples::Four), Maker::Taa, Maker::Smaa, Maker::Fxaa] {
        assert!(rig.app.sides[1].undo() && rig.app.sides[1].recipe.maker == maker);
    }
    // What draws the scene itself has a frame's time, and no point beside the node's.
    rig.app.sides[1].take(of(Maker::Msaa(Samples::Four)), "technique");
    rig.until("the peer's picture", |app| app.shown_is_wanted(1) && app.sides[1].quality.is_some());
    rig.frame();
    assert!(rig.texts().any(|(text, _)| text.starts_with("MSAA 4x  frame ")), "{:?}", rig.texts().collect::<Vec<_>>());
    let forward = rig.app.comparison.tried.iter().filter(|t| t.recipe.is_forward()).count();
    assert_eq!((forward, rig.app.comparison.tried.iter().any(|t| t.recipe.has_history())), (0, true));
}

/// Where it wants rays, the scene can't be drawn forward: the label says so, once, and no picture passes for it.
#[test]
fn what_can_not_be_shown_says_why() {
    let mut rig = Rig::new("mirrors");
    let forward = Recipe { maker: Maker::Msaa(Samples::Four), ..Recipe::default() };
    rig.app.sides.iter_mut().for_each(|side| side.take(forward, "technique"));
    rig.until("the reasons", |app| app.sides.iter().all(|side| side.refused.is_some()));
    rig.frame();
    let why = "MSAA 4x: forward shading traces no rays and blends nothing, and this scene wants it";
    let shown = |rig: &Rig, why: &str| rig.texts().any(|(text, at)| at.x > 330.0 && text.contains(why));
    assert!(shown(&rig, why), "{:?}", rig.texts().collect::<Vec<_>>());
    // Beside a picture, too, and wherever the camera goes.
    rig.app.sides[0].take(Recipe::default(), "technique");
    rig.until("the other side's picture", |app| app.shown_is_wanted(0) && app.sides[0].rendered.is_some());
    let home = rig.app.camera.unwrap();
    for step in 1..4 {
        rig.app.camera = Some(crate::scene::Camera { eye: home.eye * (1.0 + 0.01 * step as f32), ..home });
        rig.until("the next view", |app| app.sides[0].rendered.is_some() && !app.is_stale(0));
    }
    rig.frame();
    assert!(shown(&rig, why) && !rig.texts().any(|(text, _)| text.starts_with("MSAA 4x  frame")));
    let said = rig.app.status.messages.iter().filter(|m| m.starts_with("right: forward shading")).count();
    assert_eq!(said, 1, "{:?}", rig.app.status.messages);
    // Without what can't be, there is a picture.
    for effect in ["shadows", "reflections", "refraction"] {
        rig.app.set(1, effect, serde_json::json!("off")).unwrap();
    }
    rig.until("a picture", |app| app.sides[1].rendered.as_ref().is_some_and(|r| r.recipe.is_forward()));
    rig.frame();
    assert!(!shown(&rig, why));
}

/// The keys that go elsewhere at once cut the camera; those that fly do not.
#[test]
fn keys_cut_the_camera() {
    let mut rig = Rig::new("spheres");
    rig.app.kept.reference = Reference::Off;
    rig.until("a picture", |app| app.sides[0].rendered.is_some());
    rig.frame();
    let home = rig.app.camera.unwrap();
    rig.events.push(egui::Event::PointerMoved(rig.app.look.rect.center()));
    rig.key(egui::Key::F, egui::Modifiers::NONE);
    assert!(rig.app.camera != Some(home) && rig.app.cuts == 1);
    rig.key(egui::Key::Home, egui::Modifiers::NONE);
    assert_eq!((rig.app.camera, rig.app.cuts), (Some(home), 2));
    // It is there already.
    rig.key(egui::Key::Home, egui::Modifiers::NONE);
    assert_eq!(rig.app.cuts, 2);
}

#[test]
fn points_of_a_view_stay_when_the_camera_moves_and_full_is_measured() {
    let mut rig = Rig::new("flat");
    rig.until("two points", |app| app.comparison.tried.len() == 2);
    let full = |app: &super::App| {
        let view = &app.sides[0].rendered.as_ref().unwrap().view;
        app.comparison.full_ms(view)
    };
    rig.until("the time of Full", |app| full(app).is_some());
    rig.frame();
    assert!(rig.texts().any(|(text, _)| text.contains("than Full")), "{:?}", rig.texts().collect::<Vec<_>>());
    let home = rig.app.camera.unwrap();
    rig.app.camera = Some(crate::scene::Camera { eye: home.eye * 1.1, ..home });
    rig.until("two more points", |app| app.comparison.tried.len() == 4);
    let present = |rig: &Rig| {
        let comparison = &rig.app.comparison;
        comparison.tried.iter().map(|t| comparison.is_present(t)).collect::<Vec<_>>()
    };
    rig.frame();
    assert_eq!(present(&rig), [false, false, true, true]);
    assert!(rig.texts().any(|(text, _)| text == "other views"));
    rig.app.camera = Some(home);
    rig.frame();
    assert_eq!(present(&rig), [true, true, false, false]);
    // A recipe's settings are those that the node records.
    let recipe = Recipe::node(Settings { technique: Technique::Full, ..Settings::default() });
    assert_eq!(recipe.recorded(), recipe.settings);
}
