//! Pictures of cameras with `DeferredAa` against Bevy's own.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy_camera::Viewport;
use bevy_core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy_deferred_aa::deferred_aa::{Preset, Settings, Technique};
use bevy_deferred_aa::{DeferredAa, DeferredAaError, DeferredAaState};
use bevy_ecs::prelude::*;
use bevy_math::UVec2;
use bevy_render::camera::TemporalJitter;
use bevy_render::occlusion_culling::OcclusionCulling;
use support::picture::Picture;
use support::{Stage, scene};

const SIZE: [u32; 2] = [320, 180];

/// A stage with the scene, and a deferred camera into an image of this size.
fn stage(size: [u32; 2]) -> (Stage, Entity, bevy_asset::Handle<bevy_image::Image>) {
    let mut stage = Stage::new();
    scene::spawn(stage.world());
    let surroundings = scene::surroundings(stage.world());
    let target = stage.target(size);
    let camera = stage.camera(&target, (surroundings, scene::eye(), DeferredPrepass, DepthPrepass));
    (stage, camera, target)
}

/// Bevy's own deferred image with m × m pixels for each, and their mean.
fn supersampled(m: u32) -> Picture {
    let (mut stage, _, target) = stage(SIZE.map(|side| side * m));
    stage.run(12);
    let picture = stage.picture(&target);
    assert_eq!(stage.complaints(), Vec::<String>::new());
    picture.reduced(m as usize)
}

fn insert(stage: &mut Stage, camera: Entity, aa: DeferredAa) {
    stage.world().entity_mut(camera).insert(aa);
    stage.run(2);
    stage.run_until_active(camera);
}

#[test]
fn all_samples_are_the_mean_of_bevys_own_larger_image() {
    for m in [2, 4] {
        let truth = supersampled(m);
        let (mut stage, camera, target) = stage(SIZE);
        insert(&mut stage, camera, DeferredAa::full(m));
        let full = stage.picture(&target);
        let (shown, linear) = (full.psnr(&truth), full.psnr_linear(&truth));
        println!("m = {m}: {shown:.1} dB as displayed, {linear:.1} dB of linear radiance");
        full.write(std::path::Path::new(&format!("/tmp/full{m}.png")));
        truth.write(std::path::Path::new(&format!("/tmp/truth{m}.png")));
        assert_eq!(stage.complaints(), Vec::<String>::new());
        assert!(shown >= 50.0 && linear >= 50.0, "m = {m}: {shown} dB, {linear} dB");
    }
}

#[test]
fn presets_are_close_to_all_samples_for_fewer() {
    let (mut stage, camera, target) = stage(SIZE);
    insert(&mut stage, camera, DeferredAa::full(4));
    let full = stage.picture(&target);
    for preset in Preset::ALL {
        insert(&mut stage, camera, DeferredAa::preset(preset));
        let picture = stage.picture(&target);
        let ratio = stage.status(camera).statistics.as_ref().expect("statistics").ratio;
        let psnr = picture.psnr(&full);
        println!("{preset:?}: {psnr:.1} dB at {:.1} %", 100.0 * ratio);
        assert!(preset == Preset::Fast || psnr >= 42.0 && ratio < 0.4, "{preset:?}: {psnr} dB at {ratio}");
    }
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn without_the_component_bevys_image_is_back_bit_for_bit() {
    let (mut stage, camera, target) = stage(SIZE);
    stage.run(12);
    let before = stage.picture(&target);
    insert(&mut stage, camera, DeferredAa::default());
    assert_ne!(stage.picture(&target), before);
    stage.world().entity_mut(camera).remove::<DeferredAa>();
    stage.run(4);
    assert!(stage.picture(&target) == before, "the image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn the_same_frame_is_the_same_bits() {
    let (mut stage, camera, target) = stage(SIZE);
    insert(&mut stage, camera, DeferredAa::default());
    let first = stage.picture(&target);
    stage.run(3);
    assert!(stage.picture(&target) == first, "the image differs");
}

#[test]
fn what_can_t_work_is_refused_and_rendered_without() {
    let (mut stage, camera, target) = stage(SIZE);
    stage.run(12);
    let without = stage.picture(&target);
    let refused = |stage: &mut Stage, e: DeferredAaError| {
        stage.run(6);
        assert_eq!(stage.state(camera), DeferredAaState::Refused(e));
        assert!(stage.picture(&target) == without, "the image differs");
    };
    stage.world().entity_mut(camera).insert((DeferredAa::default(), OcclusionCulling));
    refused(&mut stage, DeferredAaError::OcclusionCulling);
    stage.world().entity_mut(camera).remove::<OcclusionCulling>();

    let mut settings = Settings::default();
    settings.windowed.footprint = -1.0;
    let e = settings.validate().expect_err("out of range").to_string();
    stage.world().entity_mut(camera).insert(DeferredAa { m: 2, settings, statistics: false });
    refused(&mut stage, DeferredAaError::Node(e));

    stage.world().entity_mut(camera).insert(DeferredAa { m: 9, ..DeferredAa::default() });
    let e = "m is 9: a window has 1 to 8 samples a side; set Descriptor::m to one of them";
    stage.run(60);
    refused(&mut stage, DeferredAaError::Node(e.into()));

    // And back.
    insert(&mut stage, camera, DeferredAa::default());
    stage.world().entity_mut(camera).insert(TemporalJitter::default());
    stage.run(6);
    assert_eq!(stage.state(camera), DeferredAaState::Refused(DeferredAaError::Jitter));
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn split_screens_show_what_whole_ones_do() {
    let (mut stage, camera, target) = stage(SIZE);
    insert(&mut stage, camera, DeferredAa::full(2));
    let whole = stage.picture(&target);

    // The same camera twice, in two corners of a larger image.
    let size = SIZE.map(|side| side * 2 + 10);
    let large = stage.target(size);
    let surroundings = scene::surroundings(stage.world());
    let places = [[0, 0], [SIZE[0] + 7, SIZE[1] + 3]];
    let cameras = places.map(|[x, y]| {
        let camera = stage.camera(&large, (surroundings.clone(), scene::eye(), DeferredAa::full(2)));
        let viewport =
            Viewport { physical_position: UVec2::new(x, y), physical_size: UVec2::from_array(SIZE), ..Default::default() };
        let mut settings = stage.world().get_mut::<bevy_camera::Camera>(camera).expect("a camera");
        settings.viewport = Some(viewport);
        settings.order = isize::from(x > 0) + 1;
        if x > 0 {
            settings.clear_color = bevy_camera::ClearColorConfig::None;
        }
        camera
    });
    cameras.into_iter().for_each(|camera| stage.run_until_active(camera));
    let picture = stage.picture(&large);
    for [x, y] in places.map(|place| place.map(|c| c as usize)) {
        let row = |r: usize| &picture.pixels[(y + r) * picture.size[0] + x..][..whole.size[0]];
        let part = Picture { size: whole.size, pixels: (0..whole.size[1]).flat_map(|r| row(r).to_vec()).collect() };
        let psnr = part.psnr(&whole);
        assert!(psnr >= 60.0, "at {x}, {y}: {psnr} dB");
    }
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn sizes_techniques_and_the_component_change_without_complaint() {
    let (mut stage, camera, target) = stage([64, 48]);
    insert(&mut stage, camera, DeferredAa::default());
    for i in 0..200u32 {
        let size = [1 + i * 37 % 96, 1 + i * 53 % 80];
        let mut images = stage.world().resource_mut::<bevy_asset::Assets<bevy_image::Image>>();
        images.get_mut(&target).expect("the target").resize(bevy_render::render_resource::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        });
        if i % 4 == 1 {
            stage.world().entity_mut(camera).remove::<DeferredAa>();
        } else {
            let technique = Technique::ALL[i as usize / 4 % Technique::ALL.len()];
            let settings = Settings { technique, ..Settings::default() };
            stage.world().entity_mut(camera).insert(DeferredAa { m: 4, settings, statistics: true });
        }
        stage.run(1);
    }
    assert_eq!(stage.complaints(), Vec::<String>::new());
}
