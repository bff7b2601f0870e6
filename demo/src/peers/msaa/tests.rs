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
    let mut msaa = Msaa::new(&one, Samples::Four).unwrap();
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
        // Above 70 dB both are the truth but for rounding.
        let no_worse = ours.min(70.0) > plain.min(70.0) - 0.5;
        assert!(if better { ours > plain + 2.0 } else { no_worse }, "{scene}: {ours} dB, {plain} dB");
        // Inside of surfaces both have lit the same point of the same triangle.
        let same = msaa.to_srgb8().into_iter().zip(single.to_srgb8());
        let near = same.filter(|(a, b)| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 2)).count();
        assert!(near * 10 > msaa.rgba.len() * 4, "{scene}: {near} of {}", msaa.rgba.len());
    }
}

#[test]
fn it_stands_where_no_ray_and_no_blending_is_asked_for() {
    let settings = Settings::default();
    let gpu = host("empty", 1).gpu;
    let of = |name: &str, settings: &Settings| refusal(Samples::Four, &gpu, &builtin(name).unwrap(), settings);
    assert_eq!(of("fence", &settings), None);
    assert_eq!([of("atrium", &settings), of("mirrors", &settings)], [Some(Refusal::Scene); 2]);
    assert_eq!(of("atrium", &plain()), None);
    let mut scene = builtin("fence").unwrap();
    scene.materials.iter_mut().for_each(|m| m.blended = true);
    assert_eq!(refusal(Samples::Four, &gpu, &scene, &settings), Some(Refusal::Scene));
}

/// Every number of samples draws frames of its own, or is refused where the device lacks it.
#[test]
fn numbers_of_samples_are_had_or_refused() {
    let options = Options::new(SIZE.0, SIZE.1, 1);
    let gpu = Gpu::for_peers(gpu::choose(None).unwrap(), &options.descriptor()).unwrap();
    let mut host = Host::new(gpu, builtin("fence").unwrap(), options).unwrap();
    let camera = node_camera(&host.scene.default_camera(), SIZE.0, SIZE.1);
    let mut shown = Vec::new();
    for samples in Samples::ALL {
        let refused = refusal(samples, &host.gpu, &host.scene, &plain());
        let made = Msaa::new(&host, samples);
        match (refused, made) {
            (None, Ok(mut msaa)) => {
                msaa.run(&mut host, camera).unwrap();
                let bytes = u64::from(SIZE.0 * SIZE.1) * u64::from(samples.count() * 12 + 8);
                assert_eq!(msaa.bytes(), bytes);
                shown.push((samples, msaa.picture(&host).to_srgb8()));
            }
            (Some(Refusal::Samples), Err(e)) => {
                assert_eq!(e.to_string(), Refusal::Samples.to_string());
                // wgpu has the same against it.
                target(&host.gpu.device, SIZE, samples.count(), TARGET_FORMAT);
                target(&host.gpu.device, SIZE, samples.count(), DEPTH_FORMAT);
                let complaint = host.gpu.complaint().unwrap();
                assert!(complaint.contains("sample"), "{complaint}");
            }
            (refused, made) => panic!("{samples:?}: {refused:?}, {made:?}"),
        }
    }
    assert!(shown.iter().any(|(samples, _)| *samples == Samples::Four));
    assert!(shown.windows(2).all(|pair| pair[0].1 != pair[1].1), "as many samples as before");
    // Without the adapter's own numbers there are those that every adapter has.
    let plain = Gpu::new(host.gpu.adapter.clone(), &options.descriptor()).unwrap();
    assert_eq!(Samples::ALL.map(|samples| samples.are_had_by(&plain)), [false, true, false]);
}
