//! Flying through a scene.

use crate::scene::{Bounds, Camera, Lens};
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

/// Turned around what it looks at by a drag, in heights of the picture, y down.
pub fn orbited(camera: Camera, drag: Vec2) -> Camera {
    let from = camera.eye - camera.target;
    let up = camera.up.normalize_or(Vec3::Y);
    let level = Quat::from_axis_angle(up, -drag.x * 2.0 * TURN) * from;
    let right = up.cross(level).normalize_or(Vec3::X);
    let tilted = Quat::from_axis_angle(right, -drag.y * 2.0 * TURN) * level;
    let steep = tilted.normalize_or(Vec3::Z).dot(up).abs() > STEEPEST;
    Camera { eye: camera.target + if steep { level } else { tilted }, ..camera }
}

/// Nearer to what it looks at, by a factor of the distance.
pub fn neared(camera: Camera, factor: f32) -> Camera {
    Camera { eye: camera.target + (camera.eye - camera.target) * factor, ..camera }
}

/// Moved so that all of a box is in view, from the side where the camera is. `aspect`: width over height.
pub fn framed(camera: Camera, bounds: &Bounds, aspect: f32) -> Camera {
    const MARGIN: f32 = 1.1;
    let [ahead, right, up] = axes(&camera);
    let centre = bounds.centre();
    let radius = bounds.radius().max(1e-4);
    let off = bounds.corners().map(|corner| corner - centre);
    let lens = camera.lens;
    let distance = match lens {
        Lens::Perspective { fov_y } => {
            let slope = (fov_y / 2.0).tan();
            let needed = |off: &Vec3| {
                let wide = off.dot(right).abs() / aspect.max(1e-3);
                wide.max(off.dot(up).abs()) / slope - off.dot(ahead)
            };
            off.iter().map(needed).fold(radius * 0.1, f32::max) * MARGIN
        }
        Lens::Orthographic { .. } => radius * 2.0,
    };
    let half = |off: &Vec3| (off.dot(right).abs() / aspect.max(1e-3)).max(off.dot(up).abs());
    let lens = match lens {
        Lens::Orthographic { far, .. } => {
            Lens::Orthographic { half_height: off.iter().map(half).fold(1e-4, f32::max) * MARGIN, far }
        }
        perspective => perspective,
    };
    Camera { eye: centre - ahead * distance, target: centre, lens, ..camera }
}

/// The first of these boxes that a ray through a place of the picture enters, -1 to 1 to the right and up. Those that
/// the camera is in are passed by.
pub fn picked<'a>(camera: &Camera, boxes: &'a [Bounds], place: Vec2, aspect: f32) -> Option<&'a Bounds> {
    let [ahead, right, up] = axes(camera);
    let across = right * place.x * aspect + up * place.y;
    let (from, along) = match camera.lens {
        Lens::Perspective { fov_y } => (camera.eye, ahead + across * (fov_y / 2.0).tan()),
        Lens::Orthographic { half_height, .. } => (camera.eye + across * half_height, ahead),
    };
    let entry = |bounds: &Bounds| {
        let [a, b] = [bounds.min, bounds.max].map(|corner| (corner - from) / along);
        let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
        (enters > 0.0 && enters <= leaves).then_some(enters)
    };
    let hit = boxes.iter().filter_map(|bounds| Some((entry(bounds)?, bounds)));
    hit.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, bounds)| bounds)
}

/// Ahead, to the right and up.
fn axes(camera: &Camera) -> [Vec3; 3] {
    let ahead = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
    let right = ahead.cross(camera.up.normalize_or(Vec3::Y)).normalize_or(Vec3::X);
    [ahead, right, right.cross(ahead)]
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
    fn it_turns_around_what_it_looks_at() {
        let mut c = camera();
        for _ in 0..100 {
            c = orbited(c, Vec2::new(0.03, 0.1));
            assert_eq!(c.target, camera().target);
            assert!(((c.eye - c.target).length() - 10.0).abs() < 1e-2);
            let steep = (c.eye - c.target).normalize().y.abs();
            assert!(steep <= STEEPEST + 1e-3, "{steep}");
        }
        assert!(((neared(c, 0.5).eye - c.target).length() - 5.0).abs() < 1e-2);
    }

    #[test]
    fn what_is_framed_is_in_view_and_what_is_picked_is_in_the_way() {
        let cube = |x: f32, z: f32| {
            let centre = Vec3::new(x, 2.0, z);
            Bounds { min: centre - Vec3::ONE, max: centre + Vec3::ONE }
        };
        // The first one is around the camera.
        let all = [cube(1.0, 3.0), cube(1.0, -20.0), cube(1.0, -7.0), cube(9.0, -7.0)];
        assert_eq!(picked(&camera(), &all, Vec2::ZERO, 1.5), Some(&all[2]));
        assert_eq!(picked(&camera(), &all, Vec2::new(-0.9, 0.9), 1.5), None);
        for aspect in [0.5, 1.0, 2.0] {
            let framed = framed(camera(), &all[3], aspect);
            let [ahead, right, up] = axes(&framed);
            for corner in all[3].corners() {
                let off = corner - framed.eye;
                let slope = off.dot(ahead) * 0.5f32.tan();
                assert!(off.dot(right).abs() < slope * aspect && off.dot(up).abs() < slope, "{aspect}: {off}");
            }
        }
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
