//! Where a scene is, and where to look at it from.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Camera, Lens, Scene, Sun};

/// An axis-aligned box, not empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub min: Vec3,
    /// The greatest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The smallest box around `points`; `None` if there are none.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        points.into_iter().fold(None, |bounds, point| {
            let old = bounds.unwrap_or(Self { min: point, max: point });
            Some(Self { min: old.min.min(point), max: old.max.max(point) })
        })
    }

    /// The middle.
    pub fn centre(&self) -> Vec3 {
        self.min.midpoint(self.max)
    }

    /// Half the diagonal.
    pub fn radius(&self) -> f32 {
        let half = self.max * 0.5 - self.min * 0.5;
        // Squares of huge sizes would overflow.
        let scale = half.max_element().max(f32::MIN_POSITIVE);
        (half / scale).length() * scale
    }

    /// The corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i >> bit & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        })
    }
}

impl Default for Sun {
    /// A clear late morning: white paper that faces it has radiance 1. Casts no shadow, since no file asked for it.
    fn default() -> Self {
        Self {
            to_sun: Vec3::new(0.35, 0.8, 0.5).normalize(),
            irradiance: Vec3::new(1.0, 0.96, 0.88) * PI,
            casts: false,
        }
    }
}

impl Scene {
    /// A box in the world around all instances; `None` if there are none.
    pub fn bounds(&self) -> Option<Bounds> {
        let meshes: Vec<Option<Bounds>> =
            self.meshes.iter().map(|mesh| Bounds::around(mesh.positions.iter().copied())).collect();
        let corners = self.instances.iter().flat_map(|instance| {
            let corners = meshes[instance.mesh].map(|bounds| bounds.corners());
            corners.into_iter().flatten().map(|corner| instance.world_from_mesh.transform_point3(corner))
        });
        Bounds::around(corners.filter(|corner| corner.is_finite()))
    }

    /// The scene's own first camera, or one that frames it.
    pub fn default_camera(&self) -> Camera {
        self.cameras.first().copied().unwrap_or_else(|| frame_camera(self))
    }
}

/// A camera that sees all of `scene` from the front, the right and above, in any view at least as wide as high.
pub fn frame_camera(scene: &Scene) -> Camera {
    const FOV_Y: f32 = 50.0 / 180.0 * PI;
    const FROM: Vec3 = Vec3::new(0.55, 0.4, 0.73);
    const MARGIN: f32 = 1.05;
    /// Beyond this, the camera's matrices would overflow.
    const MOST: Vec3 = Vec3::splat(1e15);

    let bounds = scene.bounds().unwrap_or(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
    let bounds = Bounds { min: bounds.min.clamp(-MOST, MOST), max: bounds.max.clamp(-MOST, MOST) };
    let centre = bounds.centre();
    // A single point has no size, squares of less would be lost, and far from the origin floats cannot tell small
    // distances apart.
    let size = Some(bounds.radius()).filter(|radius| *radius > 1e-12).unwrap_or(1e-4);
    let radius = size.max(centre.abs().max_element() * 1e-6);

    let back = FROM.normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let slope = (FOV_Y / 2.0).tan();
    let needed = |corner: Vec3| {
        let from_centre = corner - centre;
        let off_axis = from_centre.dot(right).abs().max(from_centre.dot(up).abs());
        off_axis / slope + from_centre.dot(back)
    };
    let distance = bounds.corners().into_iter().map(needed).fold(radius, f32::max) * MARGIN;
    Camera {
        eye: centre + back * distance,
        target: centre,
        up: Vec3::Y,
        lens: Lens::Perspective { fov_y: FOV_Y },
        // Depth is as precise however near this is, and someone may look at a room in a large landscape.
        // The squares of shorter vectors to it would be lost.
        near: (radius * 1e-5).max(1e-14),
    }
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::scene::{Instance, Mesh};

    fn points(positions: Vec<Vec3>) -> Scene {
        let instance = Instance { mesh: 0, world_from_mesh: Mat4::from_translation(Vec3::X), object: 1 };
        Scene { meshes: vec![Mesh { positions, ..Mesh::default() }], instances: vec![instance], ..Scene::default() }
    }

    #[test]
    fn bounds_are_in_the_world() {
        let bounds = points(vec![Vec3::ZERO, Vec3::new(1.0, -2.0, 3.0)]).bounds().unwrap();
        assert_eq!(bounds, Bounds { min: Vec3::new(1.0, -2.0, 0.0), max: Vec3::new(2.0, 0.0, 3.0) });
        assert_eq!(bounds.centre(), Vec3::new(1.5, -1.0, 1.5));
        assert_eq!(Scene::default().bounds(), None);
    }

    #[test]
    fn everything_is_in_view_whatever_its_size() {
        for size in [0.0, 1e-20, 1e-3, 1.0, 1e6, 1e20, f32::MAX] {
            let scene = points(vec![Vec3::splat(-size), Vec3::splat(size)]);
            let camera = frame_camera(&scene);
            let view = camera.target - camera.eye;
            assert!(camera.eye.is_finite() && view.length() > 0.0 && camera.near > 0.0, "{size}: {camera:?}");
            if size <= 1e6 {
                for corner in scene.bounds().unwrap().corners() {
                    let angle = (corner - camera.eye).angle_between(view);
                    assert!(angle < 50.0_f32.to_radians() / 2.0 * 1.42, "{size}: {angle}");
                    assert!((corner - camera.eye).dot(view.normalize()) > camera.near, "{size}");
                }
            }
        }
        assert!(frame_camera(&Scene::default()).eye.is_finite());
    }

    #[test]
    fn small_and_distant_scenes_fill_the_view_as_others_do() {
        for (size, centre) in [(1.0, 0.0), (1e-6, 0.0), (1e-9, 0.0), (4000.0, 0.0), (40.0, 1.3e7), (10.0, -5e6)] {
            let instance = Instance { mesh: 0, world_from_mesh: Mat4::from_translation(Vec3::X * centre), object: 1 };
            let mesh = Mesh { positions: vec![Vec3::splat(-size), Vec3::splat(size)], ..Mesh::default() };
            let scene = Scene { meshes: vec![mesh], instances: vec![instance], ..Scene::default() };
            let camera = frame_camera(&scene);
            let bounds = scene.bounds().unwrap();
            let distance = camera.eye.distance(bounds.centre()) / bounds.radius();
            assert!((2.0..4.5).contains(&distance), "{size} at {centre}: {distance} radii away");
            assert!(camera.near <= bounds.radius() * 1e-4, "{size} at {centre}: {}", camera.near);
        }
    }
}
