//! Rays through the two-level tree against every triangle in f64, and the hard cases of numerics.

use crate::harness::{device, noise};
use deferred_aa::glam::{Affine3A, DAffine3, DVec3, Mat3, Quat, Vec3, vec3};
use deferred_aa::rays::{self, Attributes, BottomLevel, Instance, Mesh, MeshId, RayError, RayScene, RayTier};
use deferred_aa::reference::rays::{self as twin, Ray};
use deferred_aa::{TextureTier, wgpu};
use deferred_aa_demo::gpu::{self, Gpu};
use insta::assert_snapshot;

const TLAS: &str = "@group(0) @binding(0) var daa_ray_tlas: acceleration_structure;";
const KERNEL: &str = "
@group(0) @binding(1) var<storage, read> daa_ray_meshes: array<vec4u>;
@group(0) @binding(2) var<storage, read> daa_ray_top: array<vec4u>;
@group(0) @binding(3) var<storage, read> rays: array<DaaRay>;
@group(0) @binding(4) var<storage, read_write> hits: array<DaaHit>;
override flags: u32 = 0u;
override through: u32 = DAA_MISS;

fn daa_ray_solid(material: u32, uv: vec2f, user: u32) -> bool {
    // Holes in a checker of 1/8, and where the first byte is below a half.
    let cell = vec2i(floor(uv * 8.0));
    return ((cell.x ^ cell.y) & 1) == i32(material) && (user & 0xffu) >= 0x80u;
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.y * groups.x * 64u + id.x;
    if index < arrayLength(&rays) {
        hits[index] = daa_trace(rays[index], flags, through);
    }
}
";

/// As `DaaRay`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuRay {
    pub origin: Vec3,
    pub t_min: f32,
    pub direction: Vec3,
    pub t_max: f32,
}

/// As `DaaHit`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct GpuHit {
    pub t: f32,
    pub instance: u32,
    pub triangle: u32,
    pub front: u32,
    barycentrics: [f32; 2],
    record: u32,
    corners: u32,
}

pub const MISS: u32 = u32::MAX;

fn ray(origin: Vec3, direction: Vec3) -> GpuRay {
    GpuRay { origin, t_min: 0.0, direction, t_max: 1e30 }
}

/// The same ray in f64.
pub fn wide(ray: &GpuRay) -> Ray {
    let [origin, direction] = [ray.origin, ray.direction].map(Vec3::as_dvec3);
    Ray { origin, direction, t_min: ray.t_min.into(), t_max: ray.t_max.into() }
}

pub struct Tracer {
    pub tier: RayTier,
    pub gpu: Gpu,
    pub scene: RayScene,
    /// The nearest hit; any; any but the back faces of object 3; the nearest where back faces are culled; any that casts
    /// a shadow.
    pipelines: [wgpu::ComputePipeline; 5],
}

/// Runs a test on each tier that the adapter has; says so where it has no ray query.
fn on_each_tier(test: impl Fn(Tracer)) {
    test(Tracer::new(RayTier::Software));
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    if adapter.features().contains(rays::QUERY_FEATURES) {
        test(Tracer::new(RayTier::Query));
    } else {
        eprintln!("skipped: the adapter has no ray query");
    }
}

impl Tracer {
    pub fn new(tier: RayTier) -> Self {
        let (gpu, source) = match tier {
            RayTier::Software => (device(TextureTier::None), format!("{}\n{KERNEL}", rays::SOFTWARE_WGSL)),
            RayTier::Query => {
                let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("an adapter");
                let limits = rays::query_limits(wgpu::Limits::default(), &adapter.limits());
                let gpu = Gpu::with(adapter, rays::QUERY_FEATURES, limits).expect("a device");
                (gpu, format!("enable wgpu_ray_query;\n{}\n{TLAS}{KERNEL}", rays::QUERY_WGSL))
            }
        };
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("rays"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipelines = [(0.0, MISS), (1.0, MISS), (1.0, 3), (2.0, MISS), (5.0, MISS)].map(|(flags, through)| {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("rays"),
                layout: None,
                module: &module,
                entry_point: Some("trace"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[("flags", flags), ("through", f64::from(through))],
                    ..Default::default()
                },
                cache: None,
            })
        });
        assert_eq!(gpu.take_errors(), Vec::<String>::new());
        let scene = RayScene::new(&gpu.device, tier);
        Self { tier, gpu, scene, pipelines }
    }

    pub fn add(&mut self, positions: &[[f32; 3]], indices: &[u32]) -> MeshId {
        let built =
            BottomLevel::build(&Mesh { name: "mesh", positions, indices, attributes: &[], masked: false }).unwrap();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let id = self.scene.add(&self.gpu.device, &self.gpu.queue, &mut encoder, &built).unwrap();
        self.gpu.queue.submit([encoder.finish()]);
        id
    }

    pub fn place(&mut self, instances: &[(MeshId, Affine3A)], camera: Vec3) {
        let instances: Vec<_> = instances.iter().map(|&(mesh, world)| instance(mesh, world)).collect();
        self.update(&instances, camera).unwrap();
    }

    fn update(&mut self, instances: &[Instance], camera: Vec3) -> Result<(), RayError> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.scene.update(&self.gpu.device, &self.gpu.queue, &mut encoder, instances, camera)?;
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    pub fn trace(&self, rays: &[GpuRay], any: bool) -> Vec<GpuHit> {
        self.run(rays, &self.pipelines[usize::from(any)])
    }

    fn run(&self, rays: &[GpuRay], pipeline: &wgpu::ComputePipeline) -> Vec<GpuHit> {
        use wgpu::util::DeviceExt;
        let Gpu { device, queue, .. } = &self.gpu;
        let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("rays"),
            contents: bytemuck::cast_slice(rays),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let size = (rays.len() * size_of::<GpuHit>()) as u64;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let output = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("hits"),
            size,
            usage,
            mapped_at_creation: false,
        });
        let [meshes, top] = self.scene.buffers();
        let buffers = [meshes, top, &input, &output].map(wgpu::Buffer::as_entire_binding);
        let tree = self.scene.top_level().map(|tree| (0, tree.as_binding()));
        let entries: Vec<_> = (tree.into_iter().chain((1..).zip(buffers)))
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("rays"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(256, (rays.len() as u32).div_ceil(64 * 256), 1);
        drop(pass);
        queue.submit([encoder.finish()]);
        bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(&output))
    }
}

fn instance(mesh: MeshId, world: Affine3A) -> Instance {
    Instance { object: 3, ..Instance::new(mesh, world) }
}

/// Numbers from −1 to 1, the same each time.
fn random(seed: &mut u32) -> f32 {
    *seed += 1;
    noise(*seed) * 2.0 - 1.0
}

fn random3(seed: &mut u32) -> Vec3 {
    vec3(random(seed), random(seed), random(seed))
}

/// A closed sphere of 20 · 4^levels triangles, each vertex moved out by up to `bumps`.
pub fn sphere(levels: u32, bumps: f32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions: Vec<Vec3> = [(-1.0, g, 0.0), (1.0, g, 0.0), (-1.0, -g, 0.0), (1.0, -g, 0.0)]
        .into_iter()
        .flat_map(|(x, y, z): (f32, f32, f32)| [vec3(x, y, z), vec3(z, x, y), vec3(y, z, x)])
        .map(Vec3::normalize)
        .collect();
    // Faces of the icosahedron: triples of nearest neighbours, outwards.
    let near = |a: Vec3, b: Vec3| a != b && a.distance(b) < 1.1;
    let mut indices = Vec::new();
    for i in 0..12usize {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let [a, b, c] = [positions[i], positions[j], positions[k]];
                if near(a, b) && near(b, c) && near(a, c) {
                    let out = (b - a).cross(c - a).dot(a) > 0.0;
                    indices.push(if out { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |i: usize, j: usize| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                positions.push((positions[i] + positions[j]).normalize());
                positions.len() - 1
            })
        };
        indices = indices
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [x, y, z] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, x, z], [x, b, y], [z, y, c], [x, y, z]]
            })
            .collect();
    }
    let mut seed = 7;
    let positions = positions.iter().map(|&p| (p * (1.0 + bumps * random(&mut seed).abs())).to_array()).collect();
    (positions, indices.into_iter().flatten().map(|i| i as u32).collect())
}

/// Holds the GPU's hits against every triangle in f64; returns how many differed, each within the margin of an edge.
fn assert_as_twin(tracer: &Tracer, triangles: &[[DVec3; 3]], owners: &[(u32, u32, bool)], rays: &[GpuRay]) -> usize {
    let closest = tracer.trace(rays, false);
    let any = tracer.trace(rays, true);
    let mut near = 0;
    for ((gpu, hit), any) in rays.iter().zip(&closest).zip(&any) {
        let ray = wide(gpu);
        let expected = twin::closest(&ray, triangles);
        let same = match expected {
            None => hit.instance == MISS && any.instance == MISS && hit.t == gpu.t_max,
            Some(e) => {
                let rounding = 1e-6 * ray.origin.length() / ray.direction.length();
                let close = (f64::from(hit.t) - e.t).abs() <= 1e-4 * e.t + rounding;
                let (instance, triangle, mirrored) = owners[e.triangle];
                let stopped = any.instance != MISS;
                close
                    && stopped
                    && (hit.instance, hit.triangle, hit.front == 1) == (instance, triangle, e.front != mirrored)
            }
        };
        if !same {
            let margin = twin::margin(&ray, triangles);
            assert!(margin < 1e-4, "{gpu:?}\n{hit:?}\n{expected:?} margin {margin}");
            near += 1;
        }
    }
    near
}

/// Shrunk, mirrored, sheared, turned: t is that of the world in all.
#[test]
fn hits_are_those_of_every_triangle_in_f64() {
    on_each_tier(hits_are_those_of_every_triangle_in_f64_on);
}

fn hits_are_those_of_every_triangle_in_f64_on(mut tracer: Tracer) {
    let mut seed = 1;
    let soup: Vec<[f32; 3]> = (0..150)
        .flat_map(|_| {
            let middle = random3(&mut seed);
            [(); 3].map(|()| (middle + 0.3 * random3(&mut seed)).to_array())
        })
        .collect();
    let order: Vec<u32> = (0..soup.len() as u32).collect();
    let (ball, faces) = sphere(1, 0.2);
    let [soup_id, ball_id] = [tracer.add(&soup, &order), tracer.add(&ball, &faces)];
    let tiny = |p: &[[f32; 3]]| -> Vec<[f32; 3]> { p.iter().map(|v| v.map(|c| c * 1e6)).collect() };
    let huge_id = tracer.add(&tiny(&ball), &faces);
    let shear = Mat3::from_cols(vec3(1.0, 0.0, 0.0), vec3(0.7, 1.0, 0.0), vec3(-0.4, 0.2, 1.0));
    let camera = vec3(0.2, -0.1, 0.4);
    let placed = [
        (soup_id, Affine3A::IDENTITY),
        (
            ball_id,
            Affine3A::from_scale_rotation_translation(
                Vec3::splat(0.3),
                Quat::from_rotation_x(1.0),
                vec3(2.0, 0.0, 0.0),
            ),
        ),
        (ball_id, Affine3A::from_mat3_translation(shear, vec3(-2.5, 0.5, 0.0))),
        (ball_id, Affine3A::from_scale_rotation_translation(vec3(-0.5, 0.5, 2.0), Quat::IDENTITY, vec3(0.0, 2.5, 0.0))),
        (huge_id, Affine3A::from_scale_rotation_translation(Vec3::splat(1e-6), Quat::IDENTITY, vec3(0.0, -2.5, 1.0))),
    ];
    tracer.place(&placed, camera);
    let (mut triangles, mut owners) = (Vec::new(), Vec::new());
    for (instance, (mesh, world)) in (0..).zip(placed) {
        let (positions, indices) = match mesh {
            id if id == soup_id => (soup.clone(), &order),
            id if id == ball_id => (ball.clone(), &faces),
            _ => (tiny(&ball), &faces),
        };
        let mirrored = world.matrix3.determinant() < 0.0;
        let world = DAffine3::from_mat3_translation(world.matrix3.as_dmat3(), world.translation.as_dvec3());
        triangles.extend(twin::place(&positions, indices, world, camera.as_dvec3()));
        owners.extend((0..indices.len() as u32 / 3).map(|triangle| (instance, triangle, mirrored)));
    }
    let rays: Vec<_> = (0..20_000)
        .map(|i| {
            let (origin, direction) = (4.0 * random3(&mut seed), random3(&mut seed));
            // Every third is a shadow ray of a limited reach.
            GpuRay { t_max: if i % 3 == 0 { 3.0 } else { 1e30 }, ..ray(origin, direction) }
        })
        .collect();
    let near = assert_as_twin(&tracer, &triangles, &owners, &rays);
    assert!(near <= rays.len() / 1000, "{near} of {} differ near edges", rays.len());
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// Row 14: rays from inside, many of them at vertices and at the middles of edges.
#[test]
fn no_ray_escapes_a_closed_mesh() {
    on_each_tier(no_ray_escapes_a_closed_mesh_on);
}

fn no_ray_escapes_a_closed_mesh_on(mut tracer: Tracer) {
    let (positions, indices) = sphere(4, 0.15);
    let id = tracer.add(&positions, &indices);
    for (scale, shear) in [(1.0, 0.0), (1e-3, 0.6), (1e6, -2.0)] {
        let matrix = Mat3::from_cols(vec3(scale, 0.0, 0.0), vec3(shear * scale, scale, 0.0), vec3(0.0, 0.0, -scale));
        let world = Affine3A::from_mat3_translation(matrix, vec3(0.3, 0.2, -0.1) * scale);
        tracer.place(&[(id, world)], Vec3::ZERO);
        let vertex = |i: usize| world.transform_point3(Vec3::from(positions[indices[i % indices.len()] as usize]));
        let mut seed = 3;
        let inside = |seed: &mut u32| world.transform_point3(random3(seed) * 0.5);
        let rays: Vec<_> = (0..1_000_000)
            .map(|i| {
                let origin = inside(&mut seed);
                let direction = match i % 3 {
                    0 => random3(&mut seed),
                    1 => vertex(i) - origin,
                    _ => (vertex(i) + vertex(i - i % 3 + (i + 1) % 3)) * 0.5 - origin,
                };
                ray(origin, direction)
            })
            .collect();
        // How watertight a ray query is along an edge is the adapter's affair.
        let aimed = |i: &usize| tracer.tier == RayTier::Software || i.is_multiple_of(3);
        let hits = tracer.trace(&rays, false);
        let escaped = (0..hits.len()).filter(aimed).filter(|&i| hits[i].instance == MISS).count();
        assert_eq!(escaped, 0, "of {} at scale {scale}", rays.len());
    }
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// Row 15: rays along the axes from points on the planes of boxes.
#[test]
fn rays_along_axes_meet_what_lies_on_their_planes() {
    let mut tracer = Tracer::new(RayTier::Software);
    // A floor of 16 × 16 quads at whole coordinates, as two triangles each.
    let positions: Vec<_> = (0..17 * 17).map(|i| [(i % 17) as f32, 0.0, (i / 17) as f32]).collect();
    let quad = |i: u32| {
        let at = i / 16 * 17 + i % 16;
        [at, at + 1, at + 17, at + 1, at + 18, at + 17]
    };
    let indices: Vec<_> = (0..256).flat_map(quad).collect();
    let id = tracer.add(&positions, &indices);
    tracer.place(&[(id, Affine3A::IDENTITY)], Vec3::ZERO);
    let corner = |i: u32| vec3((i % 17) as f32, 0.0, (i / 17) as f32);
    let down: Vec<_> = (0..17 * 17).map(|i| ray(corner(i) + Vec3::Y * 5.0, -Vec3::Y)).collect();
    let up: Vec<_> = (0..17 * 17).map(|i| ray(corner(i) - Vec3::Y * 3.0, Vec3::Y)).collect();
    assert!(tracer.trace(&down, false).iter().all(|hit| hit.t == 5.0), "down");
    assert!(tracer.trace(&up, true).iter().all(|hit| hit.t == 3.0), "up");
    // Along the floor there is nothing to hit, from its plane or beside it.
    let along: Vec<_> = (0..17).map(|i| ray(vec3(-1.0, 0.0, i as f32), Vec3::X)).collect();
    assert!(tracer.trace(&along, false).iter().all(|hit| hit.instance == MISS), "along");
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// Row 15: the same among closed boxes, against the twin: through their corners, along their edges and faces, from
/// points on their planes, with directions of many lengths. Whole and half coordinates are exact, so t is, too.
#[test]
fn rays_along_axes_are_those_of_the_twin() {
    let mut tracer = Tracer::new(RayTier::Software);
    let positions: Vec<_> = (0..8).map(|i| [0, 1, 2].map(|axis| (i >> axis & 1) as f32)).collect();
    let indices: [u32; 36] =
        [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
    let id = tracer.add(&positions, &indices);
    let quarter = Mat3::from_cols(Vec3::Y, -Vec3::X, Vec3::Z);
    let placed: Vec<_> = (0..27)
        .map(|i| {
            let at = vec3((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 3.0;
            let turned = if i % 2 == 0 { Mat3::IDENTITY } else { quarter };
            (id, Affine3A::from_mat3_translation(turned * 2f32.powi(i % 3 - 1), at))
        })
        .collect();
    tracer.place(&placed, Vec3::ZERO);
    let triangles: Vec<_> = placed
        .iter()
        .flat_map(|(_, world)| {
            let world = DAffine3::from_mat3_translation(world.matrix3.as_dmat3(), world.translation.as_dvec3());
            twin::place(&positions, &indices, world, DVec3::ZERO)
        })
        .collect();
    let mut seed = 5;
    let rays: Vec<_> = (0..12_000)
        .map(|i: u32| {
            let origin = [(); 3].map(|()| (random(&mut seed) * 10.0).round() * 0.5 + 3.5);
            let direction = [Vec3::X, Vec3::Y, Vec3::Z][i as usize % 3] * if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            ray(Vec3::from(origin), direction * [1.0, 9.5e-7, 1_048_576.0][i as usize / 6 % 3])
        })
        .collect();
    let [closest, any] = [false, true].map(|any| tracer.trace(&rays, any));
    let mut met = 0;
    for ((gpu, hit), any) in rays.iter().zip(&closest).zip(&any) {
        let ray = wide(gpu);
        let expected = twin::closest(&ray, &triangles).map(|e| e.t);
        assert_eq!(any.instance != MISS, expected.is_some(), "{gpu:?}: {hit:?}, {expected:?}");
        let found = (hit.instance != MISS).then_some(f64::from(hit.t));
        let near = found.zip(expected).is_none_or(|(a, b)| (a - b).abs() <= 1e-6 * b);
        assert!(found.is_some() == expected.is_some() && near, "{gpu:?}: {hit:?}, {expected:?}");
        met += usize::from(found.is_some());
    }
    assert!(met > 2000 && met < 10_000, "{met}");
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// Row 16: a third of the triangles has no area, and no ray notices.
#[test]
fn triangles_without_area_change_no_hit() {
    on_each_tier(|mut tracer| {
        let (positions, indices) = sphere(3, 0.2);
        let mut padded = Vec::new();
        let mut own = Vec::new();
        for (i, triangle) in (0..).zip(indices.chunks(3)) {
            if i % 2 == 0 {
                let [a, b] = [triangle[0], triangle[1]];
                padded.extend([[a, a, a], [a, b, a], [b, b, a]][i / 2 % 3]);
            }
            own.push((padded.len() / 3) as u32);
            padded.extend(triangle);
        }
        let mesh = Mesh { name: "mesh", positions: &positions, indices: &padded, attributes: &[], masked: false };
        let dropped = BottomLevel::build(&mesh).unwrap().dropped() as usize;
        assert_eq!(dropped, (padded.len() - indices.len()) / 3);
        let [plain, other] = [tracer.add(&positions, &indices), tracer.add(&positions, &padded)];
        let mut seed = 13;
        let rays: Vec<_> = (0..100_000).map(|_| ray(2.0 * random3(&mut seed), random3(&mut seed))).collect();
        let [plain, other] = [plain, other].map(|mesh| {
            tracer.place(&[(mesh, Affine3A::IDENTITY)], Vec3::ZERO);
            tracer.trace(&rays, false)
        });
        let mut differ = 0;
        for (a, b) in plain.iter().zip(&other) {
            assert_eq!((a.t, a.instance), (b.t, b.instance), "{a:?} {b:?}");
            // On an edge either triangle may be named.
            differ += usize::from(a.instance != MISS && own[a.triangle as usize] != b.triangle);
        }
        assert!(differ <= 2, "{differ}");
        assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
    });
}

/// Row 16, and scenes of nothing, one triangle, and many.
#[test]
fn empty_scenes_single_triangles_and_degenerate_ones() {
    on_each_tier(empty_scenes_single_triangles_and_degenerate_ones_on);
}

fn empty_scenes_single_triangles_and_degenerate_ones_on(mut tracer: Tracer) {
    let forward = [ray(vec3(0.2, 0.2, 1.0), -Vec3::Z)];
    tracer.place(&[], Vec3::ZERO);
    assert_eq!(tracer.trace(&forward, false)[0].instance, MISS);
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    let none = tracer.add(&[], &[]);
    tracer.place(&[(none, Affine3A::IDENTITY)], Vec3::ZERO);
    assert_eq!(tracer.trace(&forward, false)[0].instance, MISS);
    let one = tracer.add(&corners, &[0, 1, 2]);
    // The empty mesh keeps its place among the instances.
    tracer.place(&[(none, Affine3A::IDENTITY), (one, Affine3A::IDENTITY)], Vec3::ZERO);
    let hit = tracer.trace(&forward, false)[0];
    assert_eq!((hit.t, hit.instance, hit.triangle, hit.front), (1.0, 1, 0, 1));
    let padded = tracer.add(&corners, &[0, 1, 3, 2, 2, 2, 0, 1, 2]);
    tracer.place(&[(padded, Affine3A::IDENTITY)], Vec3::ZERO);
    let again = tracer.trace(&forward, false)[0];
    assert_eq!((again.t, again.triangle, again.barycentrics), (hit.t, 2, hit.barycentrics));
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// A transform that can't be undone is refused, by the instance and its mesh, and the frame before stays.
#[test]
fn instances_that_cannot_be_traced_are_refused() {
    let mut tracer = Tracer::new(RayTier::Software);
    let id = tracer.add(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[0, 1, 2]);
    tracer.place(&[(id, Affine3A::IDENTITY)], Vec3::ZERO);
    let mut refused = |world| {
        let instances = [instance(id, Affine3A::IDENTITY), instance(id, world)];
        tracer.update(&instances, Vec3::ZERO).unwrap_err()
    };
    assert_snapshot!(refused(Affine3A::from_scale(vec3(1.0, 0.0, 1.0))), @"instance 1 (mesh 'mesh') has a transform that flattens it; leave it out of the frame's instances");
    assert_snapshot!(refused(Affine3A::from_translation(vec3(f32::NAN, 0.0, 0.0))), @"instance 1 (mesh 'mesh') has a transform that is not finite; leave it out of the frame's instances");
    assert_snapshot!(refused(Affine3A::from_scale(Vec3::splat(1e-20))), @"instance 1 (mesh 'mesh') has a transform that shrinks or moves it too far; leave it out of the frame's instances");
    assert_eq!(tracer.trace(&[ray(vec3(0.2, 0.2, 1.0), -Vec3::Z)], false)[0].t, 1.0);
    tracer.scene = RayScene::new(&tracer.gpu.device, RayTier::Software);
    let other = tracer.update(&[instance(id, Affine3A::IDENTITY)], Vec3::ZERO);
    assert!(matches!(other, Err(RayError::NoMesh { instance: 0, mesh: 0, meshes: 0 })), "{other:?}");
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// Moving instances leaves every buffer where it is, once there was room for them.
#[test]
fn a_steady_frame_keeps_its_buffers() {
    on_each_tier(a_steady_frame_keeps_its_buffers_on);
}

fn a_steady_frame_keeps_its_buffers_on(mut tracer: Tracer) {
    let (positions, indices) = sphere(0, 0.0);
    let id = tracer.add(&positions, &indices);
    let at = |frame: f32| -> Vec<_> {
        (0..1000).map(|i| (id, Affine3A::from_translation(vec3(i as f32 * 3.0, frame, 0.0)))).collect()
    };
    tracer.place(&at(0.0), Vec3::ZERO);
    let (generation, bytes) = (tracer.scene.generation(), tracer.scene.bytes());
    for frame in 1..4 {
        tracer.place(&at(frame as f32), Vec3::ZERO);
        let hit = tracer.trace(&[ray(vec3(2997.0, 50.0, 0.0), -Vec3::Y)], false)[0];
        assert_eq!(hit.instance, 999);
        assert!((hit.t - (50.0 - frame as f32 - 1.0)).abs() < 0.2, "{hit:?}");
    }
    assert_eq!((tracer.scene.generation(), tracer.scene.bytes()), (generation, bytes));
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// Row 18: the scene and the camera moved far from the origin.
#[test]
fn a_world_far_away_is_traced_alike() {
    on_each_tier(a_world_far_away_is_traced_alike_on);
}

fn a_world_far_away_is_traced_alike_on(mut tracer: Tracer) {
    let (positions, indices) = sphere(2, 0.1);
    let id = tracer.add(&positions, &indices);
    let mut seed = 11;
    let rays: Vec<_> = (0..4096).map(|_| ray(3.0 * random3(&mut seed), random3(&mut seed))).collect();
    let mut hits = [0.0, 131_072.0].map(|far| {
        let away = Vec3::splat(far);
        // Turned and stretched, so that its own coordinates round.
        let turned = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.3);
        let world = Affine3A::from_scale_rotation_translation(vec3(0.7, 1.1, 0.9), turned, away + Vec3::X);
        tracer.place(&[(id, world)], away);
        tracer.trace(&rays, false)
    });
    let [near, far] = &mut hits;
    assert!(near.iter().any(|hit| hit.instance == 0) && near.iter().any(|hit| hit.instance == MISS));
    assert_eq!(near, far);
    assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
}

/// The holes of a masked mesh, and the back faces of the object that a ray passes through, against the twin without
/// them.
#[test]
fn holes_and_back_faces_let_rays_through() {
    on_each_tier(|mut tracer| {
        // A square at z = 0 with a checker of holes, before a plain one at z = −1; both are seen from the front.
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let attributes = square.map(|[u, v, _]| Attributes {
            normal: [0.0, 0.0, 1.0],
            tangent: [1.0, 0.0, 0.0, 1.0],
            uv: [u, v],
            // A quarter at one edge, three at the other.
            user: if u == 0.0 { 0x40 } else { 0xc0 },
        });
        let [grid, plain] = [true, false].map(|masked| {
            let mesh = Mesh {
                name: "square",
                positions: &square,
                indices: &[0, 1, 2, 0, 2, 3],
                attributes: &attributes,
                masked,
            };
            let built = BottomLevel::build(&mesh).unwrap();
            let mut encoder = tracer.gpu.device.create_command_encoder(&Default::default());
            let id = tracer.scene.add(&tracer.gpu.device, &tracer.gpu.queue, &mut encoder, &built).unwrap();
            tracer.gpu.queue.submit([encoder.finish()]);
            id
        });
        let behind = Affine3A::from_translation(vec3(0.0, 0.0, -1.0));
        tracer.place(&[(grid, Affine3A::IDENTITY), (plain, behind)], Vec3::ZERO);
        let cells: Vec<(u32, u32)> = (0..64).map(|i| (i % 8, i / 8)).collect();
        let rays: Vec<_> = cells
            .iter()
            .map(|&(x, y)| ray(vec3((x as f32 + 0.5) / 8.0, (y as f32 + 0.4) / 8.0, 2.0), -Vec3::Z))
            .collect();
        let open = |(x, y): &(u32, u32)| (x ^ y) & 1 == 1 || *x < 4;
        for (hit, cell) in tracer.trace(&rays, false).iter().zip(&cells) {
            assert_eq!((hit.instance, hit.t.round()), if open(cell) { (1, 3.0) } else { (0, 2.0) }, "{cell:?}");
        }
        let short: Vec<_> = rays.iter().map(|r| GpuRay { t_max: 2.5, ..*r }).collect();
        for (hit, cell) in tracer.trace(&short, true).iter().zip(&cells) {
            assert_eq!(hit.instance == MISS, open(cell), "{cell:?}");
        }
        // From behind, both are of the object that counts from the front alone, then of another.
        let backwards: Vec<_> =
            rays.iter().map(|r| GpuRay { origin: r.origin - Vec3::Z * 5.0, direction: Vec3::Z, ..*r }).collect();
        let stopped = |rays: &[GpuRay], tracer: &Tracer| {
            let hits = tracer.run(rays, &tracer.pipelines[2]);
            hits.iter().filter(|hit| hit.instance != MISS).count()
        };
        assert_eq!(stopped(&rays, &tracer), 64);
        assert_eq!(stopped(&backwards, &tracer), 0);
        let others = [(grid, Affine3A::IDENTITY), (plain, behind)]
            .map(|(mesh, world)| Instance { object: 4, ..instance(mesh, world) });
        tracer.update(&others, Vec3::ZERO).unwrap();
        assert_eq!(stopped(&backwards, &tracer), 64);
        assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
    });
}

/// Culled back faces are not seen but cast shadows; what casts none is seen. Mirrored instances keep their front.
#[test]
fn flags_of_instances_say_which_rays_they_stop() {
    on_each_tier(|mut tracer| {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = tracer.add(&square, &[0, 1, 2, 0, 2, 3]);
        let at = |x: f32, flipped: f32| {
            Affine3A::from_scale_rotation_translation(vec3(1.0, 1.0, flipped), Quat::IDENTITY, vec3(x, 0.0, 0.0))
        };
        let plain = |x, flipped| instance(mesh, at(x, flipped));
        let placed = [
            plain(0.0, 1.0),
            Instance { culled: true, ..plain(2.0, 1.0) },
            Instance { culled: true, ..plain(4.0, -1.0) },
            Instance { casts_shadow: false, ..plain(6.0, 1.0) },
        ];
        tracer.update(&placed, Vec3::ZERO).unwrap();
        let from = |z: f32| [0.5, 2.5, 4.5, 6.5].map(|x| ray(vec3(x, 0.25, z), vec3(0.0, 0.0, -z)));
        let hit = |z: f32, pipeline: usize| -> Vec<bool> {
            tracer.run(&from(z), &tracer.pipelines[pipeline]).iter().map(|hit| hit.instance != MISS).collect()
        };
        // A flip turns the side on which the vertices run counterclockwise in the world, but not in the mesh.
        for (pipeline, front, back) in [
            (0, [true; 4], [true; 4]),
            (3, [true, true, false, true], [true, false, true, true]),
            (4, [true, true, true, false], [true, true, true, false]),
        ] {
            assert_eq!(hit(1.0, pipeline), front, "{:?}, {pipeline}", tracer.tier);
            assert_eq!(hit(-1.0, pipeline), back, "{:?}, {pipeline}", tracer.tier);
        }
        assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
    });
}

/// A top level that a host built itself, in the world, over bottom levels of its own.
#[test]
fn a_hosts_own_top_level_is_traced_alike() {
    on_each_tier(|mut tracer| {
        // A triangle without an area in the midst: those after it keep their numbers.
        let (mut positions, mut indices) = sphere(2, 0.2);
        indices.splice(30..30, [5, 5, 6]);
        let square = [[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [2.0, 0.0, 2.0], [-2.0, 0.0, 2.0]];
        let floor = [0, 2, 1, 0, 3, 2];
        let ids = [tracer.add(&positions, &indices), tracer.add(&[], &[]), tracer.add(&square, &floor)];
        let turned = Affine3A::from_scale_rotation_translation(
            vec3(1.0, -0.5, 2.0),
            Quat::from_rotation_y(0.7),
            vec3(10.5, 1.0, -4.0),
        );
        let placed = [
            (ids[0], turned),
            (ids[1], Affine3A::IDENTITY),
            (ids[2], Affine3A::from_translation(vec3(10.0, -1.0, -4.0))),
            (ids[0], Affine3A::from_translation(vec3(12.0, 0.0, -5.0))),
        ];
        let camera = vec3(10.0, 0.5, -3.0);
        let instances = placed.map(|(mesh, world)| instance(mesh, world));
        let mut seed = 7;
        let rays: Vec<_> = (0..4096).map(|_| ray(random3(&mut seed) * 6.0, random3(&mut seed))).collect();
        tracer.update(&instances, camera).unwrap();
        let own = tracer.trace(&rays, false);
        let generation = tracer.scene.generation();
        let Gpu { device, queue, .. } = tracer.gpu.clone();
        if tracer.tier == RayTier::Software {
            return;
        }
        let blas = |positions: &[[f32; 3]], indices: &[u32]| {
            use wgpu::util::DeviceExt;
            let usage = wgpu::BufferUsages::BLAS_INPUT;
            let buffer = |contents| {
                device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
            };
            let size = wgpu::BlasTriangleGeometrySizeDescriptor {
                vertex_format: wgpu::VertexFormat::Float32x3,
                vertex_count: positions.len() as u32,
                index_format: Some(wgpu::IndexFormat::Uint32),
                index_count: Some(indices.len() as u32),
                flags: wgpu::AccelerationStructureGeometryFlags::OPAQUE,
            };
            let blas = device.create_blas(
                &wgpu::CreateBlasDescriptor {
                    label: None,
                    flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
                    update_mode: wgpu::AccelerationStructureUpdateMode::Build,
                },
                wgpu::BlasGeometrySizeDescriptors::Triangles { descriptors: vec![size.clone()] },
            );
            let (vertices, index_buffer) =
                (buffer(bytemuck::cast_slice(positions)), buffer(bytemuck::cast_slice(indices)));
            let geometry = wgpu::BlasTriangleGeometry {
                size: &size,
                vertex_buffer: &vertices,
                first_vertex: 0,
                vertex_stride: 12,
                index_buffer: Some(&index_buffer),
                first_index: Some(0),
                transform_buffer: None,
                transform_buffer_offset: None,
            };
            let geometry = wgpu::BlasGeometries::TriangleGeometries(vec![geometry]);
            let mut encoder = device.create_command_encoder(&Default::default());
            encoder.build_acceleration_structures([&wgpu::BlasBuildEntry { blas: &blas, geometry }], []);
            queue.submit([encoder.finish()]);
            blas
        };
        // Vertices of its own, as long as the triangles have the same order.
        positions.push([0.0; 3]);
        let bottom = [Some(blas(&positions, &indices)), None, Some(blas(&square, &floor))];
        let mut top = device.create_tlas(&wgpu::CreateTlasDescriptor {
            label: None,
            max_instances: 8,
            flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
            update_mode: wgpu::AccelerationStructureUpdateMode::Build,
        });
        for (i, (mesh, world)) in placed.iter().enumerate() {
            let bottom = bottom[ids.iter().position(|id| id == mesh).unwrap()].as_ref();
            let rows = Mat3::from(world.matrix3).transpose();
            let row = |r: usize| [rows.col(r).x, rows.col(r).y, rows.col(r).z, world.translation[r]];
            let rows: Vec<f32> = [row(0), row(1), row(2)].concat();
            top[7 - i] = bottom.map(|b| wgpu::TlasInstance::new(b, rows.try_into().unwrap(), i as u32, 0xff));
        }
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.build_acceleration_structures([], [&top]);
        queue.submit([encoder.finish()]);
        tracer.scene.update_with(&device, &queue, &top, &instances, camera).unwrap();
        assert_ne!(tracer.scene.generation(), generation, "to be bound anew");
        let theirs = tracer.trace(&rays, false);
        let mut hits = 0;
        for (a, b) in own.iter().zip(&theirs) {
            assert_eq!((a.instance, a.triangle, a.front), (b.instance, b.triangle, b.front));
            assert!((a.t - b.t).abs() <= 1e-4 * a.t.abs());
            hits += u32::from(a.instance != MISS);
        }
        assert!(hits > 200, "{hits}");
        // A steady frame keeps it, and our own takes over again.
        let generation = tracer.scene.generation();
        tracer.scene.update_with(&device, &queue, &top, &instances, camera).unwrap();
        assert_eq!(tracer.scene.generation(), generation);
        tracer.update(&instances, camera).unwrap();
        assert_eq!(tracer.trace(&rays, false), own);
        assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
    });
    let mut software = Tracer::new(RayTier::Software);
    if let Ok(adapter) = gpu::choose(None)
        && adapter.features().contains(rays::QUERY_FEATURES)
    {
        let query = Tracer::new(RayTier::Query);
        let top = query.scene.top_level().unwrap();
        let Gpu { device, queue, .. } = &software.gpu.clone();
        let refused = software.scene.update_with(device, queue, top, &[], Vec3::ZERO).unwrap_err();
        assert_snapshot!(refused, @"a top level of the host's own can only be traced by RayTier::Query; use RayScene::update");
    }
}
