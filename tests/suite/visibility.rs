//! The visibility buffer: every attribute against the twin, the picture against the stored G-buffer's, and what the
//! host may get wrong.

use crate::harness::target;
use crate::reflections_twin::{BUMPED, MATTE, at, ball, block, faces, floor, scaled, scene, turned, views};
use crate::shadows::{full, looking};
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{Affine3A, DAffine3, DVec2, DVec3, Mat4, Vec3, dvec3, vec3};
use deferred_aa::rays::{Attributes, BottomLevel, Instance, Mesh, RayError, RayScene, RayTier};
use deferred_aa::reference::visibility::{Input, Seen};
use deferred_aa::{
    BuildError, Channels, DebugView, DecidedBy, DeferredAa, Descriptor, Effect, Frame, GBufferTier, Ids, InputMistake,
    Needs, RecordError, Settings, Shading, Technique, TextureTier, Windowed, wgpu,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options};
use deferred_aa_demo::quality::psnr;
use deferred_aa_demo::raster::{Raster, node_camera};
use deferred_aa_demo::rays::Rays;
use deferred_aa_demo::scene::{Camera, Lens, Scene, builtin};
use deferred_aa_demo::upload::GpuScene;

const SIZE: [u32; 2] = [61, 47];

pub fn adapter() -> wgpu::Adapter {
    gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter")
}

/// Whether the adapter tells triangles apart; says so if not.
pub fn has_ids() -> bool {
    let has = adapter().features().contains(wgpu::Features::PRIMITIVE_INDEX);
    if !has {
        eprintln!("skipped: the adapter has no primitive index");
    }
    has
}

pub fn host(scene: Scene, m: u32, [width, height]: [u32; 2], gbuffer: GBufferTier) -> Host {
    let options = Options { anisotropy: 4, gbuffer, ..Options::new(width, height, m) };
    let name = scene.name.clone();
    Host::new(device(&options.descriptor()), scene, options).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A device with no more than a node of this descriptor asks for.
fn device(descriptor: &Descriptor<'_>) -> Gpu {
    let adapter = adapter();
    let needs = DeferredAa::requirements(&adapter, descriptor);
    assert_eq!(needs.missing, Vec::<String>::new());
    Gpu::with(adapter, needs.features, needs.limits).expect("a device")
}

// ---- Against the twin ----

/// What a frame shows of its samples, and its value by the twin.
type Shown = (&'static str, fn(&Seen) -> [f64; 4]);

const SHOWN: [Shown; 8] = [
    ("vec4f(s.relative_position, s.depth)", |s| of(s.relative_position, f64::NAN)),
    ("vec4f(s.normal * 0.5 + 0.5, 1.0)", |s| of(s.normal * 0.5 + 0.5, 1.0)),
    ("vec4f(s.geometric_normal * 0.5 + 0.5, 1.0)", |s| of(s.geometric_normal * 0.5 + 0.5, 1.0)),
    ("vec4f(s.tangent * 0.5 + 0.5)", |s| (s.tangent * 0.5 + 0.5).to_array()),
    ("vec4f(s.uv * 0.25 + 0.5, 0.0, 1.0)", |s| of((s.uv * 0.25 + 0.5).extend(0.0), 1.0)),
    ("vec4f(s.ddx, s.ddy) * 4.0 + 0.5", |s| pair(s.ddx * 4.0 + 0.5, s.ddy * 4.0 + 0.5)),
    ("vec4f(f32(s.material), f32(s.object), 0.0, 1.0)", |s| {
        [f64::from(s.identity & 0xffff), f64::from(s.identity >> 16), 0.0, 1.0]
    }),
    ("unpack4x8unorm(s.user)", |s| s.user.to_le_bytes().map(|byte| f64::from(byte) / 255.0)),
];

fn of(v: DVec3, w: f64) -> [f64; 4] {
    v.extend(w).to_array()
}

fn pair(a: DVec2, b: DVec2) -> [f64; 4] {
    [a.x, a.y, b.x, b.y]
}

/// A node of m = 1, whose image is an attribute.
struct Node {
    gpu: Gpu,
    aa: DeferredAa,
    target: wgpu::Texture,
}

impl Node {
    fn new(shown: &str, gbuffer: GBufferTier) -> Self {
        let source = format!("fn shade(s: DaaSample) -> vec4f {{ return {shown}; }}");
        let descriptor = Descriptor {
            m: 1,
            gbuffer,
            textures: TextureTier::Arrays,
            ..Descriptor::new(wgpu::TextureFormat::Rgba32Float, Shading { source: &source, file: "test.wgsl" })
        };
        let gpu = device(&descriptor);
        let mut aa = DeferredAa::new(&gpu.device, &descriptor, None).expect("a node");
        aa.resize(&gpu.device, SIZE[0], SIZE[1]).expect("a size");
        let target = target(&gpu, descriptor.target_format, SIZE);
        Self { gpu, aa, target }
    }

    /// The image, and the first target and the depth of the G-buffer.
    fn render(&mut self, scene: &Scene, camera: &Camera) -> (Vec<[f32; 4]>, Vec<[u32; 2]>, Vec<f32>) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        // With a tree, whose leaves are in another order than the mesh.
        let mut rays = Rays::new(device, queue, Some(RayTier::Software), true, scene).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        rays.update(device, queue, &mut encoder, camera.eye).unwrap();
        queue.submit([encoder.finish()]);
        self.render_with(scene, camera, &rays.scene)
    }

    /// [`render`](Self::render) with meshes and instances of the test's own.
    fn render_with(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        rays: &RayScene,
    ) -> (Vec<[f32; 4]>, Vec<[u32; 2]>, Vec<f32>) {
        let (gpu, aa) = (&self.gpu, &mut self.aa);
        let (device, queue) = (&gpu.device, &gpu.queue);
        let uploaded = GpuScene::new(device, queue, aa, scene, 1).unwrap();
        let raster = Raster::new(device, aa, TextureTier::Arrays, scene, &uploaded);
        let camera = node_camera(camera, SIZE[0], SIZE[1]);
        let mut encoder = device.create_command_encoder(&Default::default());
        raster.record(queue, &mut encoder, scene, &uploaded, &camera, aa.gbuffer().unwrap());
        let view = self.target.create_view(&Default::default());
        let frame = Frame {
            settings: full(),
            textures: Some(&uploaded.table),
            needs: Needs { rays: Some(rays), ..Default::default() },
            ..Frame::new(camera, &view)
        };
        aa.record(queue, &mut encoder, &frame).expect("a frame");
        queue.submit([encoder.finish()]);
        gpu.wait();
        assert_eq!(gpu.take_errors(), Vec::<String>::new());
        let gbuffer = aa.gbuffer().unwrap();
        let image = pod_collect_to_vec(&gpu.read_texture(&self.target, 16));
        let ids = pod_collect_to_vec(&gpu.read_texture(gbuffer.color[0].texture(), 8));
        (image, ids, pod_collect_to_vec(&gpu.read_texture(gbuffer.depth.texture(), 4)))
    }
}

/// Scenes for what is hard: clipped by the near plane, seen edge-on, slivers, mirrored, flattened, far from the origin.
fn hard() -> Vec<(&'static str, Scene, Camera)> {
    let near = looking(vec3(0.3, 1.7, 4.0), vec3(0.0, 0.8, 0.0), 0.1);
    let around = scene(vec![
        floor(MATTE),
        (ball(MATTE), at(-1.1, 1.0, 0.0) * turned(0.3)),
        (ball(BUMPED), at(1.1, 1.0, 0.3) * scaled(-0.8, 0.6, 0.7)),
        (block(MATTE), at(0.2, 0.4, 1.8) * turned(1.1) * scaled(0.3, 0.3, 0.3)),
    ]);
    // The floor passes under the camera and behind it; walls that the view nearly runs along.
    let inside = scene(vec![
        (faces(MATTE, &[1]), scaled(60.0, 0.001, 60.0)),
        (faces(BUMPED, &[0, 3]), at(0.0, 1.0, 0.0) * scaled(0.002, 1.0, 40.0)),
        (block(MATTE), at(0.4, 0.3, -3.0) * scaled(0.001, 0.6, 0.4)),
    ]);
    let slivers = scene(
        (0..24)
            .map(|i| {
                let i = i as f32;
                (faces(BUMPED, &[2]), at(0.0, 0.1 * i - 1.0, 0.0) * turned(0.13 * i) * scaled(3.0, 0.004, 1.0))
            })
            .collect(),
    );
    let flattened = scene(vec![
        floor(MATTE),
        (ball(BUMPED), at(-1.0, 1.0, 0.0) * scaled(1.0, 1.0, 0.0)),
        (ball(MATTE), at(1.0, 1.0, 0.0) * scaled(-0.8, 0.8, 0.8)),
    ]);
    let far = vec3(1e6, -2e6, 5e5);
    let mut distant = around.clone();
    distant.instances.iter_mut().for_each(|i| i.world_from_mesh = Mat4::from_translation(far) * i.world_from_mesh);
    let mut from_far = near;
    from_far.eye += far;
    from_far.target += far;
    let parallel = Camera { lens: Lens::Orthographic { half_height: 1.5, far: 20.0 }, ..near };
    vec![
        ("around", around.clone(), near),
        ("parallel", around, parallel),
        ("inside", inside, looking(vec3(0.01, 0.6, 0.5), vec3(0.0, 0.5, -4.0), 0.01)),
        ("slivers", slivers, looking(vec3(0.0, 0.2, 3.5), vec3(0.0, 0.2, 0.0), 0.1)),
        ("flattened", flattened, near),
        ("far from the origin", distant, from_far),
    ]
}

/// From a point to a triangle.
pub fn distance(point: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(from, to)| from.cross(*to).dot(normal) > 0.0) {
        return normal.normalize().dot(a).abs();
    }
    let of_side = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let share = -from.dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        (from + along * share.clamp(0.0, 1.0)).length()
    };
    sides.map(of_side).into_iter().fold(f64::MAX, f64::min)
}

/// What a sample shows lies on its triangle, however that is seen.
#[test]
fn every_sample_is_on_its_triangle() {
    if !has_ids() {
        return;
    }
    // Negative results of a hook would become 0.
    const SHIFT: f64 = 100.0;
    let mut node = Node::new("vec4f(s.relative_position + 100.0, 1.0)", GBufferTier::Visibility(Ids::Wide));
    for (name, scene, camera) in hard() {
        let (image, ids, depth) = node.render(&scene, &camera);
        let mut covered = 0;
        for (i, (pixel, [instance, triangle])) in image.iter().zip(ids).enumerate() {
            // Where the depth is 0 there is sky.
            if instance == 0 || depth[i] <= 1e-30 {
                continue;
            }
            let placed = &scene.instances[instance as usize - 1];
            let mesh = &scene.meshes[placed.mesh];
            let (world, eye) = (placed.world_from_mesh.as_dmat4(), camera.eye.as_dvec3());
            let corner = |i: u32| world.transform_point3(mesh.positions[i as usize].as_dvec3()) - eye;
            let corners = mesh.indices.as_chunks::<3>().0[triangle as usize].map(corner);
            let point = dvec3(pixel[0].into(), pixel[1].into(), pixel[2].into()) - SHIFT;
            let off = distance(point, corners);
            assert!(off <= 1e-4, "{name}, {i}: {point} lies {off} off {corners:?}");
            covered += 1;
        }
        assert!(covered > 20, "{name}: {covered}");
    }
}

#[test]
fn every_attribute_is_the_twins() {
    if !has_ids() {
        return;
    }
    let mut scenes = hard();
    scenes.extend(views().into_iter().filter(|(name, ..)| *name == "mirrored and stretched"));
    for (shown, value) in SHOWN {
        let mut node = Node::new(shown, GBufferTier::Visibility(Ids::Wide));
        // What flattens a ball leaves tangents of almost no length, whose direction is rounding.
        let has = |name: &str| !(name == "flattened" && shown.contains("tangent"));
        for (name, scene, camera) in scenes.iter().filter(|(name, ..)| has(name)) {
            let (image, ids, depth) = node.render(scene, camera);
            let positions: Vec<Vec<[f32; 3]>> =
                scene.meshes.iter().map(|mesh| mesh.positions.iter().map(|p| p.to_array()).collect()).collect();
            let attributes: Vec<Vec<Attributes>> = scene.meshes.iter().map(attributes_of).collect();
            let mesh = |i: usize| Mesh {
                name: "",
                positions: &positions[i],
                indices: &scene.meshes[i].indices,
                attributes: &attributes[i],
                masked: false,
            };
            let meshes: Vec<_> = (0..scene.meshes.len()).map(mesh).collect();
            let instances: Vec<_> = scene
                .instances
                .iter()
                .map(|i| {
                    let world = DAffine3::from_mat4(i.world_from_mesh.as_dmat4());
                    (i.mesh, world, scene.meshes[i.mesh].material as u32, u32::from(i.object))
                })
                .collect();
            let input = Input {
                camera: node_camera(camera, SIZE[0], SIZE[1]),
                samples: SIZE,
                ids: &ids,
                depth: &depth,
                meshes: &meshes,
                instances: &instances,
            };
            let (mut covered, mut unsure) = (0, 0);
            for (i, pixel) in (0..).zip(&image) {
                assert!(pixel.iter().all(|c| c.is_finite()), "{name}, {shown}, {i}: {pixel:?}");
                let Some(seen) = input.sample(i % SIZE[0], i / SIZE[0]) else {
                    assert_eq!(*pixel, [0.0; 4], "{name}, {shown}, {i}: the sky");
                    continue;
                };
                covered += 1;
                // Edge-on, f32 can't say where the ray meets the plane; at the limit of the tolerance, which way it
                // goes.
                let limit =
                    seen.weights.map(|w| (w + 0.25).abs().min((w - 1.25).abs())).into_iter().fold(1.0, f64::min);
                if seen.facing.abs() < 2e-3 || limit < 1e-3 {
                    unsure += 1;
                    continue;
                }
                let expected = value(&seen);
                for (c, (&found, expected)) in pixel.iter().zip(expected).enumerate().filter(|(_, (_, e))| !e.is_nan())
                {
                    // Negative results of a hook become 0, and alpha is at most 1.
                    let expected = expected.max(0.0).min(if c == 3 { 1.0 } else { f64::MAX });
                    // A byte may round the other way.
                    let tolerance = 4e-3 * expected.max(1.0) / seen.facing.abs().clamp(0.05, 1.0);
                    let apart = (f64::from(found) - expected).abs();
                    assert!(apart <= tolerance, "{name}, {shown}, {i}.{c}: {pixel:?}, twin {seen:?}");
                }
            }
            assert!(covered > 20 && unsure * 4 < covered, "{name}: {unsure} of {covered} unsure");
        }
    }
}

fn attributes_of(mesh: &deferred_aa_demo::scene::Mesh) -> Vec<Attributes> {
    let vertex = |v: usize| Attributes {
        normal: mesh.normals[v].to_array(),
        tangent: mesh.tangents[v].to_array(),
        uv: mesh.uvs[v].to_array(),
        user: u32::from_le_bytes(mesh.colors[v].to_array().map(|c| (c * 255.0) as u8)),
    };
    (0..mesh.positions.len()).map(vertex).collect()
}

/// A mesh that was added in one shape and moved to another is shown as one that was added so.
#[test]
fn deformed_meshes_show_their_moved_vertices() {
    if !has_ids() {
        return;
    }
    let (_, before, camera) = hard().swap_remove(0);
    let mut after = before.clone();
    for mesh in &mut after.meshes {
        mesh.positions.iter_mut().for_each(|p| *p = *p * vec3(1.1, 0.8, 1.2) + vec3(0.0, 0.1 * p.x, 0.0));
        mesh.normals.iter_mut().for_each(|n| *n = (*n + vec3(0.3, 0.1, 0.0)).normalize());
        mesh.uvs.iter_mut().for_each(|uv| *uv = *uv * 0.5 + 0.2);
    }
    for (shown, _) in SHOWN {
        let mut node = Node::new(shown, GBufferTier::Visibility(Ids::Wide));
        let (device, queue) = (&node.gpu.device, &node.gpu.queue);
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut rays = RayScene::for_visibility(device, Some(RayTier::Software));
        let built = deferred_aa_demo::rays::build(&before, true).unwrap();
        let meshes: Vec<_> = built.iter().map(|mesh| rays.add(device, queue, &mut encoder, mesh).unwrap()).collect();
        let instances: Vec<_> = (before.instances.iter())
            .map(|i| Instance {
                material: before.meshes[i.mesh].material as u32,
                object: i.object.into(),
                ..Instance::new(meshes[i.mesh], Affine3A::from_mat4(i.world_from_mesh))
            })
            .collect();
        rays.update(device, queue, &mut encoder, &instances, camera.eye).unwrap();
        queue.submit([encoder.finish()]);
        let still = node.render_with(&after, &camera, &rays).0;
        for (&id, mesh) in meshes.iter().zip(&after.meshes) {
            let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
            rays.deform(&node.gpu.queue, id, &positions, &attributes_of(mesh)).unwrap();
        }
        let moved = node.render_with(&after, &camera, &rays).0;
        assert!(moved == node.render(&after, &camera).0, "{shown}");
        let stays = ["material", "user"].iter().any(|what| shown.contains(what));
        assert!(stays || moved != still, "{shown}");
    }
}

// ---- Against the stored G-buffer ----

#[test]
fn both_tiers_show_the_same() {
    if !has_ids() {
        return;
    }
    let some: &[_] = &[Technique::Full, Technique::Windowed];
    for (name, m, techniques) in [
        ("atrium", 2, &Technique::ALL[..]),
        ("mirrors", 2, &Technique::ALL[..]),
        ("fence", 4, some),
        ("checker", 3, some),
        ("spheres", 2, some),
        ("shadows", 2, some),
    ] {
        let scene = builtin::builtin(name).unwrap();
        let camera = scene.default_camera();
        let narrow = deferred_aa_demo::host::gbuffer_tier(&scene, &adapter());
        let mut stored = host(scene.clone(), m, [96, 54], GBufferTier::default());
        let mut visible = host(scene, m, [96, 54], narrow);
        for &technique in techniques {
            // Where cloths of atrium turn away from the sun, a ray from a rebuilt position may miss what an exact one hits:
            // three pixels of this picture.
            let shadows = if name == "atrium" { Effect::Off } else { Effect::Auto };
            // A ray of `probe` that grazes an edge on one tier decides how many samples a window has.
            let windowed = Windowed { shadow_reach: 0, ..Default::default() };
            let settings = Settings { technique, shadows, windowed, ..Default::default() };
            let [a, b] = [&mut stored, &mut visible].map(|host| {
                let counted = host.frame(&camera, settings).unwrap_or_else(|e| panic!("{name}: {e}")).statistics;
                assert_eq!((counted.not_finite, counted.negative), (0, 0), "{name}, {technique:?}");
                host.picture()
            });
            let apart = psnr(&a, &b).unwrap_or(f64::INFINITY);
            assert!(apart >= 60.0, "{name}, {technique:?}: {apart} dB");
        }
        let counts = [&mut stored, &mut visible].map(|host| {
            host.frame(&camera, Settings::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            host.counts(Technique::Windowed)
        });
        let apart = counts[0].iter().zip(&counts[1]).filter(|(a, b)| a != b).count();
        assert!(apart <= 10, "{name}: the counts of {apart} windows differ");
        let bytes = [stored.aa.memory().gbuffer, visible.aa.memory().gbuffer];
        assert_eq!(bytes, [36, 8].map(|bytes| 96 * 54 * u64::from(m * m) * bytes), "{name}");
        assert!(stored.edge_mask() == visible.edge_mask(), "{name}: the edges differ");
    }
}

/// The rasteriser interpolates vertex colours for the stored tier, and the crate for this one.
#[test]
fn the_hosts_bytes_count_alike_on_both_tiers() {
    if !has_ids() {
        return;
    }
    let mut scene = hard().swap_remove(0).1;
    for mesh in &mut scene.meshes {
        mesh.colors = mesh.positions.iter().map(|p| (p.extend(1.0) * 7.0).map(f32::sin) * 0.5 + 0.5).collect();
    }
    let camera = hard()[0].2;
    let none = Windowed { depth_scale: 0.0, normal_scale: 0.0, luminance_scale: 0.0, ..Default::default() };
    let settings = Settings { windowed: Windowed { user_scale: 200.0, ..none }, ..Default::default() };
    let [stored, visible] = [GBufferTier::default(), GBufferTier::Visibility(Ids::Wide)].map(|tier| {
        let mut host = host(scene.clone(), 3, [96, 54], tier);
        host.frame(&camera, settings).expect("a frame");
        host.plan()
    });
    let differ = stored.iter().zip(&visible).filter(|(a, b)| a.k() != b.k()).count();
    assert!(differ * 50 < stored.len(), "{differ} of {}", stored.len());
    let by_user = visible.iter().filter(|word| word.decided_by() == DecidedBy::User && word.k() > 2).count();
    assert!(by_user > 1000, "{by_user}");
}

/// Every view, twice the same bits.
#[test]
fn every_view_and_the_check_read_it() {
    if !has_ids() {
        return;
    }
    let scene = builtin::builtin("fence").unwrap();
    let camera = scene.default_camera();
    let narrow = deferred_aa_demo::host::gbuffer_tier(&scene, &adapter());
    let mut host = host(scene, 2, [48, 27], narrow);
    for view in DebugView::ALL {
        for technique in Technique::ALL {
            let settings = Settings { technique, view, ..Default::default() };
            host.frame(&camera, settings).unwrap();
            let first = host.picture();
            host.frame(&camera, settings).unwrap();
            assert!(first.rgba == host.picture().rgba, "{view:?}, {technique:?}: not the same bits twice");
            assert!(first.rgba.iter().flatten().all(|c| c.is_finite()));
        }
    }
    assert_eq!(check(&mut host, &camera), []);
}

/// What the check of the input finds.
fn check(host: &mut Host, camera: &Camera) -> Vec<InputMistake> {
    let record = |aa: &mut DeferredAa, queue: &_, encoder: &mut _, frame: &Frame<'_>| {
        aa.check_input(queue, encoder, frame)?;
        aa.record(queue, encoder, frame)
    };
    host.frame_by(camera, full(), record).expect("a frame");
    host.aa.input_report().expect("a report").mistakes.clone()
}

// ---- Channels ----

/// What nobody reads makes no difference.
#[test]
fn channels_that_nobody_reads_change_no_bit() {
    let scene = builtin::builtin("cornell").unwrap();
    assert!(scene.textures.is_empty());
    let camera = scene.default_camera();
    let untextured = deferred_aa_demo::host::stored(&scene);
    assert_eq!(untextured.bytes_per_sample(), 20);
    let mut all = host(scene.clone(), 2, [48, 48], GBufferTier::default());
    let mut some = host(scene, 2, [48, 48], untextured);
    for technique in Technique::ALL {
        let settings = Settings { technique, ..Default::default() };
        let [a, b] = [&mut all, &mut some].map(|host| {
            host.frame(&camera, settings).unwrap();
            host.picture()
        });
        assert!(a.rgba == b.rgba, "{technique:?}");
    }
    assert_eq!(some.aa.memory().gbuffer, 48 * 48 * 4 * 20);
    assert_eq!(check(&mut some, &camera), []);
}

/// Each channel alone, in its narrower target, holds what it holds beside all others.
#[test]
fn each_channel_alone_is_the_same() {
    let (_, scene, camera) = hard().swap_remove(0);
    let none = Channels::NONE;
    for (shown, channels, bytes) in [
        ("vec4f(s.uv, s.ddx) * 0.25 + 0.5", Channels { uv: true, ..none }, 28),
        ("vec4f(s.tangent * 0.5 + 0.5)", Channels { tangent: true, ..none }, 16),
        ("vec4f(s.geometric_normal * 0.5 + 0.5, 1.0)", Channels { geometric_normal: true, ..none }, 16),
        ("unpack4x8unorm(s.user)", Channels { user: true, ..none }, 16),
        ("vec4f(s.normal * 0.5 + 0.5, f32(s.object))", none, 12),
    ] {
        let tier = GBufferTier::Stored(channels);
        assert_eq!(tier.bytes_per_sample(), bytes);
        let [all, alone] = [GBufferTier::default(), tier].map(|tier| Node::new(shown, tier).render(&scene, &camera).0);
        assert!(all == alone, "{shown}");
        assert!(all.iter().any(|pixel| pixel != &all[0]), "{shown}: nothing to tell apart");
    }
}

#[test]
fn a_channel_that_is_read_must_be_kept() {
    let gpu = device(&Descriptor::new(FORMAT, WHITE));
    let build = |source: &str, channels, rays| {
        let gbuffer = GBufferTier::Stored(channels);
        let descriptor = Descriptor { gbuffer, rays, ..Descriptor::new(FORMAT, Shading { source, file: "game.wgsl" }) };
        DeferredAa::new(&gpu.device, &descriptor, None).map(drop).map_err(|e| e.to_string())
    };
    let none = Channels::NONE;
    let reads = "fn shade(s: DaaSample) -> vec4f {\n    let t = s;\n    return vec4f(t.ddx, s.uv);\n}";
    let why = "game.wgsl:3:18: `ddx` is not kept in the G-buffer; set it in the Channels of Descriptor::gbuffer, or don't read it";
    assert_eq!(build(reads, none, None).unwrap_err(), why.replace("ddx", "uv").replace(":18:", ":25:"));
    assert_eq!(build(reads, Channels { uv: true, ..none }, None), Ok(()));
    // What the host's own passes read is not read by shading.
    for enters in [
        "@compute @workgroup_size(1) fn main() { var s: DaaSample; let uv = s.uv; }",
        "@vertex fn main() -> @builtin(position) vec4f { var s: DaaSample; return vec4f(s.uv, 0.0, 1.0); }",
        "@fragment fn main() -> @location(0) vec4f { var s: DaaSample; return vec4f(s.uv, 0.0, 1.0); }",
    ] {
        let beside = format!("{enters}\nfn shade(s: DaaSample) -> vec4f {{ return vec4f(s.normal, 1.0); }}");
        assert_eq!(build(&beside, none, None), Ok(()), "{enters}");
    }
    let split = "fn material(s: DaaSample) -> DaaMaterial { var m: DaaMaterial; m.normal = daa_apply_normal_map(s, s.normal); return m; }
        fn light(f: DaaSurface, m: DaaMaterial) -> vec4f { return vec4f(m.normal, f32(f.user)); }";
    assert!(build(split, none, None).unwrap_err().contains("`tangent` is not kept"));
    assert!(build(split, Channels { tangent: true, ..none }, None).unwrap_err().contains("`user` is not kept"));
    assert_eq!(build(split, Channels { tangent: true, user: true, ..none }, None), Ok(()));
}

#[test]
fn rays_need_the_geometric_normal() {
    let rays = Some(RayTier::Software);
    let descriptor =
        Descriptor { rays, gbuffer: GBufferTier::Stored(Channels::NONE), ..Descriptor::new(FORMAT, WHITE) };
    let gpu = device(&descriptor);
    assert_eq!(DeferredAa::new(&gpu.device, &descriptor, None).map(drop), Err(BuildError::RayChannel));
}

// ---- What a host may get wrong ----

#[test]
fn ids_leave_bits_for_both_halves() {
    let gpu = device(&Descriptor::new(FORMAT, WHITE));
    for triangle_bits in [0, 32, 40] {
        let gbuffer = GBufferTier::Visibility(Ids::Narrow { triangle_bits });
        let descriptor = Descriptor { gbuffer, ..Descriptor::new(FORMAT, WHITE) };
        let limits = DeferredAa::requirements(&gpu.adapter, &descriptor).limits;
        let gpu = Gpu::with(gpu.adapter.clone(), wgpu::Features::empty(), limits).expect("a device");
        let refused = DeferredAa::new(&gpu.device, &descriptor, None).map(drop);
        assert_eq!(refused, Err(BuildError::TriangleBits(triangle_bits)));
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const WHITE: Shading<'_> = Shading { source: crate::harness::WHITE, file: "test.wgsl" };

#[test]
fn a_scene_that_does_not_serve_is_refused() {
    let descriptor = Descriptor {
        gbuffer: GBufferTier::Visibility(Ids::Narrow { triangle_bits: 1 }),
        ..Descriptor::new(FORMAT, WHITE)
    };
    let gpu = device(&descriptor);
    let (device, queue) = (&gpu.device, &gpu.queue);
    let mut aa = DeferredAa::new(device, &descriptor, None).expect("a node");
    aa.resize(device, 8, 8).expect("a size");
    let target = target(&gpu, FORMAT, [8, 8]);
    let view = target.create_view(&Default::default());
    let mut record = |rays: Option<&RayScene>| {
        let camera = crate::harness::camera(1.0);
        let frame = Frame { needs: Needs { rays, ..Default::default() }, ..Frame::new(camera, &view) };
        let mut encoder = device.create_command_encoder(&Default::default());
        let result = aa.record(queue, &mut encoder, &frame);
        queue.submit([encoder.finish()]);
        result
    };
    assert_eq!(record(None), Err(RecordError::NoVisibleScene));
    assert_eq!(record(Some(&RayScene::new(device, RayTier::Software))), Err(RecordError::NoVisibleScene));
    let mut empty = RayScene::for_visibility(device, None);
    assert_eq!(record(Some(&empty)), Ok(()));
    let mut encoder = device.create_command_encoder(&Default::default());
    empty.update(device, queue, &mut encoder, &[], Vec3::X).unwrap();
    let moved = RecordError::RayCamera { scene: Vec3::X, camera: Vec3::ZERO };
    assert_eq!(record(Some(&empty)), Err(moved));
    // Narrow ids name two triangles of a mesh.
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let attributes = [Attributes { normal: [0.0, 0.0, 1.0], tangent: [0.0; 4], uv: [0.0; 2], user: 0 }; 3];
    let indices = [0, 1, 2, 0, 2, 1, 1, 0, 2];
    let mesh = Mesh { name: "leaf", positions: &positions, indices: &indices, attributes: &attributes, masked: false };
    let mut large = RayScene::for_visibility(device, None);
    large.add(device, queue, &mut encoder, &BottomLevel::untraced(&mesh).unwrap()).unwrap();
    let ids = Ids::Narrow { triangle_bits: 1 };
    assert_eq!(record(Some(&large)), Err(RecordError::Ids { ids, triangles: 3, instances: 0 }));
    gpu.wait();
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

#[test]
fn meshes_and_instances_that_do_not_serve_are_refused() {
    let gpu = device(&Descriptor::new(FORMAT, WHITE));
    let (device, queue) = (&gpu.device, &gpu.queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let attributes = [Attributes { normal: [0.0, 0.0, 1.0], tangent: [0.0; 4], uv: [0.0; 2], user: 0 }; 3];
    let bare = Mesh { name: "leaf", positions: &positions, indices: &[0, 1, 2], attributes: &[], masked: false };
    let whole = Mesh { attributes: &attributes, ..bare };
    let mut drawn = RayScene::for_visibility(device, None);
    let mut traced = RayScene::new(device, RayTier::Software);
    let mut add = |scene: &mut RayScene, mesh: Result<BottomLevel, RayError>| {
        scene.add(device, queue, &mut encoder, &mesh.unwrap()).map_err(|e| e.to_string())
    };
    let refused = add(&mut drawn, BottomLevel::untraced(&bare)).unwrap_err();
    assert!(refused.starts_with("mesh 'leaf' has no attributes"), "{refused}");
    let refused = add(&mut traced, BottomLevel::untraced(&whole)).unwrap_err();
    assert!(refused.starts_with("mesh 'leaf' was made by BottomLevel::untraced"), "{refused}");
    let mesh = add(&mut drawn, BottomLevel::untraced(&whole)).unwrap();
    let bad = [f32::NAN, 0.0, 0.0];
    assert_eq!(drawn.deform(queue, mesh, &positions, &attributes), Ok(()));
    let vertex = RayError::Vertex { mesh: "leaf".into(), vertex: 1, position: bad };
    let refused = drawn.deform(queue, mesh, &[positions[0], bad, positions[2]], &attributes).unwrap_err();
    assert_eq!(refused.to_string(), vertex.to_string());
    assert!(matches!(drawn.deform(queue, mesh, &positions[1..], &attributes), Err(RayError::Attributes { .. })));
    let instance = Instance { material: 65_535, object: 65_535, ..Instance::new(mesh, Affine3A::IDENTITY) };
    let mut update = |instance| drawn.update(device, queue, &mut encoder, &[instance], Vec3::ZERO);
    assert_eq!(update(instance), Ok(()));
    let too_many = |what| RayError::Id { instance: 0, what, id: 65_536 };
    assert_eq!(update(Instance { material: 65_536, ..instance }), Err(too_many("material")));
    assert_eq!(update(Instance { object: 65_536, ..instance }), Err(too_many("object")));
    // Flat is only drawn; what is no number is neither.
    let world = Affine3A::from_scale(vec3(1.0, 0.0, 1.0));
    assert_eq!(update(Instance { world, ..instance }), Ok(()));
    let world = Affine3A::from_scale(vec3(1.0, f32::NAN, 1.0));
    assert!(matches!(update(Instance { world, ..instance }), Err(RayError::Transform { .. })));
}

/// More materials than 16 bits hold are refused on both tiers, and none becomes another.
#[test]
fn more_materials_than_a_sample_can_name_are_refused() {
    let mut scene = builtin::builtin("flat").unwrap();
    let material = scene.materials[0].clone();
    scene.materials.resize_with(65537, || material.clone());
    let tiers = [GBufferTier::default(), GBufferTier::Visibility(Ids::Wide)];
    for gbuffer in tiers.into_iter().take(if has_ids() { 2 } else { 1 }) {
        let options = Options { gbuffer, ..Options::new(16, 16, 1) };
        let gpu = Gpu::new(gpu::choose(None).expect("an adapter"), &options.descriptor()).expect("a device");
        let refused = Host::new(gpu, scene.clone(), options).map(|_| ()).expect_err("too many").to_string();
        assert!(refused.contains("65537 materials") && refused.contains("65536"), "{refused}");
    }
    scene.materials.truncate(65536);
    let options = Options::new(16, 16, 1);
    let gpu = Gpu::new(gpu::choose(None).expect("an adapter"), &options.descriptor()).expect("a device");
    Host::new(gpu, scene, options).map(|_| ()).expect("as many as there are names");
}

/// Two flat triangles of one double-sided wall, wound oppositely: both show the same normal, so that the metric of
/// normals sees no edge between them, from either side.
#[test]
fn flat_triangles_show_the_normal_of_their_visible_side() {
    if !has_ids() {
        return;
    }
    let mut wall = faces(MATTE, &[2]);
    let turned_over: Vec<u32> = [0, 3, 2]
        .map(|corner| {
            wall.positions.push(wall.positions[corner]);
            wall.normals.push(-wall.normals[corner]);
            wall.tangents.push(wall.tangents[corner]);
            wall.uvs.push(wall.uvs[corner]);
            wall.colors.push(wall.colors[corner]);
            wall.positions.len() as u32 - 1
        })
        .to_vec();
    wall.indices.truncate(3);
    wall.indices.extend(turned_over);
    let mut made = scene(vec![(wall, at(0.0, 0.0, 0.0))]);
    made.materials[MATTE].double_sided = true;
    let windowed = Windowed { depth_scale: 0.0, luminance_scale: 0.0, two_sided: false, ..Windowed::PAPER };
    let settings = Settings { windowed, ..Settings::default() };
    for eye in [vec3(0.3, 0.2, 4.0), vec3(0.3, 0.2, -4.0)] {
        let camera = looking(eye, Vec3::ZERO, 0.1);
        let mut host = host(made.clone(), 4, SIZE, GBufferTier::Visibility(Ids::Wide));
        host.frame(&camera, settings).expect("a frame");
        assert!(host.depths().iter().filter(|&&d| d > 0.0).count() > 2000, "the wall is seen");
        assert!(host.plan().iter().all(|word| word.k() == 1), "{eye}: an edge where there is none");
    }
}
