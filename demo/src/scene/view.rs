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
        (self.max * 0.5 - self.min * 0.5).length()
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
    /// A clear late morning: white paper that faces it has radiance 1.
    fn default() -> Self {
        Self { to_sun: Vec3::new(0.35, 0.8, 0.5).normalize(), irradiance: Vec3::new(1.0, 0.96, 0.88) * PI }
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

/// A camera that sees all of `scene` from the front, the right and above.
pub fn frame_camera(scene: &Scene) -> Camera {
    const FOV_Y: f32 = 50.0 / 180.0 * PI;
    const FROM: Vec3 = Vec3::new(0.55, 0.4, 0.73);

    let bounds = scene.bounds().unwrap_or(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
    let centre = bounds.centre();
    // A single point has no size, and far from the origin floats cannot tell small distances apart.
    let radius = bounds.radius().max(centre.abs().max_element() * 1e-4).max(1e-4);
    let distance = radius / (FOV_Y / 2.0).sin();
    Camera {
        eye: centre + FROM.normalize() * distance,
        target: centre,
        up: Vec3::Y,
        lens: Lens::Perspective { fov_y: FOV_Y },
        near: radius * 1e-2,
    }
}
