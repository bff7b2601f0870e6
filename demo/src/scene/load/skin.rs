//! Skins at rest: vertices stand where their joints put them, and the node of the mesh has no say.

use glam::{DAffine3, DMat4, DVec3, Mat4};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::{Document, Elements};
use super::error::Problem;
use super::limits::label;
use super::nodes::is_sane;

/// The joints of a skin.
pub(super) struct Skin {
    /// How messages call it.
    place: String,
    /// World, less the origin, from the pose in which the mesh was bound.
    joints: Vec<DAffine3>,
    /// Where the first joint stands, so that vertices far from the world's origin keep their digits.
    pub origin: DVec3,
}

impl Skin {
    /// Skin `number` of the file, which `user` names. `worlds` are the world matrices of all nodes.
    pub fn read(document: &Document, number: usize, user: &str, worlds: &[Mat4]) -> Result<Self, Problem> {
        let root = &document.root;
        let dangling =
            |from: &str, kind, index, count| Problem::Reference { from: from.to_owned(), kind, index, count };
        let skin = root.skins.get(number).ok_or_else(|| dangling(user, "skin", number, root.skins.len()))?;
        let place = label("skin", number, skin.name.as_deref());
        let damaged = |accessor: usize, reason: String| Problem::Accessor { place: place.clone(), accessor, reason };
        let inverse_bind = match skin.inverse_bind_matrices {
            Some(index) => {
                let elements = document.elements(index).map_err(|reason| damaged(index.value(), reason))?;
                if elements.dimensions() != 16 || elements.len() < skin.joints.len() {
                    let reason = format!("it has no 4x4 matrix for each of {} joints", skin.joints.len());
                    return Err(damaged(index.value(), reason));
                }
                Some(elements)
            }
            None => None,
        };
        let mut joints = Vec::with_capacity(skin.joints.len());
        let mut origin = None;
        for (i, joint) in skin.joints.iter().map(|joint| joint.value()).enumerate() {
            let world = worlds.get(joint).ok_or_else(|| dangling(&place, "node", joint, root.nodes.len()))?;
            let bind =
                inverse_bind.as_ref().map_or(Mat4::IDENTITY, |elements| Mat4::from_cols_array(&elements.floats(i)));
            if !is_sane(&bind) {
                return Err(Problem::Transform { place: format!("{place}, inverse bind matrix {i}") });
            }
            let origin = *origin.get_or_insert(world.w_axis.truncate().as_dvec3());
            let moved = DMat4::from_translation(-origin) * world.as_dmat4();
            joints.push(DAffine3::from_mat4(moved) * DAffine3::from_mat4(bind.as_dmat4()));
        }
        Ok(Self { place, joints, origin: origin.unwrap_or_default() })
    }
}

/// Which joints move the vertices of a primitive, and by how much.
pub(super) struct Pose<'a> {
    skin: &'a Skin,
    /// JOINTS_n and WEIGHTS_n, four of each for a vertex.
    sets: Vec<[Elements<'a>; 2]>,
}

impl<'a> Pose<'a> {
    /// `None` if the primitive has no joints.
    pub fn find(
        document: &'a Document,
        primitive: &Primitive,
        place: &str,
        skin: &'a Skin,
        vertices: usize,
    ) -> Result<Option<Self>, Problem> {
        let find = |semantic: Semantic| {
            let Some(&index) = primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
            let damaged = |reason| Problem::Accessor { place: place.to_owned(), accessor: index.value(), reason };
            let elements = document.elements(index).map_err(damaged)?;
            if elements.dimensions() != 4 || elements.len() < vertices {
                return Err(damaged(format!("it has no four elements for each of {vertices} vertices")));
            }
            Ok(Some((index.value(), elements)))
        };
        let mut sets = Vec::new();
        for set in 0.. {
            let (Some((index, joints)), Some((_, weights))) =
                (find(Semantic::Joints(set))?, find(Semantic::Weights(set))?)
            else {
                break;
            };
            if !joints.are_unsigned() {
                let reason = "its elements are no joints".to_owned();
                return Err(Problem::Accessor { place: place.to_owned(), accessor: index, reason });
            }
            sets.push([joints, weights]);
        }
        Ok((!sets.is_empty()).then_some(Self { skin, sets }))
    }

    /// Checks that there is a joint wherever one of these vertices wants it.
    pub fn check(&self, vertices: &[u32], place: &str) -> Result<(), Problem> {
        let joints = self.skin.joints.len();
        for &vertex in vertices {
            if let Some((joint, _)) = self.bonds(vertex as usize).find(|&(joint, _)| joint >= joints) {
                let (place, skin) = (place.to_owned(), self.skin.place.clone());
                return Err(Problem::Joint { place, vertex, joint, skin, joints });
            }
        }
        Ok(())
    }

    /// The mean of the joints' transforms by weight, for a vertex that [`check`](Self::check) has let pass. Weights need
    /// not add up to 1; where all are 0, the first joint has the vertex.
    pub fn at(&self, vertex: usize) -> DAffine3 {
        let total: f64 = self.bonds(vertex).map(|(_, weight)| weight).sum();
        let mut mean = DMat4::ZERO;
        for (joint, weight) in self.bonds(vertex) {
            mean += DMat4::from(self.skin.joints[joint]) * (weight / total);
        }
        DAffine3::from_mat4(mean)
    }

    /// The joints that move a vertex, with weights above 0; at least one.
    fn bonds(&self, vertex: usize) -> impl Iterator<Item = (usize, f64)> {
        let all = move || {
            self.sets.iter().flat_map(move |[joints, weights]| {
                let (joints, weights) = (joints.unsigned::<4>(vertex), weights.floats::<4>(vertex));
                (0..4).map(move |i| (joints[i] as usize, f64::from(weights[i])))
            })
        };
        let counts = |&(_, weight): &(usize, f64)| weight > 0.0 && weight.is_finite();
        let first = all().next().filter(|_| !all().any(|bond| counts(&bond))).map(|(joint, _)| (joint, 1.0));
        all().filter(counts).chain(first)
    }
}
