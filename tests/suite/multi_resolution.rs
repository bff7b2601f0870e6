//! `Technique::MultiResolution`: every point of every lattice against the twin, and the hard cases.

use crate::harness::{Output, Rig, SHOW_USER, Sample, noise, rgba8};
use crate::shadows::{full, host};
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::Vec3;
use deferred_aa::reference::multi_resolution::{Input, Lattice as Points, by, steps};
use deferred_aa::reference::rays::shared_exponent;
use deferred_aa::reference::reconstruct::View;
use deferred_aa::{
    DebugView, Effect, Execution, Lattice, LuminanceCurve, MultiResolution, Pattern, RecordError, Settings, Technique,
    window,
};
use deferred_aa_demo::host::Host;
use deferred_aa_demo::quality::psnr;
use deferred_aa_demo::raster::node_camera;
use deferred_aa_demo::scene::builtin;

const PATTERNS: [Pattern; 3] = [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral];

fn multi(multi_resolution: MultiResolution) -> Settings {
    Settings { technique: Technique::MultiResolution, multi_resolution, ..Default::default() }
}

fn undersampled(pattern: Pattern, coarsest: u32) -> MultiResolution {
    let lattice = Lattice { pattern, coarsest };
    MultiResolution { shading: lattice, rays: lattice, supersampled: false, ..Default::default() }
}

/// Slanted and bent planes of several objects, some even in colour, some rough, with sky and a wire.
fn scene(x: u32, y: u32, m: u32) -> Sample {
    let (fx, fy) = (x as f32 / m as f32, y as f32 / m as f32);
    let object = 1 + (fx / 15.0) as u32 + (fy / 11.0) as u32 * 5;
    if object % 7 == 3 {
        return Sample::SKY;
    }
    let wire = (fx - fy * 0.7 - 12.0).abs() < 0.4;
    let bend = if object % 3 == 1 { noise(object + 100) * 0.1 } else { 0.0 };
    let rough = if object % 3 == 2 { 0.6 } else { 0.02 };
    let shade = |i: u32| 0.9 * noise(object * 3 + i) * (1.0 - rough * noise(x * 7 + i + y * 977)) + 0.002 * fx;
    Sample {
        depth: if wire { 0.3 } else { 0.02 + noise(object) * 0.1 + fx * 1e-3 * noise(object + 7) },
        normal: Vec3::new((fx * bend).sin(), (fy * bend).sin() * 0.5, 1.0).normalize(),
        material: object % 3,
        object: if wire { 40 } else { object },
        user: if wire { rgba8(1.0, 0.0, 0.0, 1.0) } else { rgba8(shade(0), shade(1), shade(2), 1.0) },
        ..Default::default()
    }
}

fn radiance(sample: &Sample) -> [f64; 4] {
    if sample.depth == 0.0 { [0.0; 4] } else { sample.user.to_le_bytes().map(|c| f64::from(c) / 255.0) }
}

/// Every setting off its default, besides ours and the paper's.
fn variants() -> Vec<MultiResolution> {
    let ours = MultiResolution::default();
    let mut all = vec![ours, MultiResolution::PAPER];
    for pattern in PATTERNS {
        all.extend((0..=3).map(|coarsest| undersampled(pattern, coarsest)));
        let bare = MultiResolution { veto: false, weighted: false, ..undersampled(pattern, 3) };
        all.push(MultiResolution { color_threshold: 0.05, position_threshold: 0.1, ..bare });
        all.push(MultiResolution { weighted: true, position_threshold: 1.0, color_threshold: 1.0, ..bare });
        all.push(MultiResolution { supersampled: true, color_threshold: 0.04, ..undersampled(pattern, 1) });
    }
    all.push(MultiResolution { curve: LuminanceCurve::Linear, veto: false, color_threshold: 0.1, ..ours });
    all.push(MultiResolution { color_threshold: 0.0, position_threshold: 0.0, ..undersampled(Pattern::Quad, 2) });
    all
}

/// The words and colours of all points.
fn points(aa: &deferred_aa::DeferredAa, gpu: &deferred_aa_demo::gpu::Gpu) -> (Vec<[u32; 4]>, Vec<[f32; 4]>) {
    let [words, colors] = aa.intermediates().expect("a size").lattices.expect("lattices");
    (pod_collect_to_vec(&gpu.read_buffer(words)), pod_collect_to_vec(&gpu.read_buffer(colors)))
}

fn each(l: &Points) -> impl Iterator<Item = [i64; 2]> + use<> {
    let [width, height] = l.size.map(i64::from);
    (0..height).flat_map(move |j| (0..width).map(move |i| [i, j]))
}

fn close(a: [f64; 4], b: [f32; 4], within: f64) -> bool {
    a.into_iter().zip(b).all(|(a, b)| (a - f64::from(b)).abs() <= within)
}

#[test]
fn every_point_is_the_twins() {
    for m in [2, 3, 4, 6, 8] {
        let (width, height) = if m < 5 { (61, 43) } else { (37, 21) };
        let mut rig = Rig::new(m, width, height, SHOW_USER);
        rig.fill(|x, y| scene(x, y, m));
        let order = window::order(m);
        let at = |[x, y, rank]: [u32; 3]| {
            let place = order[rank as usize];
            radiance(&scene(x * m + u32::from(place.0), y * m + u32::from(place.1), m))
        };
        let (mut all, mut unsure, mut reasons) = (0, 0, [0; 6]);
        for settings in variants() {
            let output = rig.run(multi(settings));
            let (words, colors) = points(&rig.aa, &rig.gpu);
            rig.with_input(|found| {
                let input = Input {
                    view: View::new(&rig.camera),
                    m,
                    places: &order,
                    size: rig.size,
                    depth: found.depth,
                    surface: found.surface,
                    exposure: 1.0,
                    shadow: &|_, _| 0,
                    value: &|index, _| colors[index].map(f64::from),
                };
                let filter = Settings::default().reconstructed;
                let mut sampled = 0;
                for step in steps(&settings, rig.size, false) {
                    for place in each(&step.points) {
                        let index = step.points.index(place);
                        let (word, color) = (words[index][0] & 0xffff, colors[index]);
                        let own = at(input.sample(&step.points, place));
                        let expected = input.refine(&step, place, &settings, &filter, &|i| words[i][0]);
                        all += 1;
                        let chosen = word & 1 != 0;
                        sampled += u64::from(chosen);
                        let context = format!("m = {m} {settings:?} {:?} {place:?}", step.points);
                        assert!(!chosen || close(own, color, 1e-6), "{context}: {color:?}, not {own:?}");
                        let Some(expected) = expected else {
                            assert_eq!(word, 3 | step.points.place << 4 | by::COARSEST << 8, "{context}");
                            continue;
                        };
                        reasons[(word >> 8) as usize] += 1;
                        if !expected.sure {
                            unsure += 1;
                            continue;
                        }
                        assert_eq!(word, expected.word, "{context}: {expected:?}");
                        if let Some(value) = expected.value {
                            assert!(close(value, color, 1e-4), "{context}: {color:?}, not {value:?}");
                        }
                    }
                }
                let counted: u64 = output.statistics.points.sum();
                assert_eq!(counted, sampled, "m = {m} {settings:?}");
                let pixels = steps(&settings, rig.size, false).last().expect("a step").points;
                let beyond: u64 = (0..height)
                    .flat_map(|y| (0..width).map(move |x| (x, y)))
                    .map(|(x, y)| {
                        let index = pixels.index([i64::from(x), i64::from(y)]);
                        let (image, first) = (output.image[(y * width + x) as usize], colors[index].map(f64::from));
                        if !settings.supersampled {
                            assert!(close(first, image, 1e-6));
                            return 0;
                        }
                        let own = words[index][0] & 2 != 0;
                        let (k, sure) = input.windows(&pixels, x, y, own, &settings);
                        let found = output.plan[(y * width + x) as usize].0;
                        assert!(!sure || k == found, "m = {m} {settings:?} {x} {y}: k {found}, not {k}");
                        let others = (1..found.max(1)).map(|rank| at([x, y, rank]));
                        let sum = others.fold(first, |sum, c| std::array::from_fn(|i| sum[i] + c[i]));
                        let mean = sum.map(|c| c / f64::from(found.max(1)));
                        assert!(close(mean, image, 1e-5), "m = {m} {settings:?} {x} {y}: {image:?}, not {mean:?}");
                        u64::from(found.max(1)) - 1
                    })
                    .sum();
                assert_eq!(output.statistics.shaded, sampled + beyond, "m = {m} {settings:?}");
            });
        }
        assert!(unsure * 100 < all, "m = {m}: {unsure} of {all} unsure");
        // Nothing casts a shadow here.
        for (reason, &count) in reasons.iter().enumerate().filter(|&(reason, _)| reason != by::SHADOW as usize) {
            assert!(count > 20, "m = {m}: {count} for {reason}");
        }
    }
}

fn codes(host: &Host, reflections: bool) -> Vec<u32> {
    let passed = host.aa.intermediates().expect("a size");
    let buffer = if reflections { passed.reflections } else { passed.shadows };
    buffer.map_or(Vec::new(), |buffer| pod_collect_to_vec(&host.gpu.read_buffer(buffer)))
}

/// Where the code of a sample lies in [`codes`].
fn code_index(host: &Host, [x, y, rank]: [u32; 3]) -> usize {
    let passed = host.aa.intermediates().expect("a size");
    passed.slots.sample(x, y, rank)
}

/// Points that cast rays found what full supersampling does there, the others have what the twin makes of those around
/// them.
#[test]
fn rays_are_cast_where_the_twin_says() {
    for (name, size) in [("cornell", [56, 56]), ("shadows", [64, 36]), ("mirrors", [64, 36])] {
        let scene = builtin::builtin(name).unwrap();
        let view = scene.default_camera();
        let m = 2;
        let mut host = host(scene, m, size);
        host.frame(&view, full()).unwrap();
        let (all_bits, all_codes) = (codes(&host, false), codes(&host, true));
        let (mut cast, mut interpolated, mut unsure) = (0, 0, 0);
        for pattern in PATTERNS {
            for settings in [
                undersampled(pattern, 3),
                MultiResolution { veto: false, weighted: false, ..undersampled(pattern, 2) },
                MultiResolution {
                    shading: Lattice { pattern: Pattern::Triangular, coarsest: 1 },
                    ..undersampled(pattern, 2)
                },
            ] {
                host.frame(&view, multi(settings)).unwrap();
                let (words, _) = points(&host.aa, &host.gpu);
                let (bits, reflections) = (codes(&host, false), codes(&host, true));
                let beyond = |rays| {
                    steps(&settings, size, rays).iter().map(|s| s.points.size[0] * s.points.size[1]).sum::<u32>()
                };
                // What rays found lies behind all points.
                let found = |index: usize| words[index + beyond(true) as usize];
                let decoded = |index: usize| {
                    let code = if reflections.is_empty() { 0 } else { found(index)[1] };
                    let [r, g, b] = shared_exponent::decode(code).to_array();
                    [r, g, b, f64::from(u8::from(code != 0))]
                };
                let input = Input {
                    view: View::new(&node_camera(&view, size[0], size[1])),
                    m,
                    places: &window::order(m),
                    size,
                    depth: &host.depths(),
                    surface: &host.surfaces(),
                    exposure: 1.0,
                    shadow: &|index, _| found(index)[0],
                    value: &|index, _| decoded(index),
                };
                for step in steps(&settings, size, true) {
                    for place in each(&step.points) {
                        let index = step.points.index(place);
                        let word = words[index][0] & 0xffff;
                        let sample = input.sample(&step.points, place);
                        let context = format!("{name} {settings:?} {:?} {place:?}", step.points);
                        let at = code_index(&host, sample);
                        let filter = Settings::default().reconstructed;
                        if word & 1 != 0 {
                            cast += 1;
                            assert_eq!(found(index)[0], all_bits[at], "{context}");
                            assert!(reflections.is_empty() || found(index)[1] == all_codes[at], "{context}");
                        }
                        let Some(expected) = input.refine(&step, place, &settings, &filter, &|i| words[i][0]) else {
                            continue;
                        };
                        if !expected.sure {
                            unsure += 1;
                            continue;
                        }
                        assert_eq!(word, expected.word, "{context}: {expected:?}");
                        if let (Some(value), 0) = (expected.value, word & 2) {
                            interpolated += 1;
                            assert_eq!(found(index)[0], expected.shadow, "{context}");
                            let found = decoded(index).map(|c| c as f32);
                            let greatest = value.into_iter().fold(0.0, f64::max);
                            let value = [value[0], value[1], value[2], f64::from(found[3])];
                            assert!(close(value, found, greatest / 200.0), "{context}: {found:?}, not {value:?}");
                        }
                    }
                }
                // Samples have what the last lattice found.
                let last = steps(&settings, size, true).last().expect("a step").points;
                for place in each(&last).filter(|&place| input.is_inside(&last, place)) {
                    let (index, at) = (last.index(place), code_index(&host, input.sample(&last, place)));
                    assert_eq!(bits[at], found(index)[0], "{name} {settings:?} {place:?}");
                    assert!(
                        reflections.is_empty() || reflections[at] == found(index)[1],
                        "{name} {settings:?} {place:?}"
                    );
                }
            }
        }
        assert!(cast > 1000 && interpolated > 1000, "{name}: {cast} cast, {interpolated} interpolated");
        assert!(unsure * 50 < cast + interpolated, "{name}: {unsure} unsure");
    }
}

/// Without a coarse lattice it is `Single`, bit for bit, rays and all.
#[test]
fn nothing_coarse_is_single() {
    for name in ["shadows", "mirrors", "atrium"] {
        let scene = builtin::builtin(name).unwrap();
        let view = scene.default_camera();
        let mut host = host(scene, 2, [64, 36]);
        host.frame(&view, Settings { technique: Technique::Single, ..Default::default() }).unwrap();
        let single = host.picture();
        host.frame(&view, multi(undersampled(Pattern::Quad, 0))).unwrap();
        assert!(host.picture().rgba == single.rgba, "{name}");
    }
}

/// What it leaves out is not seen, and it anti-aliases where it may.
#[test]
fn images_are_near_those_of_every_pixel_and_of_every_sample() {
    for (name, size, least) in
        [("cornell", [200, 200], 45.0f64), ("flat", [160, 90], 45.0), ("atrium", [320, 180], 40.0)]
    {
        let scene = builtin::builtin(name).unwrap();
        let view = scene.default_camera();
        let mut host = host(scene, 4, size);
        let mut picture = |settings: Settings| {
            let shot = host.frame(&view, settings).unwrap();
            (host.picture(), shot.statistics)
        };
        let (single, _) = picture(Settings { technique: Technique::Single, ..Default::default() });
        for pattern in PATTERNS {
            let (sparse, statistics) = picture(multi(undersampled(pattern, 2)));
            let found = psnr(&sparse, &single).unwrap();
            // Triangles have no sample at every other row's pixels.
            let least = if pattern == Pattern::Quad { least } else { least - 4.0 };
            assert!(found >= least, "{name} {pattern:?}: {found} dB");
            assert!(name == "atrium" || statistics.mean_k < 0.5, "{name} {pattern:?}: {}", statistics.mean_k);
        }
        let (all, _) = picture(full());
        let (ours, statistics) = picture(multi(MultiResolution::default()));
        let (found, alone) = (psnr(&ours, &all).unwrap(), psnr(&single, &all).unwrap());
        assert!(found >= least.max(alone), "{name}: {found} dB, Single {alone}");
        assert!(statistics.ratio < 0.6, "{name}: {}", statistics.ratio);
    }
}

/// A wire that `Single` shows is there, however coarse the lattice began; without the veto it is not.
#[test]
fn no_wire_of_the_fence_is_lost() {
    let scene = builtin::builtin("fence").unwrap();
    let view = scene.default_camera();
    let mut host = host(scene, 2, [320, 180]);
    host.frame(&view, Settings { technique: Technique::Single, ..Default::default() }).unwrap();
    let single = host.picture();
    let surfaces = host.surfaces();
    let first = window::order(2)[0];
    let identity =
        |x: u32, y: u32| surfaces[((y * 2 + u32::from(first.1)) * 640 + x * 2 + u32::from(first.0)) as usize][1];
    // A pixel that is thin: neither of the two beside it, or neither above and below, shows what it does.
    let thin: Vec<(u32, u32)> = (1..179)
        .flat_map(|y| (1..319).map(move |x| (x, y)))
        .filter(|&(x, y)| {
            let own = identity(x, y);
            let alone = |a: u32, b: u32| a != own && b != own;
            alone(identity(x - 1, y), identity(x + 1, y)) || alone(identity(x, y - 1), identity(x, y + 1))
        })
        .collect();
    assert!(thin.len() > 500, "{} thin pixels", thin.len());
    let mut lost = |settings: MultiResolution| {
        host.frame(&view, multi(settings)).unwrap();
        let found = host.picture();
        // It shows rather what lies beside it.
        let is_lost = |&&(x, y): &&(u32, u32)| {
            let at = (y * 320 + x) as usize;
            let beside = if identity(x - 1, y) != identity(x, y) { 1 } else { 320 };
            let apart = |a: [f32; 4], b: [f32; 4]| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f32>();
            let own = single.rgba[at];
            [at - beside, at + beside].into_iter().any(|other| {
                let other = single.rgba[other];
                apart(own, other) > 0.02 && apart(found.rgba[at], other) < apart(found.rgba[at], own)
            })
        };
        thin.iter().filter(is_lost).count()
    };
    for coarsest in 1..=3 {
        for pattern in PATTERNS {
            assert_eq!(lost(undersampled(pattern, coarsest)), 0, "{pattern:?} from {coarsest}");
        }
    }
    let bare = MultiResolution { veto: false, weighted: false, ..undersampled(Pattern::Quad, 3) };
    assert!(lost(MultiResolution { color_threshold: 0.2, position_threshold: 1.0, ..bare }) > 100);
}

/// What lies beyond the image has the border's windows, whatever the coarse cell.
#[test]
fn row_20_odd_sizes_are_cut_from_a_padded_image() {
    for (m, [width, height]) in [(2, [37, 21]), (4, [41, 9]), (3, [9, 1]), (4, [1, 17])] {
        let go_on = |x: u32, y: u32| {
            let clamp = |v: u32, side: u32| (v / m).min(side - 1) * m + v % m;
            scene(clamp(x, width), clamp(y, height), m)
        };
        let mut rig = Rig::new(m, width, height, SHOW_USER);
        rig.fill(go_on);
        let mut padded = Rig::new(m, width.next_multiple_of(8) + 24, height.next_multiple_of(8) + 24, SHOW_USER);
        padded.fill(go_on);
        for settings in variants() {
            let most = width.max(height).ilog2();
            if settings.shading.coarsest > most {
                continue;
            }
            // Positions are those of pixels, which the padding moves.
            let settings = MultiResolution { position_threshold: 1.0, weighted: false, ..settings };
            let (cut, whole) = (rig.run(multi(settings)), padded.run(multi(settings)));
            for (i, pixel) in cut.image.iter().enumerate() {
                let at = i / width as usize * padded.size[0] as usize + i % width as usize;
                assert_eq!(pixel, &whole.image[at], "m = {m} {width}×{height}, {settings:?}, window {i}");
            }
        }
    }
}

/// The same frame twice is the same bits, whatever runs it, and the debug view is the points'.
#[test]
fn levels_are_shown_as_the_points_have_them() {
    let mut rig = Rig::new(4, 61, 43, SHOW_USER);
    rig.fill(|x, y| scene(x, y, 4));
    let seen = |output: &Output| {
        let mut colors: Vec<[u32; 3]> = output.image.iter().map(|c| [c[0] as u32, c[1] as u32, c[2] as u32]).collect();
        colors.sort_unstable();
        colors.dedup();
        colors
    };
    for (pattern, colors) in [
        (Pattern::Quad, vec![[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]]),
        (Pattern::Triangular, vec![[0, 0, 0], [0, 1, 0], [0, 1, 1], [1, 0, 0], [1, 1, 0], [1, 1, 1]]),
    ] {
        for supersampled in [false, true] {
            let settings = multi(MultiResolution { supersampled, ..undersampled(pattern, 3) });
            let view = rig.run(Settings { view: DebugView::Levels, ..settings });
            assert_eq!(seen(&view), colors, "{pattern:?} {supersampled}");
            let image = rig.run(settings).image;
            assert!(rig.run(settings).image == image);
            for execution in Execution::ALL {
                let other = rig.run(Settings { execution, ..settings }).image;
                let apart = other.iter().flatten().zip(image.iter().flatten()).map(|(a, b)| (a - b).abs());
                assert!(execution == Execution::MaxFiltered || apart.fold(0.0, f32::max) < 1e-6, "{execution:?}");
            }
        }
    }
    let windowed = rig.run(Settings { view: DebugView::Levels, ..Default::default() });
    assert_eq!(seen(&windowed), [[0, 0, 0]]);
}

#[test]
fn what_does_not_fit_is_named() {
    let ours = MultiResolution::default();
    for value in [f32::NAN, -1e-6, 4.000_1, f32::INFINITY] {
        for (field, s) in [
            ("color_threshold", MultiResolution { color_threshold: value, ..ours }),
            ("position_threshold", MultiResolution { position_threshold: value, ..ours }),
            ("footprint", MultiResolution { footprint: value, ..ours }),
        ] {
            let e = multi(s).validate().expect_err(field);
            assert_eq!((e.field, e.value.to_bits()), (&*format!("multi_resolution.{field}"), value.to_bits()));
        }
    }
    let coarse = |coarsest| Lattice { coarsest, ..Default::default() };
    let shading = MultiResolution { shading: coarse(4), ..Default::default() };
    let rays = MultiResolution { rays: coarse(u32::MAX), ..Default::default() };
    assert_eq!(multi(shading).validate().map_err(|e| e.field), Err("multi_resolution.shading.coarsest"));
    assert_eq!(multi(rays).validate().map_err(|e| e.field), Err("multi_resolution.rays.coarsest"));
    for s in variants() {
        assert_eq!(multi(s).validate(), Ok(()));
    }

    let mut rig = Rig::new(1, 3, 2, SHOW_USER);
    rig.fill(|_, _| Sample::default());
    let e = rig.try_record(multi(undersampled(Pattern::Quad, 2))).expect_err("cells of 4");
    assert_eq!(e.to_string(), "multi_resolution.shading.coarsest is 2: cells of 4 pixels don't fit 3×2; 1 does");
    let deeper = MultiResolution { rays: coarse(3), ..undersampled(Pattern::Quad, 1) };
    let e = rig.try_record(multi(deeper)).expect_err("cells of 8");
    assert!(matches!(e, RecordError::Coarsest { lattice: "rays", coarsest: 3, most: 1, .. }), "{e}");
    let e = rig.try_record(multi(undersampled(Pattern::Triangular, 1))).expect_err("no half pixel");
    assert_eq!(
        e.to_string(),
        "multi_resolution.shading.pattern is Triangular: its rows are shifted by half a pixel, where a node with m = 1 has \
         no sample; use Pattern::Quad, or a node with a larger m"
    );
    let fits = MultiResolution {
        rays: Lattice { pattern: Pattern::Triangular, coarsest: 1 },
        ..undersampled(Pattern::Quad, 1)
    };
    assert!(rig.run(multi(fits)).image.iter().all(|c| c.iter().all(|c| c.is_finite())));
    // Other techniques do not look at it.
    rig.run(Settings { multi_resolution: undersampled(Pattern::Triangular, 3), ..Default::default() });
}

/// Nothing is traced, bound or recorded that the scene does not call for.
#[test]
fn passes_are_those_of_the_lattices() {
    let names = |settings: Settings| {
        let needs = deferred_aa::Needs::default();
        deferred_aa::DeferredAa::passes(&settings, &needs).map(|p| p.info.name).collect::<Vec<_>>()
    };
    assert_eq!(names(multi(undersampled(Pattern::Quad, 0))), ["points", "resolve"]);
    let four = ["points 1/4", "refine 1/2", "points 1/2", "refine", "points"];
    assert_eq!(names(multi(undersampled(Pattern::Quad, 2))), [&four[..], &["resolve"]].concat());
    let windows = ["lattice_to_pixels", "plan", "list", "shade", "resolve"];
    assert_eq!(names(multi(MultiResolution::default())), [&four[..], &windows].concat());
    let shifted = ["points 1/2", "refine shifted", "points shifted", "refine", "points", "resolve"];
    assert_eq!(names(multi(undersampled(Pattern::Triangular, 1))), shifted);
    let traced =
        Settings { shadows: Effect::On, reflections: Effect::On, ..multi(undersampled(Pattern::Equilateral, 1)) };
    let rays = [
        "trace 1/2",
        "reflect 1/2",
        "refine rays",
        "trace",
        "reflect",
        "refine rays shifted",
        "trace shifted",
        "reflect shifted",
    ];
    assert_eq!(names(traced), [&rays[..], &shifted].concat());
}

/// Bytes are those of the lattices that a frame goes through, and rays have none where nothing is traced.
#[test]
fn lattices_hold_what_they_need() {
    let mut rig = Rig::new(2, 256, 256, SHOW_USER);
    rig.fill(|x, y| scene(x, y, 2));
    let before = rig.aa.memory().scratch;
    let mut a_pixel = |pattern| {
        rig.run(multi(undersampled(pattern, 2)));
        (rig.aa.memory().scratch - before) / (256 * 256)
    };
    assert_eq!(a_pixel(Pattern::Quad), 42);
    assert_eq!(a_pixel(Pattern::Triangular), 75);
    // What is there is kept.
    assert_eq!(a_pixel(Pattern::Quad), 75);
}
