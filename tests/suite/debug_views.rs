//! Debug views against what the frame is known to hold.

use crate::campaigns::words::Writer;
use crate::harness::{Rig, SHOW_USER, Sample};
use crate::shadows::{bits, full, host, light, looking, scene, square, sun};
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{Mat4, Vec3, Vec4, vec3};
use deferred_aa::reference::rays::classify::classify;
use deferred_aa::{DebugView, Effect, MultiResolution, Settings, Technique, window};
use deferred_aa_demo::host::{Host, Sent};
use deferred_aa_demo::rays::{casting_lights, reflective};
use deferred_aa_demo::scene::{Camera, Instance, LightKind, Material, Scene};
use std::collections::BTreeSet;

fn every_technique() -> impl Iterator<Item = Settings> {
    let plain = Technique::ALL.map(|technique| Settings { technique, ..Default::default() });
    // By points alone; and with points that are other samples than a pixel's first, some of which the plan casts for
    // again.
    let by_points = MultiResolution { supersampled: false, ..Default::default() };
    let shifted = MultiResolution { supersampled: true, ..MultiResolution::PAPER };
    let of =
        |multi_resolution| Settings { technique: Technique::MultiResolution, multi_resolution, ..Default::default() };
    plain.into_iter().chain([by_points, shifted].map(of))
}

/// Black through red and yellow to white.
fn heat(t: f32) -> [f32; 3] {
    [t * 3.0, t * 3.0 - 1.0, t * 3.0 - 2.0].map(|c| c.clamp(0.0, 1.0))
}

fn near(a: [f32; 4], b: [f32; 3]) -> bool {
    a[3] == 1.0 && (0..3).all(|i| (a[i] - b[i]).abs() < 2e-3)
}

#[test]
fn surfaces_are_counted() {
    // Columns of up to all different samples, some of them sky; identities that differ in one of object and material.
    let sample = |x: u32, y: u32| {
        let (window, place) = (x / 3, y % 3 * 3 + x % 3);
        let which = place.min(window);
        match which {
            8 => Sample::SKY,
            which => Sample { object: 1 + which / 2, material: which % 2, ..Default::default() },
        }
    };
    let mut rig = Rig::new(3, 12, 9, SHOW_USER);
    rig.fill(sample);
    for settings in every_technique() {
        let view = rig.run(Settings { view: DebugView::Surfaces, ..settings });
        for (i, found) in (0..).zip(&view.image) {
            let (x, y) = (i % 12, i / 12);
            let identity = |s: Sample| (s.depth > 0.0).then_some((s.object, s.material));
            let seen: BTreeSet<_> = (0..9).map(|i| identity(sample(x * 3 + i % 3, y * 3 + i / 3))).collect();
            assert_eq!(seen.len(), (x as usize + 1).min(9));
            let expected = heat((seen.len() as f32).log2() / 9f32.log2());
            assert!(near(*found, expected), "{:?} {x} {y}: {found:?} {expected:?}", settings.technique);
        }
    }
}

fn untraced(settings: Settings) -> Settings {
    Settings { shadows: Effect::Off, reflections: Effect::Off, refraction: Effect::Off, ..settings }
}

/// Of one light it is the shadow as it falls.
#[test]
fn a_shadow_is_dark() {
    let mut under = scene(vec![square()], &[(0, Mat4::from_scale(Vec3::splat(4.0)))]);
    under.instances.push(Instance { mesh: 0, world_from_mesh: Mat4::from_translation(vec3(0.0, 2.0, 0.0)), object: 2 });
    under.sun = sun(Vec3::Y);
    let camera = looking(vec3(0.0, 1.0, 7.0), Vec3::ZERO, 0.1);
    let mut made = host(under, 2, [33, 33]);
    made.frame(&camera, Settings { view: DebugView::Shadows, ..full() }).unwrap();
    let image = made.picture();
    let at = |x: usize, y: usize| image.rgba[y * 33 + x];
    assert!(near(at(16, 16), [0.0; 3]), "under the square: {:?}", at(16, 16));
    assert!(near(at(16, 24), [1.0; 3]), "before it: {:?}", at(16, 24));
    assert!(near(at(0, 0), [0.0; 3]), "the sky: {:?}", at(0, 0));
}

/// A mirroring floor, glass and a plain square in the open, so that no ray starts at the image's border; many lights.
fn garden() -> (Scene, Camera) {
    let at =
        |x: f32, y: f32, z: f32, scale| Mat4::from_translation(vec3(x, y, z)) * Mat4::from_scale(Vec3::splat(scale));
    let [floor, mut glass, mut plain] = [square(), square(), square()];
    (glass.material, plain.material) = (1, 2);
    let placed = [(0, at(0.0, 0.0, 0.0, 3.0)), (1, at(-1.0, 1.0, 0.0, 1.0)), (2, at(7.0, 1.0, 0.0, 1.5))];
    let mut garden = scene(vec![floor, glass, plain], &placed);
    let material = garden.materials[0].clone();
    let smooth = Material { base_color: Vec4::ONE, roughness: 0.0, ..material.clone() };
    let metal = Material { metallic: 1.0, ..smooth.clone() };
    // Not clear, so that it casts shadows.
    garden.materials = vec![metal, Material { transmission: 0.4, ior: 1.3, ..smooth }, material];
    garden.sun = sun(vec3(0.3, 0.9, 0.5));
    garden.lights = (0..4).map(|i| light(LightKind::Point, vec3(i as f32 * 2.0 - 3.0, 4.0, 2.0), 9.0)).collect();
    (garden, looking(vec3(2.0, 6.0, 14.0), vec3(2.0, 0.0, 0.0), 0.1))
}

/// On every technique, one after the other: the colour of its tile's classes, of the lights that reach it, and of the
/// rays that it sends, which are together those of the statistics.
#[test]
fn rays_are_shown_on_every_technique() {
    let (m, size) = (2, [61, 35]);
    let (scene, camera) = garden();
    let sent = reflective(&scene);
    let lights = casting_lights(&scene, true).len();
    assert_eq!((lights, sent.len()), (5, 2));
    let mut host = host(scene, m, size);
    let shown = |host: &mut Host, settings: Settings| {
        let statistics = host.frame(&camera, settings).expect("a frame").statistics;
        (host.picture().rgba, statistics)
    };
    // The results of all samples, and hits: as much stays for other techniques.
    let all = Settings { technique: Technique::Selective, ray_samples: 63.0, ..full() };
    shown(&mut host, all);
    let most = host.aa.memory().rays;
    for settings in every_technique() {
        let of = |view| Settings { view, ..settings };
        let (image, _) = shown(&mut host, of(DebugView::Tiles));
        let gbuffer = host.aa.gbuffer().unwrap();
        let surface: Vec<[u32; 2]> = pod_collect_to_vec(&host.gpu.read_texture(gbuffer.color[0].texture(), 8));
        let depths = host.depths();
        let [surfaces, reflective] = classify(&depths, &surface, size, m, |material| sent.contains(&material));
        let by_points = settings.technique == Technique::MultiResolution && !settings.multi_resolution.supersampled;
        let mut seen = [0; 3];
        for (i, found) in (0..).zip(&image) {
            let tile = i / size[0] / 8 * size[0].div_ceil(8) + i % size[0] / 8;
            let class = usize::from(surfaces.contains(&tile)) + usize::from(reflective.contains(&tile));
            let expected = if by_points { [0.0; 3] } else { [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]][class] };
            assert!(near(*found, expected), "{settings:?}, pixel {i}: {found:?} {expected:?}");
            seen[class] += 1;
        }
        assert!(seen.iter().all(|&s| s > 50), "{seen:?}");

        let (image, _) = shown(&mut host, of(DebugView::Shadows));
        let first = match settings.technique {
            Technique::Reconstructed if settings.reconstructed.rotated_grid => window::rotated(m),
            Technique::Surfaces => window::rotated(m),
            Technique::Selective => window::centred(m),
            _ => window::order(m),
        }[0];
        let mut colors = BTreeSet::new();
        for (i, (found, ranks)) in (0..).zip(image.iter().zip(bits(&host))) {
            let (x, y) = (i % size[0] * m + u32::from(first.0), i / size[0] * m + u32::from(first.1));
            let mut lit = [0.0; 3];
            for (channel, lit) in lit.iter_mut().enumerate() {
                let of_channel: Vec<_> = (channel..lights).step_by(3).collect();
                let reach = of_channel.iter().filter(|&light| ranks[0] >> light & 1 == 0).count();
                *lit = reach as f32 / of_channel.len() as f32;
            }
            let expected = if depths[(y * size[0] * m + x) as usize] > 0.0 { lit } else { [0.0; 3] };
            assert!(near(*found, expected), "{:?}, pixel {i}: {found:?} {expected:?}", settings.technique);
            colors.insert(expected.map(f32::to_bits));
        }
        assert!(colors.len() > 3, "{colors:?}");

        let held = host.aa.memory().rays;
        let of_image = shown(&mut host, settings).1;
        for [shadows, others] in [[true, true], [false, true], [true, false]] {
            let of = |on| if on { Effect::Auto } else { Effect::Off };
            let settings =
                Settings { shadows: of(shadows), reflections: of(others), refraction: of(others), ..settings };
            let (image, counted) = shown(&mut host, Settings { view: DebugView::Rays, ..settings });
            let sent = host.sent([shadows, others]);
            let sum = |rays: fn(&Sent) -> u8| sent.iter().map(|s| u32::from(rays(s))).sum::<u32>();
            let found = [sum(|s| s.shadow), sum(|s| s.mirrored), sum(|s| s.refracted)];
            let expected = [counted.shadow_rays, counted.reflection_rays, counted.refraction_rays];
            assert_eq!(found, expected, "{settings:?}");
            assert_eq!([found[0] > 0, found[1] > 0, found[2] > 0], [shadows, others, others], "{settings:?}");
            if shadows && others {
                let without = [of_image.shadow_rays, of_image.reflection_rays, of_image.refraction_rays];
                assert_eq!(expected, without, "looking changes nothing");
                assert!(host.aa.memory().rays > held);
            }
            let most = 4 * (if shadows { lights as u32 } else { 0 } + 2);
            for (found, ranks) in image.iter().zip(sent.as_chunks::<4>().0) {
                let rays: u32 = ranks.iter().map(|s| u32::from(s.shadow) + u32::from(s.mirrored + s.refracted)).sum();
                let expected = heat((1.0 + rays as f32).log2() / (1.0 + most as f32).log2());
                assert!(near(*found, expected), "{settings:?}: {rays} rays, {found:?} {expected:?}");
            }
        }
        shown(&mut host, settings);
        assert!(host.aa.memory().rays <= held.max(most), "the room for rays is given back");
    }
    for view in [DebugView::Tiles, DebugView::Shadows, DebugView::Rays] {
        let (image, _) = shown(&mut host, untraced(Settings { view, ..full() }));
        assert!(image.iter().all(|c| near(*c, [0.0; 3])), "{view:?}: nothing is traced");
    }
}

/// What is no number in the G-buffer, and S at exposures that overflow.
#[test]
fn views_are_finite_whatever_they_show() {
    let mut rig = Rig::new(2, 4, 4, "fn shade(s: DaaSample) -> vec4f { return vec4f(1e30); }");
    let gbuffer = rig.aa.gbuffer().expect("a size");
    let writer = Writer::new(&rig.gpu, gbuffer);
    let bad = [f32::NAN, f32::INFINITY, -f32::INFINITY, 3e38].map(f32::to_bits);
    let sample = |i: usize| [0.1f32.to_bits(), 0, 0, 0, 0, bad[i % 4], bad[i % 4], 0x7e00_7c00, 0xfc00_fe00];
    writer.write(&rig.gpu, gbuffer, &(0..64).flat_map(sample).collect::<Vec<_>>());
    for exposure in [1.0, 1e30] {
        rig.exposure = exposure;
        for view in DebugView::ALL {
            let image = rig.run(Settings { view, ..Default::default() }).image;
            assert!(image.iter().flatten().all(|c| c.is_finite()), "{view:?} at {exposure}: {image:?}");
        }
    }
}
