//! The same scene with more lights or more triangles, for cost against them.

use crate::scene::{Bounds, Light, LightKind, Mesh, Scene};
use glam::{Vec3, Vec4};
use std::collections::HashMap;

/// Triangles of all instances.
pub fn triangles(scene: &Scene) -> u64 {
    scene.instances.iter().map(|i| scene.meshes[i.mesh].indices.len() as u64 / 3).sum()
}

/// Triangles of all meshes: what memory has to hold.
fn stored_triangles(scene: &Scene) -> u64 {
    scene.meshes.iter().map(|m| m.indices.len() as u64 / 3).sum()
}

/// The scene with point lights spread inside its bounds until it has `count`. They are faint, so that the picture, and
/// with it what is shaded, stays about the same.
pub fn with_lights(scene: &Scene, count: usize) -> Scene {
    let mut lit = scene.clone();
    let bounds = scene.bounds().unwrap_or(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
    // A white wall at this distance gets about 1/count of a radiance of 0.1.
    let distance = bounds.radius().clamp(1e-3, 1e15) * 0.25;
    let intensity = Vec3::splat(0.1 * std::f32::consts::PI * distance * distance / count.max(1) as f32);
    for i in scene.lights.len()..count {
        let place = Vec3::new(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5));
        let position = bounds.min + (bounds.max - bounds.min) * place;
        lit.lights.push(Light {
            kind: LightKind::Point,
            position,
            direction: Vec3::NEG_Y,
            intensity,
            range: f32::INFINITY,
            casts: false,
        });
    }
    lit
}

/// Halton's sequence in one base: the digits of `i` behind the point, in reverse.
fn radical_inverse(mut i: usize, base: usize) -> f32 {
    let (mut value, mut place) = (0.0, 1.0 / base as f32);
    while i > 0 {
        value += (i % base) as f32 * place;
        place /= base as f32;
        i /= base;
    }
    value
}

/// Every triangle cut into four at the middles of its edges, `times` times over: the same surfaces, the same picture.
/// `None` where the meshes would have more than `most` triangles together.
pub fn subdivided(scene: &Scene, times: u32, most: u64) -> Option<Scene> {
    if stored_triangles(scene).checked_mul(4u64.checked_pow(times)?)? > most {
        return None;
    }
    let mut fine = scene.clone();
    for _ in 0..times {
        fine.meshes.iter_mut().for_each(subdivide);
    }
    Some(fine)
}

fn subdivide(mesh: &mut Mesh) {
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let old = std::mem::take(&mut mesh.indices);
    for triangle in old.as_chunks::<3>().0 {
        let [a, b, c] = *triangle;
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)]
            .map(|(p, q)| *middles.entry((p.min(q), p.max(q))).or_insert_with(|| mesh.middle(p, q)));
        mesh.indices.extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca]);
    }
}

impl Mesh {
    /// Adds the vertex in the middle of two.
    fn middle(&mut self, p: u32, q: u32) -> u32 {
        let (p, q) = (p as usize, q as usize);
        self.positions.push(self.positions[p].midpoint(self.positions[q]));
        let normal = (self.normals[p] + self.normals[q]).normalize_or(self.normals[p]);
        self.normals.push(normal);
        let (s, t) = (self.tangents[p], self.tangents[q]);
        // Orthogonal to the normal again; a mirrored pair keeps the first one's side.
        let along = (s.truncate() + t.truncate()).reject_from_normalized(normal);
        let along = along.normalize_or(normal.any_orthonormal_vector());
        self.tangents.push(Vec4::from((along, s.w)));
        self.uvs.push(self.uvs[p].midpoint(self.uvs[q]));
        self.colors.push(self.colors[p].midpoint(self.colors[q]));
        self.positions.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::builtin;

    #[test]
    fn subdivision_keeps_the_surface() {
        let area = |scene: &Scene| -> f32 {
            let mut sum = 0.0;
            for mesh in &scene.meshes {
                for t in mesh.indices.as_chunks::<3>().0 {
                    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                    sum += (b - a).cross(c - a).length();
                }
            }
            sum
        };
        let scene = builtin("cornell").unwrap();
        let fine = subdivided(&scene, 2, u64::MAX).unwrap();
        fine.validate().unwrap();
        assert_eq!(triangles(&fine), 16 * triangles(&scene));
        assert!((area(&fine) / area(&scene) - 1.0).abs() < 1e-4);
        assert_eq!(fine.bounds(), scene.bounds());
        let [a, b] = [0, 1].map(|i| scene.meshes[0].positions[scene.meshes[0].indices[i] as usize]);
        assert!(fine.meshes[0].positions.contains(&a.midpoint(b)), "the middle of the first edge");
        // Neighbours share the vertices on their common edges.
        assert!(fine.meshes[0].positions.len() < 3 * fine.meshes[0].indices.len() / 4);
    }

    #[test]
    fn too_many_triangles_are_refused() {
        let scene = builtin("cornell").unwrap();
        let stored = stored_triangles(&scene);
        assert!(subdivided(&scene, 1, 4 * stored).is_some());
        assert!(subdivided(&scene, 1, 4 * stored - 1).is_none());
        assert!(subdivided(&scene, 40, u64::MAX).is_none());
    }

    #[test]
    fn lights_are_added_inside_and_always_the_same() {
        let scene = builtin("atrium").unwrap();
        let (lit, bounds) = (with_lights(&scene, 64), scene.bounds().unwrap());
        lit.validate().unwrap();
        assert_eq!(lit.lights.len(), 64);
        assert_eq!(lit.lights[..scene.lights.len()], scene.lights);
        assert!(
            lit.lights[scene.lights.len()..]
                .iter()
                .all(|l| { l.position.cmpge(bounds.min).all() && l.position.cmple(bounds.max).all() })
        );
        assert_eq!(lit.lights, with_lights(&scene, 64).lights);
        assert_eq!(with_lights(&scene, 0).lights, scene.lights);
    }
}
