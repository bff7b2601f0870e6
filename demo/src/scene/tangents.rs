//! Tangents for normal maps that come without.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use super::vectors::unit;
use super::{Mesh, TextureRef};

/// Beyond this, products in MikkTSpace overflow.
const MAX_COORDINATE: f32 = 1e9;
/// MikkTSpace takes time in the square of the number of triangles around a point, and recurses as deep.
const MAX_AROUND: u32 = 256;

/// Gives `mesh` MikkTSpace tangents for a normal map that is read through `map`. Vertices whose triangles disagree
/// are duplicated.
pub(super) fn generate(mesh: &mut Mesh, map: &TextureRef) {
    let uvs: Vec<Vec2> =
        mesh.uvs.iter().map(|uv| uv.extend(1.0)).map(|uv| Vec2::new(map.u_row.dot(uv), map.v_row.dot(uv))).collect();
    let mut tangents: Vec<_> =
        mesh.indices.chunks_exact(3).flat_map(|face| [face_tangent(mesh, &uvs, face); 3]).collect();
    let faces = digestible(mesh, &uvs);
    // The error type has no values.
    let _ = generate_tangents(&mut Corners { mesh, uvs: &uvs, faces: &faces, tangents: &mut tangents });
    weld(mesh, &tangents);
}

/// The triangles that MikkTSpace can take without overflow or excessive time. It would give degenerate ones the
/// tangents of their neighbours after a search through all triangles; [`weld`] does so at once.
fn digestible(mesh: &Mesh, uvs: &[Vec2]) -> Vec<usize> {
    let at = |vertex: u32| mesh.positions[vertex as usize];
    let key = |vertex: u32| at(vertex).to_array().map(f32::to_bits);
    let mut around = HashMap::new();
    for &vertex in &mesh.indices {
        *around.entry(key(vertex)).or_insert(0) += 1;
    }
    let is_digestible = |face: &[u32]| {
        let distinct = at(face[0]) != at(face[1]) && at(face[1]) != at(face[2]) && at(face[2]) != at(face[0]);
        distinct
            && face.iter().all(|&vertex| {
                let greatest = at(vertex).abs().max_element().max(uvs[vertex as usize].abs().max_element());
                greatest < MAX_COORDINATE && around[&key(vertex)] <= MAX_AROUND
            })
    };
    (0..mesh.indices.len() / 3).filter(|&face| is_digestible(&mesh.indices[3 * face..][..3])).collect()
}

/// The direction in which u grows over a triangle, if it does.
fn face_tangent(mesh: &Mesh, uvs: &[Vec2], face: &[u32]) -> Option<Vec4> {
    let [a, b, c] = [0, 1, 2].map(|k| (mesh.positions[face[k] as usize].as_dvec3(), uvs[face[k] as usize].as_dvec2()));
    let area = (b.1 - a.1).perp_dot(c.1 - a.1);
    let along_u = ((b.0 - a.0) * (c.1 - a.1).y - (c.0 - a.0) * (b.1 - a.1).y) * area.signum();
    let direction = along_u.try_normalize().filter(|_| area != 0.0)?;
    // As in `set_tangent` below.
    Some(direction.as_vec3().extend(if area > 0.0 { -1.0 } else { 1.0 }))
}

/// Arbitrary tangents, for meshes whose materials need none.
pub(super) fn arbitrary(mesh: &mut Mesh) {
    mesh.tangents = mesh.normals.iter().map(|&normal| any_tangent(normal)).collect();
}

/// `tangent` made orthogonal to the unit `normal`, with a proper sign; any tangent if that cannot be done.
pub(super) fn orthogonal(tangent: Vec4, normal: Vec3) -> Vec4 {
    let Some(direction) = unit(tangent.truncate()) else { return any_tangent(normal) };
    let rejected = direction - normal * normal.dot(direction);
    if rejected.length() < 1e-3 {
        // What is left is rounding.
        return any_tangent(normal);
    }
    rejected.normalize().extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}

fn any_tangent(normal: Vec3) -> Vec4 {
    normal.any_orthonormal_vector().extend(1.0)
}

/// Turns a tangent per corner into a tangent per vertex.
fn weld(mesh: &mut Mesh, corners: &[Option<Vec4>]) {
    const UNSET: Vec4 = Vec4::ZERO;
    mesh.tangents = vec![UNSET; mesh.positions.len()];
    // The next duplicate of each vertex.
    let mut next: Vec<Option<u32>> = vec![None; mesh.positions.len()];
    for (index, corner) in mesh.indices.iter_mut().zip(corners) {
        let Some(tangent) = *corner else { continue };
        let mut vertex = *index as usize;
        loop {
            if mesh.tangents[vertex] == UNSET {
                mesh.tangents[vertex] = tangent;
            }
            if mesh.tangents[vertex] == tangent {
                break;
            }
            vertex = match next[vertex] {
                Some(duplicate) => duplicate as usize,
                None => {
                    let duplicate = mesh.positions.len();
                    next[vertex] = Some(duplicate as u32);
                    next.push(None);
                    mesh.positions.push(mesh.positions[vertex]);
                    mesh.normals.push(mesh.normals[vertex]);
                    mesh.uvs.push(mesh.uvs[vertex]);
                    mesh.colors.push(mesh.colors[vertex]);
                    mesh.tangents.push(tangent);
                    duplicate
                }
            };
        }
        *index = vertex as u32;
    }
    for (tangent, &normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
        *tangent = orthogonal(*tangent, normal);
    }
}

struct Corners<'a> {
    mesh: &'a Mesh,
    uvs: &'a [Vec2],
    /// The triangles that are shown to MikkTSpace.
    faces: &'a [usize],
    /// Of all triangles.
    tangents: &'a mut [Option<Vec4>],
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[3 * self.faces[face] + corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.faces.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uvs[self.vertex(face, corner)].into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        // MikkTSpace's bitangent follows v, which in glTF points down the picture; the normal map's y points up.
        let tangent = space.map(|space| Vec4::from(space.tangent_encoded()) * Vec4::new(1.0, 1.0, 1.0, -1.0));
        let usable = tangent.filter(|tangent| tangent.is_finite() && tangent.truncate() != Vec3::ZERO);
        if usable.is_some() {
            self.tangents[3 * self.faces[face] + corner] = usable;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: TextureRef = TextureRef { texture: 0, u_row: Vec3::X, v_row: Vec3::Y };

    /// A flat mesh facing +z, textured upright: u to the right, v down.
    fn flat(points: &[(f32, f32)], indices: Vec<u32>) -> Mesh {
        let points = points.iter().map(|&point| Vec2::from(point));
        Mesh {
            positions: points.clone().map(|p| p.extend(0.0)).collect(),
            normals: vec![Vec3::Z; points.len()],
            uvs: points.clone().map(|p| Vec2::new(p.x, -p.y)).collect(),
            colors: vec![Vec4::ONE; points.len()],
            indices,
            ..Mesh::default()
        }
    }

    fn square() -> Mesh {
        flat(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], vec![0, 1, 2, 0, 2, 3])
    }

    #[test]
    fn an_upright_picture_has_its_bitangent_up() {
        let mut mesh = square();
        generate(&mut mesh, &PLAIN);
        assert_eq!(mesh.tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        let [n, t] = [mesh.normals[0], mesh.tangents[0].truncate()];
        assert_eq!(n.cross(t) * mesh.tangents[0].w, Vec3::Y);
    }

    #[test]
    fn the_texture_transform_turns_tangents() {
        let mut mesh = square();
        generate(&mut mesh, &TextureRef { u_row: Vec3::NEG_X, ..PLAIN });
        assert_eq!(mesh.tangents, [Vec4::new(-1.0, 0.0, 0.0, -1.0); 4]);
    }

    #[test]
    fn mirrored_halves_get_vertices_of_their_own() {
        let mut mesh = flat(
            &[(-1.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0)],
            vec![0, 1, 4, 0, 4, 5, 1, 2, 3, 1, 3, 4],
        );
        for uv in &mut mesh.uvs {
            uv.x = uv.x.abs();
        }
        generate(&mut mesh, &PLAIN);
        assert_eq!(mesh.positions.len(), 8, "the two vertices in the middle are split");
        for (i, &index) in mesh.indices.iter().enumerate() {
            let sign = if i < 6 { -1.0 } else { 1.0 };
            assert_eq!(mesh.tangents[index as usize], Vec4::new(sign, 0.0, 0.0, sign), "corner {i}");
        }
    }

    #[test]
    fn nothing_explodes_without_usable_texture_coordinates() {
        for uv in [Vec2::ZERO, Vec2::splat(1e30), Vec2::splat(f32::MAX)] {
            let mut mesh = square();
            mesh.uvs = vec![uv; 4];
            mesh.indices.extend([1, 1, 2, 3, 3, 3]);
            generate(&mut mesh, &PLAIN);
            assert!(mesh.tangents.iter().all(|t| t.is_finite() && (t.truncate().length() - 1.0).abs() < 1e-5));
        }
    }

    #[test]
    fn a_fan_of_many_triangles_neither_overflows_nor_takes_for_ever() {
        const RIM: u32 = 200_000;
        let rim = (0..RIM).map(|i| (i as f32 / RIM as f32 * 6.0).sin_cos());
        let points: Vec<(f32, f32)> = std::iter::once((0.0, 0.0)).chain(rim).collect();
        let mut mesh = flat(&points, (1..RIM).flat_map(|i| [0, i + 1, i]).collect());
        generate(&mut mesh, &PLAIN);
        assert!(mesh.tangents.iter().all(|t| t.truncate().dot(Vec3::X) > 0.9));
    }
}
