//! What a mesh's vertices are moved by before an instance places them, so that no matrix of an instance is singular or
//! holds numbers whose products f32 has no room for.

use glam::{DAffine3, DMat3, DVec3, Mat4, Vec3};

use super::skin::Pose;

/// Vertices are scaled by powers of two in steps of this exponent, so that nodes of like scale share a mesh, and those of
/// ordinary scale do not touch it.
const STEP: i32 = 32;

/// Beyond this ratio of the axes' scales, normals of the mesh's own space would need more bits than they are kept in.
const STRETCH: f64 = 64.0;

/// Below this share of what its columns span, a matrix counts as flat, as it does for rays.
const FLAT: f64 = 1e-6;

/// The part of a node's transform that goes into the vertices. Nodes with equal ones share a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Shape {
    /// Vertices stay as they are.
    Own,
    /// The axes are scaled by these powers of two, which rounds nothing.
    Stretched([i32; 3]),
    /// The linear part of a matrix that flattens, as bits.
    Flat([u64; 9]),
    /// The joints of a skin of the file place each vertex.
    Skinned(usize),
}

/// Splits the transform of a node into what shapes its mesh and the matrix of the instance. `None` if it leaves no more
/// than a line or a point.
pub(super) fn split(world: Mat4) -> Option<(Shape, Mat4)> {
    let linear = DMat3::from_mat4(world.as_dmat4());
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    let unit = DMat3::from_cols_slice(&columns.map(DVec3::normalize_or_zero).map(|c| c.to_array()).concat());
    if cofactors(unit).to_cols_array().iter().all(|c| c.abs() <= FLAT) {
        return None;
    }
    if unit.determinant().abs() <= FLAT {
        let bits = linear.to_cols_array().map(f64::to_bits);
        return Some((Shape::Flat(bits), Mat4::from_translation(world.w_axis.truncate())));
    }
    let lengths = DVec3::from_array(columns.map(DVec3::length));
    let step = if lengths.max_element() > STRETCH * lengths.min_element() { 1 } else { STEP };
    let exponents = lengths.to_array().map(|length| (length.log2() / f64::from(step)).round() as i32 * step);
    if exponents == [0; 3] {
        return Some((Shape::Own, world));
    }
    let shrunk = linear * DMat3::from_diagonal(powers(exponents.map(|e| -e)));
    let matrix = Mat4::from_cols(
        shrunk.x_axis.as_vec3().extend(0.0),
        shrunk.y_axis.as_vec3().extend(0.0),
        shrunk.z_axis.as_vec3().extend(0.0),
        world.w_axis,
    );
    Some((Shape::Stretched(exponents), matrix))
}

/// How the vertices of a primitive are moved.
pub(super) enum Motion<'a> {
    /// Not at all.
    None,
    /// All alike.
    Linear(DMat3),
    /// Each by its joints.
    Skinned(Pose<'a>),
}

impl Motion<'_> {
    /// How a shape that is no skin moves vertices.
    pub fn of(shape: Shape) -> Self {
        match shape {
            Shape::Own | Shape::Skinned(_) => Self::None,
            Shape::Stretched(exponents) => Self::Linear(DMat3::from_diagonal(powers(exponents))),
            Shape::Flat(bits) => Self::Linear(DMat3::from_cols_array(&bits.map(f64::from_bits))),
        }
    }

    pub fn position(&self, vertex: u32, own: Vec3) -> Vec3 {
        match self {
            Self::None => own,
            _ => self.at(vertex).transform_point3(own.as_dvec3()).as_vec3(),
        }
    }

    /// Normals go with the cofactors, which also hold where the matrix is singular. Zero if nothing is left of it.
    pub fn normal(&self, vertex: u32, own: Vec3) -> Vec3 {
        match self {
            Self::None => own,
            _ => {
                let linear = self.at(vertex).matrix3;
                let side = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
                (cofactors(linear) * own.as_dvec3() * side).normalize_or_zero().as_vec3()
            }
        }
    }

    pub fn tangent(&self, vertex: u32, own: Vec3) -> Vec3 {
        match self {
            Self::None => own,
            _ => self.at(vertex).transform_vector3(own.as_dvec3()).normalize_or_zero().as_vec3(),
        }
    }

    /// Whether it turns the winding of triangles round.
    pub fn mirrors(&self, vertex: u32) -> bool {
        self.at(vertex).matrix3.determinant() < 0.0
    }

    fn at(&self, vertex: u32) -> DAffine3 {
        match self {
            Self::None => DAffine3::IDENTITY,
            Self::Linear(matrix) => DAffine3::from_mat3(*matrix),
            Self::Skinned(pose) => pose.at(vertex as usize),
        }
    }
}

fn powers(exponents: [i32; 3]) -> DVec3 {
    DVec3::from_array(exponents.map(|e| 2.0_f64.powi(e)))
}

fn cofactors(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    /// Where a point and a normal of the mesh go, by way of the shape and the instance.
    fn placed(world: Mat4, position: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        let (shape, matrix) = split(world).unwrap();
        let motion = Motion::of(shape);
        let linear = DMat3::from_mat4(matrix.as_dmat4());
        let side = linear.determinant().signum();
        let normal = cofactors(linear) * motion.normal(0, normal).as_dvec3() * side;
        (matrix.transform_point3(motion.position(0, position)), normal.normalize().as_vec3())
    }

    #[test]
    fn any_scale_keeps_positions_and_normals() {
        let rotation = Quat::from_rotation_y(0.7);
        let (position, normal) = (Vec3::new(0.5, -2.0, 3.0), Vec3::new(0.6, 0.0, 0.8));
        for scale in [
            Vec3::splat(1.0),
            Vec3::splat(1e-12),
            Vec3::splat(1e15),
            Vec3::splat(-1e10),
            Vec3::new(1e15, 1.0, 1e-12),
            Vec3::new(-1e-20, 1e20, 1.0),
            Vec3::new(2.0, 2.0, -1e-30),
        ] {
            let world = Mat4::from_scale_rotation_translation(scale, rotation, Vec3::new(7.0, 8.0, 9.0));
            let (at, along) = placed(world, position, normal);
            let right = world.as_dmat4().transform_point3(position.as_dvec3());
            assert!(at.as_dvec3().distance(right) <= 1e-6 * right.length(), "{scale}: {at}, not {right}");
            let right = rotation.as_dquat() * (normal.as_dvec3() / scale.as_dvec3()).normalize();
            assert!(along.as_dvec3().distance(right) < 1e-6, "{scale}: {along}, not {right}");
            // The products that shaders form of the instance's matrix stay within f32.
            for column in DMat3::from_mat4(split(world).unwrap().1.as_dmat4()).to_cols_array_2d() {
                let exponent = DVec3::from(column).length().log2();
                assert!(exponent.abs() <= f64::from(STEP / 2), "{scale}: {exponent}");
            }
        }
    }

    #[test]
    fn ordinary_scales_leave_meshes_alone() {
        for scale in [Vec3::splat(1e-4), Vec3::ONE, Vec3::new(-2.0, 30.0, 100.0)] {
            let world = Mat4::from_scale(scale);
            assert_eq!(split(world), Some((Shape::Own, world)));
        }
    }

    #[test]
    fn what_is_flat_is_a_surface_and_what_is_less_is_not() {
        for flat in [Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 1e12, 1e-3), Vec3::new(3.0, -1.0, 0.0)] {
            let turned = Mat4::from_rotation_x(0.3) * Mat4::from_scale(flat);
            let (shape, matrix) = split(turned).unwrap();
            assert!(matches!(shape, Shape::Flat(_)) && matrix.determinant() == 1.0, "{flat}");
            let at = Motion::of(shape).position(0, Vec3::ONE);
            assert!(at.distance(turned.transform_point3(Vec3::ONE)) <= 1e-6 * at.length(), "{flat}");
        }
        let upright = Motion::of(split(Mat4::from_scale(Vec3::new(2.0, 0.0, 1.0))).unwrap().0);
        assert_eq!(upright.normal(0, Vec3::Y), Vec3::Y);
        assert_eq!(upright.normal(0, Vec3::X), Vec3::ZERO);
        for less in [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 0.0, -5.0)] {
            assert_eq!(split(Mat4::from_scale(less)), None, "{less}");
        }
    }
}
