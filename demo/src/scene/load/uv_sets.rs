//! One set of texture coordinates for materials whose maps read several. A G-buffer keeps one, so a primitive falls into
//! pieces over each of which every set is an affine image of one of them, and the material's maps are read through that.

use glam::{DMat2, DVec2, DVec3, Vec2, Vec3};

use super::compact::compact;
use super::material::MaterialTable;
use crate::scene::Mesh;

/// More pieces of one primitive than this would cost more than the maps are worth.
const MAX_PIECES: usize = 256;

/// How far an image may be off: a quarter of a texel of 4096.
const TOLERANCE: f64 = 1.0 / 16384.0;

/// The rows that lead from coordinates of one set to those of another.
type Rows = [DVec3; 2];

/// Triangles that share the affine maps.
struct Piece {
    /// The set that the others are taken from.
    from: usize,
    /// For each set.
    rows: Vec<Rows>,
    triangles: Vec<usize>,
}

/// Gives `mesh` the coordinates of one of the `sets`, of which `uvs` has those of all vertices; in pieces of their own
/// materials where there are several. Says which maps had to be left out.
pub(super) fn merge(
    mut mesh: Mesh,
    sets: &[u32],
    mut uvs: Vec<Vec<Vec2>>,
    materials: &mut MaterialTable,
    notices: &mut Vec<String>,
) -> Vec<Mesh> {
    let material = mesh.material;
    let pieces = if sets.len() > 1 { pieces(&mesh.indices, &uvs) } else { None };
    let Some(pieces) = pieces else {
        for &set in &sets[1..] {
            for map in materials.maps_on(material, set) {
                notices.push(format!(
                    "{}: {map} texture ignored, TEXCOORD_{set} is no affine image of TEXCOORD_{} in {MAX_PIECES} pieces",
                    mesh.name, sets[0],
                ));
            }
        }
        if sets.len() > 1 {
            mesh.material = materials.on_one_set(material, |set| (set == sets[0]).then_some([Vec3::X, Vec3::Y]));
        }
        mesh.uvs = uvs.swap_remove(0);
        return vec![mesh];
    };
    let piece = |piece: &Piece| {
        let corners = piece.triangles.iter().flat_map(|t| &mesh.indices[3 * t..][..3]);
        let mut indices: Vec<u32> = corners.copied().collect();
        let used = compact(&mut indices, mesh.positions.len());
        let rows = |set: u32| {
            let at = sets.iter().position(|&other| other == set)?;
            Some(piece.rows[at].map(|row| row.as_vec3()))
        };
        Mesh {
            name: mesh.name.clone(),
            positions: pick(&mesh.positions, &used),
            normals: pick(&mesh.normals, &used),
            tangents: if mesh.tangents.is_empty() { Vec::new() } else { pick(&mesh.tangents, &used) },
            uvs: pick(&uvs[piece.from], &used),
            colors: pick(&mesh.colors, &used),
            indices,
            material: materials.on_one_set(material, rows),
        }
    };
    pieces.iter().map(piece).collect()
}

fn pick<T: Copy>(all: &[T], used: &[u32]) -> Vec<T> {
    used.iter().map(|&vertex| all[vertex as usize]).collect()
}

/// `None` if there would be too many.
fn pieces(indices: &[u32], uvs: &[Vec<Vec2>]) -> Option<Vec<Piece>> {
    let corners = |t: usize, set: usize| [0, 1, 2].map(|k| uvs[set][indices[3 * t + k] as usize].as_dvec2());
    // The largest first, for their maps are the most exact.
    let mut order: Vec<(f64, usize)> = (0..indices.len() / 3).map(|t| (area(corners(t, 0)).abs(), t)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut pieces: Vec<Piece> = Vec::new();
    for (_, t) in order {
        let fits = |piece: &Piece| {
            let from = corners(t, piece.from);
            (0..uvs.len()).all(|set| {
                let off = |(p, q): (DVec2, DVec2)| (apply(&piece.rows[set], p) - q).abs().max_element();
                let mut pairs = from.into_iter().zip(corners(t, set));
                pairs.all(|pair| off(pair) <= TOLERANCE + 1e-6 * pair.1.abs().max_element())
            })
        };
        if let Some(piece) = pieces.iter_mut().find(|piece| fits(piece)) {
            piece.triangles.push(t);
            continue;
        }
        if pieces.len() == MAX_PIECES {
            return None;
        }
        let spans = |&set: &usize| {
            let [a, b, c] = corners(t, set);
            area([a, b, c]).abs() > 1e-6 * (b - a).length() * (c - a).length()
        };
        // Where no set spans the triangle, its corner stands for it.
        let from = (0..uvs.len()).find(spans);
        let rows = |set| from.map_or(constant(corners(t, set)[0]), |from| affine(corners(t, from), corners(t, set)));
        pieces.push(Piece { from: from.unwrap_or(0), rows: (0..uvs.len()).map(rows).collect(), triangles: vec![t] });
    }
    for piece in &mut pieces {
        piece.triangles.sort_unstable();
    }
    Some(pieces)
}

/// Twice the signed area of a triangle.
fn area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

fn constant(q: DVec2) -> Rows {
    [DVec3::Z * q.x, DVec3::Z * q.y]
}

/// The map that leads the corners of one triangle to those of another.
fn affine(from: [DVec2; 3], to: [DVec2; 3]) -> Rows {
    if from == to {
        return [DVec3::X, DVec3::Y];
    }
    let edges = |[a, b, c]: [DVec2; 3]| DMat2::from_cols(b - a, c - a);
    let linear = edges(to) * edges(from).inverse();
    let offset = to[0] - linear * from[0];
    [linear.row(0).extend(offset.x), linear.row(1).extend(offset.y)]
}

fn apply(rows: &Rows, p: DVec2) -> DVec2 {
    DVec2::new(rows[0].dot(p.extend(1.0)), rows[1].dot(p.extend(1.0)))
}
