//! Triangles from simple forms. Fronts are counter-clockwise; texture coordinates count in metres unless said.

use std::f32::consts::{PI, TAU};

use glam::{Mat3, Mat4, Vec2, Vec3};

/// Geometry under construction.
#[derive(Debug, Clone, Default)]
pub(super) struct Shape {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub indices: Vec<u32>,
}

/// What a surface has at a point.
pub(super) type Vertex = (Vec3, Vec3, Vec2);

impl Shape {
    fn vertex(&mut self, (position, normal, uv): Vertex) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// A surface over the unit square in `across` × `along` cells, whose front is where its first parameter goes
    /// counter-clockwise to the second.
    pub fn surface(&mut self, across: u32, along: u32, at: impl Fn(f32, f32) -> Vertex) {
        let first = self.positions.len() as u32;
        let row = across + 1;
        for j in 0..=along {
            for i in 0..=across {
                self.vertex(at(i as f32 / across as f32, j as f32 / along as f32));
            }
        }
        for j in 0..along {
            for i in 0..across {
                let corner = first + j * row + i;
                let [a, b, c, d] = [corner, corner + 1, corner + row + 1, corner + row];
                self.indices.extend([a, b, c, a, c, d]);
            }
        }
    }

    /// The parallelogram from `origin` along `u` and `v`, front where u turns counter-clockwise to v. Texture
    /// coordinates go from `uv_from` to `uv_to`, the second one downwards.
    pub fn quad(&mut self, origin: Vec3, u: Vec3, v: Vec3, uv_from: Vec2, uv_to: Vec2) {
        let normal = u.cross(v).normalize();
        self.surface(1, 1, |s, t| {
            (origin + u * s + v * t, normal, uv_from + (uv_to - uv_from) * Vec2::new(s, 1.0 - t))
        });
    }

    /// A triangle, textured all over.
    pub fn triangle(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let uvs = [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(0.5, 0.0)];
        for (corner, uv) in corners.into_iter().zip(uvs) {
            let vertex = self.vertex((corner, normal, uv));
            self.indices.push(vertex);
        }
    }

    /// An upright box.
    pub fn cuboid(&mut self, min: Vec3, max: Vec3) {
        let size = max - min;
        for axis in 0..3 {
            let (u_axis, v_axis) = [(2, 1), (0, 2), (0, 1)][axis];
            let mut u = Vec3::ZERO;
            let mut v = Vec3::ZERO;
            u[u_axis] = size[u_axis];
            v[v_axis] = size[v_axis];
            let mut lift = Vec3::ZERO;
            lift[axis] = size[axis];
            // Texture coordinates are the place in the world, so that courses run on around corners.
            let from = Vec2::new(min[u_axis], -max[v_axis]);
            let to = Vec2::new(max[u_axis], -min[v_axis]);
            let mut normal = Vec3::ZERO;
            normal[axis] = 1.0;
            if u.cross(v).dot(normal) > 0.0 {
                self.quad(min + lift, u, v, from, to);
                self.quad(min + u, -u, v, Vec2::new(to.x, from.y), Vec2::new(from.x, to.y));
            } else {
                self.quad(min + lift + u, -u, v, Vec2::new(to.x, from.y), Vec2::new(from.x, to.y));
                self.quad(min, u, v, from, to);
            }
        }
    }

    /// Turns `profile`, points of (radius, height) from bottom to top, around the y axis. Corners of the profile that
    /// turn sharply stay sharp. The texture goes `repeats` times around.
    pub fn lathe(&mut self, profile: &[(f32, f32)], segments: u32, repeats: f32) {
        let outward = |k: usize| -> Option<Vec2> {
            let (a, b) = (Vec2::from(*profile.get(k)?), Vec2::from(*profile.get(k + 1)?));
            Some(Vec2::new(b.y - a.y, a.x - b.x).normalize())
        };
        let smooth = |own: Vec2, other: Option<Vec2>| match other {
            Some(other) if own.dot(other) > 0.75 => (own + other).normalize(),
            _ => own,
        };
        let mut length = 0.0;
        for k in 0..profile.len() - 1 {
            let (from, to) = (Vec2::from(profile[k]), Vec2::from(profile[k + 1]));
            let Some(own) = outward(k) else { continue };
            let below = smooth(own, k.checked_sub(1).and_then(outward));
            let above = smooth(own, outward(k + 1));
            let next_length = length + from.distance(to);
            self.surface(segments, 1, |s, t| {
                // Clockwise from above would turn the front inwards.
                let (sin, cos) = (s * TAU).sin_cos();
                let around = |p: Vec2| Vec3::new(p.x * cos, p.y, -p.x * sin);
                let normal = below.lerp(above, t).normalize();
                let v = -(length + (next_length - length) * t);
                (around(from.lerp(to, t)), around(normal), Vec2::new(s * repeats, v))
            });
            length = next_length;
        }
    }

    /// A ball around the origin.
    pub fn ball(&mut self, radius: f32, segments: u32) {
        self.surface(2 * segments, segments, |s, t| {
            let ((sin, cos), (up, out)) = ((s * TAU).sin_cos(), ((t - 0.5) * PI).sin_cos());
            let normal = Vec3::new(cos * out, up, -sin * out);
            (normal * radius, normal, Vec2::new(s * 2.0, 1.0 - t))
        });
    }

    /// A round bar without ends.
    pub fn bar(&mut self, from: Vec3, to: Vec3, radius: f32, sides: u32) {
        let axis = (to - from).normalize();
        let (x, y) = axis.any_orthonormal_pair();
        let length = from.distance(to);
        self.surface(sides, 1, |s, t| {
            let (sin, cos) = (s * TAU).sin_cos();
            let normal = x * cos + y * sin;
            (from.lerp(to, t) + normal * radius, normal, Vec2::new(s, t * length))
        });
    }

    /// A round bar along points, without ends.
    pub fn wire(&mut self, points: &[Vec3], radius: f32, sides: u32) {
        for pair in points.windows(2) {
            self.bar(pair[0], pair[1], radius, sides);
        }
    }

    /// Adds `other`, moved by a rotation, translation and positive scale.
    pub fn add(&mut self, other: &Shape, matrix: Mat4) {
        let first = self.positions.len() as u32;
        let turn = Mat3::from_mat4(matrix).inverse().transpose();
        self.positions.extend(other.positions.iter().map(|&position| matrix.transform_point3(position)));
        self.normals.extend(other.normals.iter().map(|&normal| (turn * normal).normalize()));
        self.uvs.extend_from_slice(&other.uvs);
        self.indices.extend(other.indices.iter().map(|index| first + index));
    }
}
