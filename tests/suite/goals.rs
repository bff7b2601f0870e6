//! Settings given as a goal: the audit measures what the twin does, and an error is kept from the first frame on.

use crate::harness::{Rig, SHOW_USER, Sample, noise, rgba8};
use deferred_aa::glam::Vec3;
use deferred_aa::reference::audit;
use deferred_aa::{DeferredAa, Execution, Goal, GoalState, Needs, Settings, Technique};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options};
use deferred_aa_demo::scene::builtin;

/// Edges of objects and noise of several strengths, and some sky.
fn busy(x: u32, y: u32) -> Sample {
    let object = 1 + x / 23 + y / 31 * 5;
    if object % 7 == 3 {
        return Sample::SKY;
    }
    let strength = noise(object + 9);
    let grain = |seed: u32| 0.5 + strength * (noise(x / 2 + y / 3 * 977 + seed * 7919) - 0.5);
    Sample {
        depth: 0.02 + noise(object) * 0.2,
        normal: Vec3::new(noise(object), noise(object + 1), 1.0).normalize(),
        object,
        user: rgba8(grain(0), grain(1), grain(2), 1.0),
        ..Default::default()
    }
}

fn rms(image: &[[f32; 4]], full: &[[f32; 4]], exposure: f32) -> f64 {
    let wide = |c: &[f32; 4]| c.map(f64::from);
    let squared = image.iter().zip(full).map(|(a, b)| audit::squared_error(wide(a), wide(b), f64::from(exposure)));
    (squared.sum::<f64>() / image.len() as f64).sqrt()
}

#[test]
fn the_audit_measures_what_the_twin_does() {
    for (m, size, exposure) in [(2, [97, 54], 1.0), (4, [50, 41], 3.0)] {
        let mut rig = Rig::new(m, size[0], size[1], SHOW_USER);
        rig.exposure = exposure;
        rig.fill(busy);
        let full = rig.run(Settings { technique: Technique::Full, ..Default::default() });
        for execution in [Execution::Loop, Execution::Tiled, Execution::MaxFiltered] {
            let settings = Settings { goal: Some(Goal::Error(0.02)), execution, ..Default::default() };
            let mut compared = 0;
            let mut output = rig.run(settings);
            for _ in 0..400 {
                // What a frame reports was measured up to it; its image has the same effort.
                let progress = output.statistics.goal.expect("a goal");
                let next = rig.run(settings);
                let later = next.statistics.goal.expect("a goal");
                if progress.audited == 1.0 {
                    let (told, found) =
                        (f64::from(progress.error.expect("an error")), rms(&output.image, &full.image, exposure));
                    assert!((told / found - 1.0).abs() < 1e-3, "m = {m} {execution:?}: {told} {found}");
                    compared += 1;
                }
                assert!(rms(&next.image, &full.image, exposure) <= 0.022, "m = {m} {execution:?}: {later:?}");
                output = next;
            }
            assert!(compared > 10, "m = {m} {execution:?}: {:?}", output.statistics.goal);
            let progress = output.statistics.goal.expect("a goal");
            assert_eq!(progress.state, GoalState::Met, "{progress:?}");
            assert!(output.statistics.ratio < 0.9, "m = {m} {execution:?}: nothing left out");
        }
    }
}

#[test]
fn an_error_is_kept_on_every_scene() {
    for name in builtin::NAMES {
        let scene = builtin::builtin(name).expect("built in");
        let camera = scene.default_camera();
        let adapter = gpu::choose(None).expect("tests need an adapter");
        let options = Options::new(64, 36, 4);
        let gpu = Gpu::new(adapter, &options.descriptor()).expect("a device");
        let mut host = Host::new(gpu, scene, options).expect("a host");
        host.frame(&camera, Settings { technique: Technique::Full, ..Default::default() }).expect("a frame");
        let full = host.picture();
        for target in [0.004, 0.016] {
            let settings = Settings { goal: Some(Goal::Error(target)), ..Default::default() };
            let mut samples = (0, u64::MAX);
            for frame in 0..48 {
                let shot = host.frame(&camera, settings).expect("a frame");
                let error = rms(&host.picture().rgba, &full.rgba, 1.0);
                assert!(
                    error <= 1.1 * f64::from(target),
                    "{name} {target}, frame {frame}: {error} {:?}",
                    shot.statistics.goal
                );
                samples = (samples.0.max(shot.statistics.shaded), samples.1.min(shot.statistics.shaded));
            }
            assert!(samples.1 < samples.0 || name == "empty", "{name} {target}: no sample was left out");
            // Without a goal again: the settings as they stand.
            host.frame(&camera, Settings { goal: None, ..settings }).expect("a frame");
        }
    }
}

/// `Surfaces` has other efforts and an audit of its own.
#[test]
fn surfaces_keep_a_goal() {
    let hook = "
        fn material(s: DaaSample) -> DaaMaterial {
            let c = unpack4x8unorm(s.user);
            var m: DaaMaterial;
            m.base_color = vec4f(c.rgb, 1.0);
            m.roughness = 0.5;
            m.normal = normalize(s.normal + 0.5 * (c.rgb - 0.5));
            return m;
        }
        fn light(f: DaaSurface, m: DaaMaterial) -> DaaLight {
            return DaaLight(vec3f(max(dot(m.normal, vec3f(0.6, 0.0, 0.8)), 0.0)), vec4f(0.0, 0.0, 0.0, 1.0));
        }";
    let (size, exposure) = ([97, 54], 2.0);
    let mut rig = Rig::new(4, size[0], size[1], hook);
    rig.exposure = exposure;
    rig.fill(busy);
    let full = rig.run(Settings { technique: Technique::Full, ..Default::default() });
    let with = |goal| Settings { technique: Technique::Surfaces, goal, ..Default::default() };
    let settings = with(Some(Goal::Error(0.02)));
    let (mut compared, mut samples) = (0, (0, u64::MAX));
    let mut output = rig.run(settings);
    for _ in 0..400 {
        let progress = output.statistics.goal.expect("a goal");
        let next = rig.run(settings);
        if progress.audited == 1.0 {
            let (told, found) =
                (f64::from(progress.error.expect("an error")), rms(&output.image, &full.image, exposure));
            assert!((told / found - 1.0).abs() < 1e-3, "{told} {found}");
            compared += 1;
        }
        assert!(rms(&next.image, &full.image, exposure) <= 0.022, "{:?}", next.statistics.goal);
        samples = (samples.0.max(next.statistics.shaded), samples.1.min(next.statistics.shaded));
        output = next;
    }
    let progress = output.statistics.goal.expect("a goal");
    assert!(
        compared > 10 && progress.state == GoalState::Met && samples.1 < samples.0 * 3 / 4,
        "{samples:?} {progress:?}"
    );
    for _ in 0..70 {
        assert_eq!(rig.run(settings).image, output.image, "at rest");
    }
    // An error that a light for each of few groups can't reach.
    for _ in 0..100 {
        output = rig.run(with(Some(Goal::Error(1e-6))));
    }
    assert_eq!(output.statistics.goal.expect("a goal").state, GoalState::Missed);
    assert!(Technique::ALL.into_iter().filter(|t| t.follows_goals()).eq([Technique::Windowed, Technique::Surfaces]));
}

#[test]
fn only_an_error_is_audited() {
    let names = |goal| {
        DeferredAa::passes(&Settings { goal, ..Default::default() }, &Needs::default())
            .map(|p| p.info.name)
            .collect::<Vec<_>>()
    };
    let plain = names(None);
    assert_eq!(names(Some(Goal::Time(8.0))), plain);
    assert_eq!(names(Some(Goal::Error(0.01))), [&plain[..], &["audit"]].concat());
    let single = Settings { technique: Technique::Single, goal: Some(Goal::Error(0.01)), ..Default::default() };
    assert!(DeferredAa::passes(&single, &Needs::default()).all(|p| p.info.name != "audit"));
}

/// The search rests: after it has settled, a still camera gives the same bits and the same samples.
#[test]
fn a_goal_that_is_met_rests() {
    let mut rig = Rig::new(4, 64, 48, SHOW_USER);
    rig.fill(busy);
    let settings = Settings { goal: Some(Goal::Error(0.02)), ..Default::default() };
    for _ in 0..400 {
        rig.run(settings);
    }
    let rested = rig.run(settings);
    for _ in 0..70 {
        let again = rig.run(settings);
        assert_eq!((again.image, again.plan), (rested.image.clone(), rested.plan.clone()));
    }
}
