//! Renders a scene without, with and with all samples of `DeferredAa`, writes the pictures and prints figures.
//!
//! `cargo run --example headless [FOLDER]`

mod support;

use bevy_deferred_aa::DeferredAa;
use bevy_deferred_aa::deferred_aa::Preset;
use std::path::PathBuf;
use support::{Stage, scene};

const SIZE: [u32; 2] = [640, 360];

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out/bevy".to_owned()));
    std::fs::create_dir_all(&folder).unwrap_or_else(|e| {
        eprintln!("{}: {e}", folder.display());
        std::process::exit(2);
    });
    let mut stage = Stage::new();
    scene::spawn(stage.world());
    let surroundings = scene::surroundings(stage.world());
    let target = stage.target(SIZE);
    let camera = stage.camera(&target, (surroundings, scene::eye(), bevy_core_pipeline::prepass::DeferredPrepass, bevy_core_pipeline::prepass::DepthPrepass));
    stage.run(8);
    let off = stage.picture(&target);
    off.write(&folder.join("off.png"));

    let mut show = |name: &str, aa: DeferredAa| {
        stage.world().entity_mut(camera).insert(aa);
        stage.run(2);
        stage.run_until_active(camera);
        let picture = stage.picture(&target);
        picture.write(&folder.join(format!("{name}.png")));
        let status = stage.status(camera);
        let ratio = status.statistics.as_ref().map_or(f64::NAN, |s| s.ratio);
        println!("{name}: {:.1} % of the samples lit, {:.1} MB", 100.0 * ratio, status.bytes as f64 / 1e6);
        picture
    };
    let full = show("full", DeferredAa::full(4));
    for preset in Preset::ALL {
        let name = format!("{preset:?}").to_lowercase();
        let picture = show(&name, DeferredAa::preset(preset));
        println!("{name}: {:.1} dB to full, off: {:.1} dB", picture.psnr(&full), off.psnr(&full));
    }
    let complaints = stage.complaints();
    if !complaints.is_empty() {
        eprintln!("{}", complaints.join("\n"));
        std::process::exit(1);
    }
}
