//! Twin of `shaders/shared/sample.wgsl`, as far as several twins need it.

use crate::Camera;
use glam::{DMat4, DVec2, DVec3, DVec4};

/// The position, relative to the camera, of the point at G-buffer coordinates (in samples, y down) and depth `d`.
/// `samples` is the size of the G-buffer.
pub fn relative_position(camera: &Camera, samples: [u32; 2], xy: DVec2, d: f64) -> DVec3 {
    let [width, height] = samples.map(f64::from);
    let ndc = DVec4::new(xy.x / width * 2.0 - 1.0, 1.0 - xy.y / height * 2.0, d, 1.0);
    let p = relative_from_clip(camera) * ndc;
    p.truncate() / p.w
}

/// The transform from clip space to positions relative to the camera.
pub fn relative_from_clip(camera: &Camera) -> DMat4 {
    let mut rotation = camera.world_from_view.as_dmat4();
    rotation.w_axis = DVec4::W;
    rotation * camera.clip_from_view.as_dmat4().inverse()
}
