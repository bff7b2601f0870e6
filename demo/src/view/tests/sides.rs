//! What a side may show.

use super::super::renderer::{Maker, Recipe, Reference};
use super::Rig;
use crate::measure::quality::IDENTICAL_DB;
use deferred_aa::{Settings, Technique};

#[test]
fn a_side_may_be_a_peer_or_the_reference() {
    let mut rig = Rig::new("flat");
    rig.until("both sides against the reference", |app| app.sides.iter().all(|s| s.quality.is_some()));
    let of = |maker| Recipe { maker, ..Recipe::default() };
    for maker in [Maker::Fxaa, Maker::Smaa] {
        rig.app.sides[1].take(of(maker), of(maker).peer().unwrap().name());
        rig.until("the peer's picture", |app| app.shown_is_wanted(1) && app.sides[1].quality.is_some());
        let side = &rig.app.sides[1];
        let shown = side.rendered.as_ref().unwrap();
        let own = of(maker).peer().unwrap().name();
        assert!(shown.shot.statistics.passes.iter().any(|pass| pass.name == own), "{own}");
        assert_eq!(shown.shot.statistics.mean_k, 1.0);
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
    // Undo brings back the peer, and before it the other.
    assert!(rig.app.sides[1].undo() && rig.app.sides[1].recipe.maker == Maker::Smaa);
    assert!(rig.app.sides[1].undo() && rig.app.sides[1].recipe.maker == Maker::Fxaa);
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
