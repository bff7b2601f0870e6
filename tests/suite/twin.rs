//! GPU and CPU twin on the same G-buffer: plan, mean, and the whole frame with an analytic hook.

use crate::harness::{Rig, SHOW_USER, Sample, noise, rgba8};
use deferred_aa::glam::{Vec2, Vec3};
use deferred_aa::reference::{list, max_filter, plan, reconstruct, resolve};
use deferred_aa::{
    DepthMeasure, Execution, LuminanceCurve, Reconstructed, Settings, Technique, Weight, Windowed, window,
};

/// A scene of everything: slanted planes, steps, curved normals, several materials, sky, noise.
fn busy(x: u32, y: u32) -> Sample {
    let (fx, fy) = (x as f32, y as f32);
    let object = 1 + x / 13 + y / 17 * 5;
    let step = noise(object) * 0.2;
    if object % 7 == 3 {
        return Sample::SKY;
    }
    let bend = noise(object + 100) * 0.05;
    Sample {
        depth: 0.02 + step + fx * 1e-5 * noise(object + 7) + fy * 2e-5,
        normal: Vec3::new((fx * bend).sin(), (fy * bend).cos() * 0.5, 1.0).normalize(),
        uv: Vec2::new(fx, fy) * 0.01,
        material: object % 3,
        object,
        user: rgba8(noise(object * 3), noise(object * 5), noise(x / 3 + y * 977), 1.0),
        ..Default::default()
    }
}

fn variants() -> Vec<Windowed> {
    let base = Windowed::default();
    vec![
        base,
        Windowed::PAPER,
        Windowed { depth: DepthMeasure::Variance, depth_scale: 300.0, normal_scale: 0.0, luminance_scale: 0.0, ..base },
        Windowed { depth_scale: 100.0, normal_scale: 0.0, luminance_scale: 0.0, ..base },
        Windowed { depth_scale: 0.0, normal_scale: 7.0, luminance_scale: 0.0, two_sided: true, ..base },
        Windowed { depth_scale: 0.0, normal_scale: 0.0, luminance: LuminanceCurve::Linear, ..base },
        Windowed { depth_scale: 0.0, normal_scale: 0.0, luminance_scale: 0.0, identity_samples: 3.0, ..base },
    ]
}

#[test]
fn every_window_size_and_metric_agrees_with_the_twin() {
    for m in 1..=8 {
        let mut rig = Rig::new(m, 37, 21, SHOW_USER);
        rig.fill(busy);
        for windowed in variants() {
            let settings = Settings { windowed, ..Default::default() };
            let output = rig.run(settings);
            let worths = rig.assert_twin_agrees(&settings, &output);
            let apart = worths.iter().zip(&output.plan).filter(|(w, p)| w.k != p.0).count();
            assert!(apart as f64 <= 0.01 * worths.len() as f64, "m = {m}: {apart} windows differ");
            // The plan of those counts, and the statistics of that plan.
            let counts: Vec<u32> = output.plan.iter().map(|p| p.0).collect();
            let (planned, overflowed) = plan::plan(&counts, 37, 21, windowed.tile_limit);
            let index = |x: usize, y: usize| (y / 8 * 5 + x / 8) * 64 + y % 8 * 8 + x % 8;
            for (i, p) in output.plan.iter().enumerate() {
                assert_eq!(planned[index(i % 37, i / 37)].before, p.2, "m = {m}, window {i}");
            }
            assert_eq!(overflowed, output.statistics.overflowed_tiles);
            assert_eq!(output.statistics.shaded, counts.iter().map(|&k| u64::from(k)).sum::<u64>());
        }
    }
}

#[test]
fn the_whole_frame_is_the_twins() {
    for (m, weight) in [(2, Weight::Linear), (3, Weight::Luminance), (4, Weight::Linear), (5, Weight::Luminance)] {
        let mut rig = Rig::new(m, 37, 21, SHOW_USER);
        rig.fill(busy);
        let order = window::order(m);
        for technique in [Technique::Full, Technique::Single, Technique::Windowed] {
            for execution in Execution::ALL {
                let output = rig.run(Settings { technique, execution, weight, ..Default::default() });
                for (i, pixel) in output.image.iter().enumerate() {
                    let (x, y) = (i as u32 % 37, i as u32 / 37);
                    let k = match technique {
                        Technique::Full => m * m,
                        Technique::Single => 1,
                        _ => output.plan[i].0,
                    };
                    let samples: Vec<[f64; 4]> = order[..k as usize]
                        .iter()
                        .map(|&(sx, sy)| {
                            let s = busy(x * m + u32::from(sx), y * m + u32::from(sy));
                            // The sky is transparent black: the hook has no `sky`.
                            if s.depth == 0.0 { [0.0; 4] } else { s.user.to_le_bytes().map(|c| f64::from(c) / 255.0) }
                        })
                        .collect();
                    let expected = resolve::mean(&samples, weight, 1.0);
                    for c in 0..4 {
                        let apart = (f64::from(pixel[c]) - expected[c]).abs();
                        assert!(apart <= 1e-6, "m = {m} {technique:?} {execution:?} {i}.{c}: {pixel:?} {expected:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_lists_are_the_twins() {
    // 9 and 1 to 5 tiles, more than a workgroup scans one by one, and m from nothing to list to the longest windows.
    for (m, [width, height]) in [(1, [9, 9]), (2, [37, 21]), (3, [300, 190]), (4, [37, 21]), (8, [19, 33])] {
        let mut rig = Rig::new(m, width, height, SHOW_USER);
        rig.fill(busy);
        let n = m * m;
        let looped = rig.run(Settings { execution: Execution::Loop, ..Default::default() });
        let counts: Vec<u32> = looped.plan.iter().map(|p| p.0).collect();
        let (planned, _) = plan::plan(&counts, width, height, Windowed::NO_TILE_LIMIT);
        let pixels = list::pixels(&planned, n);
        let samples = list::samples(&planned, n);
        assert!(m == 1 || samples.len() > 64, "m = {m}: nothing to list");
        for execution in [Execution::Sorted, Execution::Bucketed, Execution::Packed] {
            let output = rig.run(Settings { execution, ..Default::default() });
            assert_eq!((&output.image, &output.plan), (&looped.image, &looped.plan), "m = {m} {execution:?}");
            let passed = rig.aa.intermediates().expect("a size");
            let (buffer, twin) = match execution {
                Execution::Packed => (passed.sample_list, &samples),
                _ => (passed.pixel_list, &pixels),
            };
            let words: Vec<u32> = bytemuck::pod_collect_to_vec(&rig.gpu.read_buffer(buffer.expect("a list")));
            assert!(words[..twin.len()] == twin[..], "m = {m} {execution:?}");
        }
    }
}

#[test]
fn the_max_filter_is_the_twins() {
    for (m, [width, height]) in [(2, [37, 21]), (4, [50, 97])] {
        let mut rig = Rig::new(m, width, height, SHOW_USER);
        rig.fill(busy);
        let looped = rig.run(Settings { execution: Execution::Loop, ..Default::default() });
        let filtered = rig.run(Settings { execution: Execution::MaxFiltered, ..Default::default() });
        let counts: Vec<u32> = looped.plan.iter().map(|p| p.0).collect();
        let expected = max_filter::max_filter(&counts, width, height);
        assert!(filtered.plan.iter().map(|p| p.0).eq(expected), "m = {m}");
        assert!(filtered.statistics.shaded > looped.statistics.shaded);
    }
}

/// Ours, the paper's, and each addition alone, on everything at once: colours, and how many samples were shaded.
#[test]
fn reconstructions_are_the_twins() {
    let paper = Reconstructed::PAPER;
    let ours = Reconstructed::default();
    let variants = [
        ours,
        paper,
        Reconstructed { contrast_scale: 0.0, ..ours },
        Reconstructed { own_first: false, least_weight: 3.0, ..ours },
        Reconstructed { planes: true, normal_scale: 4.0, ..paper },
        Reconstructed { cut_identity: true, ..paper },
        // Row 23: nothing agrees but with itself.
        Reconstructed { depth_scale: 1e6, normal_scale: 1e6, rotated_grid: false, ..paper },
    ];
    for m in [1, 2, 4, 5] {
        let mut rig = Rig::new(m, 37, 21, SHOW_USER);
        rig.fill(busy);
        for reconstructed in variants {
            let settings = Settings { technique: Technique::Reconstructed, reconstructed, ..Default::default() };
            let output = rig.run(settings);
            let order = if reconstructed.rotated_grid { window::rotated(m) } else { window::order(m) };
            let shade = |x: u32, y: u32, rank: u32| {
                let (sx, sy) = order[rank as usize];
                let s = busy(x * m + u32::from(sx), y * m + u32::from(sy));
                if s.depth == 0.0 { [0.0; 4] } else { s.user.to_le_bytes().map(|c| f64::from(c) / 255.0) }
            };
            let (mut unsure, mut shaded) = (0, 0);
            rig.with_input(|input| {
                let twin = reconstruct::Input {
                    camera: rig.camera,
                    m,
                    size: rig.size,
                    depth: input.depth,
                    surface: input.surface,
                    first: input.first,
                    shadow: &|_, _, _| 0,
                    shade: &shade,
                };
                for (i, (pixel, plan)) in output.image.iter().zip(&output.plan).enumerate() {
                    let expected = twin.pixel(i as u32 % 37, i as u32 / 37, &reconstructed);
                    assert!(pixel.iter().all(|c| c.is_finite()));
                    shaded += u64::from(plan.0);
                    if !expected.sure {
                        unsure += 1;
                        continue;
                    }
                    assert_eq!(plan.0, expected.k, "m = {m} {reconstructed:?} {i}");
                    for c in 0..4 {
                        let apart = (f64::from(pixel[c]) - expected.color[c]).abs();
                        assert!(apart <= 2e-3, "m = {m} {reconstructed:?} {i}.{c}: {pixel:?} {expected:?}");
                    }
                }
            });
            assert!(unsure < 37 * 21 / 10, "m = {m} {reconstructed:?}: {unsure} unsure");
            assert_eq!(output.statistics.shaded, shaded);
        }
    }
}
