//! Mirrored and refracted rays through the demo's host, against what the geometry says.

use crate::shadows::{full, host, looking, scene, square};
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{Mat4, Vec3, Vec4, vec3};
use deferred_aa::{Effect, Reconstructed, Settings, Technique};
use deferred_aa_demo::quality::{edge_psnr, psnr};
use deferred_aa_demo::scene::{Instance, Material, Scene, builtin};

/// Glowing in one colour, black else.
fn lamp(color: Vec3) -> Material {
    let mut material = builtin::builtin("flat").unwrap().materials[0].clone();
    (material.base_color, material.emissive) = (Vec4::new(0.0, 0.0, 0.0, 1.0), color);
    material
}

/// A floor of material 0 under a lamp that faces it, with a dark sky.
fn under_a_lamp(floor: Material) -> Scene {
    let down = Mat4::from_rotation_x(std::f32::consts::PI);
    let mut made = scene(vec![square(), square()], &[(0, Mat4::from_scale(Vec3::splat(4.0)))]);
    made.meshes[1].material = 1;
    let lamp_at = Mat4::from_translation(vec3(0.0, 2.0, 0.0)) * down;
    made.instances.push(Instance { mesh: 1, world_from_mesh: lamp_at, object: 2 });
    made.materials = vec![floor, lamp(vec3(3.0, 0.5, 0.25))];
    made.sky = deferred_aa_demo::scene::Sky { zenith: Vec3::ZERO, horizon: Vec3::ZERO, ground: Vec3::ZERO };
    made
}

fn metal() -> Material {
    let plain = builtin::builtin("flat").unwrap().materials[0].clone();
    Material { base_color: Vec4::ONE, metallic: 1.0, roughness: 0.0, ..plain }
}

fn glass(ior: f32) -> Material {
    let plain = builtin::builtin("flat").unwrap().materials[0].clone();
    Material { base_color: Vec4::ONE, roughness: 0.0, transmission: 1.0, ior, volume: true, ..plain }
}

/// A perfect mirror shows the lamp where the reflected ray meets it, in its own colour, and the sky elsewhere.
#[test]
fn a_mirror_shows_what_the_law_of_reflection_says() {
    let (width, height) = (48, 36);
    let camera = looking(vec3(0.0, 1.5, 5.0), vec3(0.0, 0.0, 0.0), 0.1);
    let mut host = host(under_a_lamp(metal()), 1, [width, height]);
    let statistics = host.frame(&camera, full()).unwrap().statistics;
    let picture = host.picture();
    let camera = deferred_aa_demo::raster::node_camera(&camera, width, height);
    let world = (camera.clip_from_view * camera.world_from_view.inverse()).inverse();
    let eye = camera.world_from_view.w_axis.truncate();
    let (mut lit, mut dark) = (0, 0);
    for y in 0..height {
        for x in 0..width {
            let ndc =
                vec3((x as f32 + 0.5) / width as f32 * 2.0 - 1.0, 1.0 - (y as f32 + 0.5) / height as f32 * 2.0, 0.5);
            let way = world.project_point3(ndc) - eye;
            let ground = eye - way * (eye.y / way.y);
            let on_floor = way.y < 0.0 && ground.x.abs() < 4.0 && ground.z.abs() < 4.0;
            // The lamp hangs before some of the floor.
            let at_lamp = eye + way * ((2.0 - eye.y) / way.y);
            if !on_floor || (way.y > 0.0 && at_lamp.x.abs() < 1.1) {
                continue;
            }
            let mirrored = ground + vec3(way.x, -way.y, way.z) * (2.0 / -way.y);
            let outside = mirrored.x.abs().max(mirrored.z.abs()) - 1.0;
            let color = Vec3::from_slice(&picture.rgba[(y * width + x) as usize][..3]);
            if outside < -0.05 {
                assert!((color - vec3(3.0, 0.5, 0.25)).abs().max_element() < 0.02, "{x} {y}: {color}");
                lit += 1;
            } else if outside > 0.05 {
                assert!(color.max_element() < 1e-3, "{x} {y}: {color}");
                dark += 1;
            }
        }
    }
    assert!(lit > 30 && dark > 200, "{lit} {dark}");
    assert!(statistics.reflection_rays > 300 && statistics.refraction_rays == 0);
}

/// What the camera would not see from behind, a mirror does not show from behind.
#[test]
fn a_mirror_shows_no_culled_faces() {
    let camera = looking(vec3(0.0, 1.5, 5.0), Vec3::ZERO, 0.1);
    // The lamp faces up, away from the floor.
    let picture = |double_sided: bool, there: bool| {
        let mut made = under_a_lamp(metal());
        made.materials[1].double_sided = double_sided;
        made.instances[1].world_from_mesh = Mat4::from_translation(vec3(0.0, 2.0, 0.0));
        made.instances.truncate(1 + usize::from(there));
        let mut host = host(made, 1, [48, 36]);
        host.frame(&camera, full()).unwrap();
        host.picture().rgba
    };
    let none = picture(false, false);
    assert_eq!(picture(false, true), none);
    assert!(picture(true, true).iter().filter(|c| c[0] > 2.0).count() > 30);
}

/// A body of glass with the index of air is not there; a ball with that of glass turns what lies behind it upside down.
#[test]
fn glass_refracts_as_its_index_says() {
    let mut behind = builtin::builtin("mirrors").unwrap();
    let glass_ball = behind.meshes.iter().position(|m| m.name == "glass ball").unwrap();
    let letters = behind.meshes.iter().position(|m| m.name == "lettering").unwrap();
    let wall = behind.meshes.iter().position(|m| m.name == "sheet").unwrap();
    behind.instances.retain(|i| [glass_ball, letters, wall].contains(&i.mesh));
    let ink = behind.meshes[letters].material;
    behind.materials[ink] = lamp(vec3(2.0, 0.0, 0.0));
    // Above the middle, behind the ball.
    let place = |mesh, world_from_mesh| Instance { mesh, world_from_mesh, object: 9 };
    let ball = Mat4::from_translation(Vec3::ZERO);
    let above = Mat4::from_translation(vec3(-3.0, 0.15, -4.0)) * Mat4::from_scale(vec3(1.2, 2.0, 1.0));
    let red_above = |index: f32| {
        let mut made = behind.clone();
        made.materials[made.meshes[glass_ball].material] = glass(index);
        made.instances = vec![Instance { object: 1, ..place(glass_ball, ball) }, place(letters, above)];
        made.lights.clear();
        made.sun = None;
        let camera = looking(vec3(0.0, 0.0, 4.0), Vec3::ZERO, 0.1);
        let mut host = host(made, 2, [40, 40]);
        let statistics = host.frame(&camera, full()).unwrap().statistics;
        assert!(statistics.refraction_rays > 100);
        let red = host.picture().rgba.iter().map(|c| f64::from(c[0] - c[2]).max(0.0)).collect::<Vec<_>>();
        // Through the ball: the middle third of the view.
        let sum = |rows: std::ops::Range<usize>| -> f64 {
            rows.flat_map(|y| (14..26).map(move |x| (x, y))).map(|(x, y)| red[y * 40 + x]).sum()
        };
        (sum(13..20), sum(20..27))
    };
    let (upper, lower) = red_above(1.0);
    assert!(upper > 4.0 * lower, "as air: {upper} {lower}");
    let (upper, lower) = red_above(1.5);
    assert!(lower > 4.0 * upper, "as glass: {upper} {lower}");
}

/// Switched off, left to itself where nothing sends rays, and by each technique.
#[test]
fn reflections_are_traced_where_materials_send_them() {
    let camera = looking(vec3(0.0, 1.5, 5.0), Vec3::ZERO, 0.1);
    let mut plain = host(under_a_lamp(lamp(Vec3::ONE)), 2, [32, 24]);
    let none = plain.frame(&camera, Settings::default()).unwrap().statistics;
    let image = plain.picture();
    assert!(none.passes.iter().all(|p| !p.name.contains("reflect")) && plain.aa.memory().rays == 0);
    let forced = plain.frame(&camera, Settings { reflections: Effect::On, ..Default::default() }).unwrap().statistics;
    assert_eq!(forced.passes.iter().filter(|p| p.name.starts_with("reflect")).count(), 2);
    assert_eq!((forced.reflection_rays, &plain.picture().rgba), (0, &image.rgba));

    let mut mirror = host(under_a_lamp(metal()), 4, [32, 24]);
    let of_full = mirror.frame(&camera, full()).unwrap().statistics;
    let reference = mirror.picture();
    for technique in [Technique::Single, Technique::Windowed, Technique::Reconstructed] {
        for reconstructed in [Reconstructed::default(), Reconstructed::PAPER] {
            let settings = Settings { technique, reconstructed, ..Default::default() };
            let some = mirror.frame(&camera, settings).unwrap().statistics;
            assert!(some.reflection_rays > 0 && some.reflection_rays <= of_full.reflection_rays, "{technique:?}");
            let db = psnr(&mirror.picture(), &reference).unwrap();
            assert!(db > 20.0, "{technique:?}: {db} dB");
        }
    }
    let off = mirror.frame(&camera, Settings { reflections: Effect::Off, refraction: Effect::Off, ..full() }).unwrap();
    assert_eq!((off.statistics.reflection_rays, off.statistics.passes.len()), (0, 2));
    let codes: Vec<u32> =
        pod_collect_to_vec(&mirror.gpu.read_buffer(mirror.aa.intermediates().unwrap().reflections.unwrap()));
    assert!(codes.iter().any(|&c| c != 0));
}

/// What geometric samples reflect and refract themselves is better than the filtered colour of all.
#[test]
fn reflections_are_reconstructed_apart() {
    let scene = builtin::builtin("mirrors").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 4, [128, 72]);
    host.frame(&camera, full()).unwrap();
    let reference = host.picture();
    let passed = host.aa.intermediates().unwrap();
    let codes: Vec<u32> = pod_collect_to_vec(&host.gpu.read_buffer(passed.reflections.unwrap()));
    let pixels: Vec<_> = (0..72).flat_map(|y| (0..128).map(move |x| (x, y))).collect();
    let traced = |&(x, y): &(u32, u32)| (0..16).any(|rank| codes[passed.slots.sample(x, y, rank)] != 0);
    let mask: Vec<bool> = pixels.iter().map(traced).collect();
    assert!(mask.iter().filter(|&&m| m).count() > 2000);
    let mut on_mirrors = |reflections_apart| {
        let reconstructed = Reconstructed { reflections_apart, ..Default::default() };
        let settings = Settings { technique: Technique::Reconstructed, reconstructed, ..Default::default() };
        host.frame(&camera, settings).unwrap();
        edge_psnr(&host.picture(), &reference, &mask).unwrap().unwrap()
    };
    let (apart, as_one) = (on_mirrors(true), on_mirrors(false));
    assert!(apart >= 38.0 && apart > as_one, "{apart} dB apart, {as_one} dB as one");
}
