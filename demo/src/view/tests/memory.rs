//! Memory stays flat, however long the viewer runs.

use super::super::app::App;
use super::{Rig, plain};
use crate::host::Options;

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
