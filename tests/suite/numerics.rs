//! Hard cases, one or more tests each, numbered as in the project's list: on the GPU, and held against the f64 twin.

use crate::harness::{Output, Rig, SHOW_USER, Sample, WHITE, camera, noise, rgba8, stored_normal};
use crate::textures::{SHOW_TEXTURE, Textured, fixed_k, full, level, mip_ruler, single, texture, tiers};
use deferred_aa::glam::camera::rh::proj::directx;
use deferred_aa::glam::{DVec3, Mat4, Vec2, Vec3, Vec4};
use deferred_aa::reference::metrics::SKY_DEPTH;
use deferred_aa::reference::{octahedral, plan, resolve};
use deferred_aa::wgpu::TextureFormat;
use deferred_aa::{
    Camera, DebugView, DecidedBy, DepthMeasure, Execution, LuminanceCurve, Preset, RecordError, Settings, TableSampler,
    Technique, TextureTier, Weight, Windowed,
};
use deferred_aa_demo::host::{Host, HostError, Options};
use deferred_aa_demo::scene::{Lens, builtin};

/// The user word as a grey radiance, of whatever bits: no compiler can know them.
const SHOW_FLOAT: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(vec3f(bitcast<f32>(s.user)), 1.0); }";

/// Everything of a sample that geometry feeds, so that a NaN in any of it is counted. Scaled: positions of far samples
/// are large on purpose.
const SHOW_GEOMETRY: &str = "
fn parts(s: DaaSample) -> vec4f {
    let p = clamp(abs(s.position) + abs(s.relative_position), vec3f(0.0), vec3f(1e30));
    let units = abs(s.view) + abs(s.normal) + abs(s.tangent.xyz) + abs(s.geometric_normal);
    return vec4f(p * 1e-30 + units, s.depth * 1e-30);
}
fn shade(s: DaaSample) -> vec4f { return parts(s); }
fn sky(s: DaaSample) -> vec4f { return parts(s); }";

/// Only the depth metric.
fn by_depth(depth: DepthMeasure, depth_scale: f32) -> Settings {
    let windowed = Windowed { depth, depth_scale, normal_scale: 0.0, luminance_scale: 0.0, ..Default::default() };
    Settings { windowed, ..Default::default() }
}

/// Only the normal metric.
fn by_normal(normal_scale: f32, two_sided: bool) -> Settings {
    let windowed = Windowed { depth_scale: 0.0, normal_scale, two_sided, luminance_scale: 0.0, ..Default::default() };
    Settings { windowed, ..Default::default() }
}

/// Only the luminance metric.
fn by_luminance(w: Windowed) -> Settings {
    Settings { windowed: Windowed { depth_scale: 0.0, normal_scale: 0.0, ..w }, ..Default::default() }
}

/// Ours and the paper's.
fn presets() -> [Windowed; 4] {
    let [fast, balanced, quality] = Preset::ALL.map(Preset::windowed);
    [fast, balanced, quality, Windowed::PAPER]
}

fn counts(output: &Output) -> Vec<u32> {
    output.plan.iter().map(|p| p.0).collect()
}

#[track_caller]
fn assert_finite(output: &Output, n: u32) {
    assert!(output.image.iter().flatten().all(|c| c.is_finite()), "not finite");
    assert!(output.plan.iter().all(|p| (1..=n).contains(&p.0)), "k out of range");
    assert_eq!(output.statistics.not_finite, 0);
}

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
        let mut rig = Rig::new(m, 3, 2, SHOW_GEOMETRY);
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
                _ => Vec3::X,
            };
            Sample { normal, ..Default::default() }
        });
        for two_sided in [false, true] {
            let settings = by_normal(1.0, two_sided);
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
            assert_finite(&output, n);
            assert_eq!(counts(&output), [n, n, 1, n, n, 1], "m = {m}, two-sided {two_sided}");
        }
        let off = rig.run(by_normal(0.0, false));
        assert_eq!(counts(&off), [1; 6]);
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
    let mut rig = Rig::new(4, 32, 32, WHITE);
    let normal = |x: u32, y: u32| {
        let seed = x / 4 + y / 4 * 131;
        Vec3::new(noise(seed), noise(seed + 9001), noise(seed + 18_007)) * 2.0 - 1.0
    };
    rig.fill(|x, y| Sample { normal: normal(x, y), ..Default::default() });
    let output = rig.run(by_normal(1e6, false));
    assert_eq!(counts(&output), [1; 1024]);
    // One code apart in a single sample: small, and a number.
    rig.fill(|x, y| {
        let nudge = if (x % 4, y % 4) == (3, 3) { 4e-5 } else { 0.0 };
        Sample { normal: normal(x, y).normalize() + Vec3::splat(nudge), ..Default::default() }
    });
    let output = rig.run(by_normal(1e3, false));
    assert!(output.plan.iter().all(|p| p.0 == 1));
    assert!(rig.run(by_normal(1e6, false)).plan.iter().filter(|p| p.0 > 1).count() > 500);
}

// ---- Row 6: octahedral codes ----

#[test]
fn row_06_normals_survive_the_gbuffer() {
    let (w, h) = (512, 400);
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::new(0.0, -0.0, -1.0)];
    let direction = |x: u32, y: u32| {
        let i = y * w + x;
        let unit = match y {
            0 if x < 7 => axes[x as usize],
            // The seams of the fold, z = ±0 and just below, and its diagonals.
            0 | 1 => {
                let (sin, cos) = (i as f32 * 0.006_135_923).sin_cos();
                Vec3::new(cos, sin, [0.0, -0.0, -1e-12, -1e-7][i as usize % 4])
            }
            2 => Vec3::new([0.0, -0.0][i as usize % 2], (x as f32 - 256.0) / 256.0, -1.0),
            _ => {
                let z = 1.0 - (2.0 * i as f32 + 1.0) / (w * h) as f32;
                let a = (f64::from(i) * 2.399_963_229_728_653 % std::f64::consts::TAU) as f32;
                Vec3::new((1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z)
            }
        };
        // Any length above 0.
        unit * [1.0, 1e-12, 1e12][i as usize % 3]
    };
    let mut rig = Rig::new(1, w, h, WHITE);
    rig.fill(|x, y| Sample { normal: direction(x, y), ..Default::default() });
    let output = rig.run(Settings { view: DebugView::Normal, ..single() });
    let degrees = |a: DVec3, b: DVec3| 2.0 * (0.5 * (a - b).length()).asin().to_degrees();
    rig.with_input(|input| {
        for (i, (code, pixel)) in (0..).zip(input.surface.iter().zip(&output.image)) {
            let direction = direction(i % w, i / w).as_dvec3().normalize();
            let stored = octahedral::decode(code[0]);
            let off = degrees(stored, direction);
            assert!(off <= 0.004, "{direction} comes back {off}° off");
            let seen = DVec3::from_slice(&pixel.map(f64::from)) * 2.0 - 1.0;
            assert!((seen - stored).length() < 1e-6, "{direction}: the GPU reads {seen}, the twin {stored}");
        }
    });
}

// ---- Row 7: formats that overflow ----

#[test]
fn row_07_no_value_overflows_a_half_float() {
    let values = [1e30, 3e38, 65520.0, 65504.0, 65503.0, 70000.0, 1e-8, 0.0, -0.0, 0.5, 1000.0];
    let w = values.len() as u32;
    let formats = [
        (TextureFormat::Rgba16Float, 65504.0_f32),
        (TextureFormat::Rgba32Float, 1e30),
        (TextureFormat::Rgba8Unorm, 1.0),
    ];
    for (format, most) in formats {
        let mut rig = Rig::with_format(2, w, 3, SHOW_FLOAT, format);
        rig.fill(|x, _| Sample { user: f32::to_bits(values[x as usize / 2]), object: 1 + x % 2, ..Default::default() });
        for weight in [Weight::Linear, Weight::Luminance] {
            for settings in [full(), single(), fixed_k(3), Settings { execution: Execution::Loop, ..fixed_k(3) }] {
                let output = rig.run(Settings { weight, ..settings });
                assert_eq!(output.statistics.not_finite, 0);
                for (i, pixel) in output.image.iter().enumerate() {
                    let wanted = values[i % values.len()].min(most);
                    let step = if format == TextureFormat::Rgba8Unorm { 0.003 } else { wanted * 1e-3 + 6e-8 };
                    let (r, a) = (pixel[0], pixel[3]);
                    // A quotient may be 2.5 units of the last place off, and be cut to a half.
                    assert!(
                        (r - wanted).abs() <= step && (a - 1.0).abs() <= 5e-4,
                        "{format:?}, {settings:?}: {pixel:?} for {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn row_07_the_ends_of_exposure_give_numbers() {
    let values = [1e30, 1e-30, 0.0, 1.0, 65504.0];
    let value = |px: u32, py: u32| values[(px + py * 3) as usize % 5];
    let mut rig = Rig::new(3, 10, 3, SHOW_FLOAT);
    rig.fill(|x, y| Sample { user: f32::to_bits(value(x / 3, y / 3)), object: x, ..Default::default() });
    for exposure in [f32::MIN_POSITIVE, 1e-20, 1e10, 1e30, f32::MAX] {
        rig.exposure = exposure;
        for (luminance, least) in
            [(LuminanceCurve::Linear, 0.02), (LuminanceCurve::Perceptual, 0.02), (LuminanceCurve::Linear, 0.0)]
        {
            for (technique, execution) in [
                (Technique::Full, Execution::Loop),
                (Technique::Windowed, Execution::Loop),
                (Technique::Windowed, Execution::Tiled),
            ] {
                let windowed =
                    Windowed { luminance, luminance_min: least, identity_samples: 4.0, ..Default::default() };
                let settings =
                    Settings { technique, execution, windowed, weight: Weight::Luminance, ..Default::default() };
                let output = rig.run(settings);
                for (i, pixel) in (0..).zip(&output.image) {
                    // All samples of a pixel are alike: so is any weighted mean of them.
                    let expected = value(i % 10, i / 10);
                    let what = format!("exposure {exposure:e}, {settings:?}, pixel {i}: {pixel:?} for {expected:e}");
                    let opaque = (pixel[3] - 1.0).abs() <= 3e-7;
                    assert!((pixel[0] - expected).abs() <= 1e-5 * expected + 1e-29 && opaque, "{what}");
                }
                if technique == Technique::Windowed {
                    assert!(output.plan.iter().all(|p| (4..=9).contains(&p.0)), "exposure {exposure:e}, {settings:?}");
                    rig.assert_twin_agrees(&settings, &output);
                }
            }
        }
    }
}

// ---- Row 8: what the host's code may return ----

#[test]
fn row_08_a_bad_sample_harms_its_pixel_alone() {
    const BAD: [u32; 9] = [
        0x7fc0_0000, // NaN
        0xffc0_0001, // NaN, signed, with a payload
        0x7f80_0001, // signalling NaN
        0x7f80_0000, // ∞
        0xff80_0000, // −∞
        0xbf80_0000, // −1
        0xff7f_ffff, // the most negative number
        0x8000_0001, // a negative denormal: may be flushed to 0, is 0 either way
        0x0000_0001, // a denormal
    ];
    let (w, h) = (19, 9);
    let good = |x: u32, y: u32| f32::to_bits(0.25 + 0.5 * noise(x + y * 331));
    for m in [1, 3] {
        let mut rig = Rig::new(m, w, h, SHOW_FLOAT);
        let fill = |rig: &Rig, bad: Option<u32>| {
            // The first-ranked sample of pixel (9, 4), so that `Single` meets it too.
            let (x, y) = (9 * m + m / 2, 4 * m + m / 2);
            rig.fill(|sx, sy| {
                let user = bad.filter(|_| (sx, sy) == (x, y)).unwrap_or_else(|| good(sx, sy));
                Sample { user, object: 1 + sx % 2, ..Default::default() }
            });
        };
        let loops = Settings { execution: Execution::Loop, ..fixed_k(m * m) };
        let all = [full(), single(), fixed_k(m * m), loops];
        fill(&rig, None);
        let clean = all.map(|s| rig.run(s));
        for bad in BAD {
            fill(&rig, Some(bad));
            for (settings, clean) in all.iter().zip(&clean) {
                let output = rig.run(*settings);
                let value = f32::from_bits(bad);
                let s = &output.statistics;
                let what = format!("m = {m}, {bad:x} in {settings:?}");
                assert_eq!(s.not_finite, u32::from(!value.is_finite()), "{what}");
                if !value.is_subnormal() {
                    assert_eq!(s.negative, u32::from(value.is_finite() && value < 0.0), "{what}");
                }
                for (i, (pixel, clean)) in output.image.iter().zip(&clean.image).enumerate() {
                    if i as u32 != 4 * w + 9 {
                        assert_eq!(pixel, clean, "{what}: pixel {i} changed");
                    } else {
                        let n = if settings.technique == Technique::Single { 1.0 } else { (m * m) as f32 };
                        let lost = f32::from_bits(good(9 * m + m / 2, 4 * m + m / 2)) / n;
                        let expected = clean[0] - lost;
                        assert!((pixel[0] - expected).abs() < 1e-6 && pixel[3] == 1.0, "{what}: {pixel:?}, {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn row_08_every_bad_sample_is_counted() {
    let mut rig = Rig::new(4, 10, 10, SHOW_FLOAT);
    let bits = |x: u32, y: u32| match (x * 7 + y * 3) % 11 {
        0 => f32::NAN.to_bits(),
        1 => f32::NEG_INFINITY.to_bits(),
        2 => f32::to_bits(-2.0),
        _ => f32::to_bits(1.0),
    };
    rig.fill(|x, y| Sample { user: bits(x, y), object: 1 + x % 2, ..Default::default() });
    let all = || (0..1600).map(|i| f32::from_bits(bits(i % 40, i / 40)));
    let not_finite = all().filter(|v| !v.is_finite()).count() as u32;
    let negative = all().filter(|&v| v == -2.0).count() as u32;
    for settings in [full(), fixed_k(16), Settings { execution: Execution::Loop, ..fixed_k(16) }] {
        let output = rig.run(settings);
        assert_eq!((output.statistics.not_finite, output.statistics.negative), (not_finite, negative), "{settings:?}");
        for (i, pixel) in output.image.iter().enumerate() {
            let (px, py) = (i as u32 % 10, i as u32 / 10);
            let samples: Vec<[f64; 4]> = (0..16)
                .map(|s| f64::from(f32::from_bits(bits(px * 4 + s % 4, py * 4 + s / 4))))
                .map(|v| [v, v, v, 1.0])
                .collect();
            let expected = resolve::mean(&samples, Weight::Linear, 1.0);
            assert!((0..4).all(|c| (f64::from(pixel[c]) - expected[c]).abs() < 1e-6), "{pixel:?}, {expected:?}");
        }
    }
}

#[test]
fn row_08_one_bad_component_is_enough() {
    for channel in 0..4 {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let hook = format!(
                "fn shade(s: DaaSample) -> vec4f {{ var c = vec4f(0.5); c[{channel}] = bitcast<f32>(s.user); return c; }}"
            );
            let mut rig = Rig::new(1, 4, 1, &hook);
            rig.fill(|x, _| Sample { user: if x == 1 { bad } else { 0.5 }.to_bits(), ..Default::default() });
            let output = rig.run(full());
            assert_eq!(output.statistics.not_finite, 1, "{channel}, {bad}");
            assert_eq!(output.image[1], [0.0, 0.0, 0.0, 1.0], "{channel}, {bad}");
            assert!([0, 2, 3].iter().all(|&i| output.image[i] == [0.5; 4]), "{channel}, {bad}");
        }
    }
}

// ---- Row 9: fireflies ----

#[test]
fn row_09_an_edge_against_a_firefly_stays_monotone() {
    // Pixel i has i samples of 50 over 16 − i of 1, under a row of 0 and 1, and one with all three.
    let value = |x: u32, y: u32| {
        let (i, s) = (x / 4, y % 4 * 4 + x % 4);
        match y / 4 {
            0 => f32::from(u8::from(s < i)) * 50.0,
            1 => {
                if s < i {
                    50.0
                } else {
                    1.0
                }
            }
            _ => [0.0, 1.0, 50.0][(s * 7 + i) as usize % 3],
        }
    };
    let mut rig = Rig::new(4, 17, 3, SHOW_FLOAT);
    rig.fill(|x, y| Sample { user: value(x, y).to_bits(), object: 1 + x % 2, ..Default::default() });
    for exposure in [1.0, 0.01] {
        rig.exposure = exposure;
        for weight in [Weight::Linear, Weight::Luminance] {
            for settings in [full(), fixed_k(16), Settings { execution: Execution::Loop, ..fixed_k(16) }] {
                let output = rig.run(Settings { weight, ..settings });
                let reds: Vec<f32> = output.image.iter().map(|p| p[0]).collect();
                for row in reds.chunks(17).take(2) {
                    assert!(row.windows(2).all(|pair| pair[0] < pair[1]), "{weight:?}: {row:?}");
                }
                if weight == Weight::Luminance && exposure == 1.0 {
                    assert!(reds[1] < 0.1, "a firefly outshines 15 black samples: {}", reds[1]);
                }
                for (i, &red) in reds.iter().enumerate() {
                    let (px, py) = (i as u32 % 17, i as u32 / 17);
                    let samples: Vec<[f64; 4]> = (0..16)
                        .map(|s| f64::from(value(px * 4 + s % 4, py * 4 + s / 4)))
                        .map(|v| [v, v, v, 1.0])
                        .collect();
                    let expected = resolve::mean(&samples, weight, f64::from(exposure))[0];
                    let apart = if weight == Weight::Linear { 1e-6 } else { 2e-6 };
                    assert!(
                        (f64::from(red) - expected).abs() <= apart * expected,
                        "{weight:?}, {i}: {red}, {expected}"
                    );
                }
            }
        }
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

// ---- Row 11: gradients of texture coordinates ----

fn ruler(tier: TextureTier, m: u32, size: [u32; 2], anisotropy: u16) -> Textured {
    let sampler = TableSampler { anisotropy, ..Default::default() };
    Textured::new(tier, m, size, SHOW_TEXTURE, |gpu| vec![(mip_ruler(gpu), sampler)])
}

#[test]
fn row_11_a_mirrored_seam_does_not_jump() {
    for tier in tiers() {
        for anisotropy in [1, 16] {
            let mut rig = ruler(tier, 4, [12, 4], anisotropy);
            // u goes back where it came from in the middle of column 6, v is mirrored as a whole.
            let step = 4.0 / 512.0;
            rig.fill(|x, y| {
                let sign = if x < 26 { 1.0 } else { -1.0 };
                let u = (x as f32 - 26.0).abs();
                Sample {
                    uv: Vec2::new(u, -(y as f32)) * step,
                    ddx: Vec2::new(step * sign, 0.0),
                    ddy: Vec2::new(0.0, -step),
                    object: 1 + x % 2,
                    ..Default::default()
                }
            });
            for settings in [full(), single(), Settings::default(), fixed_k(4), fixed_k(16)] {
                let levels: Vec<f32> = rig.run(settings).0.into_iter().map(level).collect();
                let (least, most) = levels.iter().fold((f32::MAX, f32::MIN), |(a, b), &l| (a.min(l), b.max(l)));
                assert!(most - least < 0.01, "{tier:?}, {settings:?}: mips {least} to {most}");
            }
        }
    }
}

#[test]
fn row_11_degenerate_gradients_read_a_sane_mip() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let zero = Vec2::ZERO;
    // ddx, ddy and the mips that are sane, of ten.
    let cases = [
        (zero, zero, 0.0..0.01),
        (Vec2::new(1e-38, 0.0), Vec2::new(0.0, -1e-40), 0.0..0.01),
        (Vec2::new(8.0 / 512.0, 0.0), zero, 0.0..3.1),
        // Along a diagonal, drivers approximate the length.
        (Vec2::splat(8.0 / 512.0), Vec2::splat(8.0 / 512.0), 0.0..4.1),
        (Vec2::splat(1e3), Vec2::splat(-1e3), 8.9..9.1),
        (Vec2::splat(1e30), Vec2::splat(-1e30), 8.9..9.1),
        (Vec2::splat(65504.0), Vec2::new(0.0, 65520.0), 8.9..9.1),
        // What is no number counts as none.
        (Vec2::splat(inf), Vec2::splat(-inf), 0.0..0.01),
        (Vec2::splat(nan), Vec2::new(nan, inf), 0.0..0.01),
        (Vec2::new(inf, 1.0 / 512.0), zero, 0.0..0.01),
    ];
    let w = cases.len() as u32;
    for tier in tiers() {
        for anisotropy in [1, 16] {
            let mut rig = ruler(tier, 4, [w, 2], anisotropy);
            rig.fill(|x, y| {
                let (ddx, ddy, _) = cases[x as usize / 4];
                // A row with no uv either.
                let uv = if y < 4 { Vec2::splat(0.3) } else { Vec2::new(nan, -inf) };
                Sample { uv, ddx, ddy, object: 1 + x % 2, ..Default::default() }
            });
            // No infinity and no NaN gets as far as the G-buffer, whatever a sampler would make of it.
            let stored = rig.aa.gbuffer().unwrap().color[2].texture();
            let stored: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&rig.gpu.read_texture(stored, 16));
            for [u, v, ddx, ddy] in stored {
                let halves = [ddx, ddx >> 16, ddy, ddy >> 16].map(|h| h & 0x7c00);
                assert!(f32::from_bits(u).is_finite() && f32::from_bits(v).is_finite() && !halves.contains(&0x7c00));
            }
            for settings in [full(), single(), fixed_k(5), Settings { execution: Execution::Loop, ..fixed_k(5) }] {
                let (image, statistics) = rig.run(settings);
                assert_eq!(statistics.not_finite, 0, "{tier:?}, {settings:?}");
                for (i, pixel) in image.into_iter().enumerate() {
                    let (ddx, ddy, sane) = &cases[i % w as usize];
                    // Beyond Full the footprint is that of up to the whole window.
                    let most = sane.end + if settings.technique == Technique::Full { 0.0 } else { 2.0 };
                    let shown = level(pixel);
                    assert!(shown >= sane.start && shown <= most, "{tier:?}, {anisotropy}, {ddx} {ddy}: mip {shown}");
                }
            }
        }
    }
}

// ---- Row 12: far from the origin of texture space ----

#[test]
fn row_12_a_thousand_tiles_across_is_the_same_picture() {
    let bricks = |mip: u32, x: u32, y: u32| {
        let c = |i: u32| (noise(mip * 7 + x * 131 + y * 17_011 + i) * 255.0) as u8;
        [c(0), c(1), c(2), 255]
    };
    for tier in tiers() {
        let mut rig = Textured::new(tier, 2, [40, 24], SHOW_TEXTURE, |gpu| {
            vec![(texture(gpu, [64, 64], 7, TextureFormat::Rgba8Unorm, bricks), TableSampler::default())]
        });
        // Steps of 2⁻¹⁰ of a tile, which f32 still holds 10 000 tiles out.
        let mut picture = |tiles: f32, settings| {
            rig.fill(|x, y| Sample {
                uv: Vec2::new(x as f32 * 9.0 + 1.0, y as f32 * 7.0 + 1.0) / 1024.0 + Vec2::new(tiles, -tiles),
                ddx: Vec2::new(9.0 / 1024.0, 0.0),
                ddy: Vec2::new(0.0, 7.0 / 1024.0),
                object: 1 + x % 2,
                ..Default::default()
            });
            rig.run(settings).0
        };
        for settings in [full(), single(), fixed_k(3)] {
            let near = picture(0.0, settings);
            // The offset of a footprint is a fraction of a gradient: ten thousand tiles out it is lost in f32.
            let far = if settings.technique == Technique::Full { 10_000.0 } else { 1000.0 };
            for tiles in [1.0, 1000.0, far] {
                let far = picture(tiles, settings);
                let apart =
                    near.iter().flatten().zip(far.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(apart <= 1.5 / 255.0, "{tier:?}, {tiles} tiles away, {settings:?}: {apart}");
            }
        }
    }
}

// ---- Row 19: full lists ----

/// Coloured noise on planes with steps, without sky.
fn land(x: u32, y: u32) -> Sample {
    let object = 1 + x / 11 + y / 13 * 5;
    Sample {
        depth: 0.05 + noise(object) * 0.5 + x as f32 * 1e-5,
        normal: Vec3::new(noise(object + 70) - 0.5, (y as f32 * 0.02).sin() * 0.3, 1.0),
        object,
        user: rgba8(noise(object * 3), noise(object * 5), noise(x / 3 + y * 977), 1.0),
        ..Default::default()
    }
}

#[test]
fn row_19_a_full_list_falls_back_to_one_sample_and_says_so() {
    let (w, h) = (37, 21);
    let mut rig = Rig::new(4, w, h, SHOW_USER);
    rig.fill(land);
    let all = rig.run(Settings::default());
    assert_eq!(all.statistics.overflowed_tiles, 0);
    let wanted = counts(&all);
    let one = rig.run(single());
    let index = |i: usize| {
        let (x, y) = (i % w as usize, i / w as usize);
        (y / 8 * 5 + x / 8) * 64 + y % 8 * 8 + x % 8
    };
    // What the second tile wants fits in as much and no less.
    let wants: u32 = (0..64).map(|i| wanted[(i / 8 * w + 8 + i % 8) as usize] - 1).sum();
    let mut limits = [0, 1, 50, 300, 960, wants - 1, wants];
    limits.sort_unstable();
    for execution in Execution::ALL.into_iter().filter(|&e| e != Execution::MaxFiltered) {
        let free = rig.run(Settings { execution, ..Default::default() });
        let mut fewest = u32::MAX;
        for tile_limit in limits {
            let windowed = Windowed { tile_limit, ..Default::default() };
            let output = rig.run(Settings { execution, windowed, ..Default::default() });
            assert_finite(&output, 16);
            let (planned, overflowed) = plan::plan(&wanted, w, h, tile_limit);
            assert_eq!(output.statistics.overflowed_tiles, overflowed, "limit {tile_limit}");
            assert!(overflowed <= fewest && (tile_limit > 1 || overflowed == 15), "limit {tile_limit}: {overflowed}");
            fewest = overflowed;
            let second_falls_back = (0..8).all(|x| output.plan[8 + x].0 == 1);
            assert_eq!(second_falls_back, tile_limit < wants, "limit {tile_limit}, the tile wants {wants}");
            for (i, &(k, by, before)) in output.plan.iter().enumerate() {
                let p = planned[index(i)];
                assert_eq!((k, before), (p.k, p.before), "limit {tile_limit}, window {i}");
                // A tile is all or nothing: its own picture, or that of `Single`.
                let expected = if k == wanted[i] { free.image[i] } else { one.image[i] };
                assert_eq!(output.image[i], expected, "limit {tile_limit}, window {i}");
                assert!(k > 1 || by == 0);
            }
            assert_eq!(output.statistics.shaded, planned.iter().map(|p| u64::from(p.k)).sum::<u64>());
        }
        assert!(fewest < 15);
    }
}

#[test]
fn row_19_the_longest_list_fits() {
    // m = 8, every sample of every window: 64 · 63 in a tile, which is as much as nothing limits.
    let mut rig = Rig::new(8, 17, 9, SHOW_USER);
    rig.fill(|x, y| Sample { object: 1 + x % 2, ..land(x, y) });
    let grid = rig.run(full());
    for execution in Execution::ALL {
        let output = rig.run(Settings { execution, ..fixed_k(64) });
        assert_eq!(output.statistics.overflowed_tiles, 0);
        assert_eq!(output.statistics.shaded, 17 * 9 * 64);
        assert_eq!(output.plan.iter().map(|p| p.2).max(), Some(63 * 63));
        for (a, b) in output.image.iter().flatten().zip(grid.image.iter().flatten()) {
            assert!((a - b).abs() < 1e-5, "{execution:?}: {a} {b}");
        }
    }
}

// ---- Row 20: sizes ----

#[test]
fn row_20_odd_sizes_are_cut_from_the_same_picture() {
    for (m, w, h) in [(4, 1, 1), (3, 1, 19), (4, 23, 1), (2, 17, 13), (4, 31, 7), (5, 8, 9), (1, 13, 11), (7, 3, 2)] {
        // 3 and 16: tiles that lie elsewhere, and tiles that lie alike.
        for pad in [3, 16] {
            let last = |side: u32| side as i32 * m as i32 - 1;
            // Beyond the border the windows repeat the border's window, so that S does, and the depths the border's:
            // what clamped reads see.
            let padded = |x: u32, y: u32| {
                let at = |v: u32, side: u32| {
                    let v = v as i32 - (pad * m) as i32;
                    let window = v.div_euclid(m as i32).clamp(0, side as i32 - 1);
                    (window as u32 * m + v.rem_euclid(m as i32) as u32, v.clamp(0, last(side)) as u32)
                };
                let ((wx, dx), (wy, dy)) = (at(x, w), at(y, h));
                Sample { depth: land(dx, dy).depth, ..land(wx, wy) }
            };
            let mut small = Rig::new(m, w, h, SHOW_USER);
            small.fill(land);
            let mut large = Rig::new(m, w + 2 * pad, h + 2 * pad, SHOW_USER);
            large.fill(padded);
            let loops = Settings { execution: Execution::Loop, ..Default::default() };
            let paper = Settings { windowed: Windowed::PAPER, ..loops };
            for settings in [full(), single(), loops, paper, Settings::default()] {
                let (a, b) = (small.run(settings), large.run(settings));
                for y in 0..h {
                    for x in 0..w {
                        let (i, j) = ((y * w + x) as usize, ((y + pad) * (w + 2 * pad) + x + pad) as usize);
                        let what = format!("{w}×{h}, m = {m}, pad {pad}, {settings:?}: {x}, {y}");
                        if settings.technique == Technique::Windowed {
                            assert_eq!(a.plan[i].0, b.plan[j].0, "{what}");
                        }
                        if settings.technique == Technique::Windowed && settings.execution == Execution::Tiled {
                            // A tile's list is cut into parts by what else is in the tile: the sum's order differs.
                            let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-6;
                            assert!(a.image[i].iter().zip(&b.image[j]).all(near), "{what}");
                        } else {
                            assert_eq!(a.image[i], b.image[j], "{what}");
                        }
                    }
                }
            }
        }
    }
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

// ---- Row 22: the ends of every setting ----

/// Windows in which something has degenerated, 14 kinds across; the row varies them.
fn degenerate(x: u32, y: u32, m: u32) -> Sample {
    let (kind, i, row) = (x / m, y % m * m + x % m, y / m);
    let odd = i % 2 == 1;
    let s = Sample::default();
    match kind {
        0 => Sample::SKY,
        1 if i == 0 => s,
        1 => Sample::SKY,
        2 => Sample { user: 0x3f80_0000, ..s },
        3 => Sample { normal: if odd { Vec3::X } else { Vec3::NEG_X }, ..s },
        4 => Sample { normal: Vec3::ZERO, tangent: Vec4::ZERO, ..s },
        5 => Sample { depth: [1e-40, SKY_DEPTH, 2e-30][(i + row) as usize % 3], ..s },
        6 => Sample { depth: 1.0, user: f32::to_bits(1e30), ..s },
        7 => Sample { depth: if odd { 1.0 } else { 2e-30 }, ..s },
        8 => Sample { material: 65_535 * (i & 1), object: 65_535 * (i & 1), ..s },
        9 => Sample { user: [f32::NAN, f32::INFINITY, -1.0, 1e38][(i + row) as usize % 4].to_bits(), ..s },
        10 => Sample { user: if row % 2 == 0 { 0 } else { f32::to_bits(1e30) }, ..s },
        11 => Sample { user: 0x8000_0000, depth: 0.3 + 1e-7 * i as f32, ..s },
        12 => Sample { tangent: s.normal.extend(-1.0), ..s },
        _ => Sample { normal: Vec3::new(noise(i), noise(i + 50), noise(i + 99)) - 0.5, depth: noise(i + 7), ..s },
    }
}

/// Every preset with every end of one field, and all ends together.
fn ends() -> Vec<Windowed> {
    let mut all = Vec::new();
    for preset in presets() {
        type Change = fn(&mut Windowed, bool);
        let fields: [Change; 17] = [
            |w, most| w.depth_scale = if most { 1e9 } else { 0.0 },
            |w, most| w.normal_scale = if most { 1e6 } else { 0.0 },
            |w, most| w.luminance_scale = if most { 1e6 } else { 0.0 },
            |w, most| w.luminance_min = if most { 1e6 } else { 0.0 },
            |w, most| w.luminance_edge = if most { 1.0 } else { 0.0 },
            |w, most| w.identity_samples = if most { 64.0 } else { 0.0 },
            |w, most| w.shadow_samples = if most { 64.0 } else { 0.0 },
            |w, most| w.tile_limit = if most { Windowed::NO_TILE_LIMIT } else { 0 },
            |w, most| w.depth = if most { DepthMeasure::Variance } else { DepthMeasure::Discontinuity },
            |w, most| w.two_sided = most,
            |w, most| w.luminance = if most { LuminanceCurve::Linear } else { LuminanceCurve::Perceptual },
            |w, most| w.luminance_centre = most,
            |w, most| w.luminance_channels = most,
            |w, most| w.user_scale = if most { 1e6 } else { 0.0 },
            |w, most| w.centred = most,
            |w, most| w.footprint = if most { 4.0 } else { 0.0 },
            |w, most| w.edge_aware_first = most,
        ];
        all.push(preset);
        let (mut least, mut most) = (preset, preset);
        for change in fields {
            for end in [false, true] {
                let mut w = preset;
                change(&mut w, end);
                // Each end also with nothing to cut ranges off.
                all.extend([w, Windowed { luminance_min: 0.0, luminance_edge: 0.0, ..w }]);
            }
            change(&mut least, false);
            change(&mut most, true);
        }
        most.luminance_min = 0.0;
        all.extend([least, most, Windowed { depth: DepthMeasure::Discontinuity, ..most }]);
    }
    all
}

#[test]
fn row_22_every_end_of_every_field_on_every_degenerate_window() {
    for m in [1, 2, 5] {
        let n = m * m;
        let mut rig = Rig::new(m, 14, 3, SHOW_FLOAT);
        rig.fill(|x, y| degenerate(x, y, m));
        for windowed in ends() {
            for (execution, weight) in [(Execution::Loop, Weight::Luminance), (Execution::Tiled, Weight::Linear)] {
                let settings = Settings { windowed, execution, weight, ..Default::default() };
                assert_eq!(settings.validate(), Ok(()));
                let output = rig.run(settings);
                let bad = output.image.iter().position(|p| p.iter().any(|c| !c.is_finite()));
                assert_eq!(bad, None, "m = {m}, {settings:?}");
                let bad = output.plan.iter().position(|p| !(1..=n).contains(&p.0));
                assert_eq!(bad, None, "m = {m}, {settings:?}: {:?}", output.plan);
                let s = &output.statistics;
                assert_eq!(s.shaded, output.plan.iter().map(|p| u64::from(p.0)).sum::<u64>());
                assert_eq!(s.histogram_k.iter().sum::<u32>(), 14 * 3);
            }
        }
        // The presets themselves agree with the twin here too.
        for windowed in presets() {
            let settings = Settings { windowed, ..Default::default() };
            let output = rig.run(settings);
            rig.assert_twin_agrees(&settings, &output);
        }
    }
}

#[test]
fn row_22_beyond_the_ends_the_field_is_named() {
    let mut rig = Rig::new(2, 4, 4, WHITE);
    rig.fill(|_, _| Sample::default());
    type Field = (&'static str, f32, fn(&mut Windowed) -> &mut f32);
    let fields: [Field; 9] = [
        ("windowed.depth_scale", 1e9, |w| &mut w.depth_scale),
        ("windowed.normal_scale", 1e6, |w| &mut w.normal_scale),
        ("windowed.luminance_scale", 1e6, |w| &mut w.luminance_scale),
        ("windowed.luminance_min", 1e6, |w| &mut w.luminance_min),
        ("windowed.luminance_edge", 1.0, |w| &mut w.luminance_edge),
        ("windowed.identity_samples", 64.0, |w| &mut w.identity_samples),
        ("windowed.shadow_samples", 64.0, |w| &mut w.shadow_samples),
        ("windowed.user_scale", 1e6, |w| &mut w.user_scale),
        ("windowed.footprint", 4.0, |w| &mut w.footprint),
    ];
    for (name, most, field) in fields {
        for value in [-1e-9, -1.0, most * 1.001, 1e38, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut windowed = Windowed::default();
            *field(&mut windowed) = value;
            match rig.try_record(Settings { windowed, ..Default::default() }) {
                Err(RecordError::Settings(e)) => assert_eq!((e.field, e.least, e.most), (name, 0.0, most), "{value}"),
                other => panic!("{name} = {value}: {:?}", other.map(|_| ())),
            }
        }
    }
    let windowed = Windowed { tile_limit: Windowed::NO_TILE_LIMIT + 1, ..Default::default() };
    let error = rig.try_record(Settings { windowed, ..Default::default() }).unwrap_err();
    assert!(matches!(error, RecordError::Settings(e) if e.field == "windowed.tile_limit"));
    for exposure in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        rig.exposure = exposure;
        assert!(matches!(rig.try_record(Settings::default()), Err(RecordError::Exposure(_))), "{exposure}");
    }
    // Nothing was recorded, and the node goes on.
    rig.exposure = 1.0;
    assert_eq!(rig.run(Settings::default()).image, [[1.0; 4]; 16]);
}

// ---- Row 24: many materials in one tile ----

#[test]
fn row_24_a_checker_of_64_materials_is_each_one_by_one() {
    let paint = |i: u32| {
        move |mip: u32, x: u32, y: u32| {
            let c = |j: u32| (noise(i * 4099 + mip * 31 + x * 7 + y * 131 + j * 7919) * 255.0) as u8;
            [c(0), c(1), c(2), 255]
        }
    };
    for tier in tiers() {
        // Four classes, so that neighbours differ in array, layer and sampler.
        let mut rig = Textured::new(tier, 2, [8, 8], SHOW_TEXTURE, |gpu| {
            let made = |i: u32| {
                let side = 8 << (i % 4);
                let nearest = i % 4 == 2;
                (
                    texture(gpu, [side; 2], 4, TextureFormat::Rgba8Unorm, paint(i)),
                    TableSampler { nearest, ..Default::default() },
                )
            };
            (0..64).map(made).collect()
        });
        let sample = |x: u32, y: u32, material: u32| Sample {
            uv: Vec2::new(x as f32, y as f32) * 0.061,
            ddx: Vec2::new(0.061, 0.01),
            ddy: Vec2::new(0.0, 0.061),
            material,
            object: 1 + x % 2,
            ..Default::default()
        };
        // Neighbours far apart in the table.
        let of_pixel = |px: u32, py: u32| (px + py * 8) * 37 % 64;
        let all = [full(), single(), fixed_k(3), Settings { execution: Execution::Loop, ..fixed_k(3) }];
        rig.fill(|x, y| sample(x, y, of_pixel(x / 2, y / 2)));
        let checker = all.map(|s| rig.run(s).0);
        assert!(checker[0].iter().enumerate().all(|(i, p)| checker[0][..i].iter().all(|q| q != p)), "64 colours");
        for material in 0..64 {
            rig.fill(|x, y| sample(x, y, material));
            for (settings, checker) in all.iter().zip(&checker) {
                let alone = rig.run(*settings).0;
                for (i, (pixel, alone)) in checker.iter().zip(&alone).enumerate() {
                    if of_pixel(i as u32 % 8, i as u32 / 8) == material {
                        assert_eq!(pixel, alone, "{tier:?}, material {material}, {settings:?}");
                    }
                }
            }
        }
    }
}

// ---- Row 25: cameras ----

#[test]
fn row_25_singular_cameras_are_refused_by_name() {
    let mut rig = Rig::new(2, 5, 3, SHOW_GEOMETRY);
    rig.fill(land);
    let good = camera(5.0 / 3.0);
    let squashed = Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let projections = [Mat4::ZERO, squashed * good.clip_from_view, Mat4::NAN, good.clip_from_view * f32::INFINITY];
    for clip_from_view in projections {
        rig.camera = Camera { clip_from_view, ..good };
        let refused = rig.try_record(Settings::default()).map(|_| ());
        assert_eq!(refused, Err(RecordError::Camera("projection")), "{clip_from_view}");
    }
    for world_from_view in [Mat4::ZERO, squashed, Mat4::NAN, Mat4::from_translation(Vec3::INFINITY)] {
        rig.camera = Camera { world_from_view, ..good };
        let refused = rig.try_record(Settings::default()).map(|_| ());
        assert_eq!(refused, Err(RecordError::Camera("view")), "{world_from_view}");
    }
    // The node is none the worse.
    rig.camera = good;
    assert_finite(&rig.run(Settings::default()), 4);
}

#[test]
fn row_25_the_same_projection_in_other_numbers_is_the_same() {
    let mut rig = Rig::new(2, 8, 8, "fn shade(s: DaaSample) -> vec4f { return vec4f(0.5 + 0.5 * s.view, s.depth); }");
    rig.fill(|x, _| Sample { depth: 0.3 + 0.01 * x as f32, ..Default::default() });
    for projection in [directx::orthographic(-1.0, 1.0, -1.0, 1.0, 10.0, 0.1), camera(1.0).clip_from_view] {
        let images = [1.0, 2.0, 0.25].map(|scale| {
            rig.camera.clip_from_view = projection * scale;
            rig.run(full()).image
        });
        assert!(images.iter().all(|image| *image == images[0]), "{projection}");
    }
}

#[test]
fn row_25_projections_that_no_sample_survives_are_refused() {
    use deferred_aa::glam::camera::lh::proj::directx as left;
    let mut rig = Rig::new(2, 5, 3, SHOW_GEOMETRY);
    rig.fill(land);
    let good = rig.camera;
    let refused = |rig: &mut Rig, clip_from_view| {
        rig.camera.clip_from_view = clip_from_view;
        rig.try_record(Settings::default()).map(|_| ())
    };
    for clip_from_view in [
        left::perspective_infinite_reverse(1.0, 2.0, 0.1),
        good.clip_from_view * -1.0,
        left::perspective(1.0, 2.0, 0.1, 9.0),
    ] {
        assert_eq!(refused(&mut rig, clip_from_view), Err(RecordError::Handedness), "{clip_from_view}");
    }
    for (near, aspect) in [(1e30, 1.0), (2e8, 1.0), (1e10, 1e6), (1e3, 1e6)] {
        let clip_from_view = directx::perspective_infinite_reverse(1.0, aspect, near);
        let found = refused(&mut rig, clip_from_view);
        assert!(matches!(found, Err(RecordError::NearPlane(d)) if d > 1e8), "{near}, {aspect}: {found:?}");
    }
    // Up to there, every depth has a position.
    rig.fill(|x, y| Sample { depth: [1.0, 1e-3, 2e-30, 0.0][(x + y) as usize % 4], ..land(x, y) });
    rig.camera.clip_from_view = directx::perspective_infinite_reverse(1.0, 1.0, 5e7);
    let output = rig.run(full());
    assert!(output.image.iter().flatten().all(|c| c.is_finite()) && output.statistics.not_finite == 0);
}

#[test]
fn row_25_everything_at_the_near_plane_or_far_away_is_finite() {
    let mut rig = Rig::new(3, 8, 4, SHOW_GEOMETRY);
    // Depth 1 is the near plane itself.
    rig.fill(|x, y| Sample { depth: [1.0, 0.999_999_9, 1e-28, 0.0][(x / 3 + y) as usize % 4], ..land(x, y) });
    for near in [1e-6, 0.1, 1e6] {
        for clip_from_view in [
            directx::perspective_infinite_reverse(0.01, 2.0, near),
            directx::perspective_infinite_reverse(3.0, 2.0, near),
            directx::orthographic(-1e3, 1e3, -1e3, 1e3, near * 1e3, near),
        ] {
            for eye in [Vec3::ZERO, Vec3::splat(1e6)] {
                rig.camera = Camera { clip_from_view, world_from_view: Mat4::from_translation(eye) };
                for settings in [full(), single(), Settings::default()] {
                    let output = rig.run(settings);
                    assert!(output.image.iter().flatten().all(|c| c.is_finite()), "{near}, {settings:?}");
                    assert_eq!(output.statistics.not_finite, 0, "{near}, {settings:?}");
                }
            }
        }
    }
}

#[test]
fn row_25_a_camera_inside_geometry_or_beyond_it_still_gives_a_picture() {
    let scene = builtin::builtin("cornell").unwrap();
    let own = scene.default_camera();
    let options = Options { anisotropy: 4, ..Options::new(32, 18, 2) };
    let adapter = deferred_aa_demo::gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).unwrap();
    let descriptor = options.descriptor();
    let gpu = deferred_aa_demo::gpu::Gpu::new(adapter, &descriptor).unwrap();
    let mut host = Host::new(gpu, scene, options).unwrap();
    let at = |eye: Vec3| deferred_aa_demo::scene::Camera { eye, target: eye + Vec3::NEG_Z, ..own };
    let cameras = [
        // In the tall box, in a wall, at the lamp, the near plane through all, all of it behind the near plane.
        at(Vec3::new(-0.36, -0.4, -0.3)),
        at(Vec3::new(0.0, -1.0, 0.0)),
        at(Vec3::new(0.0, 0.8, 0.0)),
        deferred_aa_demo::scene::Camera { near: 3.5, ..own },
        deferred_aa_demo::scene::Camera { near: 1e4, ..own },
        deferred_aa_demo::scene::Camera { lens: Lens::Perspective { fov_y: 3.1 }, ..own },
        deferred_aa_demo::scene::Camera { lens: Lens::Orthographic { half_height: 1e-6, far: 9.0 }, ..own },
    ];
    for camera in cameras {
        for technique in [Technique::Full, Technique::Single, Technique::Windowed] {
            let shot = host.frame(&camera, Settings { technique, ..Default::default() }).unwrap();
            assert_eq!(shot.statistics.not_finite, 0, "{camera:?}");
            assert!(host.picture().rgba.iter().flatten().all(|c| c.is_finite()), "{camera:?}");
        }
    }
    let nothing = [Lens::Orthographic { half_height: 0.0, far: 9.0 }, Lens::Perspective { fov_y: 0.0 }];
    for lens in nothing {
        let result = host.frame(&deferred_aa_demo::scene::Camera { lens, ..own }, Settings::default());
        assert!(matches!(result, Err(HostError::Record(RecordError::Camera(_)))), "{lens:?}: {result:?}");
    }
    host.frame(&own, Settings::default()).unwrap();
}
