//! What a scene does not call for: tiles that get no rays, and pipelines that are smaller.

use crate::shadows::{full, host};
use bytemuck::pod_collect_to_vec;
use deferred_aa::rays::RayTier;
use deferred_aa::reference::rays::classify::classify;
use deferred_aa::reference::rays::places::places;
use deferred_aa::{
    DebugView, DeferredAa, Effect, Execution, GBufferTier, Goal, Lattice, MultiResolution, Needs, Pattern, PlanWord,
    Reconstructed, RecordError, Settings, Technique, TextureTier, Traced, sample_order, shaded_places,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options, descriptor};
use deferred_aa_demo::measure::quality::psnr;
use deferred_aa_demo::rays::reflective;
use deferred_aa_demo::scene::builtin::{self, SQUARES, builtin};
use std::collections::HashSet;
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

/// With everything compiled ahead no frame waits: pipelines with more than it needs serve until its own are there, and
/// the image is the same bit for bit, over all scenes.
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

/// What reflections and their hits would take has no part in frames that only cast shadows, though `Selective` would
/// keep hits.
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
    // The first sample, and 8 of the 15 others.
    assert_eq!(kept(Technique::Windowed) * 16, full * 9);
    assert_eq!(kept(Technique::Selective) * 16, full * 9);
}

/// Two techniques may take turns frame by frame: the room for all samples stays, and nothing is made anew.
#[test]
fn techniques_that_take_turns_share_their_room() {
    let scene = builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 3, [45, 22]);
    let mut room = |technique| {
        host.frame(&camera, Settings { technique, ..Default::default() }).unwrap();
        let passed = host.aa.intermediates().unwrap();
        [passed.shadows.cloned().expect("shadows"), passed.reflections.cloned().expect("reflections")]
    };
    room(Technique::Selective);
    let [full, with_hits] = [room(Technique::Full), room(Technique::Selective)];
    assert_eq!(full[0], with_hits[0]);
    for technique in [Technique::Single, Technique::Full, Technique::Windowed, Technique::Selective, Technique::Full] {
        assert_eq!(room(technique), with_hits, "{technique:?}");
    }
}

/// The memory of a node is what its requirements said for each technique, with lists, lattices, views and all rays.
#[test]
fn requirements_foretell_what_a_frame_holds() {
    let scene = builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let sent = reflective(&scene);
    let [some, audited] = [None, Some(Goal::Error(0.01))];
    let triangles = Lattice { pattern: Pattern::Triangular, coarsest: 2 };
    let shifted = MultiResolution { shading: triangles, rays: triangles, ..Default::default() };
    let supersampled = MultiResolution { supersampled: true, ..Default::default() };
    let with = |technique, execution, view, goal, multi_resolution| Settings {
        technique,
        execution,
        view,
        goal,
        multi_resolution,
        ..Default::default()
    };
    let mut frames = Technique::ALL
        .map(|technique| with(technique, Execution::Loop, DebugView::Image, some, MultiResolution::default()))
        .to_vec();
    let windowed = |execution, view, goal| with(Technique::Windowed, execution, view, goal, shifted);
    frames.extend([
        windowed(Execution::Packed, DebugView::Image, some),
        windowed(Execution::Sorted, DebugView::Rays, some),
        windowed(Execution::Loop, DebugView::Image, audited),
        with(Technique::MultiResolution, Execution::Packed, DebugView::Image, some, shifted),
        with(Technique::MultiResolution, Execution::Loop, DebugView::Rays, some, supersampled),
    ]);
    frames.push(Settings { ray_samples: 0.3, ..Settings::default() });
    for settings in frames {
        for settings in [settings, Settings { shadows: Effect::Off, ..settings }] {
            let mut host = host(scene.clone(), 3, [45, 22]);
            host.frame(&camera, settings).unwrap();
            let requirements = DeferredAa::requirements(&host.gpu.adapter, &host.options.descriptor());
            let lights = [deferred_aa::CastingLight::Directional { towards: glam::Vec3::Y }];
            let needs = Needs { shadows: &lights, reflective: &sent, ..Default::default() };
            assert_eq!(requirements.memory(45, 22, &settings, &needs), host.aa.memory(), "{settings:?}");
        }
    }
}

/// Planned samples have the shadow bits and the radiance of full supersampling, in whatever room; those for which
/// there is none have what their first sample has.
#[test]
fn planned_samples_keep_what_their_rays_find() {
    let size = [61, 35];
    for (name, m) in [("shadows", 4), ("mirrors", 3), ("mirrors", 8)] {
        let scene = builtin(name).unwrap();
        let camera = scene.default_camera();
        let mut host = host(scene, m, size);
        host.frame(&camera, full()).unwrap();
        let (of_full, no_plan, all) = found(&host);
        let of_full = |x, y, rank| of_full.place(&no_plan, x, y, rank).unwrap();
        let depths = host.depths();
        let full_order = sample_order(&full(), m);
        let supersampled = MultiResolution { supersampled: true, ..Default::default() };
        for technique in [Technique::Windowed, Technique::Selective, Technique::MultiResolution] {
            let settings = Settings { technique, multi_resolution: supersampled, ray_samples: 63.0, ..full() };
            let order = sample_order(&settings, m);
            let in_full = |rank| full_order.iter().position(|&of| of == order[rank as usize]).unwrap() as u32;
            host.frame(&camera, settings).unwrap();
            let image = host.picture();
            for ray_samples in [63.0, 0.6, 0.0] {
                let at = format!("{name} {technique:?} {ray_samples}");
                let settings = Settings { ray_samples, ..settings };
                let statistics = host.frame(&camera, settings).unwrap().statistics;
                let (traced, plan, some) = found(&host);
                let slots = host.aa.intermediates().unwrap().slots;
                let (words, behind) = plan.split_at(slots.count());
                let room = (slots.count() as f64 * f64::from(ray_samples.min((m * m - 1) as f32))).ceil() as usize;
                let (begins, without) = places(words, room);
                assert_eq!(behind.iter().map(|word| word.0 as usize).collect::<Vec<_>>(), begins, "{at}");
                assert_eq!(statistics.without_rays as usize, without, "{at}");
                assert_eq!(without > 0, ray_samples < 1.0, "{at}: {without}");
                let (mut compared, mut lost, mut taken) = (0, 0, HashSet::new());
                for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                    for place in shaded_places(&settings, m, plan[slots.pixel(x, y)]).unwrap() {
                        let rank = order.iter().position(|&of| of == place).unwrap() as u32;
                        let Some(own) = traced.place(&plan, x, y, rank) else {
                            lost += 1;
                            continue;
                        };
                        assert!(taken.insert(own), "{at}: another sample has its place");
                        let [at_x, at_y] = [x * m + u32::from(place.0), y * m + u32::from(place.1)];
                        // The first samples of lattices may be interpolated.
                        let interpolated = technique == Technique::MultiResolution && rank == 0;
                        if interpolated || depths[(at_y * size[0] * m + at_x) as usize] == 0.0 {
                            continue;
                        }
                        for (some, all) in some.iter().zip(&all) {
                            assert_eq!(some.get(own), all.get(of_full(x, y, in_full(rank))), "{at} ({x}, {y}) {rank}");
                        }
                        compared += 1;
                    }
                }
                assert_eq!(lost, without, "{at}");
                assert!(compared > 1000 || ray_samples == 0.0, "{at}: {compared}");
                let db = psnr(&host.picture(), &image).unwrap();
                assert!(db > 25.0, "{at}: {db} dB");
                assert_eq!(host.picture().rgba == image.rgba, without == 0, "{at}: {db} dB");
            }
        }
    }
}

/// The samples of audited tiles have what full supersampling finds, whether or not they were planned.
#[test]
fn audited_samples_keep_what_their_rays_find() {
    for (name, m, size) in [("shadows", 4, [61, 35]), ("mirrors", 2, [200, 120])] {
        let scene = builtin(name).unwrap();
        let camera = scene.default_camera();
        let mut host = host(scene, m, size);
        host.frame(&camera, full()).unwrap();
        let (of_full, no_plan, all) = found(&host);
        let (depths, order) = (host.depths(), sample_order(&full(), m));
        let settings = Settings { goal: Some(Goal::Error(0.01)), ..Settings::default() };
        let (mut audited, mut left_out) = (0, 0);
        for _ in 0..3 {
            host.frame(&camera, settings).unwrap();
            let (traced, plan, some) = found(&host);
            let slots = host.aa.intermediates().unwrap().slots;
            for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                for (rank, &(at_x, at_y)) in (0..).zip(&order) {
                    let planned = rank < plan[slots.pixel(x, y)].k();
                    let Some(place) = traced.place(&plan, x, y, rank) else {
                        left_out += 1;
                        continue;
                    };
                    let at = (y * m + u32::from(at_y)) * size[0] * m + x * m + u32::from(at_x);
                    if depths[at as usize] == 0.0 {
                        continue;
                    }
                    let expected = of_full.place(&no_plan, x, y, rank).unwrap();
                    for (some, all) in some.iter().zip(&all) {
                        assert_eq!(some.get(place), all.get(expected), "{name} ({x}, {y}) {rank} {planned}");
                    }
                    audited += usize::from(!planned);
                }
            }
        }
        // In a small image all tiles are audited, in the larger one a part.
        assert!(audited > 500 && (left_out > 0) == (m == 2), "{name}: {audited}, {left_out}");
    }
}

/// What the last frame's rays found: the places, the plan, and the shadow bits and the radiance.
fn found(host: &Host) -> (Traced, Vec<PlanWord>, [Vec<u32>; 2]) {
    let passed = host.aa.intermediates().unwrap();
    let read = |buffer: Option<&wgpu::Buffer>| -> Vec<u32> {
        buffer.map_or(Vec::new(), |buffer| pod_collect_to_vec(&host.gpu.read_buffer(buffer)))
    };
    let plan = pod_collect_to_vec(&host.gpu.read_buffer(passed.plan));
    (passed.traced, plan, [read(passed.shadows), read(passed.reflections)])
}
