//! Rows 11, 12 and 24: texture coordinates and the table.

use crate::harness::{Sample, noise};
use crate::textures::{SHOW_TEXTURE, Textured, fixed_k, full, level, mip_ruler, single, texture, tiers};
use deferred_aa::glam::Vec2;
use deferred_aa::wgpu::TextureFormat;
use deferred_aa::{Execution, Settings, TableSampler, Technique, TextureTier};

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
                    // As the G-buffer has them.
                    let [along, across] = [ddx, ddy].map(|d| d.clamp(Vec2::splat(-65504.0), Vec2::splat(65504.0)));
                    let fine =
                        crate::drivers::is_swiftshader(&rig.gpu) && anisotropy > 1 && along.perp_dot(across) == 0.0;
                    let least = if fine { 0.0 } else { sane.start };
                    let most = sane.end + if settings.technique == Technique::Full { 0.0 } else { 2.0 };
                    let shown = level(pixel);
                    assert!(shown >= least && shown <= most, "{tier:?}, {anisotropy}, {ddx} {ddy}: mip {shown}");
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
