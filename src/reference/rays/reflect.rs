//! Twin of `shaders/rays/reflect.wgsl`: the radiance that a sample reflects and refracts, with every triangle of the
//! scene tested.

use super::trace::{self, MARGIN};
use super::{Hit, Ray};
use crate::rays::Attributes as VertexAttributes;
use crate::reference::{octahedral, rays, resolve, triangle};
use glam::{DAffine3, DVec2, DVec3, DVec4};

/// The input of the pass. No mesh is masked.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The G-buffer's depth and normals, the camera, the lights, and the triangles with their owners.
    pub trace: &'a trace::Input<'a>,
    /// The third colour target.
    pub uv: &'a [[u32; 4]],
    /// The number of samples along one side of a window.
    pub m: u32,
    /// The attributes of each triangle of `trace`, see [`place`].
    pub attributes: &'a [Attributes],
    /// The materials that send rays: [`Needs::reflective`](crate::Needs::reflective).
    pub reflective: &'a [u32],
    /// Whether reflected rays and whether refracted rays are traced.
    pub kinds: [bool; 2],
    /// The host's function `reflection`.
    pub reflect: &'a dyn Fn(&Sample) -> Reflect,
    /// The host's function `shade`.
    pub shade: &'a dyn Fn(&Sample) -> [f64; 4],
    /// The host's function `sky`.
    pub sky: &'a dyn Fn(&Sample) -> [f64; 4],
}

/// The attributes of a triangle from which its hits are shaded, in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attributes {
    /// The normals on the triangle's front. They are interpolated with the lengths that the instance's transform gives
    /// them.
    pub normals: [DVec3; 3],
    /// The tangents. They are interpolated with the lengths that the instance's transform gives them.
    pub tangents: [DVec3; 3],
    /// The sign of the bitangent on the triangle's front.
    pub bitangent: f64,
    /// The texture coordinates.
    pub uvs: [DVec2; 3],
    /// The material of the instance.
    pub material: u32,
    /// The host's 32 bits of the vertices.
    pub user: [u32; 3],
}

/// `DaaSample`, as far as the pass fills it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Position in world space.
    pub position: DVec3,
    /// Depth along the view direction, or for the hit of a ray the distance along the ray. 0 for the sky.
    pub depth: f64,
    /// Position relative to the camera.
    pub relative_position: DVec3,
    /// Index of the material.
    pub material: u32,
    /// Unit vector towards the viewer.
    pub view: DVec3,
    /// Id of the object.
    pub object: u32,
    /// Unit normal of the triangle, on the visible side.
    pub geometric_normal: DVec3,
    /// The host's own 32 bits.
    pub user: u32,
    /// Unit interpolated normal.
    pub normal: DVec3,
    /// Shadow bits: bit i is set if light i does not reach it. 0 for samples of the G-buffer.
    pub shadow: u32,
    /// Unit tangent and the sign of the bitangent.
    pub tangent: DVec4,
    /// Texture coordinates.
    pub uv: DVec2,
    /// Gradient of uv along x.
    pub ddx: DVec2,
    /// Gradient of uv along y.
    pub ddy: DVec2,
    /// The output pixel.
    pub pixel: [u32; 2],
    /// Position of the sample in the order of its window.
    pub rank: u32,
}

/// `DaaReflection`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflect {
    /// Weight of the radiance along the reflected ray; 0: no ray is traced.
    pub reflection: DVec3,
    /// Index of refraction inside over outside.
    pub ior: f64,
    /// Weight of the radiance along the refracted ray; 0: no ray is traced.
    pub refraction: DVec3,
    /// Unit normal in world space.
    pub normal: DVec3,
}

/// The result of the pass for a sample, and whether rounding could have changed it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflections {
    /// The weighted radiance.
    pub radiance: DVec3,
    /// The number of mirrored and of refracted rays. Without any, the encoded radiance is 0.
    pub rays: [u32; 2],
    /// Whether rounding could not have changed the result: no ray is within a share of 1e-4 of a triangle's edge, none
    /// runs along the triangle that it hits, and no angle is within 1e-4 of a threshold.
    pub sure: bool,
}

/// The most surfaces of its own object that a refracted ray passes.
const MAX_PASSAGES: u32 = 4;

/// `DaaCone`.
#[derive(Debug, Clone, Copy)]
struct Cone {
    width: f64,
    spread: f64,
}

impl Input<'_> {
    /// The result for the sample at the G-buffer coordinates x, y, which has this rank.
    pub fn reflections(&self, x: u32, y: u32, rank: u32) -> Reflections {
        let mut out = Reflections { radiance: DVec3::ZERO, rays: [0; 2], sure: true };
        let s = self.fetch(x, y, rank);
        if s.depth == 0.0 || !self.reflective.contains(&s.material) {
            return out;
        }
        let b = (self.reflect)(&s);
        let cone = self.cone(x, y, &s);
        let offset = self.trace.ray_offset(s.relative_position, s.object);
        for (kind, weight) in [b.reflection, b.refraction].into_iter().enumerate() {
            if !self.kinds[kind] || weight.max_element() <= 0.0 {
                continue;
            }
            let (mut direction, side) = if kind == 0 {
                ((-s.view).reflect(b.normal), 1.0)
            } else {
                (refract(-s.view, b.normal, 1.0 / b.ior.max(1e-3), &mut out.sure), -1.0)
            };
            if direction == DVec3::ZERO {
                continue;
            }
            // A normal map may mirror a ray into the surface; it then runs along the surface.
            let into = direction.dot(s.geometric_normal);
            out.sure &= kind == 1 || into.abs() > MARGIN;
            if kind == 0 && into < 0.0 {
                direction += s.geometric_normal * (0.02 - into);
            }
            let origin = s.relative_position + s.geometric_normal * (side * offset);
            let ray = Ray { origin, direction: direction.normalize(), t_min: 0.0, t_max: 1e30 };
            let inside = (kind == 1).then_some(b.ior);
            out.radiance += weight * self.arriving(&s, ray, inside, cone, &mut out.sure);
            out.rays[kind] += 1;
        }
        out.radiance = clean(out.radiance.extend(1.0).to_array());
        out
    }

    /// `daa_fetch`.
    fn fetch(&self, x: u32, y: u32, rank: u32) -> Sample {
        let at = (y * self.trace.samples[0] + x) as usize;
        let (surface, frame, uv) = (self.trace.surface[at], self.trace.frame[at], self.uv[at]);
        let d = f64::from(self.trace.depth[at]);
        let valid = d > 1e-30;
        let centre = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let relative = self.trace.relative_position(centre, if valid { d } else { 1.0 });
        let camera = &self.trace.camera;
        let forward = -camera.world_from_view.z_axis.truncate().as_dvec3().normalize();
        let normal = octahedral::decode(surface[0]);
        let float = |bits| f64::from(f32::from_bits(bits));
        Sample {
            position: relative + self.trace.eye(),
            depth: if valid { relative.dot(forward) } else { 0.0 },
            relative_position: relative,
            material: surface[1] & 0xffff,
            view: if self.orthographic() { -forward } else { -relative.normalize() },
            object: surface[1] >> 16,
            geometric_normal: trace::geometric_normal(frame[0]),
            user: frame[1],
            normal,
            shadow: 0,
            tangent: octahedral::tangent_decode(normal, frame[0] >> 16),
            uv: DVec2::new(float(uv[0]), float(uv[1])),
            ddx: halves(uv[2]),
            ddy: halves(uv[3]),
            pixel: [x / self.m, y / self.m],
            rank,
        }
    }

    fn orthographic(&self) -> bool {
        self.trace.camera.is_orthographic()
    }

    fn cone(&self, x: u32, y: u32, s: &Sample) -> Cone {
        let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let here = self.trace.relative_position(at, 1.0);
        let apart = (self.trace.relative_position(at + DVec2::X, 1.0) - here).length();
        if self.orthographic() {
            return Cone { width: apart, spread: 0.0 };
        }
        let spread = apart / here.length();
        Cone { width: spread * s.relative_position.length(), spread }
    }

    /// `daa_met`: the surface that a ray from `of` hit, and whether it is seen from the front.
    fn met(&self, of: &Sample, ray: &Ray, hit: &Hit, cone: Cone) -> (Sample, bool) {
        let a = &self.attributes[hit.triangle];
        let owner = &self.trace.owners[hit.triangle];
        let [p0, p1, p2] = self.trace.triangles[hit.triangle];
        let w = [1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics.x, hit.barycentrics.y];
        // Corners run counterclockwise in the mesh's own space.
        let front = owner.front(hit);
        let side = if front { 1.0 } else { -1.0 };
        let flat_normal = (p1 - p0).cross(p2 - p0);
        let seen = if hit.front { flat_normal } else { -flat_normal };
        let smooth_normal = a.normals[0] * w[0] + a.normals[1] * w[1] + a.normals[2] * w[2];
        let normal = smooth_normal.normalize() * side;
        let tangent = a.tangents[0] * w[0] + a.tangents[1] * w[1] + a.tangents[2] * w[2];
        let relative_position = ray.origin + ray.direction * hit.t;
        let [d1, d2] = [a.uvs[1] - a.uvs[0], a.uvs[2] - a.uvs[0]];
        let scale = (d1.perp_dot(d2).abs() / flat_normal.length()).sqrt();
        let across = (cone.width + cone.spread * hit.t) / normal.dot(ray.direction).abs().max(0.05);
        let footprint = (across * scale).min(65504.0);
        let s = Sample {
            position: relative_position + self.trace.eye(),
            depth: hit.t,
            relative_position,
            material: a.material,
            view: -ray.direction,
            object: owner.object,
            geometric_normal: seen.normalize(),
            user: triangle::user(a.user, w),
            normal,
            shadow: 0,
            tangent: tangent.normalize().extend(a.bitangent * side),
            uv: a.uvs[0] + d1 * w[1] + d2 * w[2],
            ddx: DVec2::new(footprint, 0.0),
            ddy: DVec2::new(0.0, footprint),
            ..*of
        };
        (s, front)
    }

    fn sky_towards(&self, of: &Sample, direction: DVec3) -> DVec3 {
        let s = Sample {
            view: -direction,
            relative_position: direction,
            position: direction + self.trace.eye(),
            pixel: of.pixel,
            rank: of.rank,
            ..Sample::default()
        };
        clean((self.sky)(&s))
    }

    /// `daa_arriving`: the radiance along a ray that leaves the sample `of`. A refracted ray has an index of refraction
    /// `refracted`.
    fn arriving(&self, of: &Sample, mut ray: Ray, refracted: Option<f64>, mut cone: Cone, sure: &mut bool) -> DVec3 {
        let end = if refracted.is_some() { MAX_PASSAGES } else { 1 };
        let mut inside = refracted.is_some();
        for i in 0..end {
            let Some(hit) = self.first(&ray, inside, sure) else {
                return self.sky_towards(of, ray.direction);
            };
            let (mut s, front) = self.met(of, &ray, &hit, cone);
            if let Some(ior) = refracted
                && s.object == of.object
                && !front
                && i + 1 < end
            {
                // The ray leaves the object, or is reflected inside it where the angle is too flat.
                let out = refract(ray.direction, s.normal, ior, sure);
                let leaves = out != DVec3::ZERO;
                ray.direction = if leaves { out } else { ray.direction.reflect(s.normal) }.normalize();
                let offset = self.trace.ray_offset(s.relative_position, s.object) * if leaves { -1.0 } else { 1.0 };
                ray.origin = s.relative_position + s.geometric_normal * offset;
                cone.width += cone.spread * hit.t;
                inside = !leaves;
                continue;
            }
            let [v, w] = hit.barycentrics.to_array();
            *sure &= triangle::is_user_sure(self.attributes[hit.triangle].user, [1.0 - v - w, v, w]);
            let bits = self.trace.bits_at(s.relative_position, s.normal, s.geometric_normal, s.object);
            *sure &= bits.sure.trailing_ones() as usize >= self.trace.lights.len();
            s.shadow = bits.shadow;
            return clean((self.shade)(&s));
        }
        DVec3::ZERO
    }

    /// The nearest triangle that stops the ray. Outside of bodies, culled back faces do not.
    fn first(&self, ray: &Ray, inside: bool, sure: &mut bool) -> Option<Hit> {
        let triangles = self.trace.triangles;
        let stops = |hit: &Hit| {
            let owner = &self.trace.owners[hit.triangle];
            inside || !owner.culled || owner.front(hit)
        };
        let closest = |ray: &Ray| rays::closest_where(ray, triangles, stops);
        let hit = closest(ray);
        // The origin itself may lie on other surfaces, as in the corner of two walls.
        let near = ray.origin.length() * 1e-6;
        let from_before = Ray { t_min: -near, ..*ray };
        *sure &= closest(&from_before) == hit && hit.is_none_or(|hit| hit.t > near);
        // Triangles behind the hit do not matter.
        let to_hit = Ray { t_max: hit.map_or(ray.t_max, |hit| hit.t), ..from_before };
        *sure &= triangles.iter().enumerate().all(|(i, triangle)| {
            let ray = if hit.is_some_and(|hit| hit.triangle == i) { &from_before } else { &to_hit };
            rays::margin(ray, std::slice::from_ref(triangle)) > MARGIN
        });
        if let Some(hit) = &hit {
            // Where a ray that runs along a triangle hits it depends on rounding.
            let [a, b, c] = triangles[hit.triangle];
            let normal = (b - a).cross(c - a);
            let slips = near * normal.length() / normal.dot(ray.direction).abs();
            *sure &= slips < 10.0 * MARGIN * normal.length().sqrt();
        }
        hit
    }
}

/// `refract` of WGSL: 0 under total reflection.
fn refract(direction: DVec3, normal: DVec3, eta: f64, sure: &mut bool) -> DVec3 {
    let along = normal.dot(direction);
    *sure &= (1.0 - eta * eta * (1.0 - along * along)).abs() > MARGIN;
    direction.refract(normal, eta)
}

/// `daa_clean`, without alpha.
fn clean(c: [f64; 4]) -> DVec3 {
    DVec4::from(resolve::clean(c)).truncate()
}

/// `unpack2x16float`, of finite halves.
fn halves(bits: u32) -> DVec2 {
    let half = |bits: u32| {
        let (sign, exponent, mantissa) = (bits >> 15 & 1, bits >> 10 & 31, f64::from(bits & 0x3ff));
        let magnitude = match exponent {
            0 => mantissa * 2f64.powi(-24),
            e => (1024.0 + mantissa) * 2f64.powi(e as i32 - 25),
        };
        if sign == 0 { magnitude } else { -magnitude }
    };
    DVec2::new(half(bits), half(bits >> 16))
}

/// The attributes of a mesh's triangles, transformed by an instance, in the order of [`rays::place`].
pub fn place(attributes: &[VertexAttributes], indices: &[u32], world: DAffine3, material: u32) -> Vec<Attributes> {
    let back = world.matrix3.inverse().transpose();
    // As stored: normals as codes, and tangents as angles about the decoded normals.
    let stored = |i: u32| octahedral::decode(octahedral::encode(attributes[i as usize].normal.map(f64::from).into()));
    let of = |t: &[u32; 3]| {
        let tangent = |i: u32| {
            let [x, y, z, _] = attributes[i as usize].tangent.map(f64::from);
            let (n, along) = (stored(i), DVec3::new(x, y, z));
            (along - n * n.dot(along)).normalize()
        };
        // The bitangent is transformed with the surface: if that mirrors it, the sign that gives it from N and T
        // changes.
        let (n, along) = (stored(t[0]), tangent(t[0]));
        let bitangent = world.matrix3 * (n.cross(along) * f64::from(attributes[t[0] as usize].tangent[3]));
        Attributes {
            normals: t.map(|i| back * stored(i)),
            tangents: t.map(|i| world.matrix3 * tangent(i)),
            bitangent: bitangent.dot((back * n).cross(world.matrix3 * along)).signum(),
            uvs: t.map(|i| DVec2::from(attributes[i as usize].uv.map(f64::from))),
            material,
            user: t.map(|i| attributes[i as usize].user),
        }
    };
    indices.as_chunks::<3>().0.iter().map(of).collect()
}
