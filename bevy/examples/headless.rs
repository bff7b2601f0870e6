//! Renders a scene with Bevy's own deferred shading, with FXAA, SMAA and `DeferredAa`, writes the pictures, and prints
//! what each costs and how close it comes to Bevy's own image with 8 × 8 pixels for each.
//!
//! `cargo run --release --example headless -- [--size WxH] [--scene FILE.gltf] [FOLDER]`

mod support;

use bevy_anti_alias::fxaa::Fxaa;
use bevy_anti_alias::smaa::{Smaa, SmaaPreset};
use bevy_core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy_core_pipeline::tonemapping::Tonemapping;
use bevy_deferred_aa::DeferredAa;
use bevy_deferred_aa::deferred_aa::Preset;
use bevy_diagnostic::DiagnosticsStore;
use bevy_ecs::prelude::*;
use std::path::PathBuf;
use support::picture::Picture;
use support::{Stage, scene};

/// The side of the truth's windows.
const TRUTH: u32 = 8;

struct Arguments {
    size: [u32; 2],
    scene: Option<String>,
    folder: PathBuf,
}

impl Arguments {
    fn read() -> Result<Self, String> {
        let mut read = Self { size: [320, 180], scene: None, folder: "out/bevy".into() };
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            match word.as_str() {
                "--size" => {
                    let size = words.next().unwrap_or_default();
                    let sides = size.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
                    read.size = sides
                        .filter(|sides| sides.iter().all(|side| (1..=2048).contains(side)))
                        .ok_or(format!("--size takes sides of 1 to 2048 pixels such as 320x180, not '{size}'"))?;
                }
                "--scene" => {
                    let scene = words.next().ok_or("--scene takes a glTF file")?;
                    support::check_scene(&scene)?;
                    read.scene = Some(scene);
                }
                folder if !folder.starts_with('-') => read.folder = folder.into(),
                other => {
                    return Err(format!("no option {other}; there are --size WxH, --scene FILE.gltf and a folder"));
                }
            }
        }
        Ok(read)
    }
}

fn main() {
    let done = Arguments::read().and_then(|arguments| run(&arguments));
    if let Err(e) = done {
        eprintln!("headless: {e}");
        std::process::exit(2);
    }
}

/// A stage with the scene, and a deferred camera into an image of this size.
fn stage(
    arguments: &Arguments,
    size: [u32; 2],
) -> Result<(Stage, Entity, bevy_asset::Handle<bevy_image::Image>), String> {
    let mut stage = support::make("headless", Stage::new);
    let eye = match &arguments.scene {
        Some(file) => stage.load(file)?,
        None => {
            scene::spawn(stage.world());
            scene::eye()
        }
    };
    let surroundings = scene::surroundings(stage.world());
    let target = stage.target(size);
    let camera = stage.camera(&target, (surroundings, eye, DeferredPrepass, DepthPrepass));
    // FXAA and SMAA work on the tone-mapped image, so all are compared there.
    stage.world().entity_mut(camera).insert(Tonemapping::Reinhard);
    if arguments.scene.is_some() {
        // A file is as large as it likes.
        stage.world().entity_mut(camera).remove::<bevy_pbr::DistanceFog>();
    }
    stage.run(12);
    Ok((stage, camera, target))
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let folder = &arguments.folder;
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let large = {
        let (mut stage, _, target) = stage(arguments, arguments.size.map(|side| side * TRUTH))?;
        stage.picture(&target)
    };
    let (truth, edges) =
        (large.reduced(TRUTH as usize).before_reinhard(), large.before_reinhard().edges(TRUTH as usize));
    truth.write(&folder.join("truth.png"))?;
    drop(large);

    let (mut stage, camera, target) = stage(arguments, arguments.size)?;
    println!("{}×{}, PSNR to {TRUTH}×{TRUTH} pixels of Bevy's own for each", arguments.size[0], arguments.size[1]);
    println!("{:<18} {:>8} {:>9} {:>8} {:>9}  passes, ms", "", "PSNR", "at edges", "lit", "memory");
    let mut shown = Vec::new();
    let mut row = |stage: &mut Stage, name: &str, picture: Picture| -> Result<(), String> {
        let picture = picture.before_reinhard();
        picture.write(&folder.join(format!("{}.png", name.replace(' ', "-"))))?;
        let status = stage.status(camera).cloned().unwrap_or_default();
        let lit = status.statistics.as_ref().map_or("-".to_owned(), |s| format!("{:.2} px", s.mean_k));
        let bytes = if status.bytes == 0 { "-".to_owned() } else { format!("{:.1} MB", status.bytes as f64 / 1e6) };
        // A picture may have no edges.
        let decibels = |psnr: f64| if psnr.is_nan() { "-".to_owned() } else { format!("{psnr:.1} dB") };
        let (all, at_edges) = (picture.psnr(&truth), picture.psnr_where(&truth, |i| edges[i]));
        let (all, at_edges) = (decibels(all), decibels(at_edges));
        println!("{name:<18} {all:>8} {at_edges:>9} {lit:>8} {bytes:>9}  {}", times(stage));
        shown.push((name.to_owned(), picture));
        Ok(())
    };
    let off = stage.picture(&target);
    row(&mut stage, "off", off)?;

    stage.world().entity_mut(camera).insert(Fxaa::default());
    stage.run(8);
    let fxaa = stage.picture(&target);
    row(&mut stage, "FXAA", fxaa)?;
    stage.world().entity_mut(camera).remove::<Fxaa>().insert(Smaa { preset: SmaaPreset::Ultra });
    stage.run(8);
    let smaa = stage.picture(&target);
    row(&mut stage, "SMAA ultra", smaa)?;
    stage.world().entity_mut(camera).remove::<Smaa>();

    for m in [2, 3, 4] {
        let presets = Preset::ALL.map(|preset| (format!("{preset:?}").to_lowercase(), DeferredAa::preset(preset)));
        for (name, aa) in presets.into_iter().chain([("full".to_owned(), DeferredAa::full(m))]) {
            stage.world().entity_mut(camera).insert(DeferredAa { m, ..aa });
            stage.run(2);
            stage.run_until_active(camera)?;
            stage.run(8);
            let picture = stage.picture(&target);
            row(&mut stage, &format!("{name} m = {m}"), picture)?;
        }
    }
    // Bevy's own, FXAA, SMAA, and ours at m = 2 and 3: the edges of the torus, the blade and the leaves.
    let parts: Vec<_> = ["off", "FXAA", "SMAA ultra", "balanced m = 2", "balanced m = 3"]
        .iter()
        .filter_map(|name| shown.iter().find(|(shown, _)| shown == name).map(|(_, picture)| picture))
        .collect();
    Picture::strip(&parts, [0.66, 0.3], [0.2, 0.32], 2).write(&folder.join("comparison.png"))?;

    let complaints = stage.complaints();
    if complaints.is_empty() { Ok(()) } else { Err(complaints.join("\n")) }
}

/// The GPU times of the passes that differ.
fn times(stage: &mut Stage) -> String {
    let store = stage.app.world().resource::<DiagnosticsStore>();
    let time = |name: &str| {
        let path = format!("render/{name}/elapsed_gpu");
        let fresh = |d: &&bevy_diagnostic::Diagnostic| {
            d.path().as_str() == path
                && d.measurement().is_some_and(|m| m.time.elapsed() < std::time::Duration::from_secs(2))
        };
        store.iter().find(fresh).and_then(|d| d.value())
    };
    [
        "deferred_aa_raster",
        "deferred_aa_pack",
        "deferred_aa_shade",
        "deferred_aa_composite",
        "deferred_lighting",
        "fxaa",
        "smaa",
    ]
    .into_iter()
    .filter_map(|name| Some(format!("{} {:.1}", name.trim_start_matches("deferred_aa_"), time(name)?)))
    .collect::<Vec<_>>()
    .join(", ")
}
