//! Files that are none, devices that are lost, reports that fail.

use super::super::renderer;
use super::super::state::Kept;
use super::{Dropped, Rig, plain};
use egui::Modifiers;
use serde_json::json;
use std::sync::Arc;

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
