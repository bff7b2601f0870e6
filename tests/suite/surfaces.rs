//! `Surfaces` against its twin, and against `Full`.

use crate::harness::{Output, Rig, SHOW_USER, Sample, noise, rgba8, stored_normal};
use crate::shadows::{bits, probed};
use deferred_aa::glam::{DVec2, DVec3, Vec2, Vec3};
use deferred_aa::rays::{RayScene, RayTier};
use deferred_aa::reference::rays::shared_exponent;
use deferred_aa::reference::sample::relative_position;
use deferred_aa::reference::surfaces::cover::{Around, Covered, Seen, cover, rays, tapped};
use deferred_aa::reference::surfaces::light::{Block, Corner, Group, Light, Lookup, Material, Tap, Window};
use deferred_aa::wgpu;
use deferred_aa::{
    CastingLight, DecidedBy, DeferredAa, Needs, Preset, Settings, SurfaceWord, Surfaces, Technique, Weight, Windowed,
    window,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options};
use deferred_aa_demo::quality::psnr;
use deferred_aa_demo::scene::builtin;

const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;

/// A material that the twin computes too: its emission shows where a texture is read, and how blurred.
const HOOK: &str = "
fn material(s: DaaSample) -> DaaMaterial {
    let c = unpack4x8unorm(s.user);
    var m: DaaMaterial;
    m.base_color = vec4f(c.rgb, 1.0);
    m.roughness = 0.2 + 0.6 * c.a;
    m.metallic = c.b * c.b;
    m.normal = normalize(s.normal + vec3f(c.r - 0.5, c.g - 0.5, 0.0) * 0.4 * c.a);
    m.emissive = vec3f(s.uv, s.ddx.x * 8.0) * 0.1;
    m.occlusion = c.g;
    return m;
}
fn light(f: DaaSurface, m: DaaMaterial) -> vec4f {
    let lambert = max(dot(m.normal, vec3f(0.48, 0.6, 0.64)), 0.0);
    let rim = m.roughness * m.metallic * (1.0 - dot(f.normal, f.view));
    return vec4f(m.base_color.rgb * lambert + m.emissive + vec3f(rim, m.occlusion * 0.1, f.coverage * 0.01), 1.0);
}
fn sky(s: DaaSample) -> vec4f { return vec4f(0.2, 0.3, s.view.y * s.view.y, 1.0); }";

/// The same, with light in two parts.
fn in_parts() -> String {
    let whole = "return vec4f(m.base_color.rgb * lambert + m.emissive + ";
    assert!(HOOK.contains(whole));
    HOOK.replace("DaaMaterial) -> vec4f", "DaaMaterial) -> DaaLight")
        .replace(whole, "return DaaLight(vec3f(lambert), vec4f(")
        .replace("* 0.01), 1.0);", "* 0.01), 1.0));")
}

/// Planes, folds and steps of several objects, thin ones among them, with even and noisy materials, and sky.
fn busy(x: u32, y: u32) -> Sample {
    let (fx, fy) = (x as f32, y as f32);
    let object = if x % 29 < 2 { 200 + y / 40 } else { 1 + x / 23 + y / 19 * 5 };
    if object % 7 == 3 {
        return Sample::SKY;
    }
    let bend = noise(object + 100) * 0.03;
    let rough = noise(object + 50);
    let grain =
        |seed: u32| noise(x * 7 + y * 1013 + seed) * rough * rough + noise(object * seed) * (1.0 - rough * rough);
    Sample {
        depth: 0.02 + noise(object) * 0.2 + fy * 1e-5,
        normal: Vec3::new((fx * bend).sin(), (fy * bend).cos() * 0.5, 1.0).normalize(),
        uv: Vec2::new(fx, fy) * 0.01,
        ddx: Vec2::new(1.0 / 128.0, 0.0),
        ddy: Vec2::new(0.0, 1.0 / 128.0),
        material: object % 3,
        object,
        user: rgba8(grain(3), grain(5), grain(11), grain(13)),
        ..Default::default()
    }
}

fn settings(surfaces: Surfaces) -> Settings {
    Settings { technique: Technique::Surfaces, surfaces, ..Default::default() }
}

/// Those of a rig.
fn words(rig: &Rig) -> Vec<(SurfaceWord, Vec<u8>)> {
    words_of(&rig.aa, &rig.gpu, rig.size)
}

/// The word of each pixel, and the labels of its samples by rank, where it has several surfaces.
fn words_of(aa: &DeferredAa, gpu: &Gpu, [width, height]: [u32; 2]) -> Vec<(SurfaceWord, Vec<u8>)> {
    let passed = aa.intermediates().expect("a size");
    let all: Vec<u32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(passed.surfaces.expect("surfaces")));
    let n = aa.m() * aa.m();
    let of_set = if aa.m() > 5 { 2 } else { 1 };
    let slots = passed.slots.count();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let word = |(x, y)| {
        let slot = passed.slots.pixel(x, y);
        let bit =
            |bit: usize, rank: u32| all[slots * (1 + bit * of_set + (rank / 32) as usize) + slot] >> (rank % 32) & 1;
        let label = |rank| (bit(0, rank) | bit(1, rank) << 1 | bit(2, rank) << 2) as u8;
        (SurfaceWord(all[slot]), (0..n).map(label).collect())
    };
    pixels.map(word).collect()
}

/// Positions of windows' samples, as the twin computes them.
struct Scene {
    m: u32,
    camera: deferred_aa::Camera,
    order: Vec<(u8, u8)>,
    sample: fn(u32, u32) -> Sample,
}

impl Scene {
    fn of(rig: &Rig, sample: fn(u32, u32) -> Sample) -> Self {
        Self { m: rig.aa.m(), camera: rig.camera, order: window::rotated(rig.aa.m()), sample }
    }

    fn at(&self, pixel: [u32; 2], rank: usize) -> (Sample, DVec3) {
        let (sx, sy) = self.order[rank];
        let [x, y] = [pixel[0] * self.m + u32::from(sx), pixel[1] * self.m + u32::from(sy)];
        let s = (self.sample)(x, y);
        let depth = if s.depth > 0.0 { f64::from(s.depth) } else { 1.0 };
        let at = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        (s, relative_position(&self.camera, [WIDTH * self.m, HEIGHT * self.m], at, depth))
    }

    fn covered(&self, pixel: [u32; 2], surfaces: &Surfaces) -> Covered {
        let seen = |rank| match self.at(pixel, rank) {
            (s, _) if s.depth == 0.0 => Seen::Sky,
            (s, position) => Seen::Surface {
                position,
                normal: stored_normal(s.normal),
                identity: s.material | s.object << 16,
                triangle: None,
            },
        };
        let window: Vec<_> = (0..self.order.len()).map(seen).collect();
        cover(&window, -DVec3::Z, surfaces)
    }

    /// `sky` and `material` of the hook.
    fn tap(&self, pixel: [u32; 2], lookup: Lookup) -> Tap {
        let (s, position) = self.at(pixel, lookup.rank);
        let view = -position.normalize();
        if s.depth == 0.0 {
            return Tap::Sky([0.2, 0.3, view.y * view.y, 1.0]);
        }
        let [r, g, b, a] = s.user.to_le_bytes().map(|c| f64::from(c) / 255.0);
        let normal = stored_normal(s.normal);
        let uv = s.uv.as_dvec2() + DVec2::from(lookup.offset) / 128.0;
        let material = Material {
            base_color: [r, g, b, 1.0],
            roughness: 0.2 + 0.6 * a,
            metallic: b * b,
            normal: (normal + DVec3::new(r - 0.5, g - 0.5, 0.0) * 0.4 * a).normalize(),
            emissive: [uv.x * 0.1, uv.y * 0.1, lookup.footprint / 128.0 * 0.8],
            occlusion: g,
        };
        Tap::Surface { position, normal, identity: s.material | s.object << 16, shadow: 0, material }
    }
}

/// `light` of the hook.
fn light(g: &Group) -> Light {
    let m = &g.material;
    let lambert = m.normal.dot(DVec3::new(0.48, 0.6, 0.64)).max(0.0);
    let rim = m.roughness * m.metallic * (1.0 - g.normal.dot(-g.position.normalize()));
    let more = [rim, m.occlusion * 0.1, g.coverage * 0.01];
    let [r, g, b] = more;
    Light { diffuse: [lambert; 3], rest: [r, g, b, 1.0] }
}

/// The windows of a frame as the twin has them.
struct Windows<'a> {
    scene: Scene,
    settings: &'a Settings,
    /// Whether blocks share their light.
    blocks: bool,
}

impl Windows<'_> {
    fn with<R>(
        &self,
        pixel: [u32; 2],
        covered: &Covered,
        corners: &[Option<Corner>; 4],
        then: impl FnOnce(Window<'_>) -> R,
    ) -> R {
        let block = Block { place: pixel.map(|p| p % 4), corners, forward: -DVec3::Z };
        then(Window {
            covered,
            order: &self.scene.order,
            settings: &self.settings.surfaces,
            weight: self.settings.weight,
            exposure: 1.0,
            tap: &|lookup| self.scene.tap(pixel, lookup),
            light: &light,
            block: self.blocks.then_some(block),
        })
    }

    /// What the corners of a window's block lend, and the least margin of the decisions on them.
    fn corners(&self, pixel: [u32; 2]) -> ([Option<Corner>; 4], f64) {
        let mut least = f64::INFINITY;
        let corners = std::array::from_fn(|i| {
            let [x, y] = [pixel[0] / 4 * 4 + i as u32 % 2 * 3, pixel[1] / 4 * 4 + i as u32 / 2 * 3];
            if !self.blocks || x >= WIDTH || y >= HEIGHT {
                return None;
            }
            let covered = self.scene.covered([x, y], &self.settings.surfaces);
            let (corner, margin) = self.with([x, y], &covered, &[None; 4], |window| window.corner());
            least = least.min(margin).min(covered.margin * 1e5);
            corner
        });
        (corners, least)
    }
}

/// How a frame compares with the twin.
#[derive(Debug, Default)]
struct Compared {
    /// Windows too near a threshold to be compared.
    left_out: usize,
    /// Windows without a light of their own.
    interpolated: usize,
}

/// Holds a frame against the twin. `blocks`: the host's light is in parts.
fn assert_twin_agrees(
    rig: &Rig,
    sample: fn(u32, u32) -> Sample,
    settings: &Settings,
    output: &Output,
    blocks: bool,
) -> Compared {
    let windows =
        Windows { scene: Scene::of(rig, sample), settings, blocks: blocks && settings.surfaces.block_spread > 0.0 };
    let m = rig.aa.m();
    let mut compared = Compared::default();
    for (i, (word, labels)) in words(rig).into_iter().enumerate() {
        let pixel = [i as u32 % WIDTH, i as u32 / WIDTH];
        let covered = windows.scene.covered(pixel, &settings.surfaces);
        let (corners, corners_margin) = windows.corners(pixel);
        if covered.margin < 1e-5 || corners_margin < 1.0 {
            compared.left_out += 1;
            continue;
        }
        let of = format!("m = {m}, window {pixel:?}: {covered:?}");
        assert_eq!((word.surfaces(), word.is_merged()), (u32::from(covered.surfaces), covered.merged), "{of}");
        if covered.surfaces > 1 {
            assert_eq!(labels, covered.labels, "{of}");
        }
        let lit = windows.with(pixel, &covered, &corners, |window| window.lit());
        if lit.margin < 1.0 {
            compared.left_out += 1;
            continue;
        }
        let counts = (word.lights(), word.interpolated(), word.taps());
        assert_eq!(counts, (lit.lights, lit.interpolated, lit.taps), "{of} {lit:?}");
        let apart = (0..4).map(|c| (f64::from(output.image[i][c]) - lit.color[c]).abs()).fold(0.0, f64::max);
        assert!(apart <= 2e-5, "{of}: {:?}, twin {lit:?}", output.image[i]);
        compared.interpolated += usize::from(lit.lights == 0);
    }
    compared
}

fn variants() -> Vec<Surfaces> {
    let base = Surfaces::default();
    vec![
        base,
        Preset::Fast.surfaces(),
        Preset::Quality.surfaces(),
        Surfaces { groups: 1, ..base },
        Surfaces::ONCE,
        Surfaces { spread: 5e-3, tap_spread: 1e-3, widening: 0.0, ..base },
        Surfaces { surfaces: 2, first_taps: 1, footprint: 2.0, groups: 3, ..base },
        Surfaces { taps: 5, first_taps: 3, normal_cosine: 0.999, plane: 1e-4, footprint: 1.0, spread: 0.02, ..base },
    ]
}

#[test]
fn every_window_is_the_twins() {
    for m in 1..=8 {
        let mut rig = Rig::new(m, WIDTH, HEIGHT, HOOK);
        rig.fill(busy);
        for (i, surfaces) in variants().into_iter().enumerate() {
            let weight = if i % 2 == 0 { Weight::Linear } else { Weight::Luminance };
            let settings = Settings { weight, ..settings(surfaces) };
            let output = rig.run(settings);
            let compared = assert_twin_agrees(&rig, busy, &settings, &output, false);
            eprintln!("m = {m}, variant {i}: {compared:?}");
            assert!(compared.left_out as u32 * 5 <= 2 * WIDTH * HEIGHT, "m = {m}, variant {i}: {compared:?}");
            assert_eq!((compared.interpolated, output.statistics.surfaces.interpolated), (0, 0));
        }
    }
}

/// The same four times as large, so that blocks fit into it.
fn large(x: u32, y: u32) -> Sample {
    busy(x / 4, y / 4)
}

#[test]
fn light_between_the_corners_of_blocks_is_the_twins() {
    let variants = [
        Preset::Fast.surfaces(),
        Surfaces { block_spread: 0.1, block_contrast: 0.3, ..Default::default() },
        Surfaces { block_spread: 1e6, block_contrast: 1.0, spread: 1e6, tap_spread: 0.0, ..Default::default() },
        Surfaces {
            block_spread: 0.05,
            block_contrast: 0.02,
            surfaces: 2,
            groups: 1,
            first_taps: 2,
            ..Default::default()
        },
    ];
    for m in [1, 2, 3, 4, 6, 8] {
        let mut rig = Rig::new(m, WIDTH, HEIGHT, &in_parts());
        rig.fill(large);
        for (i, surfaces) in variants.into_iter().enumerate() {
            let weight = if i % 2 == 0 { Weight::Linear } else { Weight::Luminance };
            // Pixels of so small an image are far apart.
            let settings = Settings { weight, ..settings(Surfaces { plane: 0.1, ..surfaces }) };
            let output = rig.run(settings);
            let compared = assert_twin_agrees(&rig, large, &settings, &output, true);
            eprintln!("m = {m}, variant {i}: {compared:?}, {:?}", output.statistics.surfaces);
            assert!(compared.left_out as u32 * 2 <= WIDTH * HEIGHT, "m = {m}, variant {i}: {compared:?}");
            assert!(compared.interpolated > 20, "m = {m}, variant {i}: {compared:?}");
            assert_eq!(output.statistics.not_finite, 0);
        }
    }
}

#[test]
fn statistics_are_the_sums_of_the_words() {
    for m in [1, 3, 8] {
        let mut rig = Rig::new(m, WIDTH, HEIGHT, HOOK);
        rig.fill(busy);
        let s = rig.run(settings(Surfaces { surfaces: 3, ..Default::default() })).statistics;
        let words = words(&rig);
        let sum = |of: fn(SurfaceWord) -> u32| words.iter().map(|(word, _)| u64::from(of(*word))).sum::<u64>();
        assert_eq!(s.shaded, sum(SurfaceWord::lights));
        assert_eq!(u64::from(s.surfaces.surfaces), sum(SurfaceWord::surfaces));
        assert_eq!(u64::from(s.surfaces.taps), sum(SurfaceWord::taps));
        assert_eq!(u64::from(s.surfaces.merged), sum(|word| word.is_merged().into()));
        assert!(s.surfaces.merged > 0 || m == 1, "{s:?}");
        for (k, windows) in (1..).zip(&s.histogram_k) {
            assert_eq!(*windows as usize, words.iter().filter(|(word, _)| word.lights() == k).count(), "{k}");
        }
    }
}

/// With a light for each tap, the image is that of `Full`.
#[test]
fn a_light_for_each_tap_is_full_supersampling() {
    let each = Surfaces { spread: 0.0, tap_spread: 0.0, first_taps: 16, ..Default::default() };
    // Up to 8 groups of a surface, so that 2 × 2 samples have one each.
    for m in [1, 2] {
        let mut rig = Rig::new(m, WIDTH, HEIGHT, &HOOK.replace("f.coverage * 0.01", "0.0"));
        rig.fill(|x, y| Sample { user: (noise(x * 7919 + y) * 4e9) as u32, ..busy(x, y) });
        let full = rig.run(Settings { technique: Technique::Full, ..Default::default() });
        let lit = rig.run(settings(each));
        let sky = |i: usize| rig.aa.m() == 1 && busy(i as u32 % WIDTH, i as u32 / WIDTH).depth == 0.0;
        for (i, (a, b)) in full.image.iter().zip(&lit.image).enumerate().filter(|(i, _)| !sky(*i)) {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 2e-6), "m = {m}, {i}: {a:?} {b:?}");
        }
    }
}

/// A host without `material` and `light` has the sample nearest to each surface's centre shaded.
#[test]
fn a_whole_hook_is_shaded_once_for_each_surface() {
    for m in [1, 4, 7] {
        let mut rig = Rig::new(m, WIDTH, HEIGHT, SHOW_USER);
        rig.fill(busy);
        let output = rig.run(settings(Surfaces::default()));
        let scene = Scene::of(&rig, busy);
        let n = (m * m) as usize;
        for (i, (word, labels)) in words(&rig).into_iter().enumerate() {
            assert_eq!((word.lights(), word.taps()), (word.surfaces(), word.surfaces()));
            let label = |rank: usize| if word.surfaces() == 1 { 0 } else { labels[rank] };
            let mut expected = [0.0; 4];
            for surface in 0..word.surfaces() as u8 {
                let ranks: Vec<usize> = (0..n).filter(|&rank| label(rank) == surface).collect();
                let place = |rank: usize| DVec2::new(scene.order[rank].0.into(), scene.order[rank].1.into());
                let centre = ranks.iter().map(|&rank| place(rank)).sum::<DVec2>() / ranks.len() as f64;
                let to_centre = |rank: &usize| (place(*rank).distance_squared(centre) * 1e6).round() as u64;
                let central = *ranks.iter().min_by_key(|rank| (to_centre(rank), **rank)).expect("samples");
                let (s, _) = scene.at([i as u32 % WIDTH, i as u32 / WIDTH], central);
                let color = if s.depth == 0.0 { [0.0; 4] } else { s.user.to_le_bytes().map(|c| f64::from(c) / 255.0) };
                let share = ranks.len() as f64 / n as f64;
                expected.iter_mut().zip(color).for_each(|(e, c)| *e += c * share);
            }
            if word.is_merged() {
                continue;
            }
            let apart =
                output.image[i].iter().zip(expected).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
            assert!(apart <= 1e-5, "m = {m}, window {i}: {:?} {expected:?}", output.image[i]);
        }
    }
}

/// The host's own features decide in place of the crate's.
#[test]
fn a_host_may_say_what_spreads() {
    let with =
        |spread: &str| format!("{HOOK}\nfn spread(s: DaaSample, m: DaaMaterial) -> DaaSpread {{ return {spread}; }}");
    let lights = |hook: &str| {
        let mut rig = Rig::new(4, WIDTH, HEIGHT, hook);
        rig.fill(busy);
        let s = rig.run(settings(Surfaces::default())).statistics;
        [s.shaded, s.surfaces.surfaces.into(), s.surfaces.taps.into()]
    };
    let own = lights(HOOK);
    let [lit, surfaces, taps] = lights(&with("DaaSpread()"));
    assert!(lit == surfaces && taps < own[2], "nothing spreads: {lit} lights, {surfaces} surfaces, {taps} taps");
    let [far, _, all] = lights(&with("DaaSpread(vec4f(1e3 * f32(s.rank)), vec4f(0.0))"));
    assert!(far > own[0] && all > own[2], "all spreads: {far} {all} {own:?}");
    let nan = "let zero = m.occlusion * 0.0; return DaaSpread(vec4f(zero / zero), vec4f(1.0 / zero)";
    let [none, ..] = lights(&with("DaaSpread()").replace("return DaaSpread()", &format!("{nan})")));
    assert_eq!(none, surfaces, "NaN spreads nothing");
}

#[test]
fn nothing_that_is_not_finite_gets_out() {
    let zero = "let zero = f32(min(s.rank, 0u));";
    for bad in ["vec4f(zero / zero)", "vec4f(1.0 / zero)", "vec4f(-1.0)"] {
        for host in [HOOK, &in_parts()] {
            let hook = host
                .replace("    m.occlusion = c.g;", &format!("{zero}\n m.occlusion = 1.0;\n m.base_color = {bad}; m.roughness = m.base_color.x; m.normal = m.base_color.xyz;"));
            let mut rig = Rig::new(4, WIDTH, HEIGHT, &hook);
            rig.fill(busy);
            let output = rig.run(settings(Surfaces::default()));
            assert!(output.image.iter().flatten().all(|c| c.is_finite() && *c >= 0.0), "{bad}");
        }
    }
    // A light that is not finite at the corners of blocks stays there.
    let corner = "(f.pixel.x % 4u) % 3u == 0u && (f.pixel.y % 4u) % 3u == 0u";
    for bad in ["1.0", "-1.0"] {
        let broken = format!("let rim = select(1.0, {bad} / max(1.0 - f.coverage, 0.0), {corner}) *");
        let mut rig = Rig::new(4, WIDTH, HEIGHT, &in_parts().replace("let rim =", &broken));
        rig.fill(large);
        let output = rig.run(settings(Surfaces { plane: 0.1, block_spread: 1e6, spread: 1e6, ..Default::default() }));
        assert!(output.image.iter().flatten().all(|c| c.is_finite() && *c >= 0.0), "{bad}");
        let black = output.image.iter().filter(|c| c[..3] == [0.0; 3]).count() as u32;
        assert!(output.statistics.not_finite >= 100 && black <= output.statistics.not_finite, "{black} black pixels");
        assert_eq!(output.statistics.surfaces.interpolated, 0);
    }
    // Neither does a material between them take good light to a bad image.
    let bad =
        format!("    m.occlusion = c.g;\n{zero}\n if s.pixel.x % 4u == 1u {{ m.base_color = vec4f(zero / zero); }}");
    let mut rig = Rig::new(4, WIDTH, HEIGHT, &in_parts().replace("    m.occlusion = c.g;", &bad));
    rig.fill(large);
    let output = rig.run(settings(Surfaces { plane: 0.1, block_spread: 1e6, spread: 1e6, ..Default::default() }));
    assert!(output.image.iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
    let black = output.image.iter().filter(|c| c[..3] == [0.0; 3]).count() as u32;
    assert!(output.statistics.not_finite >= 100 && black >= 100, "{black}, {:?}", output.statistics);
    assert!(output.statistics.surfaces.interpolated >= 100);
    // Normals that cancel.
    let cancel =
        HOOK.replace("m.normal = normalize(", "m.normal = select(-1.0, 1.0, (s.rank & 1u) == 0u) * normalize(");
    let mut rig = Rig::new(4, WIDTH, HEIGHT, &cancel);
    rig.fill(busy);
    let output = rig.run(settings(Surfaces { spread: 1e6, first_taps: 16, ..Default::default() }));
    assert!(output.image.iter().flatten().all(|c| c.is_finite()));
    assert_eq!(output.statistics.not_finite, 0);
}

#[test]
fn the_same_frame_is_the_same_bits() {
    let mut rig = Rig::new(5, WIDTH, HEIGHT, &in_parts());
    rig.fill(busy);
    let bits = |output: &Output| output.image.iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
    let first = rig.run(settings(Preset::Quality.surfaces()));
    for _ in 0..4 {
        let again = rig.run(settings(Preset::Quality.surfaces()));
        assert_eq!(bits(&first), bits(&again));
        assert_eq!(first.statistics.histogram_k, again.statistics.histogram_k);
        rig.run(Settings::default());
    }
}

/// On every built-in scene, with shadows and mirrors where they have them: near to `Full`, with hardly more lights than
/// plain shading has, and nearer with the presets in turn.
#[test]
fn scenes_are_nearly_those_of_full_supersampling() {
    let mut lines = Vec::new();
    for name in builtin::NAMES {
        let scene = builtin::builtin(name).expect("built in");
        let camera = scene.default_camera();
        let adapter = gpu::choose(None).expect("tests need an adapter");
        let options = Options::new(160, 90, 4);
        let gpu = Gpu::new(adapter, &options.descriptor()).expect("a device");
        let mut host = Host::new(gpu, scene, options).expect("a host");
        host.frame(&camera, Settings { technique: Technique::Full, ..Default::default() }).expect("a frame");
        let full = host.picture();
        let [fast, balanced, quality] = Preset::ALL.map(|preset| {
            // So small an image of `shadows` is full of their edges, beyond the room of the default.
            let settings = Settings { ray_samples: 15.0, ..settings(preset.surfaces()) };
            let shot = host.frame(&camera, settings).expect("a frame");
            assert_eq!(host.gpu.take_errors(), Vec::<String>::new());
            let db = psnr(&host.picture(), &full).expect("of one size");
            (db, shot.statistics.mean_k)
        });
        let line = format!("{name}: fast {fast:.2?}, balanced {balanced:.2?}, quality {quality:.2?}");
        eprintln!("{line}");
        let sound = balanced.0 > 40.0 && quality.0 > 41.0 && quality.0 + 0.5 > balanced.0 && balanced.0 + 0.5 > fast.0;
        if !sound || balanced.1 > 2.0 || quality.1 > 2.6 {
            lines.push(line);
        }
    }
    assert!(lines.is_empty(), "dB and lights a pixel:\n{}", lines.join("\n"));
}

/// The samples that cast rays are the twin's.
#[test]
fn rays_are_cast_where_the_twin_wants_them() {
    let (width, height) = (96, 54);
    let reach = |shadow_reach| Surfaces { shadow_reach, ..Default::default() };
    let few = Surfaces { taps: 3, ..reach(1) };
    for (name, of) in [
        ("shadows", reach(0)),
        ("shadows", reach(3)),
        ("mirrors", reach(1)),
        ("shadows", Surfaces::ONCE),
        ("mirrors", few),
    ] {
        let scene = builtin::builtin(name).expect("built in");
        let camera = scene.default_camera();
        let options = Options::new(width, height, 4);
        let gpu = Gpu::new(gpu::choose(None).expect("tests need an adapter"), &options.descriptor()).expect("a device");
        let mut host = Host::new(gpu, scene, options).expect("a host");
        let settings = settings(of);
        let probed = probed(&mut host, &camera, &settings, of.shadow_reach);
        host.frame(&camera, settings).expect("a frame");
        let found = bits(&host);
        let passed = host.aa.intermediates().expect("a size");
        let read = |buffer: Option<&wgpu::Buffer>| -> Vec<u32> {
            buffer.map_or(Vec::new(), |buffer| bytemuck::pod_collect_to_vec(&host.gpu.read_buffer(buffer)))
        };
        let reflections = read(passed.reflections);
        let words = words_of(&host.aa, &host.gpu, [width, height]);
        let first = |found: &[u32], x: i32, y: i32| {
            let [x, y] = [x.clamp(0, width as i32 - 1) as u32, y.clamp(0, height as i32 - 1) as u32];
            found.get(passed.slots.sample(x, y, 0)).copied().unwrap_or(0)
        };
        let reflected = |x, y| {
            let c = shared_exponent::decode(first(&reflections, x, y));
            c / (1.0 + c)
        };
        let (mut all, mut alone) = ([0; 3], 0);
        for (i, word) in host.plan().into_iter().enumerate() {
            let (x, y) = ((i as u32 % width) as i32, (i as u32 / width) as i32);
            let near = |reach: i32| (-reach..=reach).flat_map(move |j| (-reach..=reach).map(move |i| (x + i, y + j)));
            let around = Around {
                shadow_edge: near(1).any(|(i, j)| {
                    let [i, j] = [i.clamp(0, width as i32 - 1), j.clamp(0, height as i32 - 1)];
                    probed.get((j * width as i32 + i) as usize).copied().unwrap_or(false)
                }),
                contrast: near(1)
                    .map(|(i, j)| (reflected(i, j) - reflected(x, y)).abs().max_element())
                    .fold(0.0, f64::max),
            };
            let surfaces = words[i].0.surfaces() as u8;
            let wanted = rays(16, surfaces, tapped(&words[i].1, &of, false), &around);
            let same = (word.k() as usize, word.decided_by()) == (wanted.k, wanted.by);
            assert!(same || wanted.margin < 1e-6, "{name} ({x}, {y}): {word:?} {around:?}");
            if word.decided_by() == DecidedBy::Luminance {
                let bits = &found[i][..wanted.k];
                assert!(bits.iter().all(|of_rank| *of_rank == bits[0]), "{name} ({x}, {y}): {bits:?}");
                alone += 1;
            }
            assert!([1, 4, 16].contains(&word.k()) || of.taps < 16, "{name} ({x}, {y}): {word:?}");
            all[match word.k() {
                1 => 0,
                16 => 2,
                _ => 1,
            }] += 1;
        }
        let between = name == "mirrors" || of.taps < 16;
        assert!(all[0] > 500 && (all[2] > 200 || of == Surfaces::ONCE) && (all[1] > 10) == between, "{name}: {all:?}");
        assert!(alone > 100 || name == "shadows", "{name}: {alone}");
    }
}

/// Of a window of several surfaces, all samples cast rays of a host that shades samples as a whole, which may have any of
/// them shaded. Of another host those do up to the last tap.
#[test]
fn samples_that_are_not_read_cast_no_rays() {
    let lights = [CastingLight::Directional { towards: Vec3::Y }];
    for (shading, whole) in [(SHOW_USER, true), (HOOK, false)] {
        let mut rig = Rig::with_rays(4, WIDTH, HEIGHT, shading);
        rig.fill(busy);
        let mut scene = RayScene::new(&rig.gpu.device, RayTier::Software);
        let mut encoder = rig.gpu.device.create_command_encoder(&Default::default());
        let eye = rig.camera.world_from_view.w_axis.truncate();
        scene.update(&rig.gpu.device, &rig.gpu.queue, &mut encoder, &[], eye).expect("an empty scene");
        rig.gpu.queue.submit([encoder.finish()]);
        let needs = Needs { shadows: &lights, rays: Some(&scene), ..Default::default() };
        let plan = rig.run_with(settings(Surfaces::ONCE), needs).plan;
        let mut as_wanted = 0;
        for ((word, labels), (k, ..)) in words(&rig).into_iter().zip(plan) {
            let several = word.surfaces() > 1;
            let wanted = if several { tapped(&labels, &Surfaces::ONCE, whole) } else { 1 };
            assert_eq!(k as usize, wanted, "whole: {whole}, {word:?} {labels:?}");
            as_wanted += u32::from(several && (wanted == 16) == whole);
        }
        assert!(as_wanted > 100, "{as_wanted}");
    }
}

/// Shadows thinner than the distance of first samples, which these hit here and there.
#[test]
fn thin_shadows_are_whole() {
    let scene = builtin::builtin("shadows").expect("built in");
    let camera = scene.default_camera();
    let options = Options::new(480, 270, 4);
    let gpu = Gpu::new(gpu::choose(None).expect("tests need an adapter"), &options.descriptor()).expect("a device");
    let mut host = Host::new(gpu, scene, options).expect("a host");
    host.frame(&camera, Settings { technique: Technique::Full, ..Default::default() }).expect("a frame");
    let full = host.picture();
    let mut db = |settings| {
        host.frame(&camera, settings).expect("a frame");
        psnr(&host.picture(), &full).expect("of one size")
    };
    let [short, nearly, whole] = Preset::ALL.map(|preset| db(settings(preset.surfaces())));
    let windowed =
        |shadow_reach| Settings { windowed: Windowed { shadow_reach, ..Default::default() }, ..Default::default() };
    let [dashes, lines] = [0, 2].map(|reach| db(windowed(reach)));
    eprintln!("{short:.2}, {nearly:.2} and {whole:.2} dB, Windowed {dashes:.2} and {lines:.2}");
    assert!(whole > 63.0 && nearly > 58.0 && short > 52.0, "{whole} {nearly} {short}");
    assert!(dashes < 47.5 && lines > 48.5, "{dashes} {lines}");
}

/// Where a shadow or a mirror has only room for first results, a frame is still whole.
#[test]
fn without_room_first_results_stand_in() {
    for name in ["shadows", "mirrors"] {
        let scene = builtin::builtin(name).expect("built in");
        let camera = scene.default_camera();
        let options = Options::new(96, 54, 4);
        let gpu = Gpu::new(gpu::choose(None).expect("tests need an adapter"), &options.descriptor()).expect("a device");
        let mut host = Host::new(gpu, scene, options).expect("a host");
        let all = host
            .frame(&camera, settings(Surfaces { shadow_reach: 1, ..Default::default() }))
            .expect("a frame")
            .statistics;
        let image = host.picture();
        assert!(all.without_rays == 0 && all.shadow_rays + all.reflection_rays > 0, "{all:?}");
        let few = Settings { ray_samples: 0.0, ..settings(Surfaces { shadow_reach: 1, ..Default::default() }) };
        let few = host.frame(&camera, few).expect("a frame").statistics;
        assert!(few.without_rays > 0 && few.shadow_rays < all.shadow_rays, "{few:?}");
        let db = psnr(&host.picture(), &image).expect("of one size");
        assert!((25.0..100.0).contains(&db), "{name}: {db}");
    }
}

/// Objects of one sample each: more surfaces than are told apart, whose rest is read as one.
#[test]
fn samples_of_as_many_objects_are_the_twins() {
    fn confetti(x: u32, y: u32) -> Sample {
        let object = 1 + x % 8 + y % 8 * 8;
        let sky = noise(x + y * 769) < 0.1;
        let ddx = Vec2::new(1.0 / 128.0, 0.0);
        let depth = 0.02 + noise(object) * 0.2;
        if sky { Sample::SKY } else { Sample { object, depth, ddx, ddy: ddx.perp(), ..busy(x | 1, y) } }
    }
    for m in [3, 8] {
        let mut rig = Rig::new(m, WIDTH, HEIGHT, HOOK);
        rig.fill(confetti);
        for groups in [1, 8] {
            let settings = settings(Surfaces { groups, ..Default::default() });
            let output = rig.run(settings);
            let compared = assert_twin_agrees(&rig, confetti, &settings, &output, false);
            eprintln!("m = {m}, {groups} groups: {compared:?}");
            assert!(compared.left_out as u32 * 2 < WIDTH * HEIGHT);
            assert!(output.statistics.surfaces.merged > WIDTH * HEIGHT * 9 / 10, "m = {m}");
        }
    }
}
