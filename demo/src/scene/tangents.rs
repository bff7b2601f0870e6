//! Tangents for normal maps that come without.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};

use crate::scene::{Mesh, TextureRef};

/// Beyond this, products in MikkTSpace overflow.
const MAX_COORDINATE: f32 = 1e9;

/// Gives `mesh` MikkTSpace tangents for a normal map that is read through `map`. Vertices whose triangles disagree
/// are duplicated.
pub(super) fn generate(mesh: &mut Mesh, map: &TextureRef) {
    let uvs: Vec<[f32; 2]> = mesh
        .uvs
        .iter()
        .map(|uv| [map.u_row.dot(uv.extend(1.0)), map.v_row.dot(uv.extend(1.0))])
        .collect();
    let moderate = mesh.positions.iter().flat_map(|p| p.to_array()).chain(uvs.iter().flatten().copied());
    let mut corners = vec![None; mesh.indices.len()];
    if moderate.into_iter().all(|x| x.abs() < MAX_COORDINATE) {
        // The error type has no values.
        let _ = generate_tangents(&mut Corners { mesh, uvs: &uvs, tangents: &mut corners });
    }
    weld(mesh, &corners);
}

/// Arbitrary tangents, for meshes whose materials need none.
pub(super) fn arbitrary(mesh: &mut Mesh) {
    mesh.tangents = mesh.normals.iter().map(|&normal| any_tangent(normal)).collect();
}

/// `tangent` made orthogonal to the unit `normal`, with a proper sign; any tangent if that cannot be done.
pub(super) fn orthogonal(tangent: Vec4, normal: Vec3) -> Vec4 {
    let direction = tangent.truncate();
    match (direction - normal * normal.dot(direction)).try_normalize() {
        Some(direction) => direction.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 }),
        None => any_tangent(normal),
    }
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
    uvs: &'a [[f32; 2]],
    tangents: &'a mut [Option<Vec4>],
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[3 * face + corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.indices.len() / 3
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
        self.uvs[self.vertex(face, corner)]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        // MikkTSpace's bitangent follows v, which in glTF points down the picture; the normal map's y points up.
        self.tangents[3 * face + corner] = space
            .map(|space| Vec4::from(space.tangent_encoded()) * Vec4::new(1.0, 1.0, 1.0, -1.0))
            .filter(|tangent| tangent.is_finite());
    }
}
