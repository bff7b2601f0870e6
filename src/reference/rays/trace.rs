//! Twin of `shaders/rays/trace.wgsl`: the shadow bits of a sample, with every triangle of the scene tested.

use super::Ray;
use crate::reference::sample::relative_position;
use crate::reference::{octahedral, rays};
use crate::{Camera, CastingLight};
use glam::{DVec2, DVec3};

/// The input of the pass. Positions are relative to the camera.
#[derive(Debug, Clone)]
pub struct Input<'a> {
    /// The camera of the frame.
    pub camera: Camera,
    /// The number of samples of the G-buffer along x and y.
    pub samples: [u32; 2],
    /// The depth target, rows from the top.
    pub depth: &'a [f32],
    /// The first colour target.
    pub surface: &'a [[u32; 2]],
    /// The second colour target.
    pub frame: &'a [[u32; 2]],
    /// The least offsets of rays by object, [`RayScene::least_offsets`](crate::rays::RayScene::least_offsets).
    pub least_offsets: &'a [f32],
    /// The setting [`Settings::ray_bias`](crate::Settings::ray_bias), 0 for a visibility buffer.
    pub ray_bias: f32,
    /// The lights that cast shadows, [`Needs::shadows`](crate::Needs::shadows).
    pub lights: &'a [CastingLight],
    /// The triangles of all instances.
    pub triangles: &'a [[DVec3; 3]],
    /// The instance of each triangle.
    pub owners: &'a [Owner],
}

/// What rays need to know of a triangle's instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Owner {
    /// The object.
    pub object: u32,
    /// Whether the instance mirrors its mesh.
    pub mirrored: bool,
    /// [`Instance::culled`](crate::rays::Instance::culled).
    pub culled: bool,
    /// [`Instance::casts_shadow`](crate::rays::Instance::casts_shadow).
    pub casts_shadow: bool,
}

impl Owner {
    /// Whether the front of the mesh was hit.
    pub(super) fn front(&self, hit: &rays::Hit) -> bool {
        hit.front != self.mirrored
    }
}

/// The shadow bits, and which of them rounding could not have changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bits {
    /// Bit i is set if light i does not reach the sample.
    pub shadow: u32,
    /// Bit i is set if the ray is further than a share of 1e-4 of a triangle from any edge, or if there was no ray and
    /// the angle is as clear.
    pub sure: u32,
}

/// The greatest distance from a threshold that rounding may bridge.
pub(super) const MARGIN: f64 = 1e-4;

impl Input<'_> {
    /// `daa_ray_offset`.
    pub(super) fn ray_offset(&self, relative: DVec3, object: u32) -> f64 {
        let least = self.least_offsets.get(object as usize).copied().unwrap_or(0.0);
        let distance = relative.abs().max_element();
        let bias = f64::from(self.ray_bias) * self.camera.sample_width(self.samples);
        let by_sample = if self.camera.is_orthographic() { bias } else { bias * distance };
        (distance * 2f64.powi(-16)).max(by_sample).max(f64::from(least))
    }

    /// The bits of the sample at the G-buffer coordinates x, y.
    pub fn bits(&self, x: u32, y: u32) -> Bits {
        let at = (y * self.samples[0] + x) as usize;
        let depth = self.depth[at];
        if depth <= 1e-30 {
            return Bits { shadow: 0, sure: u32::MAX };
        }
        let position = self.relative_position(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), f64::from(depth));
        let normal = octahedral::decode(self.surface[at][0]);
        let geometric = geometric_normal(self.frame[at][0]);
        self.bits_at(position, normal, geometric, self.surface[at][1] >> 16)
    }

    /// The bits of a surface of `object` at a position.
    pub fn bits_at(&self, position: DVec3, normal: DVec3, geometric: DVec3, object: u32) -> Bits {
        let mut bits = Bits { shadow: 0, sure: 0 };
        for (i, light) in self.lights.iter().enumerate() {
            let (shadow, sure) = self.light(light, position, normal, geometric, object);
            bits.shadow |= u32::from(shadow) << i;
            bits.sure |= u32::from(sure) << i;
        }
        bits
    }

    /// `daa_relative_position`: the position, relative to the camera, of the point at G-buffer coordinates and depth
    /// `d`.
    pub(super) fn relative_position(&self, xy: DVec2, d: f64) -> DVec3 {
        relative_position(&self.camera, self.samples, xy, d)
    }

    /// The camera's position in world space.
    pub(super) fn eye(&self) -> DVec3 {
        self.camera.world_from_view.w_axis.truncate().as_dvec3()
    }

    fn light(
        &self,
        light: &CastingLight,
        position: DVec3,
        normal: DVec3,
        geometric: DVec3,
        object: u32,
    ) -> (bool, bool) {
        let mut sure = true;
        let mut decide = |value: f64, scale: f64| {
            sure &= value.abs() > MARGIN * scale;
            value > 0.0
        };
        let (towards, punctual) = match *light {
            CastingLight::Directional { towards } => (towards.as_dvec3().normalize(), None),
            CastingLight::Punctual { position: at, range, cone } => {
                let at = at.as_dvec3() - self.eye();
                let towards = at - position;
                let distance = towards.length();
                let range = if range > 0.0 { f64::from(range.min(1e18)) } else { 1e18 };
                if distance == 0.0 || !decide(range - distance, range) {
                    return (false, sure);
                }
                if let Some((axis, angle)) = cone
                    && !decide(-towards.dot(axis.as_dvec3().normalize()) - f64::from(angle).cos() * distance, distance)
                {
                    return (false, sure);
                }
                (towards, Some(at))
            }
        };
        if !decide(normal.dot(towards), towards.length()) {
            return (true, sure);
        }
        let inside = !decide(geometric.dot(towards), towards.length());
        let offset = self.ray_offset(position, object);
        let origin = position + geometric * if inside { -offset } else { offset };
        let ray = match punctual {
            None => Ray { origin, direction: towards, t_min: 0.0, t_max: 1e30 },
            Some(at) => Ray { origin, direction: at - origin, t_min: 0.0, t_max: 0.9998 },
        };
        let stops = |i: usize, hit: &rays::Hit| {
            let owner = &self.owners[i];
            owner.casts_shadow && (!inside || owner.object != object || owner.front(hit))
        };
        let stopped = |ray: &Ray, clearly: bool| {
            self.triangles.iter().enumerate().any(|(i, triangle)| {
                let triangle = std::slice::from_ref(triangle);
                let hit = rays::closest(ray, triangle).is_some_and(|hit| stops(i, &hit));
                hit && (!clearly || rays::margin(ray, triangle) > MARGIN)
            })
        };
        // The origin itself may lie on other surfaces, as in the corner of two walls.
        let near = position.length() * 1e-6 / ray.direction.length();
        let [before, after] = [-near, near].map(|t_min| Ray { t_min, ..ray });
        let shadow = stopped(&ray, false);
        // A single hit far from every edge suffices; without a hit, all triangles must be missed clearly.
        let clear = stopped(&after, true);
        let missed = !stopped(&before, false) && rays::margin(&before, self.triangles) > MARGIN;
        (shadow, sure && (clear || missed))
    }
}

/// Decodes a normal of 8+8 octahedral bits.
pub(in crate::reference) fn geometric_normal(code: u32) -> DVec3 {
    let wide = |bits: u32| {
        // Converted to 16 bits: both codes are shares of their greatest value.
        let c = (f64::from(bits as u8 as i8) / 127.0).max(-1.0);
        u32::from((c * 32767.0).round() as i16 as u16)
    };
    octahedral::decode(wide(code) | wide(code >> 8) << 16)
}
