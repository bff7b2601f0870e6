//! Rows 1 to 5, 10 and 21: what the metrics measure.

use super::{SHOW_FLOAT, SHOW_GEOMETRY, assert_finite, by_depth, by_luminance, by_normal, counts, presets};
use crate::harness::{Rig, SHOW_USER, Sample, WHITE, noise, rgba8, stored_normal};
use deferred_aa::glam::Vec3;
use deferred_aa::reference::metrics::SKY_DEPTH;
use deferred_aa::{DecidedBy, DepthMeasure, LuminanceCurve, Settings, Technique, Windowed};

/// k of one window by E[d²] − E[d]² in f32: the formula that cancels.
fn naive_variance_k(depths: &[f32], scale: f32) -> u32 {
    let n = depths.len() as f32;
    let mean = depths.iter().sum::<f32>() / n;
    let variance = depths.iter().map(|d| d * d).sum::<f32>() / n - mean * mean;
    (scale * variance / (mean * mean)).clamp(1.0, n).round_ties_even() as u32
}

// ---- Row 1: variance far from zero ----

#[test]
fn row_01_variance_does_not_cancel() {
    // Depths of 0.5 (1 ± a), a from 1e-5 (the 100 ± 0.001 of the list) to 1.6e-4 over the columns: the greatest scale
    // makes k of variances that f32 loses beside E[d²].
    const SCALE: f32 = 1e9;
    let (w, h) = (32, 8);
    let mut rig = Rig::new(4, w, h, WHITE);
    let depth = |x: u32, y: u32| {
        let a = 1e-5 + 1.5e-4 * (x / 4) as f32 / w as f32;
        0.5 * (1.0 + a * (2.0 * noise(x + y * 997) - 1.0))
    };
    rig.fill(|x, y| Sample { depth: depth(x, y), ..Default::default() });
    let settings = by_depth(DepthMeasure::Variance, SCALE);
    let output = rig.run(settings);
    let worths = rig.assert_twin_agrees(&settings, &output);
    assert!(worths.iter().zip(&output.plan).filter(|(worth, p)| worth.k != p.0).count() <= 2);
    let k = counts(&output);
    assert!(k.contains(&1) && k.iter().any(|&k| k > 6), "{k:?}");
    // The figure of the list: ±1e-5 of the depth is a variance of at most 1e-10, a tenth of a sample here.
    assert!(k.iter().step_by(w as usize).all(|&k| k == 1));
    let naive = |i: usize| {
        let (px, py) = (i as u32 % w, i as u32 / w);
        let depths: Vec<f32> = (0..16).map(|s| depth(px * 4 + s % 4, py * 4 + s / 4)).collect();
        naive_variance_k(&depths, SCALE)
    };
    let wrong = (0..k.len()).filter(|&i| naive(i).abs_diff(worths[i].k) > 2).count();
    assert!(wrong > k.len() / 2, "the naive formula would do: {wrong} wrong");
}

#[test]
fn row_01_variance_is_never_below_zero() {
    // Equal depths that no power of two is near: nothing but a variance of 0 exactly has k = 1 under this scale.
    let depths = [0.1, 1.0 / 3.0, 0.7, 0.999_999_9, 1e-3, 1e-20, 3e-30];
    let mut rig = Rig::new(3, 7, 2, WHITE);
    rig.fill(|x, _| Sample { depth: depths[x as usize / 3], ..Default::default() });
    let settings = by_depth(DepthMeasure::Variance, 1e9);
    let output = rig.run(settings);
    rig.assert_twin_agrees(&settings, &output);
    assert_eq!(counts(&output), [1; 14]);
}

#[test]
fn row_01_the_variance_is_right_to_one_in_a_hundred_thousand() {
    // Depths of 0.01 (1 ± 1e-4): the scale at which k goes from 1 to 2 tells the variance.
    let w = 8;
    let mut rig = Rig::new(4, w, 1, WHITE);
    rig.fill(|x, y| Sample { depth: 0.01 * (1.0 + 1e-4 * (2.0 * noise(x + y * 997) - 1.0)), ..Default::default() });
    // The first frame fills what the twin reads.
    rig.run(by_depth(DepthMeasure::Variance, 1.0));
    for x in 0..w as usize {
        let variance = rig.with_input(|input| input.depth_variance(x, 0));
        assert!(variance > 1e-9);
        for (share, k) in [(1.0 - 1e-5, 1), (1.0 + 1e-5, 2)] {
            let output = rig.run(by_depth(DepthMeasure::Variance, (1.5 / variance * share) as f32));
            assert_eq!(output.plan[x].0, k, "window {x}, variance {variance:e}");
        }
    }
}

// ---- Row 2: slanted planes ----

/// Depth (near/z) over the image of a plane at 89° to the view: 1/z = (1 − tan 89° · X)/z₀ along a slanted direction.
fn grazing(x: u32, y: u32, m: u32) -> f32 {
    let along = 0.01 * (x as f32 * 0.8 + y as f32 * 0.6) / m as f32;
    1e-3 / (1.0 + 57.29 * 0.6) * (1.0 + 57.29 * along)
}

#[test]
fn row_02_a_plane_needs_one_sample_and_a_step_more_at_every_scale() {
    const SCALES: [f32; 5] = [1e-3, 1.0, 37.0, 1e3, 1e6];
    let (w, h) = (24, 10);
    let settings = by_depth(DepthMeasure::Discontinuity, Windowed::default().depth_scale);
    for m in [2, 3, 4, 8] {
        let mut rig = Rig::new(m, w, h, WHITE);
        // The step is in the middle of the windows of column 12 and row 5.
        let stepped = |x: u32, y: u32| x >= 12 * m + m / 2 || y >= 5 * m + m / 2;
        let mut verdicts = Vec::new();
        for scene in SCALES {
            rig.fill(|x, y| Sample { depth: grazing(x, y, m) / scene, ..Default::default() });
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
            assert!(output.plan.iter().all(|p| p.0 == 1), "m = {m}, scale {scene}: a plane is no edge");

            let raised = |x, y| if stepped(x, y) { 1.001 } else { 1.0 };
            rig.fill(|x, y| Sample { depth: grazing(x, y, m) / scene * raised(x, y), ..Default::default() });
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
            for (i, &(k, by, _)) in output.plan.iter().enumerate() {
                let (px, py) = (i as u32 % w, i as u32 / w);
                let on_step = (px == 12 && py <= 5) || (py == 5 && px <= 12);
                assert_eq!((k > 1, by == 1), (on_step, on_step), "m = {m}, scale {scene}, window {px}, {py}: k = {k}");
            }
            verdicts.push(counts(&output));
        }
        assert!(verdicts.windows(2).all(|pair| pair[0] == pair[1]), "m = {m}: the scale of the scene shows");
    }
}

#[test]
fn row_02_the_variance_does_see_a_slant() {
    // What the paper's measure does with the same plane, so that the test above is known to be hard.
    let mut rig = Rig::new(4, 24, 10, WHITE);
    rig.fill(|x, y| Sample { depth: grazing(x, y, 4), ..Default::default() });
    let settings = by_depth(DepthMeasure::Variance, Windowed::PAPER.depth_scale);
    let output = rig.run(settings);
    rig.assert_twin_agrees(&settings, &output);
    assert!(output.plan.iter().filter(|p| p.0 > 1).count() > 20);
}

// ---- Row 3: the sky ----

#[test]
fn row_03_the_sky_needs_one_sample_and_its_edge_more() {
    for m in [1, 2, 4, 7] {
        for (depth, normal_scale) in [(DepthMeasure::Discontinuity, 16.0), (DepthMeasure::Variance, 16.0)] {
            let mut rig = Rig::new(m, 9, 4, SHOW_GEOMETRY);
            let windowed = Windowed { depth, normal_scale, luminance_scale: 0.0, ..Default::default() };
            let settings = Settings { windowed, ..Default::default() };
            // Nothing but sky, cleared or drawn with rubbish in the other targets.
            rig.fill(|x, _| Sample { normal: Vec3::new(x as f32 - 9.0, 1.0, 0.5), object: x, ..Sample::SKY });
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
            assert_finite(&output, m * m);
            assert!(output.plan.iter().all(|p| p.0 == 1), "m = {m}, {depth:?}");

            // Its edge runs through the windows of column 4. The surface is as far as floats go, or as near.
            for surface in [2.0 * SKY_DEPTH, 1e-25, 1e-15, 1e-6, 0.5, 1.0] {
                let edge = 4 * m + m / 2;
                rig.fill(|x, _| if x >= edge { Sample::SKY } else { Sample { depth: surface, ..Default::default() } });
                let output = rig.run(settings);
                rig.assert_twin_agrees(&settings, &output);
                assert_finite(&output, m * m);
                for (i, &(k, ..)) in output.plan.iter().enumerate() {
                    assert_eq!(k > 1, m > 1 && i % 9 == 4, "m = {m}, {depth:?}, depth {surface}, window {i}: k = {k}");
                }
            }
        }
    }
}

#[test]
fn row_03_a_sky_of_several_objects_is_one() {
    let mut rig = Rig::new(4, 16, 8, WHITE);
    let windowed = Windowed { identity_samples: 16.0, ..Default::default() };
    let identity = Settings { windowed, ..Default::default() };
    for technique in Technique::ALL {
        let settings = Settings { technique, ..identity };
        let found = [true, false].map(|drawn| {
            rig.fill(|x, y| Sample { object: if drawn { x + 7 * y } else { 0 }, ..Sample::SKY });
            let output = rig.run(settings);
            if technique == Technique::Windowed {
                rig.assert_twin_agrees(&settings, &output);
            }
            (output.statistics.shaded, output.image)
        });
        assert_eq!(found[0], found[1], "{technique:?}");
    }
    // And another one than an object whose code is 0.
    rig.fill(|x, _| if x < 30 { Sample { object: 0, ..Default::default() } } else { Sample::SKY });
    let none = Windowed { depth_scale: 0.0, normal_scale: 0.0, luminance_scale: 0.0, ..windowed };
    let settings = Settings { windowed: none, ..Default::default() };
    let output = rig.run(settings);
    rig.assert_twin_agrees(&settings, &output);
    assert!(output.plan.iter().enumerate().all(|(i, p)| p.0 == if i % 16 == 7 { 16 } else { 1 }));
}

// ---- Row 4: normals that cancel ----

#[test]
fn row_04_normals_that_cancel_take_every_sample() {
    let spiral = |i: u32| {
        let z = 1.0 - (2.0 * i as f32 + 1.0) / 16.0;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        Vec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
    };
    for m in [2, 3, 4, 8] {
        let n = m * m;
        let mut rig = Rig::new(m, 4, 2, SHOW_GEOMETRY);
        rig.fill(|x, y| {
            let i = y % m * m + x % m;
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            let normal = match (x / m, n % 2) {
                // Both sides of a leaf.
                (0, 0) => Vec3::X * sign,
                // Spread over the sphere, each with its opposite.
                (1, 0) => spiral(i / 2 % 16) * sign,
                // An odd number: three at thirds of a turn.
                (0 | 1, _) => Vec3::new((i as f32 * 2.094_395_1).cos(), 0.0, (i as f32 * 2.094_395_1).sin()),
                // One side.
                (2, _) => Vec3::X,
                // Most of one side: with two-sided normals that is the same.
                _ => Vec3::X * if i % 4 == 3 { -1.0 } else { 1.0 },
            };
            Sample { normal, ..Default::default() }
        });
        for two_sided in [false, true] {
            let settings = by_normal(100.0, two_sided);
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
            assert_finite(&output, n);
            let most = if two_sided { 1 } else { n };
            assert_eq!(counts(&output), [[n, n, 1, most]; 2].concat(), "m = {m}, two-sided {two_sided}");
        }
        let off = rig.run(by_normal(0.0, false));
        assert_eq!(counts(&off), [1; 8]);
    }
}

// ---- Row 5: small angles ----

#[test]
fn row_05_small_angles_keep_their_digits() {
    // Columns of windows bent by 1e-4 rad and more, about the diagonal, where no code is exact.
    let (w, h) = (16, 4);
    let mut rig = Rig::new(4, w, h, WHITE);
    let base = Vec3::new(0.6, 0.5, 0.62).normalize();
    let across = base.any_orthonormal_vector();
    let normal = |x: u32| {
        let angle = 1e-4 * (1 + x / 4) as f32;
        let half = if x % 4 < 2 { 0.5 } else { -0.5 } * angle;
        (base + across * half).normalize()
    };
    rig.fill(|x, _| Sample { normal: normal(x), ..Default::default() });
    let scale = 6e4;
    let output = rig.run(by_normal(scale, false));
    let mut seen = 0;
    for (i, &(k, ..)) in output.plan.iter().enumerate() {
        let column = i as u32 % w;
        let (a, b) = (stored_normal(normal(column * 4)), stored_normal(normal(column * 4 + 3)));
        // √(1 − cos) in f64, where it keeps half its digits, and the twin's chord.
        let mean = (a + b).normalize();
        let exact = (1.0 - mean.dot(a).min(mean.dot(b))).max(0.0).sqrt();
        let twin = rig.with_input(|input| input.normal_cone(i % w as usize, i / w as usize, false));
        assert!((twin - exact).abs() <= 1e-3 * exact, "{twin} {exact}");
        let wanted = (f64::from(scale) * twin).clamp(1.0, 16.0);
        // Unit vectors in f32 are off by 6e-8, a part in 800 of the smallest chord.
        if ((wanted - wanted.floor()) - 0.5).abs() > 0.03 {
            assert_eq!(f64::from(k), wanted.round(), "window {i}: {wanted}");
            seen += 1;
        }
        // What 1 − n·n in f32 would have seen of the first column.
        if column == 0 {
            let (mean, a) = (mean.as_vec3().normalize(), a.as_vec3().normalize());
            let naive = scale * (1.0 - mean.dot(a)).max(0.0).sqrt();
            assert!(k > 1 && (naive - wanted as f32).abs() > 0.5, "the naive formula would do: {naive}, {wanted}");
        }
    }
    assert!(seen > 40, "{seen}");
}

#[test]
fn row_05_equal_normals_are_no_cone() {
    // Their dot product with themselves is 1 ± an ulp: never below 0 under the root, never a sample too many.
    for m in [2, 3, 4, 8] {
        let mut rig = Rig::new(m, 32, 32, WHITE);
        let normal = |x: u32, y: u32| {
            let seed = x / m + y / m * 131;
            Vec3::new(noise(seed), noise(seed + 9001), noise(seed + 18_007)) * 2.0 - 1.0
        };
        rig.fill(|x, y| Sample { normal: normal(x, y), ..Default::default() });
        let output = rig.run(by_normal(1e6, false));
        assert_eq!(counts(&output), [1; 1024], "m = {m}");
        // One code apart in a single sample: small, and a number.
        rig.fill(|x, y| {
            let nudge = if (x % m, y % m) == (m - 1, m - 1) { 4e-5 } else { 0.0 };
            Sample { normal: normal(x, y).normalize() + Vec3::splat(nudge), ..Default::default() }
        });
        let output = rig.run(by_normal(1e3, false));
        assert!(output.plan.iter().all(|p| p.0 == 1), "m = {m}");
        let seen = rig.run(by_normal(1e6, false)).plan.iter().filter(|p| p.0 > 1).count();
        assert!(seen > 500, "m = {m}: {seen}");
    }
}

// ---- Row 10: contrast near black ----

#[test]
fn row_10_noise_in_the_dark_is_no_edge() {
    let mut rig = Rig::new(2, 16, 16, SHOW_FLOAT);
    let dark = |x: u32, y: u32| (noise(x / 2 + y / 2 * 71) * 1e-8).to_bits();
    let curves = [LuminanceCurve::Linear, LuminanceCurve::Perceptual];
    let presets = presets();

    // Noise of 1e-8: 0/0 in a ratio, nothing here.
    rig.fill(|x, y| Sample { user: dark(x, y), ..Default::default() });
    for (luminance, preset) in curves.into_iter().flat_map(|c| presets.map(|p| (c, p))) {
        let settings = by_luminance(Windowed { luminance, luminance_scale: 1e6, ..preset });
        let output = rig.run(settings);
        rig.assert_twin_agrees(&settings, &output);
        assert_eq!(counts(&output), [1; 256], "{settings:?}");
        // Without thresholds it is an edge where the scale makes it one: nothing divides by the darkness.
        let bare = Windowed { luminance_min: 0.0, luminance_edge: 0.0, ..settings.windowed };
        let settings = Settings { windowed: bare, ..settings };
        let output = rig.run(settings);
        rig.assert_twin_agrees(&settings, &output);
        assert_finite(&output, 4);
        let most = if luminance == LuminanceCurve::Perceptual { 4 } else { 1 };
        assert_eq!(output.plan.iter().map(|p| p.0).max(), Some(most), "{settings:?}");
    }

    // Black, and black beside −0: a range of 0 at any thresholds, theirs included.
    rig.fill(|x, _| Sample { user: if x % 4 < 2 { 0 } else { 0x8000_0000 }, ..Default::default() });
    for luminance in curves {
        for (least, share) in [(0.0, 0.0), (0.0, 1.0), (1e6, 0.0), (0.02, 0.05)] {
            let w = Windowed {
                luminance,
                luminance_min: least,
                luminance_edge: share,
                luminance_scale: 1e6,
                ..Default::default()
            };
            let settings = by_luminance(w);
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
            assert_eq!(counts(&output), [1; 256]);
        }
    }
}

#[test]
fn row_10_thresholds_cut_where_they_say() {
    let mut rig = Rig::new(4, 12, 1, SHOW_FLOAT);
    let values: [f32; 12] = [0.0, 0.25, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 0.9, 0.9, 0.9];
    rig.fill(|x, _| Sample { user: values[x as usize / 4].to_bits(), ..Default::default() });
    let worth = |rig: &mut Rig, least: f32, share: f32| {
        let w = Windowed {
            luminance: LuminanceCurve::Linear,
            luminance_scale: 1e6,
            luminance_min: least,
            luminance_edge: share,
            ..Default::default()
        };
        let settings = by_luminance(w);
        let output = rig.run(settings);
        rig.assert_twin_agrees(&settings, &output);
        output.plan.iter().map(|p| p.0 == 16).collect::<Vec<_>>()
    };
    let (t, f) = (true, false);
    assert_eq!(worth(&mut rig, 0.0, 0.0), [t, t, t, t, f, t, t, f, t, t, f, f]);
    // Absolute.
    assert_eq!(worth(&mut rig, 0.499, 0.0), [f, f, t, t, f, t, t, f, f, f, f, f]);
    assert_eq!(worth(&mut rig, 0.501, 0.0), [f; 12]);
    // A share of the greatest. A range that reaches the threshold counts: black beside anything does at 1.
    assert_eq!(worth(&mut rig, 0.0, 0.45), [t, t, t, t, f, t, t, f, f, f, f, f]);
    assert_eq!(worth(&mut rig, 0.0, 1.0), [t, t, t, t, f, f, f, f, f, f, f, f]);
    // The greater of both.
    assert_eq!(worth(&mut rig, 0.3, 0.45), [f, f, t, t, f, t, t, f, f, f, f, f]);
}

#[test]
fn row_10_an_edge_of_hue_is_an_edge() {
    let mut rig = Rig::new(4, 16, 8, SHOW_USER);
    // Red and green of one luminance, and greys that differ by as much as their red does.
    let hues = [rgba8(1.0, 0.0, 0.0, 1.0), rgba8(0.0, 76.0 / 255.0, 0.0, 1.0)];
    let greys = [rgba8(1.0, 1.0, 1.0, 1.0), rgba8(0.0, 0.0, 0.0, 1.0)];
    let mut run = |colors: [u32; 2], settings: Settings| {
        rig.fill(|x, _| Sample { user: colors[usize::from(x >= 32)], ..Default::default() });
        let output = rig.run(settings);
        if settings.technique == Technique::Windowed {
            rig.assert_twin_agrees(&settings, &output);
        }
        counts(&output)
    };
    for preset in presets() {
        let settings = |luminance_channels| by_luminance(Windowed { luminance_channels, ..preset });
        let grey = run(greys, settings(false));
        assert!(grey.contains(&16), "{preset:?}");
        assert_eq!(run(greys, settings(true)), grey, "{preset:?}");
        assert_eq!(run(hues, settings(true)), grey, "{preset:?}");
        // The paper's metric is blind to it.
        assert_eq!(run(hues, settings(false)), [1; 128], "{preset:?}");
    }
    let settings = Settings { technique: Technique::Reconstructed, ..Default::default() };
    let grey = run(greys, settings);
    assert!(grey.contains(&16));
    assert_eq!(run(hues, settings), grey);
}

#[test]
fn row_10_the_hosts_bytes_count_where_they_are_asked_for() {
    let mut rig = Rig::new(4, 10, 8, WHITE);
    // A byte that rises from window to window, in each of the four, and the sky around one sample.
    rig.fill(|x, y| {
        let (window, byte) = (x / 4, y / 8);
        let here = Sample { user: (25 * window) << (8 * byte), ..Default::default() };
        match (window, x % 4 == 1 && y % 4 == 2) {
            (9, false) => Sample::SKY,
            (_, true) => here,
            _ => Sample { user: 0, ..here },
        }
    });
    let settings = |user_scale| {
        let none = Windowed { depth_scale: 0.0, normal_scale: 0.0, luminance_scale: 0.0, ..Default::default() };
        Settings { windowed: Windowed { user_scale, ..none }, ..Default::default() }
    };
    let output = rig.run(settings(20.0));
    rig.assert_twin_agrees(&settings(20.0), &output);
    for (i, &(k, by, _)) in output.plan.iter().enumerate() {
        let wanted = if i % 10 == 9 { 1.0 } else { (i % 10) as f64 * 25.0 / 255.0 * 20.0 };
        assert_eq!(k, wanted.clamp(1.0, 16.0).round_ties_even() as u32, "window {i}");
        assert_eq!(by == DecidedBy::User as u32, k > 1, "window {i}");
    }
    assert_eq!(output.statistics.decided.user as usize, output.plan.iter().filter(|p| p.0 > 1).count());
    // Any difference, and none.
    let all = rig.run(settings(255.0 * 16.0));
    assert!(all.plan.iter().enumerate().all(|(i, p)| p.0 == if matches!(i % 10, 0 | 9) { 1 } else { 16 }));
    assert_eq!(counts(&rig.run(settings(0.0))), [1; 80]);
}

// ---- Row 21: denormals ----

#[test]
fn row_21_denormals_are_zero_on_both_sides() {
    let depths = [0.0, 1e-40, 1e-38, 1e-31, 0.5, 1e-45];
    let values = [0.0, 1e-40, 1e-45, 1e-38, 0.5, 1e-30];
    let mut rig = Rig::new(4, 12, 12, SHOW_FLOAT);
    let all = [
        Settings::default(),
        Settings { windowed: Windowed::PAPER, ..Default::default() },
        by_depth(DepthMeasure::Discontinuity, 1e9),
        by_depth(DepthMeasure::Variance, 1e9),
        by_luminance(Windowed { luminance_scale: 1e6, luminance_min: 0.0, luminance_edge: 0.0, ..Default::default() }),
    ];
    // Nothing but denormal depths and radiance: sky and black, whatever the driver does with denormals.
    let pick = |list: [f32; 6], seed: u32, of: usize| list[(noise(seed) * of as f32) as usize];
    rig.fill(|x, y| Sample {
        depth: pick(depths, x + y * 53, 4),
        user: pick(values, x / 4 + y / 4 * 19, 4).to_bits(),
        ..Default::default()
    });
    for settings in all {
        let output = rig.run(settings);
        rig.assert_twin_agrees(&settings, &output);
        assert_finite(&output, 16);
        assert_eq!(counts(&output), [1; 144], "{settings:?}");
    }
    // On a surface.
    rig.fill(|x, y| Sample { user: pick(values, x / 4 + y / 4 * 19, 4).to_bits(), ..Default::default() });
    for settings in all {
        let output = rig.run(settings);
        rig.assert_twin_agrees(&settings, &output);
        assert_finite(&output, 16);
        assert_eq!(counts(&output), [1; 144], "{settings:?}");
    }
    // Among numbers.
    rig.fill(|x, y| Sample {
        depth: pick(depths, x + y * 53, 6),
        user: pick(values, x / 4 + y / 4 * 19, 6).to_bits(),
        ..Default::default()
    });
    for settings in all {
        let output = rig.run(settings);
        rig.assert_twin_agrees(&settings, &output);
        assert_finite(&output, 16);
    }
}
