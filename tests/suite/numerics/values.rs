//! Rows 6 to 9: codes, formats, and what a host's code may return.

use super::{SHOW_FLOAT, land};
use crate::harness::{Rig, Sample, WHITE, noise};
use crate::textures::{fixed_k, full, single};
use deferred_aa::glam::{DVec3, Vec3};
use deferred_aa::reference::{octahedral, resolve};
use deferred_aa::wgpu::TextureFormat;
use deferred_aa::{DebugView, Execution, LuminanceCurve, Settings, Technique, Weight, Windowed};

// ---- Row 6: octahedral codes ----

#[test]
fn row_06_normals_survive_the_gbuffer() {
    let (w, h) = (1024, 1024);
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
            2 => Vec3::new([0.0, -0.0][i as usize % 2], (x as f32 - 512.0) / 512.0, -1.0),
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
fn row_07_a_sample_beyond_1e30_counts_as_1e30() {
    let mut rig = Rig::new(4, 3, 1, SHOW_FLOAT);
    let values = [f32::MAX, 3e38, 1e30];
    rig.fill(|x, y| {
        let user = if (x % 4, y) == (2, 1) { values[x as usize / 4].to_bits() } else { 0 };
        Sample { user, object: 1 + x % 2, ..Default::default() }
    });
    for settings in [full(), fixed_k(16), Settings { execution: Execution::Loop, ..fixed_k(16) }] {
        for pixel in rig.run(settings).image {
            assert!((pixel[0] / 1e30 - 1.0 / 16.0).abs() < 1e-6, "{settings:?}: {pixel:?}");
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
fn row_08_no_technique_lets_a_bad_sample_out() {
    let bits = |x: u32, y: u32| match x * 7 + y * 3 {
        i if i % 11 == 0 => f32::NAN.to_bits(),
        i if i % 13 == 0 => f32::INFINITY.to_bits(),
        i if i % 17 == 0 => f32::NEG_INFINITY.to_bits(),
        i => (0.25 + 0.5 * noise(i)).to_bits(),
    };
    for m in [1, 2, 4] {
        let mut rig = Rig::new(m, 21, 13, SHOW_FLOAT);
        rig.fill(|x, y| Sample { user: bits(x, y), ..land(x, y) });
        for technique in Technique::ALL {
            for weight in [Weight::Linear, Weight::Luminance] {
                let output = rig.run(Settings { technique, weight, ..Default::default() });
                let what = format!("m = {m}, {technique:?}, {weight:?}");
                let sound = |p: &[f32; 4]| p.iter().all(|c| (0.0..=1.0).contains(c));
                assert!(output.image.iter().all(sound), "{what}");
                assert!(output.statistics.not_finite > 0 && output.statistics.negative == 0, "{what}");
            }
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
