//! Twin of `shaders/gbuffer/visibility.wgsl`: the attributes of a sample, from the triangle that it shows.

use crate::Camera;
use crate::rays::{Attributes, Mesh};
use crate::reference::sample::relative_position;
use crate::reference::{octahedral, triangle};
use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4};

/// The input of the reader.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// The camera of the frame.
    pub camera: Camera,
    /// The number of samples of the G-buffer along x and y.
    pub samples: [u32; 2],
    /// The ids, rows from the top.
    pub ids: &'a [[u32; 2]],
    /// The depth target.
    pub depth: &'a [f32],
    /// The meshes.
    pub meshes: &'a [Mesh<'a>],
    /// The instances: the index of the mesh, the transform to world space, the material and the object.
    pub instances: &'a [(usize, DAffine3, u32, u32)],
}

/// The attributes of a sample: `DaaAttributes`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Position relative to the camera.
    pub relative_position: DVec3,
    /// Unit interpolated normal, on the visible side.
    pub normal: DVec3,
    /// Unit normal of the triangle, on the visible side.
    pub geometric_normal: DVec3,
    /// Unit tangent and the sign of the bitangent.
    pub tangent: DVec4,
    /// Texture coordinates.
    pub uv: DVec2,
    /// Gradient of uv along x.
    pub ddx: DVec2,
    /// Gradient of uv along y.
    pub ddy: DVec2,
    /// material | object << 16.
    pub identity: u32,
    /// The host's 32 bits.
    pub user: u32,
    /// The cosine between the ray and the triangle's normal. Rounding grows as it nears 0.
    pub facing: f64,
    /// The weights of the vertices before they are limited to the triangle.
    pub weights: [f64; 3],
}

/// A triangle before the camera.
struct Triangle {
    a: DVec3,
    ab: DVec3,
    ac: DVec3,
    plane: DVec3,
    inverse_area: f64,
}

/// Where a ray meets its plane: the point, the weights of the second and the third vertex, and the cosine.
type Meeting = (DVec3, DVec2, f64);

impl Input<'_> {
    /// The attributes of the sample at the G-buffer coordinates x, y; `None` if it shows no triangle.
    pub fn sample(&self, x: u32, y: u32) -> Option<Seen> {
        let at = (y * self.samples[0] + x) as usize;
        let [instance, triangle] = self.ids[at];
        let depth = self.depth[at];
        if instance == 0 || depth <= 1e-30 {
            return None;
        }
        let (mesh, world, material, object) = self.instances[instance as usize - 1];
        let mesh = &self.meshes[mesh];
        let corners = mesh.indices.as_chunks::<3>().0[triangle as usize];
        let linear = world.matrix3;
        let translation = world.translation - self.camera.world_from_view.w_axis.truncate().as_dvec3();
        let own = corners.map(|i| DVec3::from(mesh.positions[i as usize].map(f64::from)));
        let [a, ab, ac] = [linear * own[0] + translation, linear * (own[1] - own[0]), linear * (own[2] - own[0])];
        let product = ab.cross(ac);
        let inverse_area = 1.0 / product.length().max(1e-18);
        let t = Triangle { a, ab, ac, plane: product * inverse_area, inverse_area };

        let centre = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let mut met = self.meet(&t, centre);
        let inside = met.1.min_element() > -0.25 && met.1.x + met.1.y < 1.25;
        if !inside || met.2.abs() < 1e-5 {
            met.0 = relative_position(&self.camera, self.samples, centre, depth.into());
            met.1 = t.weights(met.0);
        }
        let (point, weights, facing) = met;
        let positive = DVec2::new(weights.x.max(0.0), weights.y.max(0.0));
        let inner = positive / (positive.x + positive.y).max(1.0);
        let w = [1.0 - inner.x - inner.y, inner.x, inner.y];

        let side = if facing < 0.0 { 1.0 } else { -1.0 };
        let attributes = corners.map(|i| mesh.attributes[i as usize]);
        let normals = attributes.map(|a| stored_normal(&a));
        let cofactors = DMat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        let plane = if facing > 0.0 { -t.plane } else { t.plane };
        let smooth = cofactors * weighted(normals, w);
        let normal = (smooth * side).try_normalize().unwrap_or(plane);
        let tangents = [0, 1, 2].map(|i| stored_tangent(normals[i], &attributes[i]));
        let along = linear * weighted(tangents, w);
        let across = (along - normal * normal.dot(along)).normalize_or(DVec3::X);
        let sign = f64::from(attributes[0].tangent[3]).signum();
        let uvs = attributes.map(|a| DVec2::from(a.uv.map(f64::from)));
        let change = |axis: DVec2, place: u32| {
            let way = if place.is_multiple_of(2) { 1.0 } else { -1.0 };
            let next = self.meet(&t, centre + axis * way);
            let other = || weights - self.meet(&t, centre - axis * way).1;
            let apart = if next.2 * facing > 0.0 { next.1 - weights } else { other() } * way;
            (uvs[1] - uvs[0]) * apart.x + (uvs[2] - uvs[0]) * apart.y
        };
        Some(Seen {
            relative_position: point,
            normal,
            geometric_normal: plane,
            tangent: across.extend(sign * side),
            uv: uvs[0] * w[0] + uvs[1] * w[1] + uvs[2] * w[2],
            ddx: change(DVec2::X, x),
            ddy: change(DVec2::Y, y),
            identity: material | object << 16,
            user: triangle::user(attributes.map(|a| a.user), w),
            facing,
            weights: [1.0 - weights.x - weights.y, weights.x, weights.y],
        })
    }

    /// `daa_meet`.
    fn meet(&self, t: &Triangle, xy: DVec2) -> Meeting {
        let near = relative_position(&self.camera, self.samples, xy, 1.0);
        let parallel = self.camera.is_orthographic();
        let (origin, direction) = if parallel {
            (near, -self.camera.world_from_view.z_axis.truncate().as_dvec3().normalize())
        } else {
            (DVec3::ZERO, near.normalize())
        };
        let facing = t.plane.dot(direction);
        let point = origin + direction * (t.plane.dot(t.a - origin) / facing);
        (point, t.weights(point), facing)
    }
}

impl Triangle {
    /// The weights of the second and the third vertex at a point of the plane.
    fn weights(&self, point: DVec3) -> DVec2 {
        let from_a = point - self.a;
        let second = from_a.cross(self.ac).dot(self.plane);
        let third = self.ab.cross(from_a).dot(self.plane);
        DVec2::new(second, third) * self.inverse_area
    }
}

fn weighted(of: [DVec3; 3], w: [f64; 3]) -> DVec3 {
    of[0] * w[0] + of[1] * w[1] + of[2] * w[2]
}

/// The normal as it is stored, as a code.
fn stored_normal(a: &Attributes) -> DVec3 {
    octahedral::decode(octahedral::encode(DVec3::from(a.normal.map(f64::from))))
}

/// The tangent as it is stored, as an angle about the stored normal.
fn stored_tangent(normal: DVec3, a: &Attributes) -> DVec3 {
    let [x, y, z, _] = a.tangent.map(f64::from);
    let along = DVec3::new(x, y, z);
    let basis = octahedral::tangent_decode(normal, 0).truncate();
    (along - normal * normal.dot(along)).try_normalize().unwrap_or(basis)
}
