//! From a glTF primitive to a mesh.

use glam::{Vec2, Vec3, Vec4};
use gltf::json::Index;
use gltf::json::accessor::Accessor;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::{Document, Elements};
use super::compact::compact;
use super::error::Problem;
use super::material::MaterialTable;
use super::placement::{Motion, Shape};
use super::skin::{Pose, Skin};
use super::uv_sets;
use crate::scene::vectors::unit;
use crate::scene::{Mesh, tangents};

/// Triangle corners of all meshes together, before and after strips are taken apart.
pub(super) const MAX_CORNERS: usize = 200_000_000;

/// A primitive's readable attributes.
struct Attributes<'a> {
    positions: Elements<'a>,
    normals: Option<Elements<'a>>,
    tangents: Option<Elements<'a>>,
    /// Of each set that the material reads.
    uvs: Vec<Option<Elements<'a>>>,
    colors: Option<Elements<'a>>,
}

/// Converts `primitive`, whose vertices are moved first: to one mesh, or to several where its material needs that. Nothing
/// with a notice if there is nothing to draw. `budget` is what is left of [`MAX_CORNERS`].
pub(super) fn convert(
    document: &Document,
    primitive: &Primitive,
    place: &str,
    (shape, skin): (Shape, Option<&Skin>),
    materials: &mut MaterialTable,
    budget: &mut usize,
    notices: &mut Vec<String>,
) -> Result<Vec<Mesh>, Problem> {
    let mut notice = |text: String| notices.push(format!("{place}: {text}"));
    let mode = match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
        Checked::Valid(_) => {
            notice("points and lines are not drawn".to_owned());
            return Ok(Vec::new());
        }
        Checked::Invalid => {
            notice("skipped, its mode is unknown".to_owned());
            return Ok(Vec::new());
        }
    };
    let material = materials.material(primitive.material, place)?;
    let sets = materials.uv_sets(material);
    let Some(attributes) = Attributes::find(document, primitive, place, &sets)? else {
        notice("skipped, it has no positions".to_owned());
        return Ok(Vec::new());
    };
    let count = attributes.positions.len();

    let order: Vec<u32> = match primitive.indices {
        Some(index) => {
            let elements = elements(document, index, place)?;
            if !elements.are_indices() {
                return Err(damaged(place, index, "its elements are no indices"));
            }
            spend(budget, elements.len())?;
            (0..elements.len()).map(|i| elements.index(i)).collect()
        }
        None => {
            spend(budget, count)?;
            // The budget is far below the range of u32.
            (0..count as u32).collect()
        }
    };
    if let Some(&bad) = order.iter().find(|&&index| index as usize >= count) {
        return Err(Problem::Index { place: place.to_owned(), index: bad, vertices: count });
    }
    if mode != Mode::Triangles {
        spend(budget, order.len().saturating_mul(2))?;
    } else if !order.len().is_multiple_of(3) {
        notice("the last triangle is incomplete and left out".to_owned());
    }
    let mut corners = triangles(mode, order);

    let pose = skin.map(|skin| Pose::find(document, primitive, place, skin, count)).transpose()?.flatten();
    let motion = match pose {
        Some(pose) => {
            pose.check(&corners, place)?;
            Motion::Skinned(pose)
        }
        None if skin.is_some() => {
            notice("skipped, it has no joints as others of its mesh have".to_owned());
            return Ok(Vec::new());
        }
        None => Motion::of(shape),
    };
    if matches!(motion, Motion::Skinned(_)) {
        corners.as_chunks_mut::<3>().0.iter_mut().filter(|t| motion.mirrors(t[0])).for_each(|t| t.swap(1, 2));
    }
    let position = |vertex: u32| motion.position(vertex, attributes.positions.floats(vertex as usize).into());
    let before = corners.len();
    retain_triangles(&mut corners, |triangle| triangle.iter().all(|&vertex| position(vertex).is_finite()));
    if corners.len() < before {
        notice(format!("{} triangles left out, their positions are not finite", (before - corners.len()) / 3));
    }
    if corners.is_empty() {
        notice("skipped, it has no triangles".to_owned());
        return Ok(Vec::new());
    }

    // Primitives often share long vertex arrays of which each needs a part.
    let used = match &attributes.normals {
        Some(_) => compact(&mut corners, count),
        // Flat shading wants vertices of their own for every triangle.
        None => {
            let own = (0..corners.len() as u32).collect();
            std::mem::replace(&mut corners, own)
        }
    };
    let mut mesh = Mesh {
        name: place.to_owned(),
        positions: used.iter().map(|&vertex| position(vertex)).collect(),
        indices: corners,
        material,
        ..Mesh::default()
    };
    let (uvs, repaired) = attributes.fill(&mut mesh, &used, &motion);
    if repaired > 0 {
        notice(format!("{repaired} vertices repaired, they had no usable normal, colour or texture coordinate"));
    }
    let given = attributes.normals.as_ref().and(attributes.tangents.as_ref());
    if let Some(given) = given {
        let given = used.iter().map(|&vertex| {
            let own = Vec4::from(given.floats(vertex as usize));
            let sign = if motion.mirrors(vertex) { -own.w } else { own.w };
            motion.tangent(vertex, own.truncate()).extend(sign)
        });
        mesh.tangents = given.zip(&mesh.normals).map(|(t, &n)| tangents::orthogonal(t, n)).collect();
    }

    let mut meshes = uv_sets::merge(mesh, &sets, uvs, materials, notices);
    for mesh in meshes.iter_mut().filter(|_| given.is_none()) {
        match materials.materials[mesh.material].normal_texture {
            Some(map) => tangents::generate(mesh, &map),
            None => tangents::arbitrary(mesh),
        }
    }
    Ok(meshes)
}

impl<'a> Attributes<'a> {
    /// `None` if there are no positions.
    fn find(
        document: &'a Document,
        primitive: &Primitive,
        place: &str,
        uv_sets: &[u32],
    ) -> Result<Option<Self>, Problem> {
        let find = |semantic: Semantic, shapes: &[usize]| {
            let Some(&index) = primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
            let elements = elements(document, index, place)?;
            if !shapes.contains(&elements.dimensions()) {
                return Err(damaged(place, index, "its elements have the wrong number of components"));
            }
            Ok(Some((index, elements)))
        };
        let Some((_, positions)) = find(Semantic::Positions, &[3])? else { return Ok(None) };
        let find = |semantic: Semantic, shapes: &[usize]| match find(semantic, shapes)? {
            Some((index, elements)) if elements.len() < positions.len() => {
                let reason = format!("{} elements for {} vertices", elements.len(), positions.len());
                Err(damaged(place, index, &reason))
            }
            found => Ok(found.map(|(_, elements)| elements)),
        };
        Ok(Some(Self {
            normals: find(Semantic::Normals, &[3])?,
            tangents: find(Semantic::Tangents, &[4])?,
            uvs: uv_sets.iter().map(|&set| find(Semantic::TexCoords(set), &[2])).collect::<Result<_, _>>()?,
            colors: find(Semantic::Colors(0), &[3, 4])?,
            positions,
        }))
    }

    /// Adds normals and colours to `mesh`, whose vertices are these. Returns the texture coordinates of each set, and how
    /// many vertices were unusable and had to be repaired.
    fn fill(&self, mesh: &mut Mesh, used: &[u32], motion: &Motion) -> (Vec<Vec<Vec2>>, usize) {
        let mut bad = vec![false; used.len()];
        let vertices = || used.iter().map(|&vertex| vertex as usize).enumerate();

        mesh.normals = match &self.normals {
            Some(normals) => vertices()
                .map(|(i, v)| {
                    let own = unit(normals.floats(v).into());
                    bad[i] = own.is_none();
                    own.map_or(Vec3::ZERO, |own| motion.normal(used[i], own))
                })
                .collect(),
            None => vec![Vec3::ZERO; used.len()],
        };
        for triangle in mesh.indices.chunks_exact(3) {
            if triangle.iter().all(|&vertex| mesh.normals[vertex as usize] != Vec3::ZERO) {
                continue;
            }
            let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[triangle[k] as usize].as_dvec3());
            let flat = (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |normal| normal.as_vec3());
            for &vertex in triangle {
                let normal = &mut mesh.normals[vertex as usize];
                if *normal == Vec3::ZERO {
                    *normal = flat;
                }
            }
        }

        let mut coordinates = |uvs: &Option<Elements>| match uvs {
            Some(uvs) => vertices()
                .map(|(i, v)| {
                    let uv = Vec2::from(uvs.floats(v));
                    bad[i] |= !uv.is_finite();
                    if uv.is_finite() { uv } else { Vec2::ZERO }
                })
                .collect(),
            None => vec![Vec2::ZERO; used.len()],
        };
        let uvs = self.uvs.iter().map(&mut coordinates).collect();
        mesh.colors = match &self.colors {
            Some(colors) => vertices()
                .map(|(i, v)| {
                    let color = match colors.dimensions() {
                        3 => Vec3::from(colors.floats(v)).extend(1.0),
                        _ => Vec4::from(colors.floats(v)),
                    };
                    bad[i] |= !color.is_finite();
                    if color.is_finite() { color.clamp(Vec4::ZERO, Vec4::ONE) } else { Vec4::ONE }
                })
                .collect(),
            None => vec![Vec4::ONE; used.len()],
        };
        (uvs, bad.into_iter().filter(|&bad| bad).count())
    }
}

/// Takes strips and fans apart, keeping the winding.
fn triangles(mode: Mode, mut order: Vec<u32>) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => order
            .windows(3)
            .enumerate()
            .flat_map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        Mode::TriangleFan => match order.split_first() {
            Some((&hub, rim)) => rim.windows(2).flat_map(|w| [hub, w[0], w[1]]).collect(),
            None => Vec::new(),
        },
        _ => {
            order.truncate(order.len() / 3 * 3);
            order
        }
    }
}

fn retain_triangles(corners: &mut Vec<u32>, keep: impl Fn(&[u32]) -> bool) {
    if !corners.chunks_exact(3).all(&keep) {
        *corners = corners.chunks_exact(3).filter(|&triangle| keep(triangle)).flatten().copied().collect();
    }
}

fn elements<'a>(document: &'a Document, index: Index<Accessor>, place: &str) -> Result<Elements<'a>, Problem> {
    document.elements(index).map_err(|reason| damaged(place, index, &reason))
}

fn damaged(place: &str, accessor: Index<Accessor>, reason: &str) -> Problem {
    Problem::Accessor { place: place.to_owned(), accessor: accessor.value(), reason: reason.to_owned() }
}

fn spend(budget: &mut usize, corners: usize) -> Result<(), Problem> {
    *budget = budget
        .checked_sub(corners)
        .ok_or_else(|| Problem::TooLarge { what: "the triangle corners".to_owned(), limit: MAX_CORNERS })?;
    Ok(())
}
