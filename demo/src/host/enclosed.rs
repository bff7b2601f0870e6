//! Lights that stand inside an opaque body, such as a bulb that was modelled around them: with shadows, they light
//! nothing, which looks like a fault of the shadows.

use crate::scene::{Instance, Light, LightKind, Scene};
use deferred_aa::MAX_CASTING_LIGHTS;
use glam::{DMat4, DVec3, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Bodies reach this share of the scene's radius from their light at most. What is larger is a room.
const REACH: f64 = 0.25;

/// Directions in which a light is looked from.
const DIRECTIONS: usize = 128;

/// A line for each light that casts shadows and that one object shuts in.
pub fn notices(scene: &Scene) -> Vec<String> {
    let lights = scene.lights.iter().filter(|l| l.casts).take(MAX_CASTING_LIGHTS - 1);
    let mut lights = lights.filter(|l| l.kind != LightKind::Directional).peekable();
    let Some(bounds) = lights.peek().and_then(|_| scene.bounds()) else { return Vec::new() };
    let reach = f64::from(bounds.radius()) * REACH;
    let boxes: Vec<_> = scene.meshes.iter().map(|mesh| around(mesh.positions.iter().map(|p| p.as_dvec3()))).collect();
    let mut objects: BTreeMap<u16, Vec<&Instance>> = BTreeMap::new();
    for instance in scene.instances.iter().filter(|i| is_opaque(scene, i)) {
        objects.entry(instance.object).or_default().push(instance);
    }
    let placed =
        |i: &Instance| around(corners(boxes[i.mesh]).map(|c| i.world_from_mesh.as_dmat4().transform_point3(c)));
    let objects: Vec<_> = objects.into_values().map(|own| (around(own.iter().flat_map(|i| placed(i))), own)).collect();
    let told = |light: &Light| {
        let at = light.position.as_dvec3();
        let near = objects.iter().filter(|([low, high], _)| low.cmple(at).all() && at.cmple(*high).all());
        let mesh = near.filter_map(|(_, own)| enclosing(scene, own, light, reach)).next()?;
        let Vec3 { x, y, z } = light.position;
        let name = &scene.meshes[mesh].name;
        Some(format!(
            "the light at ({x}, {y}, {z}) lights nothing but the inside of {name}, which encloses it; open the mesh, or \
             draw with --set shadows=off"
        ))
    };
    lights.filter_map(told).collect()
}

/// The mesh that a light meets first, if one of these instances is near in every direction in which it shines.
fn enclosing(scene: &Scene, instances: &[&Instance], light: &Light, reach: f64) -> Option<usize> {
    let mut near = Vec::new();
    for instance in instances {
        let mesh = &scene.meshes[instance.mesh];
        let place = DMat4::from_translation(-light.position.as_dvec3()) * instance.world_from_mesh.as_dmat4();
        let points: Vec<_> = mesh.positions.iter().map(|p| place.transform_point3(p.as_dvec3())).collect();
        let triangles = mesh.indices.as_chunks::<3>().0.iter().map(|t| t.map(|i| points[i as usize]));
        let is_near = |[a, b, c]: &[DVec3; 3]| {
            let (low, high) = (a.min(*b).min(*c), a.max(*b).max(*c));
            low.max_element() <= reach && high.min_element() >= -reach
        };
        near.extend(triangles.filter(is_near).map(|t| (t, instance.mesh)));
    }
    let mut first = None;
    for direction in directions(light) {
        let (_, mesh) = near.iter().find(|(t, _)| meets(t, direction).is_some_and(|distance| distance <= reach))?;
        first.get_or_insert(*mesh);
    }
    first
}

/// Unit vectors spread evenly over what the light shines on.
fn directions(light: &Light) -> impl Iterator<Item = DVec3> {
    let (axis, least) = match light.kind {
        LightKind::Spot { outer, .. } => (light.direction.as_dvec3(), f64::from(outer).cos()),
        LightKind::Point | LightKind::Directional => (DVec3::Z, -1.0),
    };
    let (across, up) = axis.any_orthonormal_pair();
    // A Fibonacci lattice.
    (0..DIRECTIONS).map(move |i| {
        let along = 1.0 - (i as f64 + 0.5) / DIRECTIONS as f64 * (1.0 - least);
        let (sin, cos) = (i as f64 * PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
        axis * along + (across * cos + up * sin) * (1.0 - along * along).max(0.0).sqrt()
    })
}

/// Where a ray from the origin meets a triangle, from either side: Möller and Trumbore 1997.
fn meets([a, b, c]: &[DVec3; 3], direction: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    let v = -a.dot(across) / determinant;
    let around = (-*a).cross(ab);
    let w = direction.dot(around) / determinant;
    // NaN, where the ray runs along the triangle, is in no range.
    let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0;
    Some(ac.dot(around) / determinant).filter(|distance| inside && *distance > 0.0)
}

fn is_opaque(scene: &Scene, instance: &Instance) -> bool {
    let material = &scene.materials[scene.meshes[instance.mesh].material];
    material.alpha_cutoff.is_none() && !material.blended && material.transmission == 0.0
}

fn around(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

fn corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |i| DVec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), high, low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, builtin};
    use glam::Mat4;

    /// A cube around the origin of side 2; without its lid if it is open.
    fn cube(open: bool) -> Mesh {
        let positions = (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0);
        let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [0, 2, 6, 4], [1, 3, 7, 5], [2, 3, 7, 6]];
        let sides = &sides[..if open { 5 } else { 6 }];
        Mesh {
            name: "bulb".to_owned(),
            positions: positions.collect(),
            indices: sides.iter().flat_map(|s| [s[0], s[1], s[2], s[0], s[2], s[3]]).collect(),
            ..Mesh::default()
        }
    }

    /// A light in a cube of this size that stands on the floor of a hall.
    fn scene(open: bool, size: f32, light: Light, material: impl FnOnce(&mut Material)) -> Scene {
        let mut scene = builtin::builtin("flat").unwrap();
        material(&mut scene.materials[0]);
        let place = Mat4::from_translation(Vec3::new(1.0, 2.0, 3.0));
        let instance = |mesh, world_from_mesh, object| Instance { mesh, world_from_mesh, object };
        scene.meshes = vec![cube(open), Mesh { name: "hall".to_owned(), ..cube(false) }];
        scene.instances = vec![
            instance(0, place * Mat4::from_scale(Vec3::splat(size)), 1),
            instance(1, place * Mat4::from_scale(Vec3::splat(10.0)), 2),
        ];
        scene.lights = vec![light];
        scene
    }

    fn light() -> Light {
        Light {
            kind: LightKind::Point,
            position: Vec3::new(1.0, 2.1, 3.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::ONE,
            range: f32::INFINITY,
            casts: true,
        }
    }

    #[test]
    fn a_light_in_a_closed_body_is_told_of() {
        let told = notices(&scene(false, 0.3, light(), |_| ()));
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].contains("(1, 2.1, 3)") && told[0].contains("bulb"), "{}", told[0]);
    }

    #[test]
    fn nothing_is_said_where_light_gets_out() {
        let none = |scene: &Scene, why: &str| assert_eq!(notices(scene), [""; 0], "{why}");
        none(&scene(true, 0.3, light(), |_| ()), "it is open");
        none(&scene(false, 9.0, light(), |_| ()), "it is a room");
        none(&scene(false, 0.3, light(), |m| m.transmission = 1.0), "it is of glass");
        none(&scene(false, 0.3, light(), |m| m.alpha_cutoff = Some(0.5)), "it has holes");
        none(&scene(false, 0.3, Light { casts: false, ..light() }, |_| ()), "no shadows");
        none(&scene(false, 0.3, Light { position: Vec3::ZERO, ..light() }, |_| ()), "it stands outside");
    }

    #[test]
    fn spots_count_by_their_cone() {
        let spot = |direction| Light { kind: LightKind::Spot { inner: 0.1, outer: 0.4 }, direction, ..light() };
        // The lid that is missing is the one at +y.
        assert_eq!(notices(&scene(true, 0.3, spot(Vec3::NEG_Y), |_| ())).len(), 1);
        assert_eq!(notices(&scene(true, 0.3, spot(Vec3::Y), |_| ())).len(), 0);
    }

    #[test]
    fn the_built_in_scenes_have_no_such_light() {
        for name in builtin::NAMES {
            let scene = builtin::builtin(name).unwrap();
            assert_eq!(notices(&scene), [""; 0], "{name}");
        }
    }
}
