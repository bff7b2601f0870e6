//! Mirrored and refracted rays against the twin: a hook shows what their hits are shaded from, one attribute a sample.

use crate::harness::target;
use crate::shadows::{looking, owner, tiers};
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{DAffine3, DVec3, Mat4, Vec2, Vec3, Vec4, vec3};
use deferred_aa::rays::{Attributes, RayTier};
use deferred_aa::reference::rays::reflect::{Input, Reflect, Reflections, Sample, place};
use deferred_aa::reference::rays::{self as twin, shared_exponent, trace};
use deferred_aa::{
    CastingLight, DeferredAa, Descriptor, Frame, Needs, Settings, Shading, Technique, TextureTier, wgpu, window,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::raster::{Raster, node_camera};
use deferred_aa_demo::rays::Rays;
use deferred_aa_demo::scene::{Camera, Instance, Lens, Mesh, Scene, builtin};
use deferred_aa_demo::upload::GpuScene;

pub const MATTE: usize = 0;
pub const MIRROR: usize = 1;
pub const BUMPED: usize = 2;
pub const GLASS: usize = 3;

const HOOKS: &str = "
fn shade(s: DaaSample) -> vec4f {
    var c: vec3f;
    switch (s.pixel.x + s.pixel.y + s.rank) % 10u {
        case 0u: { c = 0.5 + 0.5 * s.normal; }
        case 1u: { c = 0.5 + 0.5 * s.geometric_normal; }
        case 2u: { c = 0.5 + 0.5 * s.tangent.xyz; }
        case 3u: { c = 0.5 + 0.5 * s.tangent.w * cross(s.normal, s.tangent.xyz); }
        case 4u: { c = vec3f(s.uv, 0.25); }
        case 5u: { c = vec3f(s.ddx.x, s.ddy.y, abs(s.ddx.y) + abs(s.ddy.x)); }
        case 6u: { c = vec3f(f32(s.material) / 4.0, f32(s.object) / 8.0, f32(s.user & 0xffu) / 255.0); }
        case 7u: { c = 1.0 + vec3f(vec3u(s.shadow, s.shadow >> 1u, s.shadow >> 2u) & vec3u(1u)); }
        case 8u: { c = 0.5 + 0.05 * s.position; }
        default: { c = vec3f(0.5 + 0.5 * s.view.xy, 0.1 * s.depth); }
    }
    return vec4f(c, 1.0);
}
fn sky(s: DaaSample) -> vec4f { return vec4f(0.5 - 0.5 * s.view, 1.0); }
fn reflection(s: DaaSample) -> DaaReflection {
    var b: DaaReflection;
    b.normal = s.normal;
    b.ior = 1.5;
    switch s.material {
        case 1u: { b.reflection = vec3f(1.0); }
        case 2u: {
            b.reflection = vec3f(1.0, s.uv.y, length(s.ddx));
            b.normal = daa_apply_normal_map(s, vec3f(fract(s.uv * 8.0) - 0.5, 1.5));
        }
        case 3u: {
            b.reflection = vec3f(0.25, 0.125, 0.5);
            b.refraction = vec3f(0.75, 0.875, 0.5);
        }
        default: {}
    }
    return b;
}";

/// The hooks again.
fn shade(s: &Sample) -> [f64; 4] {
    let signed = |v: DVec3| 0.5 + 0.5 * v;
    let c = match (s.pixel[0] + s.pixel[1] + s.rank) % 10 {
        0 => signed(s.normal),
        1 => signed(s.geometric_normal),
        2 => signed(s.tangent.truncate()),
        3 => signed(s.tangent.w * s.normal.cross(s.tangent.truncate())),
        4 => s.uv.extend(0.25),
        5 => DVec3::new(s.ddx.x, s.ddy.y, s.ddx.y.abs() + s.ddy.x.abs()),
        6 => DVec3::new(f64::from(s.material) / 4.0, f64::from(s.object) / 8.0, f64::from(s.user & 0xff) / 255.0),
        7 => 1.0 + DVec3::from([0, 1, 2].map(|i| f64::from(s.shadow >> i & 1))),
        8 => 0.5 + 0.05 * s.position,
        _ => signed(s.view).truncate().extend(0.1 * s.depth),
    };
    c.extend(1.0).to_array()
}

fn sky(s: &Sample) -> [f64; 4] {
    (0.5 - 0.5 * s.view).extend(1.0).to_array()
}

fn reflection(s: &Sample) -> Reflect {
    let none = Reflect { reflection: DVec3::ZERO, refraction: DVec3::ZERO, ior: 1.5, normal: s.normal };
    match s.material as usize {
        MIRROR => Reflect { reflection: DVec3::ONE, ..none },
        BUMPED => {
            let tilt = (s.uv * 8.0).fract_gl() - 0.5;
            let tangent = s.tangent.truncate();
            let bitangent = s.normal.cross(tangent) * s.tangent.w;
            let normal = (tangent * tilt.x + bitangent * tilt.y + s.normal * 1.5).normalize();
            Reflect { reflection: DVec3::new(1.0, s.uv.y, s.ddx.length()), normal, ..none }
        }
        GLASS => {
            let (reflection, refraction) = (DVec3::new(0.25, 0.125, 0.5), DVec3::new(0.75, 0.875, 0.5));
            Reflect { reflection, refraction, ..none }
        }
        _ => none,
    }
}

// ---- Scenes ----

/// Vertices with what rays need of them; two colours in turn.
pub fn mesh(material: usize, vertices: &[(Vec3, Vec3, Vec4, Vec2)], indices: Vec<u32>) -> Mesh {
    Mesh {
        name: "made".to_owned(),
        positions: vertices.iter().map(|v| v.0).collect(),
        normals: vertices.iter().map(|v| v.1).collect(),
        tangents: vertices.iter().map(|v| v.2).collect(),
        uvs: vertices.iter().map(|v| v.3).collect(),
        colors: (0..vertices.len()).map(|i| Vec4::splat((i % 2) as f32)).collect(),
        indices,
        material,
    }
}

/// Of radius 1, smooth, its uv round the equator and down.
pub fn ball(material: usize) -> Mesh {
    let (rings, around) = (8, 12);
    let vertex = |i: u32| {
        let uv = Vec2::new((i % (around + 1)) as f32 / around as f32, (i / (around + 1)) as f32 / rings as f32);
        let (sin, cos) = (uv.x * std::f32::consts::TAU).sin_cos();
        let (out, up) = (uv.y * std::f32::consts::PI).sin_cos();
        let p = vec3(cos * out, up, sin * out);
        (p, p, vec3(-sin, 0.0, cos).extend(1.0), uv)
    };
    let vertices: Vec<_> = (0..(rings + 1) * (around + 1)).map(vertex).collect();
    let mut indices = Vec::new();
    for i in (0..rings * around).map(|i| i / around * (around + 1) + i % around) {
        let below = i + around + 1;
        // At the poles, one triangle of two has no area.
        if i > around {
            indices.extend([i, i + 1, below]);
        }
        if below < rings * (around + 1) {
            indices.extend([i + 1, below + 1, below]);
        }
    }
    mesh(material, &vertices, indices)
}

/// Faces of a cube of side 2, the given ones of x, y, z, −x, −y, −z; bitangents of either sign.
pub fn faces(material: usize, which: &[usize]) -> Mesh {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for &face in which {
        let axis = |i: usize| Vec3::AXES[(face + i) % 3];
        let (side, w) = (if face < 3 { 1.0 } else { -1.0 }, if face % 2 == 0 { 1.0 } else { -1.0 });
        let (normal, tangent) = (axis(0) * side, axis(1));
        let bitangent = normal.cross(tangent);
        let first = vertices.len() as u32;
        for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let uv = Vec2::new(0.5 + 0.25 * u, 0.5 + 0.5 * v * w);
            vertices.push((normal + tangent * u + bitangent * v, normal, tangent.extend(w), uv));
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    mesh(material, &vertices, indices)
}

pub fn block(material: usize) -> Mesh {
    faces(material, &[0, 1, 2, 3, 4, 5])
}

/// A square of side 8 at y = 0, facing up.
pub fn floor(material: usize) -> (Mesh, Mat4) {
    (faces(material, &[1]), Mat4::from_translation(vec3(0.0, -0.1, 0.0)) * Mat4::from_scale(vec3(4.0, 0.1, 4.0)))
}

pub fn at(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(vec3(x, y, z))
}

pub fn turned(by: f32) -> Mat4 {
    Mat4::from_rotation_y(by) * Mat4::from_rotation_x(0.7 * by)
}

pub fn scaled(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_scale(vec3(x, y, z))
}

pub fn scene(placed: Vec<(Mesh, Mat4)>) -> Scene {
    let plain = builtin::builtin("flat").unwrap().materials[0].clone();
    let instance = |(mesh, &world_from_mesh)| Instance { mesh, world_from_mesh, object: mesh as u16 + 1 };
    let (meshes, worlds): (Vec<_>, Vec<_>) = placed.into_iter().unzip();
    let instances = (0..).zip(&worlds).map(instance).collect();
    Scene { name: "made".to_owned(), meshes, instances, materials: vec![plain; 4], ..Default::default() }
}

fn lights() -> [CastingLight; 3] {
    [
        CastingLight::Directional { towards: vec3(0.4, 1.0, 0.3) },
        CastingLight::Punctual { position: vec3(-2.0, 3.0, 1.5), range: 6.0, cone: None },
        CastingLight::Punctual { position: vec3(1.0, 4.0, 2.0), range: 0.0, cone: Some((vec3(-0.2, -1.0, -0.4), 0.4)) },
    ]
}

// ---- The comparison ----

const M: u32 = 2;
const SIZE: [u32; 2] = [44, 33];

const REFLECTIVE: [u32; 3] = [MIRROR as u32, BUMPED as u32, GLASS as u32];

/// The G-buffer of a frame.
#[derive(Clone, PartialEq)]
struct Seen {
    camera: deferred_aa::Camera,
    depth: Vec<f32>,
    surface: Vec<[u32; 2]>,
    frame: Vec<[u32; 2]>,
    uv: Vec<[u32; 4]>,
}

/// A node with the hooks, on a tier.
struct Node {
    tier: RayTier,
    gpu: Gpu,
    aa: DeferredAa,
    target: wgpu::TextureView,
}

impl Node {
    fn new(tier: RayTier) -> Self {
        Self::with(tier, HOOKS)
    }

    fn with(tier: RayTier, hooks: &str) -> Self {
        let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
        let descriptor = Descriptor {
            textures: TextureTier::Arrays,
            m: M,
            rays: Some(tier),
            ..Descriptor::new(wgpu::TextureFormat::Rgba16Float, Shading { source: hooks, file: "test.wgsl" })
        };
        let gpu = Gpu::new(adapter, &descriptor).expect("a device");
        let mut aa = DeferredAa::new(&gpu.device, &descriptor, None).expect("a node");
        aa.resize(&gpu.device, SIZE[0], SIZE[1]).expect("a size");
        let target = target(&gpu, descriptor.target_format, SIZE);
        Self { tier, gpu, aa, target: target.create_view(&Default::default()) }
    }

    /// The G-buffer of a frame, the codes of its samples in the order of [`samples`], and the rays.
    fn render(&mut self, scene: &Scene, camera: &Camera) -> (Seen, Vec<u32>, [u32; 2]) {
        let (gpu, aa) = (&self.gpu, &mut self.aa);
        let (device, queue) = (&gpu.device, &gpu.queue);
        let uploaded = GpuScene::new(device, queue, aa, scene, 1).unwrap();
        let raster = Raster::new(device, aa, TextureTier::Arrays, scene, &uploaded);
        let mut rays = Rays::new(device, queue, Some(self.tier), false, scene).unwrap();
        let camera = node_camera(camera, SIZE[0], SIZE[1]);
        let mut encoder = device.create_command_encoder(&Default::default());
        raster.record(queue, &mut encoder, scene, &uploaded, &camera, aa.gbuffer().unwrap());
        rays.update(device, queue, &mut encoder, camera.world_from_view.w_axis.truncate()).unwrap();
        let frame = Frame {
            settings: Settings { technique: Technique::Full, ..Default::default() },
            textures: Some(&uploaded.table),
            needs: Needs { rays: Some(&rays.scene), shadows: &lights(), reflective: &REFLECTIVE, ..Default::default() },
            statistics: true,
            ..Frame::new(camera, &self.target)
        };
        aa.record(queue, &mut encoder, &frame).expect("a frame");
        queue.submit([encoder.finish()]);
        gpu.wait();
        let statistics = aa.statistics().expect("statistics");
        let rays = [statistics.reflection_rays, statistics.refraction_rays];
        let passed = aa.intermediates().unwrap();
        let by_rank: Vec<u32> = pod_collect_to_vec(&gpu.read_buffer(passed.reflections.unwrap()));
        let code = |(x, y, rank)| by_rank[passed.slots.sample(x / M, y / M, rank)];
        let codes = samples().map(code).collect();
        let gbuffer = aa.gbuffer().unwrap();
        let color = |i: usize, texel| gpu.read_texture(gbuffer.color[i].texture(), texel);
        let seen = Seen {
            camera,
            depth: pod_collect_to_vec(&gpu.read_texture(gbuffer.depth.texture(), 4)),
            surface: pod_collect_to_vec(&color(0, 8)),
            frame: pod_collect_to_vec(&color(1, 8)),
            uv: pod_collect_to_vec(&color(2, 16)),
        };
        assert_eq!(gpu.take_errors(), Vec::<String>::new());
        (seen, codes, rays)
    }
}

/// All of a frame: G-buffer coordinates and rank.
fn samples() -> impl Iterator<Item = (u32, u32, u32)> {
    let order = window::order(M);
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    pixels.flat_map(move |(x, y)| {
        let places: Vec<_> = (0..).zip(&order).map(|(rank, &(sx, sy))| (u32::from(sx), u32::from(sy), rank)).collect();
        places.into_iter().map(move |(sx, sy, rank)| (x * M + sx, y * M + sy, rank))
    })
}

/// What the twin makes of all samples of that G-buffer.
fn expected(scene: &Scene, seen: &Seen) -> Vec<Reflections> {
    let eye = seen.camera.world_from_view.w_axis.truncate().as_dvec3();
    let (mut triangles, mut owners, mut attributes) = (Vec::new(), Vec::new(), Vec::new());
    for i in &scene.instances {
        let mesh = &scene.meshes[i.mesh];
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let vertices: Vec<_> = (0..positions.len())
            .map(|v| Attributes {
                normal: mesh.normals[v].to_array(),
                tangent: mesh.tangents[v].to_array(),
                uv: mesh.uvs[v].to_array(),
                user: u32::from_le_bytes(mesh.colors[v].to_array().map(|c| (c * 255.0) as u8)),
            })
            .collect();
        let world = DAffine3::from_mat4(i.world_from_mesh.as_dmat4());
        triangles.extend(twin::place(&positions, &mesh.indices, world, eye));
        attributes.extend(place(&vertices, &mesh.indices, world, mesh.material as u32));
        owners.resize(triangles.len(), owner(scene, i));
    }
    let input = Input {
        trace: &trace::Input {
            camera: seen.camera,
            samples: SIZE.map(|side| side * M),
            depth: &seen.depth,
            surface: &seen.surface,
            frame: &seen.frame,
            // The offset by distance is greater here.
            least_offsets: &[],
            ray_bias: Settings::default().ray_bias,
            lights: &lights(),
            triangles: &triangles,
            owners: &owners,
        },
        uv: &seen.uv,
        m: M,
        attributes: &attributes,
        reflective: &REFLECTIVE,
        kinds: [true, true],
        reflect: &reflection,
        shade: &shade,
        sky: &sky,
    };
    samples().map(|(x, y, rank)| input.reflections(x, y, rank)).collect()
}

pub fn views() -> Vec<(&'static str, Scene, Camera)> {
    let mirror = scene(vec![
        floor(MIRROR),
        (ball(MATTE), at(-1.0, 1.2, 0.0)),
        (block(MATTE), at(1.5, 0.8, -1.0) * turned(0.6) * scaled(0.6, 0.6, 0.6)),
        (faces(BUMPED, &[2]), at(0.0, 1.0, -4.0) * scaled(3.0, 1.5, 1.0)),
    ]);
    let chrome = scene(vec![
        floor(MATTE),
        (ball(MIRROR), at(-1.1, 1.0, 0.0) * turned(0.3)),
        (ball(BUMPED), at(1.1, 1.0, 0.3)),
        (block(MATTE), at(0.2, 0.4, 1.8) * turned(1.1) * scaled(0.3, 0.3, 0.3)),
    ]);
    let glass = scene(vec![
        floor(MATTE),
        (ball(GLASS), at(-1.0, 1.1, 0.0) * turned(0.3)),
        (block(GLASS), at(1.0, 1.0, 0.6) * turned(0.5) * scaled(0.9, 0.9, 0.2)),
        (block(GLASS), at(0.2, 0.5, 2.0) * turned(1.0) * scaled(0.4, 0.4, 0.4)),
        (ball(MATTE), at(0.5, 1.0, -1.5)),
    ]);
    let stretched = scene(vec![
        floor(MIRROR),
        (ball(MATTE), at(-1.8, 1.0, 0.0) * scaled(-0.7, 0.7, 0.7) * turned(0.8)),
        (ball(MATTE), at(0.2, 0.8, -0.5) * scaled(0.9, 0.3, 0.5) * turned(0.5)),
        (block(MATTE), at(1.9, 0.8, -0.5) * turned(0.4) * scaled(0.4, -0.7, 0.3) * turned(0.9)),
        (ball(GLASS), at(-0.8, 0.8, 1.6) * turned(0.6) * scaled(0.5, 0.4, -0.7)),
        (ball(BUMPED), at(0.9, 0.7, 1.5) * scaled(-0.6, 0.4, 0.5) * turned(0.6)),
    ]);
    let seen_from = |eye, height| looking(eye, vec3(0.0, height, 0.0), 0.1);
    let near = seen_from(vec3(0.3, 1.7, 4.0), 1.0);
    let lens = Lens::Orthographic { half_height: 1.3, far: 20.0 };
    vec![
        ("plane mirror", mirror, seen_from(vec3(0.3, 1.7, 5.0), 0.6)),
        ("chrome, rays side by side", chrome.clone(), Camera { lens, ..near }),
        ("chrome", chrome, near),
        ("glass", glass, seen_from(vec3(0.3, 1.9, 4.2), 0.9)),
        ("mirrored and stretched", stretched, seen_from(vec3(0.3, 2.2, 5.0), 0.5)),
    ]
}

#[test]
fn what_rays_bring_back_is_the_twins_on_each_tier() {
    let mut nodes: Vec<Node> = tiers().into_iter().map(Node::new).collect();
    for (name, scene, camera) in views() {
        let mut first: Option<(Seen, Vec<Reflections>)> = None;
        for node in &mut nodes {
            let (seen, codes, counted) = node.render(&scene, &camera);
            let (as_seen, all) = first.get_or_insert_with(|| {
                let all = expected(&scene, &seen);
                (seen.clone(), all)
            });
            assert!(seen == *as_seen, "{name}: tiers see another G-buffer");
            let (mut sent, mut unsure, mut rays) = (0, 0, [0; 2]);
            for (((x, y, rank), twin), code) in samples().zip(all.iter()).zip(codes) {
                let at = format!("{name} {:?}, sample {x} {y}, shown {}", node.tier, (x / M + y / M + rank) % 10);
                rays = [rays[0] + twin.rays[0], rays[1] + twin.rays[1]];
                assert_eq!(code != 0, twin.rays != [0, 0], "{at}");
                sent += u32::from(code != 0);
                unsure += u32::from(!twin.sure);
                // Half a step is the code's, half what f32 rounds.
                let (found, step) = (shared_exponent::decode(code), shared_exponent::step(code));
                let apart = (found - twin.radiance).abs().max_element();
                assert!(!twin.sure || apart <= step, "{at}: {found}, twin {twin:?}");
            }
            // On SwiftShader depth is further off the planes, so that more rays pass near an edge.
            let most = if crate::drivers::is_swiftshader(&node.gpu) { sent / 50 } else { sent / 100 };
            assert!(sent >= 3000 && unsure <= most, "{name}: {unsure} of {sent} unsure");
            assert_eq!(counted, rays, "{name} {:?}", node.tier);
        }
    }
}

/// Row 8: what rays meet, and what the host says of them, is counted when it is no number, and black.
#[test]
fn bad_values_behind_rays_are_counted() {
    let (_, scene, camera) = views().swap_remove(0);
    let bad = "bitcast<f32>(0x7fc00000u + (s.pixel.x >> 20u))";
    let mirror = "b.normal = s.normal; b.ior = 1.5; b.reflection = vec3f(1.0);";
    let hooks = |shade: &str, reflection: &str| {
        format!(
            "fn shade(s: DaaSample) -> vec4f {{ var c = vec3f(0.5); if s.traced == 0u {{ {shade} }} return vec4f(c, 1.0); }}
            fn reflection(s: DaaSample) -> DaaReflection {{ var b: DaaReflection; {mirror} {reflection} return b; }}"
        )
    };
    for (name, shade, reflection) in [
        ("a hit", format!("c.g = {bad};"), String::new()),
        ("a weight", String::new(), format!("b.reflection.b = {bad};")),
        ("a normal", String::new(), format!("b.normal.x = {bad};")),
    ] {
        for tier in tiers() {
            let mut node = Node::with(tier, &hooks("", ""));
            let (_, sound, rays) = node.render(&scene, &camera);
            assert_eq!(node.aa.statistics().unwrap().not_finite, 0);
            let mut node = Node::with(tier, &hooks(&shade, &reflection));
            let (_, codes, _) = node.render(&scene, &camera);
            let counted = node.aa.statistics().unwrap().not_finite;
            assert!(counted > 1000 && counted <= 2 * rays[0], "{name}, {tier:?}: {counted} of {rays:?}");
            let other = codes.iter().zip(&sound).filter(|(code, sound)| **code != **sound);
            assert!(other.map(|(code, _)| shared_exponent::decode(*code)).all(|c| c.min_element() == 0.0), "{name}");
            // Black that was traced is told from what was not.
            let traced = |codes: &[u32]| codes.iter().filter(|&&code| code != 0).count();
            if name != "a normal" {
                assert_eq!(traced(&codes), traced(&sound), "{name}");
            }
        }
    }
    // Radiance below the least that a code holds is black, however small its exponent is.
    for dim in ["1e-7", "1e-30"] {
        let mut node = Node::with(RayTier::Software, &hooks(&format!("c = vec3f({dim});"), ""));
        let (_, codes, _) = node.render(&scene, &camera);
        let seen = codes.iter().filter(|&&code| code != 0).map(|&code| shared_exponent::decode(code).max_element());
        assert!(seen.clone().count() > 1000 && seen.fold(0.0, f64::max) <= 1.0, "{dim}");
        let met =
            codes.iter().filter(|&&code| code != 0 && shared_exponent::decode(code).max_element() <= 1e-6).count();
        assert!(met > 1000, "{dim}: {met}");
    }
}
