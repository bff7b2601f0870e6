//! What a scene does not call for: tiles that get no rays, and pipelines that are smaller.

use crate::shadows::{full, host};
use bytemuck::pod_collect_to_vec;
use deferred_aa::rays::RayTier;
use deferred_aa::reference::rays::classify::classify;
use deferred_aa::{
    DeferredAa, Effect, GBufferTier, Needs, Reconstructed, RecordError, Settings, Technique, TextureTier,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options, descriptor};
use deferred_aa_demo::rays::reflective;
use deferred_aa_demo::scene::builtin::{self, SQUARES, builtin};
use std::time::{Duration, Instant};

/// The lists that rays are dispatched over are the twin's, whatever their order.
#[test]
fn tiles_are_the_twins() {
    for (name, m, size) in [("mirrors", 2, [93, 51]), ("shadows", 3, [40, 31]), ("cornell", 1, [17, 64])] {
        let scene = builtin(name).unwrap();
        let (camera, sent) = (scene.default_camera(), reflective(&scene));
        let mut host = host(scene, m, size);
        let tiles = host.frame(&camera, full()).unwrap().statistics.tiles;
        let gbuffer = host.aa.gbuffer().unwrap();
        let surface: Vec<[u32; 2]> = pod_collect_to_vec(&host.gpu.read_texture(gbuffer.color[0].texture(), 8));
        let expected = classify(&host.depths(), &surface, size, m, |material| sent.contains(&material));
        assert_eq!([tiles.surface, tiles.reflect].map(|t| t as usize), [0, 1].map(|i| expected[i].len()), "{name}");
        let words: Vec<u32> =
            pod_collect_to_vec(&host.gpu.read_buffer(host.aa.intermediates().unwrap().tile_lists.unwrap()));
        let all = size.map(|side| side.div_ceil(8)).iter().product::<u32>();
        assert_eq!(tiles.all, all);
        for (class, expected) in (0..).zip(expected) {
            let begin = 8 + class * all as usize;
            let mut listed = words[begin..begin + words[class * 4] as usize].to_vec();
            listed.sort_unstable();
            assert_eq!(listed, expected, "{name}, class {class}");
        }
    }
}

/// One square of 64 that mirrors is one tile of 64, and no other sends a ray.
#[test]
fn a_mirror_in_a_corner_is_its_own_tiles_matter() {
    let mut seen = Vec::new();
    for mirrors in [0, 1, 5, SQUARES] {
        let scene = builtin::mirrored(mirrors);
        let camera = scene.default_camera();
        let mut host = host(scene, 2, [64, 64]);
        let statistics = host.frame(&camera, full()).unwrap().statistics;
        assert_eq!(statistics.reflection_rays, mirrors * 64 * 4);
        seen.push((statistics.tiles.all, statistics.tiles.reflect));
    }
    // Where nothing casts or mirrors, nothing is classified either.
    assert_eq!(seen, [(64, 0), (64, 1), (64, 5), (64, 64)]);
}

/// With everything compiled ahead no frame waits: pipelines with more than it needs serve until its own are there, and the
/// image is the same bit for bit, over all scenes.
#[test]
fn pruned_and_unpruned_images_are_the_same_bits() {
    for name in builtin::NAMES {
        let scene = builtin(name).unwrap();
        let camera = scene.default_camera();
        let mut host = host(scene, 2, [40, 24]);
        for technique in [
            Technique::Full,
            Technique::Windowed,
            Technique::Reconstructed,
            Technique::Selective,
            Technique::MultiResolution,
        ] {
            let settings = Settings { technique, ..Default::default() };
            let all = Settings { shadows: Effect::On, reflections: Effect::On, ..settings };
            host.aa.warm_up(&all, &Needs::default()).unwrap();
            let first = host.frame(&camera, settings).unwrap().statistics;
            let unpruned = host.picture().rgba;
            // The same passes, whoever serves.
            let names: Vec<_> = first.passes.iter().map(|p| p.name).collect();
            let start = Instant::now();
            while !host.is_ready(settings) {
                assert!(start.elapsed() < Duration::from_secs(120), "{name}: its own pipelines never came");
                std::thread::sleep(Duration::from_millis(5));
            }
            let second = host.frame(&camera, settings).unwrap().statistics;
            assert_eq!(second.passes.iter().map(|p| p.name).collect::<Vec<_>>(), names, "{name}");
            assert!(host.picture().rgba == unpruned, "{name} {technique:?}: images differ");
        }
    }
}

/// What reflections and their hits would take has no part in frames that only cast shadows, though `Selective` would keep hits.
#[test]
fn shadows_alone_are_not_refused_for_the_room_of_reflections() {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let descriptor = descriptor(1, TextureTier::Arrays, RayTier::Software, GBufferTier::default());
    let needed = DeferredAa::requirements(&adapter, &descriptor);
    // On the limits of every device a word for each sample fits, and six more for each pixel do not.
    let gpu = Gpu::with(adapter, needed.features, needed.limits).expect("a device");
    let options = Options { anisotropy: 1, ..Options::new(2312, 2080, 1) };
    let mut host = Host::new(gpu, builtin("shadows").unwrap(), options).expect("a host");
    let (device, camera) = (host.gpu.device.clone(), host.scene.default_camera());
    let mut outcome = |settings| {
        let mut outcome = Ok(());
        // Only recorded: nothing is submitted.
        let _ = host.frame_by(&camera, settings, |aa, queue, _, frame| {
            outcome = aa.record(queue, &mut device.create_command_encoder(&Default::default()), frame);
            Err(RecordError::NoSize)
        });
        outcome
    };
    let shadows = Settings {
        technique: Technique::Selective,
        reflections: Effect::Off,
        refraction: Effect::Off,
        ..Default::default()
    };
    assert_eq!(outcome(shadows), Ok(()));
    let refused = outcome(Settings { reflections: Effect::On, ..shadows }).expect_err("more than the device binds");
    assert!(matches!(refused, RecordError::Traces { bytes: 134_650_880, .. }), "{refused}");
}

/// What a frame keeps of its rays is as much as its samples may send.
#[test]
fn single_keeps_a_sixteenth_of_what_full_keeps() {
    let scene = builtin("shadows").unwrap();
    let camera = scene.default_camera();
    let kept = |technique| {
        let mut host = host(scene.clone(), 4, [32, 18]);
        let reconstructed = Reconstructed::PAPER;
        host.frame(&camera, Settings { technique, reconstructed, ..Default::default() }).unwrap();
        host.aa.intermediates().and_then(|passed| passed.shadows).expect("shadows").size()
    };
    let full = kept(Technique::Full);
    assert_eq!(kept(Technique::Single) * 16, full);
    // The four samples of a rotated grid.
    assert_eq!(kept(Technique::Reconstructed) * 4, full);
    assert_eq!(kept(Technique::Windowed), full);
}
