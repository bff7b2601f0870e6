use super::*;
use crate::host::Options;
use crate::host::gpu::{self, Gpu};
use crate::host::raster::node_camera;
use crate::measure::quality;
use crate::measure::reference::{self, MovedFrames};
use crate::scene::builtin::builtin;
use deferred_aa::{Effect, Technique};

const SIZE: (u32, u32) = (96, 54);

fn host(scene: &str, m: u32) -> Host {
    let scene = builtin(scene).unwrap();
    let options = Options::new(SIZE.0, SIZE.1, m);
    let gpu = Gpu::new(gpu::choose(None).unwrap(), &options.descriptor()).unwrap();
    Host::new(gpu, scene, options).unwrap()
}

fn plain() -> Settings {
    let off = Effect::Off;
    let settings = Settings { shadows: off, reflections: off, refraction: off, ..Default::default() };
    Settings { technique: Technique::Single, ..settings }
}

/// What the peer makes of a scene, beside Single and a truth of 64 samples a pixel.
fn pictures(scene: &str) -> [Picture; 3] {
    let mut many = host(scene, 4);
    let camera = node_camera(&many.scene.default_camera(), SIZE.0, SIZE.1);
    let mut frames = MovedFrames::new(SIZE, 8, 4);
    for _ in 0..frames.progress().1 {
        many.frame_with(frames.moved(camera), reference::truth(plain())).unwrap();
        frames.add(&many.picture());
    }
    let mut one = host(scene, 1);
    let mut msaa = Msaa::new(&one).unwrap();
    // Nothing of the node's is needed for it.
    let shot = msaa.run(&mut one, camera).unwrap();
    assert!(shot.milliseconds.is_none_or(|ms| ms > 0.0), "{shot:?}");
    let picture = msaa.picture(&one);
    msaa.run(&mut one, camera).unwrap();
    assert!(msaa.picture(&one) == picture, "{scene}: the same frame twice");
    one.frame_with(camera, plain()).unwrap();
    [picture, one.picture(), frames.mean()]
}

#[test]
fn forward_shading_shows_the_same_scene_with_better_edges() {
    for scene in ["fence", "cornell", "spheres", "checker", "flat", "empty", "atrium"] {
        let [msaa, single, truth] = pictures(scene);
        let [ours, plain] = [&msaa, &single].map(|picture| quality::psnr(picture, &truth).unwrap());
        println!("{scene}: MSAA {ours:.2} dB, Single {plain:.2} dB");
        let better = ["fence", "cornell", "spheres", "atrium"].contains(&scene);
        assert!(if better { ours > plain + 2.0 } else { ours > plain - 0.5 }, "{scene}: {ours} dB, {plain} dB");
        // Inside of surfaces both have lit the same point of the same triangle.
        let same = msaa.to_srgb8().into_iter().zip(single.to_srgb8());
        let near = same.filter(|(a, b)| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 2)).count();
        assert!(near * 10 > msaa.rgba.len() * 4, "{scene}: {near} of {}", msaa.rgba.len());
    }
}

#[test]
fn it_stands_where_no_ray_and_no_blending_is_asked_for() {
    let settings = Settings::default();
    let suits = |name: &str, settings: &Settings| suits(&builtin(name).unwrap(), settings);
    assert!(suits("fence", &settings) && !suits("atrium", &settings) && !suits("mirrors", &settings));
    assert!(suits("atrium", &plain()));
    let mut scene = builtin("fence").unwrap();
    scene.materials.iter_mut().for_each(|m| m.blended = true);
    assert!(!super::suits(&scene, &settings));
}
