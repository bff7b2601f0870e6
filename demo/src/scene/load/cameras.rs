//! Cameras in the world.

use std::f32::consts::FRAC_PI_2;

use glam::Mat4;
use gltf::json::camera;

use crate::scene::vectors::unit;
use crate::scene::{Camera, Lens};

/// In radians: half a degree to nearly a half turn.
const FOV_RANGE: std::ops::RangeInclusive<f32> = 0.008..=3.1;

/// The camera of a node under `world`; `None` if it cannot show anything.
pub(super) fn convert(camera: &camera::Camera, world: Mat4) -> Option<Camera> {
    let eye = world.w_axis.truncate();
    let forward = unit(-world.z_axis.truncate())?;
    let up = unit(world.y_axis.truncate())?;
    if forward.cross(up).length() < 1e-3 {
        return None;
    }
    // The target must differ from the eye even far out, where floats are sparse.
    let target = eye + forward * (eye.abs().max_element() * 1e-4).max(1.0);
    let (lens, near) = if let Some(perspective) = &camera.perspective {
        (Lens::Perspective { fov_y: fov(perspective)? }, perspective.znear)
    } else {
        let orthographic = camera.orthographic.as_ref()?;
        let (half_height, far) = (orthographic.ymag.abs(), orthographic.zfar);
        let usable = half_height.is_finite() && half_height > 0.0 && far.is_finite() && far > orthographic.znear;
        if !usable {
            return None;
        }
        // glTF allows a near plane of zero here. How far the view reaches says nothing of what stands before the eye.
        (Lens::Orthographic { half_height, far }, orthographic.znear.max((half_height * 1e-4).min(far * 0.5)))
    };
    let near = if near.is_finite() && near > 0.0 { near } else { 0.01 };
    let is_empty = matches!(lens, Lens::Orthographic { far, .. } if far <= near);
    (target.is_finite() && !is_empty).then_some(Camera { eye, target, up, lens, near })
}

fn fov(perspective: &camera::Perspective) -> Option<f32> {
    let fov = perspective.yfov;
    // Some exporters write degrees.
    let fov = if fov > FRAC_PI_2 * 2.0 { fov.to_radians() } else { fov };
    FOV_RANGE.contains(&fov).then_some(fov)
}
