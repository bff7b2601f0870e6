//! `Technique::Selective`: plans and images against the twin, each threshold alone, and the hard cases.

use crate::harness::{Output, Rig, SHOW_USER, Sample, camera, noise, rgba8};
use crate::shadows::{full, host, light, looking, scene, square};
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{Mat4, Vec2, Vec3, vec3};
use deferred_aa::reference::selective::Input;
use deferred_aa::{
    ColorReference, DebugView, Enabled, LuminanceCurve, Needs, ObjectImportance, PlanWord, RecordError, Selective,
    Settings, Technique, Weight, window,
};
use deferred_aa_demo::quality::psnr;
use deferred_aa_demo::scene::{LightKind, builtin};

/// Objects of several pixels in several materials, curved, with sky, patches of flat colour and of noise.
fn busy(x: u32, y: u32, m: u32) -> Sample {
    let (px, py) = (x / m, y / m);
    let (fx, fy) = (x as f32 / m as f32, y as f32 / m as f32);
    let object = 1 + px / 7 + (py + px % 3) / 6 * 5;
    if object % 7 == 3 {
        return Sample::SKY;
    }
    let bend = noise(object + 100) * 0.3;
    let rough = if object.is_multiple_of(2) { 0.05 } else { noise(object * 11) };
    let shade = |i: u32| noise(object * 3 + i) * (1.0 - rough * noise(x * 7 + i + y * 977));
    Sample {
        depth: 0.02 + noise(object) * 0.2 + fx * 1e-5,
        normal: Vec3::new((fx * bend).sin(), (fy * bend).cos() * 0.5, 1.0).normalize(),
        uv: Vec2::new(fx, fy) * 0.01,
        material: object % 3,
        object,
        user: rgba8(shade(0), shade(1), shade(2), 1.0),
        ..Default::default()
    }
}

fn selective(selective: Selective) -> Settings {
    Settings { technique: Technique::Selective, selective, ..Default::default() }
}

/// One threshold alone, at τ.
fn only(set: fn(&mut Selective, f32), enable: fn(&mut Enabled), tau: f32) -> Selective {
    let mut s = Selective { enabled: Enabled::NONE, ..Selective::default() };
    set(&mut s, tau);
    enable(&mut s.enabled);
    s
}

type Threshold = (fn(&mut Selective, f32), fn(&mut Enabled));

const THRESHOLDS: [Threshold; 9] = [
    (|s, v| s.tau_col = v, |e| e.col = true),
    (|s, v| s.tau_poid = v, |e| e.poid = true),
    (|s, v| s.tau_psn = v, |e| e.psn = true),
    (|s, v| s.tau_psc = v, |e| e.psc = true),
    (|s, v| s.tau_pte = v, |e| e.pte = true),
    (|s, v| s.tau_soid = v, |e| e.soid = true),
    (|s, v| s.tau_ssn = v, |e| e.ssn = true),
    (|s, v| s.tau_ssc = v, |e| e.ssc = true),
    (|s, v| s.tau_ste = v, |e| e.ste = true),
];

const TEXTURED: [u32; 1] = [1];

fn importance() -> Vec<ObjectImportance> {
    [(2, 1.0), (4, 0.4), (5, 0.0), (9, 1.0), (65_535, 1.0)]
        .map(|(object, importance)| ObjectImportance { object, importance })
        .to_vec()
}

fn stored_importance(marks: &[ObjectImportance], object: u32) -> f64 {
    let found = marks.iter().find(|mark| mark.object == object);
    found.map_or(0.0, |mark| f64::from((mark.importance * 255.0).round()) / 255.0)
}

/// Every setting off its default, besides ours and the paper's.
fn variants() -> Vec<Selective> {
    let ours = Selective::default();
    let sparse = Selective { tau_col: 0.4, tau_poid: 0.1, tau_psn: 0.05, tau_pte: 0.2, ..ours };
    vec![
        ours,
        sparse,
        Selective::PAPER,
        Selective { tau_col: 0.3, ..Selective::PAPER },
        Selective { reference: ColorReference::Luminance, ..sparse },
        Selective { reference: ColorReference::Gradient, curve: LuminanceCurve::Linear, ..sparse },
        Selective { focused: true, ..sparse },
        Selective { focused: true, enabled: Enabled { col: false, ..Enabled::ALL }, ..sparse },
        // A disagreement that relaxes.
        Selective { tau_col: 0.05, tau_poid: 0.9, tau_psn: 1.0, ..ours },
        Selective { bilinear: true, normal_cosine: 0.999, contrast_min: 0.1, ..sparse },
    ]
}

/// Holds plan and image against the twin; how many windows it is not sure of.
fn assert_twin_agrees(rig: &Rig, settings: &Settings, output: &Output, marks: &[ObjectImportance]) -> usize {
    let (m, s) = (rig.aa.m(), &settings.selective);
    let width = rig.size[0];
    let mut unsure = 0;
    let mut quadrants = [0; 9];
    let places = window::centred(m);
    rig.with_input(|read| {
        let input = Input {
            m,
            places: &places,
            size: rig.size,
            depth: read.depth,
            surface: read.surface,
            first: read.first,
            exposure: rig.exposure,
            shadow: &|_, _| 0,
            hit: &|_, _, _| [0; 3],
            textured: &|material| TEXTURED.contains(&material),
            importance: &|object| stored_importance(marks, object),
        };
        for (i, (&(k, by, active), pixel)) in output.plan.iter().zip(&output.image).enumerate() {
            let (x, y) = (i as u32 % width, i as u32 / width);
            let (expected, sure) = input.planned(x, y, s);
            for q in (0..4).filter(|q| active >> q & 1 == 1) {
                quadrants[input.quadrant(x, y, q, s).by] += 1;
            }
            assert_eq!(k, input.samples(active), "m = {m} {s:?} window {i}");
            if sure {
                assert_eq!(k | by << 8 | active << 16, expected, "m = {m} {s:?} window {i}");
            } else {
                unsure += 1;
            }
            let shade = |sx: u8, sy: u8| {
                let found = busy(x * m + u32::from(sx), y * m + u32::from(sy), m);
                if found.depth == 0.0 { [0.0; 4] } else { found.user.to_le_bytes().map(|c| f64::from(c) / 255.0) }
            };
            let mean = input.pixel(x, y, active, s, settings.weight, &shade);
            for c in 0..4 {
                let apart = (f64::from(pixel[c]) - mean[c]).abs();
                assert!(apart <= 2e-6, "m = {m} {s:?} {i}.{c}: {pixel:?} {mean:?}");
            }
        }
    });
    assert_eq!(output.statistics.quadrants.values(), quadrants, "m = {m} {s:?}");
    let shaded = output.plan.iter().map(|p| u64::from(p.0)).sum::<u64>();
    assert_eq!(output.statistics.shaded, shaded);
    assert_eq!(output.statistics.decided.sum(), output.plan.len() as u64);
    unsure
}

#[test]
fn plans_and_images_are_the_twins() {
    let marks = importance();
    let needs = Needs { textured: &TEXTURED, importance: &marks, ..Default::default() };
    let mut seen = [0; 9];
    for m in [1, 2, 3, 4, 5, 6, 7, 8] {
        let mut rig = Rig::new(m, 37, 21, SHOW_USER);
        rig.exposure = 1.5;
        rig.fill(|x, y| busy(x, y, m));
        for (i, s) in variants().into_iter().enumerate() {
            let weight = if i % 3 == 1 { Weight::Luminance } else { Weight::Linear };
            let settings = Settings { weight, ..selective(s) };
            let output = rig.run_with(settings, needs);
            let unsure = assert_twin_agrees(&rig, &settings, &output, &marks);
            assert!(unsure <= 37 * 21 / 50, "m = {m} {s:?}: {unsure} unsure");
            let partly = output.plan.iter().filter(|p| ![0, 15].contains(&p.2)).count();
            let active = output.plan.iter().filter(|p| p.2 != 0).count();
            assert!(partly > 20 && active < 37 * 21 * 19 / 20, "m = {m} {s:?}: {partly} of {active} in part");
            seen = std::array::from_fn(|i| seen[i] + output.statistics.quadrants.values()[i]);
        }
    }
    assert!(seen[..3].iter().all(|&q| q > 1000) && seen[4] > 1000, "{seen:?}");
}

/// At m = 4 with every quadrant active, and at m = 2 and 3 as well, the image is that of `Full`; at any m, k is 16
/// samples and perhaps the first; with none, that of `Single`.
#[test]
fn all_and_nothing_are_full_and_single() {
    for m in 1..=8 {
        let mut rig = Rig::new(m, 21, 13, SHOW_USER);
        rig.fill(|x, y| busy(x, y, m));
        let enabled = Enabled { col: true, ..Enabled::NONE };
        let all = Selective { tau_col: 0.0, bilinear: false, enabled, ..Default::default() };
        let found = rig.run(selective(all));
        assert!(found.plan.iter().all(|p| p.2 == 15 && (p.0 == m * m || (m > 4 && (16..=17).contains(&p.0)))));
        let reference = rig.run(full());
        let apart = |a: &Output, b: &Output| {
            let channels = a.image.iter().flatten().zip(b.image.iter().flatten());
            channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        assert!(m > 4 || apart(&found, &reference) < 1e-6, "m = {m}");
        // Switched off, and at 1, which suppresses.
        let one = Selective { tau_col: 1.0, ..all };
        for s in [Selective { enabled: Enabled::NONE, ..all }, one] {
            let found = rig.run(selective(s));
            assert!(found.plan.iter().all(|p| (p.0, p.2) == (1, 0)), "m = {m}");
            assert_eq!(found.statistics.quadrants.sum(), 0);
            if [3, 4, 5].contains(&m) {
                let single = rig.run(Settings { technique: Technique::Single, ..Default::default() });
                assert!(apart(&found, &single) < 1e-6, "m = {m}");
            }
        }
    }
}

/// A threshold takes what its attribute disagrees on, whatever the colours at 0, nothing at 1, and less the higher it
/// is.
#[test]
fn each_threshold_alone_takes_its_attribute() {
    let marks = importance();
    let needs = Needs { textured: &TEXTURED, importance: &marks, ..Default::default() };
    let mut rig = Rig::new(4, 37, 21, SHOW_USER);
    rig.fill(|x, y| busy(x, y, 4));
    for (i, (set, enable)) in THRESHOLDS.into_iter().enumerate() {
        // Nothing was traced.
        let there = [0, 1, 2, 4].contains(&i);
        let mut last = u32::MAX;
        for tau in [0.0, 0.02, 0.2, 1.0] {
            let s = only(set, enable, tau);
            let found = rig.run_with(selective(s), needs);
            assert_twin_agrees(&rig, &selective(s), &found, &marks);
            let active: u32 = found.plan.iter().map(|p| p.2.count_ones()).sum();
            assert!(found.statistics.quadrants.values().into_iter().enumerate().all(|(j, q)| q == 0 || i == j));
            assert!(active <= last, "threshold {i} at {tau}: {active} after {last}");
            if tau == 0.0 && i == 0 {
                assert_eq!(active, 37 * 21 * 4);
            } else {
                assert!(tau == 1.0 || (active > 0) == there, "threshold {i} at {tau}: {active}");
            }
            last = active;
        }
        assert_eq!(last, 0, "threshold {i} at 1");
    }
    // A threshold of 1 suppresses what τcol would have taken; switched off it does not.
    let dense = Selective { tau_col: 0.0, ..Default::default() };
    let active = |rig: &mut Rig, s: Selective| {
        rig.run_with(selective(s), Needs::default()).plan.iter().map(|p| p.2.count_ones()).sum::<u32>()
    };
    let suppressed = active(&mut rig, Selective { tau_poid: 1.0, tau_psn: 1.0, ..dense });
    let off = Enabled { poid: false, psn: false, ..Enabled::ALL };
    let switched = active(&mut rig, Selective { enabled: off, ..dense });
    assert!(switched == 37 * 21 * 4 && suppressed < switched, "{suppressed} {switched}");
}

/// Object-focused: quadrants away from the object have τcol, however their attributes disagree.
#[test]
fn the_focus_is_on_an_object() {
    let mut rig = Rig::new(4, 37, 21, SHOW_USER);
    rig.fill(|x, y| busy(x, y, 4));
    let s = Selective { tau_col: 1.0, tau_poid: 0.0, tau_psn: 0.0, focused: true, ..Default::default() };
    let with = |rig: &mut Rig, object, importance| {
        let marks = [ObjectImportance { object, importance }];
        let found = rig.run_with(selective(s), Needs { importance: &marks, ..Default::default() });
        assert_twin_agrees(rig, &selective(s), &found, &marks);
        found.plan.iter().map(|p| p.2).collect::<Vec<_>>()
    };
    let object = |x: usize, y: usize| busy(x as u32 * 4 + 2, y as u32 * 4 + 2, 4).object;
    let near = |x: usize, y: usize, of: u32| {
        let around = (-1..=1i32).flat_map(|dy| (-1..=1i32).map(move |dx| (dx, dy)));
        let clamp = |v: i32, end: i32| v.clamp(0, end - 1) as usize;
        around.into_iter().any(|(dx, dy)| object(clamp(x as i32 + dx, 37), clamp(y as i32 + dy, 21)) == of)
    };
    let focused = with(&mut rig, 2, 1.0);
    assert!(focused.iter().filter(|&&active| active != 0).count() > 10);
    for (i, &active) in focused.iter().enumerate() {
        assert!(active == 0 || near(i % 37, i / 37, 2), "window {i}");
    }
    // Nothing is important without the table, nor at 0.
    assert!(with(&mut rig, 2, 0.0).iter().all(|&active| active == 0));
    assert!(with(&mut rig, 60_000, 1.0).iter().all(|&active| active == 0));
    // By half, the threshold is half as strict: 0.5 between 0 and 1.
    let half = with(&mut rig, 2, 0.5);
    let count = |active: &[u32]| active.iter().map(|a| a.count_ones()).sum::<u32>();
    assert!(count(&half) > 0 && count(&half) < count(&focused), "{} {}", count(&half), count(&focused));
}

/// The planned ranks have the bits that `Full` traced, the plan is the twin's from these, and what is reflected is told
/// apart.
#[test]
fn plans_with_rays_are_the_twins() {
    for (name, m, size) in
        [("shadows", 3, [48, 27]), ("cornell", 4, [40, 37]), ("mirrors", 4, [64, 36]), ("mirrors", 2, [51, 29])]
    {
        let scene = builtin::builtin(name).unwrap();
        let camera = scene.default_camera();
        let mut host = host(scene, m, size);
        let places = window::centred(m);
        assert_eq!(places, window::order(m), "bits of `Full` are compared rank by rank");
        let read = |host: &deferred_aa_demo::host::Host, reflections: bool| -> Option<Vec<u32>> {
            let passed = host.aa.intermediates().unwrap();
            let buffer = if reflections { passed.reflections } else { passed.shadows };
            buffer.map(|buffer| pod_collect_to_vec(&host.gpu.read_buffer(buffer)))
        };
        host.frame(&camera, full()).unwrap();
        let of_full = [false, true].map(|reflections| read(&host, reflections));
        let mut seen = [0; 9];
        for s in [Selective::default(), Selective { tau_col: 0.9, ..Selective::PAPER }] {
            let settings = selective(s);
            let statistics = host.frame(&camera, settings).unwrap().statistics;
            let [bits, codes] = [false, true].map(|reflections| read(&host, reflections));
            let passed = host.aa.intermediates().unwrap();
            let slots = passed.slots.count();
            let (plan, traced): (Vec<PlanWord>, _) =
                (pod_collect_to_vec(&host.gpu.read_buffer(passed.plan)), passed.traced);
            let at = |x: u32, y: u32| passed.slots.pixel(x, y);
            let depth = host.depths();
            let surface = host.surfaces();
            let first: Vec<[f32; 4]> = pod_collect_to_vec(&host.gpu.read_texture(passed.first, 16));
            let textured: Vec<bool> = host.scene.materials.iter().map(|m| m.base_color_texture.is_some()).collect();
            let input = Input {
                m,
                places: &places,
                size,
                depth: &depth,
                surface: &surface,
                first: &first,
                exposure: 1.0,
                shadow: &|x, y| bits.as_ref().map_or(0, |bits| bits[at(x, y)]),
                hit: &|x, y, kind| {
                    let word =
                        |i| codes.as_ref().map_or(0, |c| c[traced.hits() + (kind as usize * 3 + i) * slots + at(x, y)]);
                    [0, 1, 2].map(word)
                },
                textured: &|material| textured[material as usize],
                importance: &|_| 0.0,
            };
            let mut unsure = 0;
            for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                let word = plan[at(x, y)].0 & 0xfffff;
                let (expected, sure) = input.planned(x, y, &s);
                if sure {
                    assert_eq!(word, expected, "{name} m = {m} {s:?} {x}, {y}");
                } else {
                    unsure += 1;
                }
                for (rank, &(sx, sy)) in places.iter().enumerate() {
                    if rank == 0 || window::quadrants(m, sx, sy) & (word >> 16) != 0 {
                        for (own, all) in [(&bits, &of_full[0]), (&codes, &of_full[1])] {
                            let place = traced.place(&plan, x, y, rank as u32).expect("room");
                            let own = own.as_ref().map(|words| words[place]);
                            let all = all.as_ref().map(|words| words[rank * slots + at(x, y)]);
                            assert_eq!(own, all, "{name} m = {m} {x}, {y}, rank {rank}");
                        }
                    }
                }
            }
            assert!(unsure <= size[0] * size[1] / 50, "{name} {s:?}: {unsure} unsure");
            seen = std::array::from_fn(|i| seen[i] + statistics.quadrants.values()[i]);
            assert!(
                statistics.mean_k > 1.0 && statistics.mean_k < 0.9 * f64::from(m * m),
                "{name}: {}",
                statistics.mean_k
            );
        }
        assert!(seen[3] > 50, "{name}: {seen:?}");
        assert!(name != "mirrors" || (seen[5] > 50 && seen[6] > 10), "{name}: {seen:?}");
    }
}

/// What a mirror shows is told apart where the mirror is one and its colours would not do.
#[test]
fn reflections_are_selected_by_what_they_meet() {
    let scene = builtin::builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 4, [96, 54]);
    host.frame(&camera, full()).unwrap();
    let reference = host.picture();
    let mut run = |enabled: Enabled| {
        let s = Selective { tau_col: 0.6, tau_soid: 0.02, tau_ssn: 0.02, tau_ssc: 0.02, enabled, ..Default::default() };
        let statistics = host.frame(&camera, selective(s)).unwrap().statistics;
        (psnr(&host.picture(), &reference).unwrap(), statistics)
    };
    let primary = Enabled { soid: false, ssn: false, ssc: false, ste: false, ..Enabled::ALL };
    let (without, of_primary) = run(primary);
    let (with, of_all) = run(Enabled::ALL);
    assert_eq!(of_primary.quadrants.values()[5..], [0; 4]);
    assert!(of_all.quadrants.values()[5..8].iter().all(|&q| q > 20), "{:?}", of_all.quadrants);
    assert!(with > without + 0.5, "{with} dB with them, {without} without");
}

/// Shadow edges on one plane in one colour are selected by shadow alone, and Selective comes nearer to `Full` than
/// `Single`.
#[test]
fn shadow_edges_are_selected() {
    let scene = builtin::builtin("shadows").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 4, [160, 90]);
    host.frame(&camera, full()).unwrap();
    let reference = host.picture();
    let mut run = |settings: Settings| {
        let statistics = host.frame(&camera, settings).unwrap().statistics;
        (psnr(&host.picture(), &reference).unwrap(), statistics)
    };
    let (single, _) = run(Settings { technique: Technique::Single, ..Default::default() });
    let (paper, of_paper) = run(selective(Selective::PAPER));
    let (ours, of_ours) = run(selective(Selective::default()));
    assert!(of_paper.quadrants.shadow > 500 && of_ours.quadrants.shadow > 500, "{of_paper:?}");
    assert!(of_ours.mean_k < 8.0 && paper > single + 4.0 && ours > single + 8.0, "{single} {paper} {ours}");
}

// ---- Hard cases ----

/// Row 10: two blacks are no contrast, noise in the dark is none; τ = 0 takes both.
#[test]
fn row_10_the_dark_does_not_contrast() {
    const DARK: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(vec3f(bitcast<f32>(s.user)), 1.0); }";
    for amount in [0.0, 1e-40, 1e-8] {
        let mut rig = Rig::new(2, 19, 11, DARK);
        rig.fill(|x, y| Sample { user: (noise(x + y * 77) * amount).to_bits(), ..Default::default() });
        for s in [Selective::default(), Selective { tau_col: 0.1, ..Selective::PAPER }] {
            let found = rig.run(selective(s));
            assert!(found.plan.iter().all(|p| p.0 == 1), "{amount} {s:?}");
            let all = rig.run(selective(Selective { tau_col: 0.0, ..s }));
            assert!(all.plan.iter().all(|p| p.0 == 4), "{amount} {s:?}");
        }
    }
}

/// Rows 7, 8, 22 and 23: every end of every field on what is degenerate, radiance of any size: finite, k in range.
#[test]
fn row_22_ends_of_every_field_are_sound() {
    const HDR: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(bitcast<f32>(s.user), 1.0, 0.0, 1.0); }
        fn sky(s: DaaSample) -> vec4f { return vec4f(1e30); }";
    let values = [0.0, 1.0, 1e30, 65520.0, 1e-40, f32::NAN, f32::INFINITY, -1.0];
    for m in [1, 3, 4] {
        let mut rig = Rig::new(m, 13, 9, HDR);
        rig.fill(|x, y| {
            let i = (x / m * 3 + y / m * 5) % 11;
            let user = values[i as usize % 8].to_bits();
            let normal = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z][i as usize % 4];
            let depth = if i == 9 { 0.0 } else { 1e-20 + noise(i) };
            Sample { user, normal, depth, object: i * 6553, material: i * 6553, ..Default::default() }
        });
        let taus = |tau: f32| {
            let mut s = Selective::default();
            THRESHOLDS.iter().for_each(|(set, _)| set(&mut s, tau));
            s
        };
        let ends = [0.0, 1.0].into_iter().flat_map(|tau| {
            let s = taus(tau);
            let mut all = vec![
                s,
                Selective { normal_cosine: -1.0, contrast_min: 1.0, footprint: 4.0, ..s },
                Selective { normal_cosine: 1.0, contrast_min: 0.0, footprint: 0.0, curve: LuminanceCurve::Linear, ..s },
                Selective { focused: true, bilinear: true, ..s },
                Selective { enabled: Enabled { col: false, ..Enabled::ALL }, ..s },
                Selective { enabled: Enabled::NONE, ..s },
            ];
            all.extend(
                [ColorReference::Luminance, ColorReference::Gradient].map(|reference| Selective { reference, ..s }),
            );
            all.into_iter().map(move |s| (tau, s))
        });
        for (tau, s) in ends {
            for (exposure, weight) in [(1.0, Weight::Linear), (1e30, Weight::Luminance), (1e-30, Weight::Linear)] {
                rig.exposure = exposure;
                let found = rig.run(Settings { weight, ..selective(s) });
                assert!(found.image.iter().flatten().all(|c| c.is_finite()), "m = {m} {s:?}");
                assert!(found.plan.iter().all(|p| (1..=m * m).contains(&p.0)), "m = {m} {s:?}");
                let active: u32 = found.plan.iter().map(|p| p.2.count_ones()).sum();
                assert!(tau == 0.0 || active == 0, "m = {m} {s:?}: τ = 1 took {active}");
                let whole = tau == 0.0 && s.enabled.col && !s.focused;
                assert!(!whole || active == 13 * 9 * 4, "m = {m} {s:?}: τ = 0 took {active}");
            }
        }
    }
}

/// Row 20: the border is what it would be in an image that goes on as its last pixels do, whatever is beside the tile.
#[test]
fn row_20_odd_sizes_are_cut_from_a_padded_image() {
    let mut settings = selective(Selective { tau_col: 0.3, bilinear: true, ..Default::default() });
    for reference in [ColorReference::Color, ColorReference::Gradient] {
        settings.selective.reference = reference;
        for (m, [width, height]) in [(4, [37, 21]), (3, [9, 1]), (5, [1, 17]), (4, [1, 1])] {
            let go_on = |x: u32, y: u32| {
                let clamp = |v: u32, side: u32| (v / m).min(side - 1) * m + v % m;
                busy(clamp(x, width), clamp(y, height), m)
            };
            let mut rig = Rig::new(m, width, height, SHOW_USER);
            rig.fill(go_on);
            let mut padded = Rig::new(m, width.next_multiple_of(8) + 8, height.next_multiple_of(8) + 8, SHOW_USER);
            padded.camera = camera(1.0);
            padded.fill(go_on);
            let (cut, whole) = (rig.run(settings), padded.run(settings));
            for (i, (plan, pixel)) in cut.plan.iter().zip(&cut.image).enumerate() {
                let at = i / width as usize * padded.size[0] as usize + i % width as usize;
                assert_eq!((plan, pixel), (&whole.plan[at], &whole.image[at]), "m = {m} {width}×{height}, window {i}");
            }
        }
    }
}

/// On either side of a wall one lamp shines, and not the same: as many, as the paper counts, and others.
#[test]
fn other_lights_are_not_as_many_lights() {
    use std::f32::consts::FRAC_PI_2;
    let upright = Mat4::from_translation(vec3(0.0, 0.25, 0.0))
        * Mat4::from_rotation_z(FRAC_PI_2)
        * Mat4::from_scale(vec3(0.25, 1.0, 4.0));
    let mut scene = scene(vec![square()], &[(0, Mat4::IDENTITY), (0, upright)]);
    scene.sun = None;
    scene.lights = [-3.0, 3.0].map(|x| light(LightKind::Point, vec3(x, 2.0, 0.0), 100.0)).to_vec();
    let mut host = host(scene, 2, [32, 32]);
    // From above, so that the wall is a line.
    let camera = looking(vec3(0.0, 1.5, 0.0), Vec3::ZERO, 0.01);
    let only_shadows =
        Selective { enabled: Enabled { psc: true, ..Enabled::NONE }, tau_psc: 0.0, ..Default::default() };
    let mut chosen = |shadow_lights| {
        let shot = host.frame(&camera, selective(Selective { shadow_lights, ..only_shadows })).unwrap();
        shot.statistics.quadrants.shadow
    };
    // A pixel to the left and one to the right of it, two quadrants each, all the way down.
    assert!(chosen(true) >= 4 * 28, "{}", chosen(true));
    assert_eq!(chosen(false), 0);
}

/// The same frame twice is the same bits, and the debug view is the plan's.
#[test]
fn quadrants_are_shown_as_the_plan_has_them() {
    let mut rig = Rig::new(4, 37, 21, SHOW_USER);
    rig.fill(|x, y| busy(x, y, 4));
    let settings = selective(Selective { tau_col: 0.3, ..Default::default() });
    let found = rig.run(settings);
    assert!(rig.run(settings).image == found.image);
    let view = rig.run(Settings { view: DebugView::Quadrants, ..settings });
    const COLORS: [[f32; 4]; 5] =
        [[0., 0., 0., 1.], [1., 0., 0., 1.], [0., 1., 0., 1.], [0., 0., 1., 1.], [1., 1., 1., 1.]];
    let mut seen = [0; 5];
    for (pixel, plan) in view.image.iter().zip(&found.plan) {
        let active = plan.2.count_ones() as usize;
        assert_eq!(*pixel, COLORS[active]);
        seen[active] += 1;
    }
    assert!(seen.iter().all(|&s| s > 5), "{seen:?}");
    let windowed = rig.run(Settings { view: DebugView::Quadrants, ..Default::default() });
    assert!(windowed.image.iter().all(|c| *c == COLORS[0]));
}

#[test]
fn what_is_out_of_range_is_named() {
    let fields = ["tau_col", "tau_poid", "tau_psn", "tau_psc", "tau_pte", "tau_soid", "tau_ssn", "tau_ssc", "tau_ste"];
    for (field, (set, _)) in fields.into_iter().zip(THRESHOLDS) {
        for value in [f32::NAN, -1e-6, 1.000_1, f32::INFINITY] {
            let mut s = Selective::default();
            set(&mut s, value);
            let e = selective(s).validate().expect_err(field);
            assert_eq!((e.field, e.value.to_bits()), (&*format!("selective.{field}"), value.to_bits()));
        }
        for value in [0.0, 1.0] {
            let mut s = Selective::default();
            set(&mut s, value);
            assert_eq!(selective(s).validate(), Ok(()));
        }
    }
    let others = [
        ("selective.contrast_min", Selective { contrast_min: -0.1, ..Default::default() }),
        ("selective.normal_cosine", Selective { normal_cosine: 1.1, ..Default::default() }),
        ("selective.footprint", Selective { footprint: f32::NAN, ..Default::default() }),
    ];
    for (field, s) in others {
        assert_eq!(selective(s).validate().map_err(|e| e.field), Err(field));
    }
    for s in [Selective::default(), Selective::PAPER] {
        assert_eq!(selective(s).validate(), Ok(()));
    }

    let mut rig = Rig::new(2, 8, 8, SHOW_USER);
    let mut refused = |needs: Needs<'_>| {
        let plain = rig.try_record_with(Settings::default(), needs);
        assert!(plain.is_ok(), "only Selective reads them");
        rig.try_record_with(selective(Selective::default()), needs).map(drop).expect_err("refused")
    };
    let mark = |object, importance| ObjectImportance { object, importance };
    let beyond = refused(Needs { importance: &[mark(3, 1.0), mark(65_536, 1.0)], ..Default::default() });
    assert_eq!(beyond, RecordError::ImportantObject { index: 1, object: 65_536 });
    insta::assert_snapshot!(beyond, @"Needs::importance[1].object is 65536; the table ends at 65535, as the G-buffer's objects do");
    for importance in [-0.1, 1.1, f32::NAN] {
        let wrong = refused(Needs { importance: &[mark(3, importance)], ..Default::default() });
        assert_eq!(
            wrong.to_string(),
            format!("Needs::importance[0].importance is {importance}, it must lie in 0 to 1")
        );
    }
    let beyond = refused(Needs { textured: &[1, 2, 70_000], ..Default::default() });
    insta::assert_snapshot!(beyond, @"Needs::textured[2] is 70000; the G-buffer holds materials below 65536");
}
