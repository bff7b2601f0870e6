//! Shadow rays through the demo's host: against the twin, on each tier, and the hard cases of numerics.

use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{DAffine3, Mat4, Vec2, Vec3, Vec4, vec3};
use deferred_aa::rays::{QUERY_FEATURES, RayTier};
use deferred_aa::reference::rays::trace::{Input, Owner};
use deferred_aa::reference::rays::{self as twin, probe};
use deferred_aa::{
    DeferredAa, Effect, Execution, GBufferTier, Ids, PlanWord, Reconstructed, Settings, Technique, TextureTier,
    Windowed, sample_order,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options};
use deferred_aa_demo::picture::Picture;
use deferred_aa_demo::quality::{edge_psnr, psnr};
use deferred_aa_demo::raster::node_camera;
use deferred_aa_demo::rays::casting_lights;
use deferred_aa_demo::scene::{Camera, Instance, Light, LightKind, Material, Mesh, Scene, Sun, builtin};

pub fn host_on(scene: Scene, m: u32, [width, height]: [u32; 2], rays: RayTier) -> Host {
    host_with(scene, Options { anisotropy: 4, rays, ..Options::new(width, height, m) })
}

pub fn host_with(scene: Scene, options: Options) -> Host {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let gpu = Gpu::new(adapter, &options.descriptor()).expect("a device");
    Host::new(gpu, scene, options).expect("a host")
}

pub fn host(scene: Scene, m: u32, size: [u32; 2]) -> Host {
    host_on(scene, m, size, RayTier::Software)
}

pub fn full() -> Settings {
    Settings { technique: Technique::Full, ..Default::default() }
}

/// The tiers that the adapter has.
pub fn tiers() -> Vec<RayTier> {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    if adapter.features().contains(QUERY_FEATURES) {
        return vec![RayTier::Software, RayTier::Query];
    }
    eprintln!("ray query skipped: the adapter has none");
    vec![RayTier::Software]
}

/// The tiers of the G-buffer that the adapter has.
fn gbuffers() -> Vec<GBufferTier> {
    let mut all = vec![GBufferTier::default()];
    all.extend(crate::visibility::has_ids().then_some(GBufferTier::Visibility(Ids::Wide)));
    all
}

/// The bits of the last frame, `[y · width + x][rank]`; 0 for samples that were not traced.
pub fn bits(host: &Host) -> Vec<Vec<u32>> {
    let passed = host.aa.intermediates().expect("a size");
    let all: Vec<u32> = pod_collect_to_vec(&host.gpu.read_buffer(passed.shadows.expect("a frame that traced")));
    let plan: Vec<PlanWord> = pod_collect_to_vec(&host.gpu.read_buffer(passed.plan));
    let n = host.options.m * host.options.m;
    let at = |x, y, rank| passed.traced.place(&plan, x, y, rank).map_or(0, |place| all[place]);
    let pixels = (0..host.options.height).flat_map(|y| (0..host.options.width).map(move |x| (x, y)));
    pixels.map(|(x, y)| (0..n).map(|rank| at(x, y, rank)).collect()).collect()
}

/// The windows in which `probe` finds an edge of a shadow by these settings, from the bits of all samples.
pub fn probed(host: &mut Host, camera: &Camera, settings: &Settings, reach: u32) -> Vec<bool> {
    let m = host.options.m;
    host.frame(camera, full()).expect("a frame");
    if reach == 0 || host.aa.intermediates().expect("a size").shadows.is_none() {
        return Vec::new();
    }
    let (all, depths) = (bits(host), host.depths());
    let [of_full, order] = [full(), *settings].map(|settings| sample_order(&settings, m));
    let size = [host.options.width, host.options.height].map(|side| side as usize);
    let window = |pixel: usize| {
        let bits = |&(x, y): &(u8, u8)| {
            let rank = of_full.iter().position(|place| *place == (x, y)).expect("every place has a rank");
            let corner = [pixel % size[0], pixel / size[0]].map(|at| at * m as usize);
            let at = (corner[1] + usize::from(y)) * size[0] * m as usize + corner[0] + usize::from(x);
            (depths[at] > 1e-30).then(|| all[pixel][rank])
        };
        order.iter().map(bits).collect()
    };
    let windows: Vec<Vec<_>> = (0..all.len()).map(window).collect();
    let input = probe::Input { size, windows: &windows, reach: reach as usize };
    (0..all.len()).map(|pixel| input.differs(pixel % size[0], pixel / size[0])).collect()
}

/// What rays need to know of an instance.
pub fn owner(scene: &Scene, i: &Instance) -> Owner {
    let material = &scene.materials[scene.meshes[i.mesh].material];
    Owner {
        object: i.object.into(),
        mirrored: i.world_from_mesh.determinant() < 0.0,
        culled: !material.double_sided,
        casts_shadow: material.transmission < 0.5,
    }
}

/// Without what has holes.
fn solid(mut scene: Scene) -> Scene {
    scene.instances.retain(|i| scene.materials[scene.meshes[i.mesh].material].alpha_cutoff.is_none());
    scene
}

#[test]
fn bits_are_those_of_the_twin_on_each_tier() {
    for (name, size) in [("cornell", [40, 40]), ("shadows", [48, 27])] {
        let scene = solid(builtin::builtin(name).unwrap());
        let camera = scene.default_camera();
        let eye = camera.eye.as_dvec3();
        let (mut triangles, mut owners) = (Vec::new(), Vec::new());
        for i in &scene.instances {
            let mesh = &scene.meshes[i.mesh];
            let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
            let world = DAffine3::from_mat4(i.world_from_mesh.as_dmat4());
            triangles.extend(twin::place(&positions, &mesh.indices, world, eye));
            owners.resize(triangles.len(), owner(&scene, i));
        }
        let lights = casting_lights(&scene, scene.sun.is_some_and(|s| s.casts));
        let all = (1u32 << lights.len()) - 1;
        let mut of_tiers = Vec::new();
        for tier in tiers() {
            let m = 2;
            let mut host = host_on(scene.clone(), m, size, tier);
            let statistics = host.frame(&camera, full()).unwrap().statistics;
            let gbuffer = host.aa.gbuffer().unwrap();
            let read = |i: usize| host.gpu.read_texture(gbuffer.color[i].texture(), 8);
            let [surface, frame]: [Vec<[u32; 2]>; 2] = [0, 1].map(|i| pod_collect_to_vec(&read(i)));
            let input = Input {
                camera: node_camera(&camera, size[0], size[1]),
                samples: [size[0] * m, size[1] * m],
                depth: &host.depths(),
                surface: &surface,
                frame: &frame,
                least_offsets: host.rays.as_ref().unwrap().scene.least_offsets(),
                ray_bias: full().ray_bias.max(host.gpu.least_ray_bias()),
                lights: &lights,
                triangles: &triangles,
                owners: &owners,
            };
            let found = bits(&host);
            let (mut traced, mut unsure, mut shadowed) = (0, 0, 0);
            for (pixel, ranks) in found.iter().enumerate() {
                let corner = [pixel as u32 % size[0] * m, pixel as u32 / size[0] * m];
                for ((x, y), &bits) in deferred_aa::window::order(m).into_iter().zip(ranks) {
                    let expected = input.bits(corner[0] + u32::from(x), corner[1] + u32::from(y));
                    let sure = expected.sure & all;
                    assert_eq!(bits & sure, expected.shadow & sure, "{name} {tier:?}, pixel {pixel}, {x} {y}");
                    traced += 1;
                    shadowed += u32::from(bits != 0);
                    unsure += u32::from(sure != all);
                }
            }
            assert!(shadowed > traced / 50, "{name}: {shadowed} of {traced} in shadow");
            assert!(unsure < traced / 100, "{name} {tier:?}: {unsure} of {traced} unsure");
            assert!(statistics.shadow_rays > 0 && statistics.shadow_rays <= traced * lights.len() as u32);
            of_tiers.push(found);
        }
        // On such rays alone the twin is not sure.
        let apart =
            |t: &Vec<Vec<u32>>| t.iter().flatten().zip(of_tiers[0].iter().flatten()).filter(|(a, b)| a != b).count();
        assert!(of_tiers.iter().all(|t| apart(t) <= 6), "{name}: tiers differ");
    }
}

/// The passes, memory and images of frames that need no ray, that need some, and that trace though nothing calls for
/// it.
#[test]
fn what_is_not_needed_is_not_there() {
    for name in ["flat", "empty", "checker"] {
        let scene = builtin::builtin(name).unwrap();
        let camera = scene.default_camera();
        let mut host = host(scene, 2, [32, 18]);
        let pruned = host.frame(&camera, Settings::default()).unwrap().statistics;
        let image = host.picture();
        assert!(pruned.passes.iter().all(|p| !p.name.starts_with("trace")), "{name}: {:?}", pruned.passes);
        assert_eq!((host.aa.memory().rays, pruned.shadow_rays), (0, 0), "{name}");
        assert!(host.rays.is_none() && host.aa.intermediates().unwrap().shadows.is_none(), "{name}");
        // Without a sun, nothing casts even where all that can is asked to.
        host.scene.sun = None;
        let unpruned = host.frame(&camera, Settings { shadows: Effect::On, ..Default::default() }).unwrap().statistics;
        assert_eq!(unpruned.passes.iter().filter(|p| p.name.starts_with("trace")).count(), 2, "{name}");
        assert!(host.aa.memory().rays > 0);
        assert_eq!((unpruned.shadow_rays, &host.picture().rgba), (0, &image.rgba), "{name}");
    }
}

/// Bits of planned samples are those of `Full`, whatever the execution; switched off there are none.
#[test]
fn techniques_trace_what_they_shade() {
    let scene = builtin::builtin("shadows").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 4, [128, 72]);
    let of_full = host.frame(&camera, full()).unwrap().statistics;
    let (all, depths, order) = (bits(&host), host.depths(), sample_order(&full(), 4));
    for execution in Execution::ALL {
        let statistics =
            host.frame(&camera, Settings { execution, ray_samples: 15.0, ..Default::default() }).unwrap().statistics;
        let counts = host.counts(Technique::Windowed);
        for (i, ((k, found), expected)) in (0..).zip(counts.iter().zip(bits(&host)).zip(&all)) {
            for (rank, &(x, y)) in order.iter().enumerate().take(*k as usize) {
                // Tiles of sky are not traced.
                let at = (i / 128 * 4 + u32::from(y)) * 512 + i % 128 * 4 + u32::from(x);
                assert!(depths[at as usize] == 0.0 || found[rank] == expected[rank], "{execution:?} {i} {rank}");
            }
        }
        // Without those of `probe`.
        let windowed = Windowed { shadow_reach: 0, ..Default::default() };
        let alone = Settings { execution, ray_samples: 15.0, windowed, ..Default::default() };
        let traced = host.frame(&camera, alone).unwrap().statistics.shadow_rays;
        let fewer = traced < of_full.shadow_rays / 2 || execution == Execution::MaxFiltered;
        assert!(traced > 0 && fewer && traced < statistics.shadow_rays, "{execution:?}: {traced}");
    }
    let off = host.frame(&camera, Settings { shadows: Effect::Off, ..full() }).unwrap().statistics;
    assert_eq!((off.shadow_rays, off.passes.len()), (0, 2));
}

/// Of thin casters: one shaded sample a window, and its geometric ones' shadow bits.
#[test]
fn shadow_edges_are_reconstructed() {
    let scene = builtin::builtin("shadows").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, 4, [160, 90]);
    let picture = |host: &mut Host, settings: Settings| {
        let statistics = host.frame(&camera, settings).unwrap().statistics;
        (host.picture(), statistics)
    };
    let (all, of_full) = picture(&mut host, full());
    let (single, _) = picture(&mut host, Settings { technique: Technique::Single, ..Default::default() });
    let ours = Settings { technique: Technique::Reconstructed, ..Default::default() };
    let (reconstructed, statistics) = picture(&mut host, ours);
    let gained = psnr(&reconstructed, &all).unwrap() - psnr(&single, &all).unwrap();
    assert!(gained >= 12.0, "{gained} dB");
    assert!(statistics.mean_k < 2.5 && statistics.shadow_rays < of_full.shadow_rays * 2 / 3, "{statistics:?}");
    // Shadow edges alone: pixels whose samples differ in shadow.
    host.frame(&camera, full()).unwrap();
    let edges: Vec<bool> = bits(&host).iter().map(|ranks| ranks.iter().any(|b| *b != ranks[0])).collect();
    let at_edges = |image: &Picture| edge_psnr(image, &all, &edges).unwrap().unwrap();
    assert!(edges.iter().filter(|&&e| e).count() > 500);
    let gained = at_edges(&reconstructed) - at_edges(&single);
    assert!(gained >= 6.0, "{gained} dB at shadow edges");
    let every = Reconstructed { trace_all: true, ..Default::default() };
    host.frame(&camera, Settings { reconstructed: every, ..ours }).unwrap();
    assert!(psnr(&host.picture(), &all).unwrap() > psnr(&reconstructed, &all).unwrap());
}

// ---- Hard cases ----

pub fn light(kind: LightKind, position: Vec3, range: f32) -> Light {
    Light { kind, position, direction: Vec3::NEG_Y, intensity: Vec3::ONE, range, casts: true }
}

fn mesh(name: &str, triangles: &[[Vec3; 3]], normal: impl Fn(Vec3) -> Vec3) -> Mesh {
    let positions: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    let normals: Vec<Vec3> = positions.iter().map(|&p| normal(p)).collect();
    let count = positions.len();
    Mesh {
        name: name.to_owned(),
        normals: normals.clone(),
        tangents: normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect(),
        uvs: vec![Vec2::ZERO; count],
        colors: vec![Vec4::ONE; count],
        indices: (0..count as u32).collect(),
        positions,
        material: 0,
    }
}

/// A square of side 2 around the origin, facing up.
pub fn square() -> Mesh {
    let corner = |x, z| vec3(x, 0.0, z);
    let [a, b, c, d] = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
    mesh("square", &[[a, b, c], [a, c, d]], |_| Vec3::Y)
}

pub fn scene(meshes: Vec<Mesh>, placed: &[(usize, Mat4)]) -> Scene {
    let instances = placed
        .iter()
        .enumerate()
        .map(|(i, &(mesh, world_from_mesh))| Instance { mesh, world_from_mesh, object: i as u16 + 1 })
        .collect();
    let materials = builtin::builtin("flat").unwrap().materials;
    Scene { name: "made".to_owned(), meshes, instances, materials, ..Default::default() }
}

pub fn sun(to_sun: Vec3) -> Option<Sun> {
    Some(Sun { to_sun: to_sun.normalize(), irradiance: Vec3::splat(3.0), casts: true })
}

pub fn looking(eye: Vec3, target: Vec3, near: f32) -> Camera {
    deferred_aa_demo::raster::look_at(eye, target, 0.7, near)
}

/// Row 13: nothing shadows itself, at any scale, seen along any axis, at any slant of the light; a blocker 1e-4 of the
/// scale away still does, or twice what the rasteriser loses.
#[test]
fn surfaces_do_not_shadow_themselves() {
    const SIDE: u32 = 148;
    // A turn of all that is there, so that the camera looks along another axis.
    let axes = [Mat4::IDENTITY, Mat4::from_rotation_z(1.5), Mat4::from_rotation_x(1.5), Mat4::from_rotation_y(1.45)];
    for scale in [1e-3f32, 1.0, 1e3, 1e6] {
        let mut traced = 0;
        for (axis, gbuffer) in axes.iter().flat_map(|axis| gbuffers().into_iter().map(move |tier| (*axis, tier))) {
            let at = format!("{scale} {gbuffer:?} {axis}");
            let options = || Options { gbuffer, ..Options::new(SIDE, SIDE, 2) };
            let grow = Mat4::from_scale(Vec3::splat(scale));
            let turn = axis * Mat4::from_rotation_z(0.3) * Mat4::from_rotation_x(0.2);
            let camera = looking(axis.transform_vector3(vec3(0.3, 3.0, 2.5)) * scale, Vec3::ZERO, 0.01 * scale);
            // It fills the view.
            let large = grow * Mat4::from_scale(Vec3::splat(4.0));
            let mut alone = host_with(scene(vec![square()], &[(0, large * turn)]), options());
            for slant in [0.02f32, 0.3, 2.0] {
                alone.scene.sun = sun(turn.transform_vector3(vec3(0.6, slant, 0.8)));
                let rays = alone.frame(&camera, full()).unwrap().statistics.shadow_rays;
                assert_eq!(rays, 4 * SIDE * SIDE, "{at} {slant}");
                let dark = bits(&alone).iter().flatten().filter(|&&b| b != 0).count();
                assert_eq!(dark, 0, "{at} {slant}: shadows itself, of {rays}");
                traced += rays;
            }

            // A smaller one is shadowed by what lies over it, its back to the camera, so that what it covers is seen.
            let lost = alone.gpu.least_ray_bias() * 0.7 / (2.0 * SIDE as f32) * 4.0;
            let height = if gbuffer == GBufferTier::default() { (2.0 * lost).max(1e-4) } else { 1e-4 };
            let over = Mat4::from_rotation_x(std::f32::consts::PI);
            let above = Mat4::from_translation(turn.transform_vector3(Vec3::Y) * height * scale);
            let mut covered = scene(vec![square()], &[(0, grow * turn), (0, above * grow * turn * over)]);
            covered.sun = sun(turn.transform_vector3(vec3(0.0, 1.0, 0.0)));
            let mut covered = host_with(covered, options());
            let rays = covered.frame(&camera, full()).unwrap().statistics.shadow_rays;
            assert!(rays > 4000, "{at}: {rays}");
            let shadowed = bits(&covered).iter().flatten().filter(|&&b| b == 1).count() as u32;
            assert!(shadowed >= rays - rays / 50, "{at}: {shadowed} of {rays} in shadow");
        }
        assert!(traced >= 1_000_000, "{traced} rays at {scale}");
    }
}

/// Vertices far from their mesh's own origin, moved back by the instance: rays round there, and nothing shadows itself
/// for it.
#[test]
fn vertices_far_from_their_own_origin_do_not_shadow_themselves() {
    for own in [300.0f32, 5e3, 1e5] {
        for tier in tiers() {
            let by = vec3(own, own * 0.5, -own);
            // Slanted, so that rounding moves a point off its plane, and one triangle, so that it has one.
            let turn = Mat4::from_rotation_z(0.3) * Mat4::from_rotation_x(0.2);
            let corners = [vec3(-1.5, 0.0, 1.0), vec3(1.5, 0.0, 1.0), vec3(0.0, 0.0, -1.5)];
            let [a, b, c] = corners.map(|p| turn.transform_point3(p) + by);
            let normal = (b - a).cross(c - a).normalize();
            let mut plain = scene(vec![mesh("far", &[[a, b, c]], |_| normal)], &[(0, Mat4::from_translation(-by))]);
            plain.sun = sun(turn.transform_vector3(vec3(0.6, 0.3, 0.8)));
            let camera = looking(vec3(0.3, 3.0, 2.5), Vec3::ZERO, 0.01);
            let mut host = host_on(plain, 2, [48, 48], tier);
            let statistics = host.frame(&camera, full()).unwrap().statistics;
            assert!(statistics.shadow_rays > 500, "{own} {tier:?}");
            let dark = bits(&host).iter().flatten().filter(|&&b| b != 0).count();
            assert_eq!(dark, 0, "{own} {tier:?}: shadows itself");
        }
    }
}

/// Rays that leave one mesh start where they would without another one, however that was made.
#[test]
fn a_mesh_far_from_its_own_origin_leaves_the_shadows_of_others_alone() {
    let by = Mat4::from_translation(vec3(4.5e6, 0.0, 0.0));
    let mut moved = square();
    moved.positions.iter_mut().for_each(|p| *p = by.transform_point3(*p));
    let over = Mat4::from_translation(vec3(0.0, 0.05, 0.0)) * Mat4::from_rotation_x(std::f32::consts::PI);
    let small = over * Mat4::from_scale(Vec3::splat(0.5));
    let mut with = scene(vec![square(), moved], &[(0, Mat4::IDENTITY), (0, small), (1, by.inverse())]);
    with.instances[2].world_from_mesh.w_axis.z -= 20.0;
    with.sun = sun(vec3(0.1, 1.0, 0.2));
    let mut without = with.clone();
    without.instances.pop();
    let camera = looking(vec3(0.3, 3.0, 2.5), Vec3::ZERO, 0.01);
    for tier in tiers() {
        let [with, without] = [&with, &without].map(|scene| {
            let mut host = host_on(scene.clone(), 2, [48, 48], tier);
            host.frame(&camera, full()).unwrap();
            let offsets = host.rays.as_ref().unwrap().scene.least_offsets().to_vec();
            (bits(&host), offsets)
        });
        assert!(with.1[3] > 1.0 && with.1[1] < 1e-5, "{tier:?}: {:?}", with.1);
        // The small square's shadow, and nothing of the far mesh in view.
        let dark = without.0.iter().flatten().filter(|&&b| b != 0).count();
        assert!(dark > 500, "{tier:?}: {dark}");
        assert_eq!(with.0, without.0, "{tier:?}");
    }
}

/// A ground of 40 km, on which f32 can't tell where a ray starts as well as it could on a small one.
#[test]
fn a_large_ground_under_a_near_eye_does_not_shadow_itself() {
    for half in [100.0f32, 2e4, 1e6] {
        if half > 100.0 && crate::drivers::is_swiftshader(&crate::harness::device(TextureTier::None)) {
            eprintln!("a ground of {half} skipped: SwiftShader draws nothing of it");
            continue;
        }
        for tier in tiers() {
            for gbuffer in gbuffers() {
                let turn = Mat4::from_rotation_x(0.01) * Mat4::from_rotation_z(0.02);
                let mut plain = scene(vec![square()], &[(0, turn * Mat4::from_scale(Vec3::splat(half)))]);
                plain.sun = sun(vec3(0.6, 0.3, 0.8));
                let camera = looking(vec3(0.0, 1.7, 0.0), vec3(3.0, 1.2, -5.0), 0.1);
                let options = Options { rays: tier, gbuffer, ..Options::new(48, 48, 2) };
                let mut host = host_with(plain, options);
                let statistics = host.frame(&camera, full()).unwrap().statistics;
                assert!(statistics.shadow_rays > 2000, "{half} {tier:?} {gbuffer:?}: {}", statistics.shadow_rays);
                let dark = bits(&host).iter().flatten().filter(|&&b| b != 0).count();
                assert_eq!(dark, 0, "{half} {tier:?} {gbuffer:?}: of {}", statistics.shadow_rays);
            }
        }
    }
}

/// The shadow of a masked square has the hole that its vertex colours cut.
#[test]
fn holes_of_vertex_colours_let_light_through() {
    for tier in tiers() {
        let above = Mat4::from_translation(vec3(0.0, 1.0, 0.0));
        let mut cut = scene(vec![square(), square()], &[(0, Mat4::from_scale(Vec3::splat(3.0))), (1, above)]);
        cut.meshes[1].material = 1;
        let plain = cut.materials[0].clone();
        cut.materials = vec![plain.clone(), Material { alpha_cutoff: Some(0.5), double_sided: true, ..plain }];
        for (p, color) in cut.meshes[1].positions.clone().iter().zip(&mut cut.meshes[1].colors) {
            color.w = if p.x < 0.0 { 0.0 } else { 1.0 };
        }
        cut.sun = sun(Vec3::Y);
        let camera = looking(vec3(0.0, 0.7, 0.5), Vec3::ZERO, 0.01);
        let mut host = host_on(cut, 1, [40, 40], tier);
        host.frame(&camera, full()).unwrap();
        let found = bits(&host);
        let half = |columns: std::ops::Range<usize>| {
            columns.flat_map(|x| (0..40).map(move |y| y * 40 + x)).filter(|&i| found[i][0] != 0).count()
        };
        assert_eq!((half(0..19), half(21..40)), (0, 19 * 40), "{tier:?}");
    }
}

/// Light passes clear glass; what transmits nothing keeps it.
#[test]
fn light_passes_clear_glass() {
    for tier in tiers() {
        let dark = [0.0, 1.0].map(|transmission| {
            let above = Mat4::from_translation(vec3(0.0, 1.0, 0.0));
            let mut made = scene(vec![square(), square()], &[(0, Mat4::from_scale(Vec3::splat(3.0))), (1, above)]);
            made.meshes[1].material = 1;
            let plain = made.materials[0].clone();
            made.materials = vec![plain.clone(), Material { transmission, ..plain }];
            made.sun = sun(Vec3::Y);
            let mut host = host_on(made, 1, [40, 40], tier);
            host.frame(&looking(vec3(0.0, 0.9, 0.01), Vec3::ZERO, 0.01), full()).unwrap();
            bits(&host).iter().flatten().filter(|&&b| b != 0).count()
        });
        assert_eq!(dark, [1600, 0], "{tier:?}");
    }
}

/// Row 17: on a coarse ball under a grazing light the light grows with n·l alone.
#[test]
fn a_coarse_ball_has_no_triangles_at_its_terminator() {
    let at = |i: u32, j: u32| {
        let (a, b) = (i as f32 / 10.0 * std::f32::consts::TAU, j as f32 / 10.0 * std::f32::consts::PI);
        vec3(b.sin() * a.cos(), b.cos(), b.sin() * a.sin())
    };
    let quad = |i, j| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let triangles: Vec<_> = (0..10).flat_map(|i| (0..10).flat_map(move |j| quad(i, j))).collect();
    for stretched in [Vec3::ONE, vec3(1.0, 1.0, -1.0), vec3(1.5, 0.7, 1.0)] {
        let mut ball = scene(vec![mesh("ball", &triangles, |p| p.normalize())], &[(0, Mat4::from_scale(stretched))]);
        ball.sun = sun(vec3(1.0, 0.4, 0.15));
        ball.materials[0].double_sided = true;
        let camera = looking(vec3(0.5, 0.5, 5.0), Vec3::ZERO, 0.1);
        let mut host = host(ball, 2, [64, 64]);
        let statistics = host.frame(&camera, full()).unwrap().statistics;
        assert!(statistics.shadow_rays > 2000);
        // Whatever the smooth surface turns to the light is lit, and nothing else.
        let surfaces = host.surfaces();
        let depths = host.depths();
        let to_sun = host.scene.sun.unwrap().to_sun;
        let found = bits(&host);
        let mut checked = 0;
        for (pixel, ranks) in found.iter().enumerate() {
            for ((x, y), bit) in deferred_aa::window::order(2).into_iter().zip(ranks) {
                let at = (pixel / 64 * 2 + y as usize) * 128 + pixel % 64 * 2 + x as usize;
                let normal = deferred_aa::reference::octahedral::decode(surfaces[at][0]).as_vec3();
                let cosine = normal.dot(to_sun);
                if depths[at] > 0.0 && cosine.abs() > 1e-3 {
                    assert_eq!(*bit == 0, cosine > 0.0, "{stretched}: pixel {pixel}, n·l = {cosine}");
                    checked += 1;
                }
            }
        }
        assert!(checked > 3000, "{checked}");
    }
}

/// Row 18: moved far from the origin, with its camera.
#[test]
fn shadows_far_from_the_origin_are_the_same() {
    let mut near = solid(builtin::builtin("cornell").unwrap());
    let mut camera = near.default_camera();
    // What f32 resolves out there, or the scene itself would be another one.
    let snap = |v: Vec3| (v * 64.0).round() / 64.0;
    near.instances.iter_mut().for_each(|i| {
        i.world_from_mesh.w_axis = snap(i.world_from_mesh.w_axis.truncate()).extend(1.0);
    });
    near.lights.iter_mut().for_each(|l| l.position = snap(l.position));
    camera.eye = snap(camera.eye);
    let mut far = near.clone();
    let picture = |scene: Scene, camera: &Camera| -> Picture {
        let mut host = host(scene, 2, [64, 64]);
        host.frame(camera, full()).unwrap();
        host.picture()
    };
    let here = picture(near, &camera);
    let by = vec3(131_072.0, -131_072.0, 65_536.0);
    far.instances.iter_mut().for_each(|i| i.world_from_mesh = Mat4::from_translation(by) * i.world_from_mesh);
    far.lights.iter_mut().for_each(|l| l.position += by);
    camera.eye += by;
    camera.target += by;
    let there = picture(far, &camera);
    let psnr = psnr(&here, &there).unwrap();
    assert!(psnr >= 60.0, "{psnr} dB");
}

/// A light at the surface, behind it, at zero distance, with a zero, tiny or infinite range, and a camera in a closed
/// box.
#[test]
fn lights_in_odd_places() {
    let camera = looking(vec3(0.2, 2.0, 1.5), Vec3::ZERO, 0.01);
    let share = |kind, position, range| {
        let mut lit = scene(vec![square()], &[(0, Mat4::IDENTITY)]);
        lit.lights = vec![light(kind, position, range)];
        let mut host = host(lit, 1, [33, 33]);
        let statistics = host.frame(&camera, full()).unwrap().statistics;
        assert!(host.picture().rgba.iter().flatten().all(|c| c.is_finite()), "{position} {range}");
        assert_eq!(statistics.not_finite, 0);
        let dark = bits(&host).iter().flatten().filter(|&&b| b != 0).count();
        (statistics.shadow_rays, dark)
    };
    let point = LightKind::Point;
    let (rays, dark) = share(point, vec3(0.0, 1.0, 0.0), f32::INFINITY);
    assert!(rays > 100 && dark == 0, "above: {rays} {dark}");
    assert_eq!(share(point, vec3(0.0, 1.0, 0.0), 0.0), (rays, 0), "a range of 0 is none");
    assert_eq!(share(point, vec3(0.0, 1.0, 0.0), 0.5), (0, 0), "out of reach");
    assert_eq!(share(point, vec3(0.0, -1.0, 0.0), f32::INFINITY), (0, rays as usize), "behind");
    let (at_surface, _) = share(point, Vec3::ZERO, f32::INFINITY);
    assert!(at_surface <= rays);
    share(point, camera.eye, 1e-30);
    let cone = LightKind::Spot { inner: 0.1, outer: 0.2 };
    let (in_cone, dark) = share(cone, vec3(0.0, 1.0, 0.0), 10.0);
    assert!(in_cone > 0 && in_cone < rays / 4 && dark == 0, "{in_cone}");

    // Inside a closed box nothing of the sun is seen.
    let mut closed = builtin::builtin("cornell").unwrap();
    closed.lights.clear();
    closed.sun = sun(vec3(0.2, 1.0, 0.1));
    let camera = closed.default_camera();
    let inside = looking(vec3(0.0, 0.0, 0.9), vec3(0.0, -1.0, 0.0), camera.near);
    let mut host = host(closed, 1, [32, 32]);
    host.frame(&inside, full()).unwrap();
    assert!(bits(&host).iter().flatten().all(|&b| b == 1));
}

/// A ray ends before its lamp.
#[test]
fn what_lies_behind_a_lamp_casts_no_shadow() {
    let camera = looking(vec3(0.2, 0.6, 1.5), Vec3::ZERO, 0.01);
    for (height, darkens) in [(1.005, false), (0.9, true)] {
        for tier in tiers() {
            let mut lit = scene(vec![square()], &[(0, Mat4::IDENTITY), (0, Mat4::from_translation(Vec3::Y * height))]);
            lit.lights = vec![light(LightKind::Point, Vec3::Y, f32::INFINITY)];
            let mut host = host_on(lit, 1, [32, 32], tier);
            let rays = host.frame(&camera, full()).unwrap().statistics.shadow_rays;
            let dark = bits(&host).iter().flatten().filter(|&&b| b != 0).count();
            assert!(rays > 100 && (dark > 0) == darkens, "{height}, {tier:?}: {dark} of {rays}");
        }
    }
}

/// What a frame that traces needs, and says if it has not.
#[test]
fn frames_that_cannot_be_traced_are_refused() {
    use deferred_aa::rays::RayScene;
    use deferred_aa::{CastingLight, Frame, MAX_CASTING_LIGHTS, Needs, Shading};
    use insta::assert_snapshot;
    let shading = Shading { source: "fn shade(s: DaaSample) -> vec4f { return vec4f(1.0); }", file: "white.wgsl" };
    let plain = deferred_aa::Descriptor::new(wgpu::TextureFormat::Rgba16Float, shading);
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let traces = deferred_aa::Descriptor { rays: Some(RayTier::Software), ..plain };
    let gpu = Gpu::new(adapter, &traces).expect("a device");
    let target = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 16, height: 16, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: plain.target_format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = target.create_view(&Default::default());
    let camera = crate::harness::camera(1.0);
    let eye = camera.world_from_view.w_axis.truncate();
    let refused = |rays, needs: Needs<'_>| {
        let descriptor = deferred_aa::Descriptor { rays, ..plain };
        let mut aa = DeferredAa::new(&gpu.device, &descriptor, None).unwrap();
        aa.resize(&gpu.device, 16, 16).unwrap();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let frame = Frame { needs, ..Frame::new(camera, &view) };
        aa.record(&gpu.queue, &mut encoder, &frame).unwrap_err()
    };
    let placed = |tier, eye| {
        let mut scene = RayScene::new(&gpu.device, tier);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        scene.update(&gpu.device, &gpu.queue, &mut encoder, &[], eye).unwrap();
        scene
    };
    let sun = [CastingLight::Directional { towards: Vec3::Y }];
    let (software, here) = (Some(RayTier::Software), placed(RayTier::Software, eye));
    assert_snapshot!(refused(None, Needs { shadows: &sun, rays: Some(&here), ..Default::default() }), @"the frame asks for rays, the node was built without them; set Descriptor::rays");
    assert_snapshot!(refused(software, Needs { shadows: &sun, ..Default::default() }), @"the frame asks for rays, but has no scene for them; set Needs::rays");
    let there = placed(RayTier::Software, eye + 1.0);
    assert_snapshot!(refused(software, Needs { shadows: &sun, rays: Some(&there), ..Default::default() }), @"the scene for rays was updated for a camera at [1, 1, 1], the frame's is at [0, 0, 0]; call RayScene::update with it");
    let many = [sun[0]; MAX_CASTING_LIGHTS + 1];
    assert_snapshot!(refused(software, Needs { shadows: &many, rays: Some(&here), ..Default::default() }), @"33 lights cast shadows; 32 can, so leave some out of Needs::shadows");
    let nowhere = CastingLight::Punctual { position: vec3(f32::NAN, 0.0, 0.0), range: 1.0, cone: None };
    assert_snapshot!(refused(software, Needs { shadows: &[sun[0], nowhere], rays: Some(&here), ..Default::default() }), @"light 1 of Needs::shadows is not finite, has no direction, or is more than 1e12 from the camera");
    let beyond = CastingLight::Punctual { position: vec3(0.0, 2e12, 0.0), range: 1.0, cone: None };
    assert_snapshot!(refused(software, Needs { shadows: &[beyond], rays: Some(&here), ..Default::default() }), @"light 0 of Needs::shadows is not finite, has no direction, or is more than 1e12 from the camera");
    let flat = CastingLight::Directional { towards: Vec3::ZERO };
    assert_snapshot!(refused(software, Needs { shadows: &[flat], rays: Some(&here), ..Default::default() }), @"light 0 of Needs::shadows is not finite, has no direction, or is more than 1e12 from the camera");
    let mirrors = Needs { reflective: &[3], rays: Some(&here), ..Default::default() };
    assert_snapshot!(refused(software, mirrors), @"the frame has materials that reflect or refract, but the host's WGSL has no `fn reflection(s: DaaSample) -> DaaReflection`; write it, or leave Needs::reflective empty");
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}
