//! Rows 19, 20 and 22: lists, sizes and settings at their ends.

use super::{SHOW_FLOAT, assert_finite, counts, land, presets};
use crate::harness::{OUT, Rig, SHOW_USER, Sample, WHITE, cover, covering, noise};
use crate::textures::{fixed_k, full, single};
use deferred_aa::glam::{Mat4, Vec3, Vec4};
use deferred_aa::reference::metrics::SKY_DEPTH;
use deferred_aa::reference::plan;
use deferred_aa::{
    DepthMeasure, Execution, GBufferTier, Goal, Lent, Lifetime, LuminanceCurve, Needs, PartKind, Physical, RecordError,
    SettingRange, SettingScale, Settings, Surfaces, Technique, Weight, Windowed, wgpu,
};

// ---- Row 19: full lists ----

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

#[test]
fn row_19_nothing_is_written_past_the_end_of_a_buffer() {
    use wgpu::util::DeviceExt as _;
    const CANARY: u8 = 0xa5;
    const ROOM: u64 = 4096;
    let mut rig = Rig::new(8, 17, 9, SHOW_USER);
    let longest = Settings { execution: Execution::Packed, ..fixed_k(64) };
    let some = Settings { windowed: Windowed { tile_limit: 300, ..Default::default() }, ..Default::default() };
    let executions = Execution::ALL.map(|execution| Settings { execution, ..fixed_k(64) });
    let techniques = Technique::ALL.map(|technique| Settings { technique, ..Default::default() });
    for settings in [&[longest, some][..], &executions, &techniques].concat() {
        let parts = rig.aa.parts(&settings, &Needs::default());
        let buffers: Vec<_> = parts
            .iter()
            .filter_map(|info| match (info.kind, info.lifetime) {
                (PartKind::Buffer { bytes, usage }, Lifetime::Transient { from_begin }) => {
                    let buffer = rig.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                        label: Some("canary"),
                        contents: &vec![CANARY; (bytes + ROOM) as usize],
                        usage: usage | wgpu::BufferUsages::COPY_SRC,
                    });
                    Some((info.part, from_begin, bytes as usize, buffer))
                }
                _ => None,
            })
            .collect();
        let lent: Vec<_> =
            buffers.iter().map(|(part, .., buffer)| Lent { part: *part, memory: Physical::Buffer(buffer) }).collect();
        rig.aa.lend(&rig.gpu.device, &lent).expect("a loan");
        rig.fill(|x, y| Sample { object: 1 + x % 2, ..land(x, y) });
        rig.run(settings);
        for (part, cleared, bytes, buffer) in &buffers {
            let end = &rig.gpu.read_buffer(buffer)[*bytes..];
            // What a frame clears is cleared to its end.
            let kept = |b: &u8| *b == CANARY || (*cleared && *b == 0);
            assert_eq!(end.iter().position(|b| !kept(b)), None, "{part:?} past its {bytes} bytes, {settings:?}");
        }
    }
}

#[test]
fn row_19_lists_longer_than_a_dimension_of_workgroups_are_all_shaded() {
    // 4.2 million pixels, each with more samples than one, are 66 048 workgroups of the list, more than the 65 535 of a
    // dimension. Each tile has a colour of its own.
    const PAINT: &str = "
@group(0) @binding(0) var<uniform> tile_size: vec4u;
@fragment fn fragment(@builtin(position) p: vec4f) -> Out {
    var f: DaaFragment;
    f.normal = vec3f(0.0, 0.0, 1.0);
    f.geometric_normal = f.normal;
    let tile = vec2u(p.xy) / tile_size.xy;
    f.user = tile.x | (tile.y << 12u);
    f.object = 1u + u32(p.x) % 2u;
    let g = daa_pack(f);
    return Out(0.5, g.surface, g.frame, g.uv);
}";
    const SHOW_TILE: &str = "
fn shade(s: DaaSample) -> vec4f { return vec4f(f32(s.user & 0xfffu), f32(s.user >> 12u), 0.0, 1.0); }";
    use wgpu::util::DeviceExt as _;
    let (m, w, h) = (2, 4096, 1032);
    let mut rig = Rig::new(m, w, h, SHOW_TILE);
    let gbuffer = rig.aa.gbuffer().expect("a size");
    let source = format!("{}\n{OUT}{PAINT}", GBufferTier::default().pack_wgsl());
    let device = &rig.gpu.device;
    let pipeline = covering(device, "paint", None, source, &GBufferTier::default().color_targets());
    let tile_size = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::bytes_of(&[8 * m, 8 * m, 0, 0]),
        usage: wgpu::BufferUsages::UNIFORM,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: tile_size.as_entire_binding() }],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    cover(&mut encoder, gbuffer, &pipeline, &group);
    rig.gpu.queue.submit([encoder.finish()]);
    for execution in [Execution::Sorted, Execution::Packed] {
        let output = rig.run(Settings { execution, ..fixed_k(4) });
        assert_eq!(output.statistics.histogram_k[3], w * h, "{execution:?}");
        for (i, pixel) in (0..).zip(&output.image) {
            let tile = [i % w / 8, i / w / 8].map(|t| t as f32);
            assert_eq!([pixel[0], pixel[1]], tile, "{execution:?}");
        }
    }
    for technique in [Technique::Single, Technique::Surfaces] {
        let output = rig.run(Settings { technique, ..Default::default() });
        let wrong = (0..).zip(&output.image).find(|(i, p)| [p[0], p[1]] != [i % w / 8, i / w / 8].map(|t| t as f32));
        assert_eq!(wrong, None, "{technique:?}");
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
            // The same view, cut: what is computed from positions is alike, too.
            let cut = [w, h].map(|side| (side + 2 * pad) as f32 / side as f32);
            small.camera = large.camera;
            small.camera.clip_from_view =
                Mat4::from_scale(Vec3::new(cut[0], cut[1], 1.0)) * small.camera.clip_from_view;
            let loops = Settings { execution: Execution::Loop, ..Default::default() };
            let paper = Settings { windowed: Windowed::PAPER, ..loops };
            // Blocks begin at the image's corner.
            let alone = Surfaces { block_spread: 0.0, ..Default::default() };
            let surfaces = Settings { technique: Technique::Surfaces, surfaces: alone, ..Default::default() };
            let tiled = Settings { execution: Execution::Tiled, ..Default::default() };
            for settings in [full(), single(), loops, tiled, paper, surfaces, Settings::default()] {
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

/// The default settings with one of the ranges at a value.
fn with(range: &SettingRange, value: f32) -> Settings {
    use serde_json::{json, to_value};
    let goals = [None, Some(Goal::Error(0.01)), Some(Goal::Time(10.0))];
    let trees = goals.map(|goal| to_value(Settings { goal, ..Default::default() }).unwrap());
    let pointer = format!("/{}", range.path.replace('.', "/"));
    let mut tree = trees.into_iter().find(|tree| tree.pointer(&pointer).is_some()).expect("a number at the path");
    let whole = range.scale == SettingScale::Whole;
    *tree.pointer_mut(&pointer).unwrap() = if whole { json!(value as u32) } else { json!(value) };
    serde_json::from_value(tree).unwrap()
}

#[test]
fn row_22_every_end_of_every_range_is_sound_for_every_technique() {
    let mut rig = Rig::new(4, 14, 3, SHOW_FLOAT);
    rig.fill(|x, y| degenerate(x, y, 4));
    for range in Settings::RANGES {
        for value in [range.least, range.most] {
            for technique in Technique::ALL {
                let settings = Settings { technique, ..with(range, value) };
                let group = range.path.split('.').next().unwrap();
                let own = format!("{technique:?}").to_lowercase() == group.replace('_', "");
                let of_all = !range.path.contains('.') || group == "goal";
                if !(own || of_all) || (group == "goal" && !technique.follows_goals()) {
                    continue;
                }
                let what = format!("{technique:?}, {} = {value:e}", range.path);
                let output = rig.run(settings);
                assert!(output.image.iter().flatten().all(|c| c.is_finite()), "{what}");
                // A frame of a goal begins where the last one ended: no two are alike.
                if settings.goal.is_none() {
                    assert_eq!(rig.run(settings).image, output.image, "{what}, again");
                }
            }
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
