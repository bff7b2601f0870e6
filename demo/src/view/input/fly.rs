//! Flying through a scene.

use crate::scene::{Camera, Lens};
use glam::{Quat, Vec2, Vec3};

/// Radians of turn for a drag over the height of the picture.
const TURN: f32 = 2.0;

/// How near to straight up or down one can look, as the cosine of the angle.
const STEEPEST: f32 = 0.995;

/// Turned by a drag, in heights of the picture, y down.
pub fn turned(camera: Camera, drag: Vec2) -> Camera {
    let towards = camera.target - camera.eye;
    let up = camera.up.normalize_or(Vec3::Y);
    let around = Quat::from_axis_angle(up, -drag.x * TURN);
    let level = around * towards;
    let right = level.cross(up).normalize_or(Vec3::X);
    let tilted = Quat::from_axis_angle(right, -drag.y * TURN) * level;
    let steep = tilted.normalize_or(Vec3::NEG_Z).dot(up).abs() > STEEPEST;
    Camera { target: camera.eye + if steep { level } else { tilted }, ..camera }
}

/// Moved by metres to the right, up and ahead.
pub fn moved(camera: Camera, by: Vec3) -> Camera {
    let ahead = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
    let up = camera.up.normalize_or(Vec3::Y);
    let right = ahead.cross(up).normalize_or(Vec3::X);
    let off = right * by.x + up * by.y + ahead * by.z;
    Camera { eye: camera.eye + off, target: camera.target + off, ..camera }
}

/// With a narrower or a wider view, by a factor.
pub fn zoomed(camera: Camera, factor: f32) -> Camera {
    let lens = match camera.lens {
        Lens::Perspective { fov_y } => Lens::Perspective { fov_y: (fov_y * factor).clamp(0.02, 2.9) },
        Lens::Orthographic { half_height, far } => {
            Lens::Orthographic { half_height: (half_height * factor).clamp(1e-4, 1e6), far }
        }
    };
    Camera { lens, ..camera }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let lens = Lens::Perspective { fov_y: 1.0 };
        Camera { eye: Vec3::new(1.0, 2.0, 3.0), target: Vec3::new(1.0, 2.0, -7.0), up: Vec3::Y, lens, near: 0.1 }
    }

    #[test]
    fn it_moves_as_it_looks() {
        let moved = moved(camera(), Vec3::new(1.0, 2.0, 3.0));
        assert!((moved.eye - Vec3::new(2.0, 4.0, 0.0)).length() < 1e-5);
        assert!((moved.target - moved.eye - Vec3::NEG_Z * 10.0).length() < 1e-5);
    }

    #[test]
    fn it_turns_and_never_over() {
        // A drag to the right looks to the left, as if the picture were grasped; or the other way round, but not both.
        let right = turned(camera(), Vec2::new(0.1, 0.0));
        assert!((right.target - right.eye).x > 0.5 && (right.target - right.eye).y.abs() < 1e-5);
        let mut c = camera();
        for _ in 0..100 {
            c = turned(c, Vec2::new(0.01, 0.3));
            let towards = (c.target - c.eye).normalize();
            assert!(towards.is_finite() && towards.y.abs() <= STEEPEST + 1e-3, "{towards}");
        }
        assert_eq!(turned(camera(), Vec2::ZERO).eye, camera().eye);
    }
}
