//! Vector arithmetic that holds for any numbers a file may contain.

use glam::Vec3;

/// `vector` with length 1; `None` if it has no direction. Neither tiny nor huge elements upset it.
pub(super) fn unit(vector: Vec3) -> Option<Vec3> {
    let scale = vector.abs().max_element();
    // Division also lifts subnormals, whose squares would vanish.
    (scale > 0.0 && vector.is_finite()).then(|| (vector / scale).normalize()).filter(|unit| unit.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_direction_has_a_unit_vector() {
        for size in [1e-44, 1e-30, 1.0, 1e30, f32::MAX] {
            let length = unit(Vec3::new(size, -size, 0.0)).unwrap().length();
            assert!((length - 1.0).abs() < 1e-6, "{size}: {length}");
        }
        for none in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
            assert_eq!(unit(none), None);
        }
    }
}
