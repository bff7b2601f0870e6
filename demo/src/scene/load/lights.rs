//! KHR_lights_punctual.
//!
//! glTF gives candela and lux; the renderer has plain units without exposure, in which π of irradiance makes white
//! paper 1. Files made for viewers with exposure hold anything from 1 to 100 000. So the lights of a file keep their
//! ratios, and if together they would light the middle of the scene far too little or too much, all are scaled to
//! light it well.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{Mat4, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual as json;
use gltf::json::validation::Checked;

use crate::scene::vectors::unit;
use crate::scene::{Bounds, Light, LightKind, Sun};

/// Irradiance in the middle of the scene that is left as it is.
const SENSIBLE: std::ops::RangeInclusive<f32> = 0.2..=20.0;
/// Else it is made this: white paper at 1.
const GOOD: f32 = PI;

/// The light of a node under `world`; `None` if it is dark or broken.
pub(super) fn convert(light: &json::Light, world: Mat4) -> Option<Light> {
    let intensity = Vec3::from(light.color) * light.intensity;
    if !intensity.is_finite() || intensity.min_element() < 0.0 || intensity == Vec3::ZERO {
        return None;
    }
    let kind = match light.type_ {
        Checked::Valid(json::Type::Directional) => LightKind::Directional,
        Checked::Valid(json::Type::Point) => LightKind::Point,
        Checked::Valid(json::Type::Spot) => {
            let (inner, outer) =
                light.spot.as_ref().map_or((0.0, FRAC_PI_4), |s| (s.inner_cone_angle, s.outer_cone_angle));
            let outer = if outer.is_finite() { outer.clamp(1e-3, FRAC_PI_2) } else { FRAC_PI_4 };
            let inner = if inner.is_finite() { inner.clamp(0.0, outer - 5e-4) } else { 0.0 };
            LightKind::Spot { inner, outer }
        }
        Checked::Invalid => return None,
    };
    let direction = unit(-world.z_axis.truncate());
    let direction = match kind {
        LightKind::Point => direction.unwrap_or(Vec3::NEG_Z),
        _ => direction?,
    };
    let range = light.range.filter(|range| *range > 0.0).unwrap_or(f32::INFINITY);
    Some(Light { kind, position: world.w_axis.truncate(), direction, intensity, range, casts: true })
}

/// Scales `lights` if they would make a scene of this `centre` and `radius` all black or all white. Says by how much.
pub(super) fn expose(lights: &mut [Light], centre: Vec3, radius: f32) -> Option<f32> {
    let irradiance: f32 = lights
        .iter()
        .map(|light| {
            let strength = light.intensity.max_element();
            match light.kind {
                LightKind::Directional => strength,
                _ => strength / light.position.distance_squared(centre).max(radius * radius / 4.0).max(1e-12),
            }
        })
        .sum();
    if SENSIBLE.contains(&irradiance) || !(irradiance.is_finite() && irradiance > 0.0) {
        return None;
    }
    let factor = GOOD / irradiance;
    // One that is all but dark, or another that is much brighter and far away.
    if !lights.iter().all(|light| (light.intensity * factor).is_finite()) {
        return None;
    }
    for light in lights {
        light.intensity *= factor;
    }
    Some(factor)
}

/// What lights a scene that brings no light, beside the sun: five lamps along its middle, warm and cool in turn. Each
/// gives white paper a radiance of about a half at a quarter of the scene's height away.
pub(super) fn rig(bounds: &Bounds) -> Vec<Light> {
    const WARM: Vec3 = Vec3::new(1.0, 0.72, 0.42);
    const COOL: Vec3 = Vec3::new(0.5, 0.7, 1.0);
    let size = bounds.max - bounds.min;
    let along = if size.x >= size.z { Vec3::X * size.x } else { Vec3::Z * size.z };
    let distance = size.y.max(size.min_element()).max(size.max_element() * 0.05) * 0.25;
    (0..5u8)
        .map(|i| Light {
            kind: LightKind::Point,
            position: bounds.centre() + along * (f32::from(i) - 2.0) * 0.2 - Vec3::Y * size.y * 0.15,
            direction: Vec3::NEG_Y,
            intensity: if i % 2 == 0 { WARM } else { COOL } * (FRAC_PI_2 * distance * distance),
            range: f32::INFINITY,
            casts: false,
        })
        .filter(|light| light.position.is_finite() && light.intensity.is_finite())
        .collect()
}

/// Takes the first directional light out of `lights`.
pub(super) fn take_sun(lights: &mut Vec<Light>) -> Option<Sun> {
    let first = lights.iter().position(|light| light.kind == LightKind::Directional)?;
    let light = lights.remove(first);
    Some(Sun { to_sun: -light.direction, irradiance: light.intensity, casts: light.casts })
}
