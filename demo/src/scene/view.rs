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

/// A camera that sees all of `scene` from the front, somewhat from the right and above, in any view at least as wide as
/// high. It fills 82 % of the height or width of a square view.
pub fn frame_camera(scene: &Scene) -> Camera {
    const FOV_Y: f32 = 40.0 / 180.0 * PI;
    const FROM: Vec3 = Vec3::new(0.5, 0.28, 0.82);
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
    let slope = (FOV_Y / 2.0).tan() * FILLED;
    // From the middle, along the axes of the view.
    let seen = |point: Vec3| {
        let from_centre = point.clamp(-MOST, MOST) - centre;
        Vec3::new(from_centre.dot(right), from_centre.dot(up), from_centre.dot(back))
    };
    let placed = scene.instances.iter().flat_map(|instance| {
        let positions = &scene.meshes[instance.mesh].positions;
        positions.iter().map(|&p| instance.world_from_mesh.transform_point3(p))
    });
    let mut points: Vec<_> = placed.filter(|p| p.is_finite()).map(seen).collect();
    if points.is_empty() {
        points = bounds.corners().map(seen).to_vec();
    }
    // Two planes through the eye bound each axis. They move with it, so that the farthest point beyond them says how far
    // back it has to be.
    let beyond = |axis: usize, side: f32| points.iter().map(|p| side * p[axis] + slope * p.z).fold(f32::MIN, f32::max);
    let back_for = |axis| (beyond(axis, 1.0) + beyond(axis, -1.0)) / (2.0 * slope);
    let distance = f32::max(back_for(0), back_for(1)).max(radius);
    let aside = right * middle(&points, 0, distance) + up * middle(&points, 1, distance);
    let eye = centre + aside + back * distance;
    Camera {
        eye,
        // At the distance of the middle, around which one turns.
        target: centre + aside,
        up: Vec3::Y,
        lens: Lens::Perspective { fov_y: FOV_Y },
        // Depth is as precise however near this is, and someone may look at a room in a large landscape.
        // The squares of shorter vectors to it would be lost.
        near: (radius * 1e-5).max(1e-14),
    }
}

/// How much of a square view a framed scene fills.
const FILLED: f32 = 0.82;

/// How far aside along an axis an eye at this distance is, from which the points reach as far to both sides.
fn middle(points: &[Vec3], axis: usize, distance: f32) -> f32 {
    let all = points.iter().map(|p| p[axis]);
    let (mut least, mut most) = (all.clone().fold(f32::MAX, f32::min), all.fold(f32::MIN, f32::max));
    for _ in 0..24 {
        let aside = least.midpoint(most);
        let slopes = points.iter().map(|p| (p[axis] - aside) / (distance - p.z).max(distance * 1e-3));
        let (low, high) = slopes.fold((f32::MAX, f32::MIN), |(low, high), s| (low.min(s), high.max(s)));
        if low + high > 0.0 {
            least = aside;
        } else {
            most = aside;
        }
    }
    least.midpoint(most)
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
                for point in &scene.meshes[0].positions {
                    let from_eye = *point + Vec3::X - camera.eye;
                    let angle = from_eye.angle_between(view);
                    assert!(angle < 40.0_f32.to_radians() / 2.0 * 1.42, "{size}: {angle}");
                    assert!(from_eye.dot(view.normalize()) > camera.near, "{size}");
                }
            }
        }
        assert!(frame_camera(&Scene::default()).eye.is_finite());
    }

    /// Whatever its shape: not a box around it decides, but where its points are seen.
    #[test]
    fn a_framed_scene_fills_the_view() {
        let ball =
            |i: i32| Vec3::new((i as f32).sin(), (i as f32 * 0.7).cos() * 0.4, (i as f32 * 1.3).sin()).normalize();
        for scale in [Vec3::ONE, Vec3::new(3.0, 0.1, 1.0), Vec3::new(0.2, 5.0, 0.2)] {
            let scene = points((0..500).map(|i| ball(i) * scale).collect());
            let camera = frame_camera(&scene);
            let clip = |p: &Vec3| {
                let view = (camera.target - camera.eye).normalize();
                let right = view.cross(Vec3::Y).normalize();
                let from_eye = *p + Vec3::X - camera.eye;
                let depth = from_eye.dot(view) * 20f32.to_radians().tan();
                [from_eye.dot(right) / depth, from_eye.dot(right.cross(view)) / depth]
            };
            let seen: Vec<_> = scene.meshes[0].positions.iter().map(clip).collect();
            let sides = [0, 1].map(|axis| {
                let values = seen.iter().map(|p| p[axis]);
                let (least, most) = (values.clone().fold(f32::MAX, f32::min), values.fold(f32::MIN, f32::max));
                assert!((least + most).abs() < 0.01, "{scale}: not in the middle, {least} to {most}");
                most
            });
            let filled = sides[0].max(sides[1]);
            assert!((filled - FILLED).abs() < 0.01, "{scale}: {sides:?}");
        }
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
            assert!((1.0..4.5).contains(&distance), "{size} at {centre}: {distance} radii away");
            assert!(camera.near <= bounds.radius() * 1e-4, "{size} at {centre}: {}", camera.near);
        }
    }
}
