//! Random meshes, instances and rays on both tiers: each hit is one that the twin finds for the ray, or for a ray as
//! near as rounding moves it.

use super::Campaign;
use super::random::Random;
use crate::rays::{GpuHit, GpuRay, MISS, Tracer, sphere, wide};
use crate::visibility::{adapter, distance};
use deferred_aa::glam::{Affine3A, DAffine3, DVec3, Mat3, Vec3};
use deferred_aa::rays::{QUERY_FEATURES, RayScene, RayTier};
use deferred_aa::reference::rays::{self as twin, Ray};
use std::time::Duration;

pub const CAMPAIGN: Campaign = Campaign {
    name: "rays",
    share: 0.1,
    few: 16,
    limit: Duration::from_secs(60),
    start: || {
        let mut tracers = vec![Tracer::new(RayTier::Software)];
        if adapter().features().contains(QUERY_FEATURES) {
            tracers.push(Tracer::new(RayTier::Query));
        } else {
            eprintln!("skipped: the adapter has no ray query");
        }
        Box::new(move |seed| {
            let world = World::new(&mut Random::new(seed));
            tracers.iter_mut().map(|tracer| world.check(tracer, seed)).sum()
        })
    },
};

const RAYS: usize = 1000;

/// Positions and indices.
type Soup = (Vec<[f32; 3]>, Vec<u32>);

struct Mesh {
    positions: Vec<[f32; 3]>,
    indices: Vec<u32>,
    /// The length of the mesh's own unit; instances undo it.
    unit: f32,
}

/// Instances of meshes, and their triangles relative to the camera.
struct World {
    meshes: Vec<Mesh>,
    placed: Vec<(usize, Affine3A)>,
    camera: Vec3,
    triangles: Vec<[DVec3; 3]>,
    /// The instance and the triangle in its mesh, and whether the instance mirrors.
    owners: Vec<(u32, u32, bool)>,
    /// The greatest distance of a vertex from the camera.
    extent: f64,
}

impl World {
    fn new(random: &mut Random) -> Self {
        let scale = random.pick(&[1.0, 1.0, 1e-3, 1e3]) * random.magnitude(0.1, 10.0);
        let meshes: Vec<Mesh> = (0..1 + random.below(3)).map(|_| mesh(random)).collect();
        let camera = random.vector() * scale;
        let placed: Vec<_> = (0..1 + random.below(5))
            .map(|_| {
                let mesh = random.below(meshes.len() as u32) as usize;
                (mesh, transform(random, scale, meshes[mesh].unit))
            })
            .collect();
        let mut world =
            Self { meshes, placed, camera, triangles: Vec::new(), owners: Vec::new(), extent: f64::from(scale) };
        world.list();
        world
    }

    fn list(&mut self) {
        for (instance, &(mesh, at)) in (0..).zip(&self.placed) {
            let Mesh { positions, indices, .. } = &self.meshes[mesh];
            let mirrored = at.matrix3.determinant() < 0.0;
            let at = DAffine3::from_mat3_translation(at.matrix3.as_dmat3(), at.translation.as_dvec3());
            self.triangles.extend(twin::place(positions, indices, at, self.camera.as_dvec3()));
            self.owners.extend((0..indices.len() as u32 / 3).map(|triangle| (instance, triangle, mirrored)));
        }
        let lengths = self.triangles.iter().flatten().map(|v| v.length());
        self.extent = lengths.fold(self.extent, f64::max);
    }

    /// Traces rays and holds them against the twin; returns how many.
    fn check(&self, tracer: &mut Tracer, seed: u32) -> u64 {
        tracer.scene = RayScene::new(&tracer.gpu.device, tracer.tier);
        let ids: Vec<_> = self.meshes.iter().map(|mesh| tracer.add(&mesh.positions, &mesh.indices)).collect();
        let placed: Vec<_> = self.placed.iter().map(|&(mesh, at)| (ids[mesh], at)).collect();
        tracer.place(&placed, self.camera);
        let mut random = Random::new(!seed);
        let rays: Vec<_> = (0..RAYS).map(|_| self.ray(&mut random)).collect();
        let (closest, any) = (tracer.trace(&rays, false), tracer.trace(&rays, true));
        // How watertight a ray query is along an edge, and how exact, is the adapter's affair.
        let is_query = tracer.tier == RayTier::Query;
        for ((ray, hit), any) in rays.iter().zip(&closest).zip(&any) {
            let told = format!("{:?}, {ray:?}: {hit:?}, any {any:?}", tracer.tier);
            assert!(hit.instance != MISS || hit.t == ray.t_max, "{told}");
            assert!(
                self.explains(&mut random, ray, hit, if is_query { (256.0, 4.0) } else { (16.0, 1.0) })
                    || is_query && twin::margin(&wide(ray), &self.triangles) < 1e-4,
                "{told}, twin {}",
                self.twins(ray)
            );
            assert!(hit.instance == any.instance || self.is_torn(&mut random, ray, hit, any), "{told}");
        }
        assert_eq!(tracer.gpu.take_errors(), Vec::<String>::new());
        rays.len() as u64
    }

    /// What the twin says of a ray, with how high the triangle looks, in roundings.
    fn twins(&self, ray: &GpuRay) -> String {
        let (wide, rounding) = (wide(ray), self.rounding(ray));
        let Some(hit) = twin::closest(&wide, &self.triangles) else { return "misses".into() };
        let triangle = self.triangles[hit.triangle];
        let height = height(triangle, wide.direction) / rounding;
        format!("{hit:?}, {height:.0} roundings high, {triangle:?} of {:?}", self.owners[hit.triangle])
    }

    /// A ray from anywhere; most are aimed at triangles, some at their vertices and edges.
    fn ray(&self, random: &mut Random) -> GpuRay {
        let extent = self.extent as f32;
        let origin = random.vector() * extent * random.pick(&[0.1, 1.0, 1.5]);
        let corners = random.pick(&self.triangles).map(|v| v.as_vec3());
        let way = match random.below(6) {
            0 => random.vector() * extent,
            1 => corners[0] - origin,
            2 => corners[0].midpoint(corners[1]) - origin,
            _ => {
                let [a, b] = [random.unit(), random.unit()];
                corners[0].lerp(corners[1], a).lerp(corners[2], b) - origin
            }
        };
        let direction = way.try_normalize().unwrap_or(Vec3::X) * random.magnitude(0.01, 100.0);
        let reach = if random.once_in(3) { random.within(0.1, 2.0) * extent / direction.length() } else { 1e30 };
        GpuRay { origin, t_min: 0.0, direction, t_max: reach }
    }

    /// Whether the twin explains a hit: nothing is there, for the ray or one beside it, or the triangle is where the ray
    /// passes and nothing covers it. Triangles that look thinner than `thin` roundings may be missed, or hit anywhere;
    /// `beyond` roundings within its edge a triangle may be missed.
    fn explains(&self, random: &mut Random, ray: &GpuRay, hit: &GpuHit, (thin, beyond): (f64, f64)) -> bool {
        let (wide, rounding) = (wide(ray), self.rounding(ray));
        let own = self.owners.iter().position(|owner| (owner.0, owner.1) == (hit.instance, hit.triangle));
        let reach = match own {
            Some(own) if self.is_beside(&wide, hit, own, rounding, thin) => {
                f64::from(hit.t) - self.error(&wide, hit, own, thin)
            }
            Some(_) => return false,
            None if hit.instance == MISS => wide.t_max,
            None => return false,
        };
        let is_free = |ray: &Ray| twin::closest(ray, &self.triangles).is_none_or(|nearest| nearest.t >= reach);
        is_free(&wide)
            || (0..400).any(|_| is_free(&beside(random, &wide, beyond * rounding)))
            || self.is_thin(&wide, thin * rounding)
    }

    /// How far rounding moves a ray or a vertex.
    fn rounding(&self, ray: &GpuRay) -> f64 {
        1e-6 * self.extent.max(ray.origin.length().into())
    }

    /// What `thin` roundings do to t at a triangle: more where the ray grazes it.
    fn error(&self, ray: &Ray, hit: &GpuHit, own: usize, thin: f64) -> f64 {
        let slope = normal(self.triangles[own]).dot(ray.direction).abs().max(1e-9);
        1e-4 * f64::from(hit.t) + 6e-7 * thin * self.extent / slope
    }

    /// Whether triangle `own` lies where the hit says, and faces as it says, unless it looks thinner than `thin` roundings.
    fn is_beside(&self, ray: &Ray, hit: &GpuHit, own: usize, rounding: f64, thin: f64) -> bool {
        let (triangle, normal) = (self.triangles[own], normal(self.triangles[own]));
        let slope = normal.dot(ray.direction);
        let t = normal.dot(triangle[0] - ray.origin) / slope;
        let edge_on = height(triangle, ray.direction) < thin * rounding;
        // As seen along the ray, whose line is a point then.
        let beside_line = distance(DVec3::ZERO, triangle.map(|v| (v - ray.origin).reject_from(ray.direction)));
        beside_line <= 4.0 * rounding
            && (edge_on
                || (f64::from(hit.t) - t).abs() <= self.error(ray, hit, own, thin)
                    && (hit.front == 1) == ((slope < 0.0) != self.owners[own].2))
    }

    /// Whether a triangle that the ray hits looks thinner than that.
    fn is_thin(&self, ray: &Ray, most: f64) -> bool {
        self.triangles
            .iter()
            .any(|&triangle| twin::closest(ray, &[triangle]).is_some() && height(triangle, ray.direction) < most)
    }

    /// Whether the nearest and any hit may disagree on whether there is one: near an edge, or at the reach.
    fn is_torn(&self, random: &mut Random, ray: &GpuRay, hit: &GpuHit, any: &GpuHit) -> bool {
        if (hit.instance == MISS) == (any.instance == MISS) {
            return true;
        }
        let (wide, error) = (wide(ray), self.rounding(ray));
        let beside: Vec<_> =
            (0..100).map(|_| twin::closest(&beside(random, &wide, error), &self.triangles).is_some()).collect();
        beside.contains(&true) && beside.contains(&false)
    }
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The least height of a triangle as seen along a direction.
fn height(triangle: [DVec3; 3], along: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|v| v.reject_from(along));
    let longest = [b - a, c - b, a - c].map(DVec3::length).into_iter().fold(0.0, f64::max);
    (b - a).cross(c - a).length() / longest.max(f64::MIN_POSITIVE)
}

/// A ray whose origin and end are off by up to `error`.
fn beside(random: &mut Random, ray: &Ray, error: f64) -> Ray {
    let shift = random.vector().as_dvec3() * error;
    let turn = random.vector().as_dvec3() * 2e-7 * ray.direction.length();
    let nudge = f64::from(random.within(-1.0, 1.0)) * 1e-6;
    Ray { origin: ray.origin + shift, direction: ray.direction + turn, t_max: ray.t_max * (1.0 + nudge), ..*ray }
}

fn transform(random: &mut Random, scale: f32, unit: f32) -> Affine3A {
    let mut size = Vec3::splat(random.magnitude(0.2, 1.0));
    if random.once_in(2) {
        size = Vec3::from_array([(); 3].map(|()| random.magnitude(0.02, 1.0) * random.pick(&[1.0, -1.0])));
    }
    let shear = if random.once_in(3) { random.within(-2.0, 2.0) } else { 0.0 };
    let sheared = Mat3::from_cols(Vec3::X, Vec3::new(shear, 1.0, 0.0), Vec3::Z);
    let matrix = Mat3::from_quat(random.rotation()) * sheared * Mat3::from_diagonal(size * (scale / unit));
    Affine3A::from_mat3_translation(matrix, random.vector() * scale * random.pick(&[0.0, 1.0, 3.0]))
}

fn mesh(random: &mut Random) -> Mesh {
    let (mut positions, mut indices) = match random.below(4) {
        0 => triangles(random, 0.4),
        1 => triangles(random, 0.003),
        2 => sphere(random.below(2), 0.3),
        _ => grid(random),
    };
    if random.once_in(3) {
        // Triangles without an area among the others.
        let at = 3 * random.below(indices.len() as u32 / 3) as usize;
        let corner = indices[at];
        indices.splice(at..at, [corner, corner, indices[at + 1]]);
    }
    let unit = random.pick(&[1.0, 1.0, 1e-4, 1e4]);
    positions.iter_mut().flatten().for_each(|c| *c *= unit);
    Mesh { positions, indices, unit }
}

/// Triangles apart from each other; slivers where `width` is little.
fn triangles(random: &mut Random, width: f32) -> Soup {
    let count = 1 + random.below(60);
    let triangle = |_| {
        let [at, along] = [random.vector(), random.vector()];
        let aside = random.vector() * width;
        [at, at + along * 0.7, at + along * random.unit() + aside].map(|v| v.to_array())
    };
    let positions: Vec<_> = (0..count).flat_map(triangle).collect();
    (positions, (0..count * 3).collect())
}

/// Bumpy ground of shared edges, some of them along the axes.
fn grid(random: &mut Random) -> Soup {
    let side = 2 + random.below(5);
    let bump = random.pick(&[0.0, 0.2]);
    let at = |i: u32| (i as f32 / (side - 1) as f32) * 2.0 - 1.0;
    let positions = (0..side * side).map(|i| [at(i % side), random.within(-bump, bump), at(i / side)]).collect();
    let quad = |i: u32| {
        let at = i / (side - 1) * side + i % (side - 1);
        [at, at + 1, at + side, at + 1, at + side + 1, at + side]
    };
    (positions, (0..(side - 1) * (side - 1)).flat_map(quad).collect())
}
