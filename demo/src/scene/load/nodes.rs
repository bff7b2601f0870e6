//! The node hierarchy: what stands where.

use glam::{Mat4, Quat, Vec3, Vec4};
use gltf::json::Root;
use gltf::json::accessor::Accessor;
use gltf::json::scene::Node;
use gltf::json::{Index, extensions};

use super::accessor::Document;
use super::error::Problem;
use super::limits::{MAX_INSTANCES, label};

/// Larger elements would overflow as soon as they are multiplied.
const MAX_ELEMENT: f32 = 1e30;

/// A node of the scene.
pub(super) struct Placed {
    pub number: usize,
    /// The world-from-node matrix.
    pub world: Mat4,
    /// Whether its mesh and its light are shown: KHR_node_visibility hides a node with all below it. Cameras stay.
    pub visible: bool,
}

/// All nodes of scene `wanted` (or the default one, or all trees of a file without scenes), parents first.
pub(super) fn walk(root: &Root, wanted: Option<usize>, notices: &mut Vec<String>) -> Result<Vec<Placed>, Problem> {
    let roots = roots(root, wanted)?;
    let mut stack: Vec<(usize, Mat4, bool, Option<usize>)> =
        roots.into_iter().rev().map(|node| (node, Mat4::IDENTITY, true, None)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((number, world_from_parent, parent_visible, parent)) = stack.pop() {
        let Some(node) = root.nodes.get(number) else {
            let from = parent.map_or("the scene".to_owned(), |parent| format!("node {parent}"));
            return Err(Problem::Reference { from, kind: "node", index: number, count: root.nodes.len() });
        };
        let place = label("node", number, node.name.as_deref());
        if std::mem::replace(&mut seen[number], true) {
            return Err(Problem::Hierarchy { place });
        }
        let world_from_node = world_from_parent * local(node, &place, notices);
        if !is_sane(&world_from_node) {
            return Err(Problem::Transform { place });
        }
        let visible = parent_visible && is_visible(node);
        placed.push(Placed { number, world: world_from_node, visible });
        let children = node.children.iter().flatten().rev();
        stack.extend(children.map(|child| (child.value(), world_from_node, visible, Some(number))));
    }
    Ok(placed)
}

/// The world matrices of all nodes: as placed in the scene, and of the others as their own trees have them.
pub(super) fn worlds(root: &Root, placed: &[Placed]) -> Vec<Mat4> {
    let mut parents = vec![None; root.nodes.len()];
    for (number, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten() {
            if let Some(parent) = parents.get_mut(child.value()) {
                *parent = Some(number);
            }
        }
    }
    let mut worlds = vec![None; root.nodes.len()];
    for node in placed {
        worlds[node.number] = Some(node.world);
    }
    for number in 0..worlds.len() {
        let mut path = Vec::new();
        let mut next = Some(number);
        // Where what is not drawn goes round in a circle, it is cut open.
        while let Some(node) = next.filter(|&node| worlds[node].is_none() && path.len() <= parents.len()) {
            path.push(node);
            next = parents[node];
        }
        let mut world = next.and_then(|node| worlds[node]).unwrap_or(Mat4::IDENTITY);
        while let Some(node) = path.pop() {
            world *= local(&root.nodes[node], "", &mut Vec::new());
            worlds[node] = Some(world);
        }
    }
    worlds.into_iter().map(Option::unwrap_or_default).collect()
}

fn roots(root: &Root, wanted: Option<usize>) -> Result<Vec<usize>, Problem> {
    let count = root.scenes.len();
    let scene = match (wanted, root.scene) {
        (Some(index), _) => Some(index),
        (None, Some(default)) => Some(default.value()),
        (None, None) => (count > 0).then_some(0),
    };
    if let Some(index) = scene {
        let scene = root.scenes.get(index).ok_or(Problem::NoSuchScene { index, count })?;
        return Ok(scene.nodes.iter().map(|node| node.value()).collect());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    let roots: Vec<usize> = (0..root.nodes.len()).filter(|&node| !is_child[node]).collect();
    if roots.is_empty() && !root.nodes.is_empty() {
        return Err(Problem::Hierarchy { place: "node 0".to_owned() });
    }
    Ok(roots)
}

fn local(node: &Node, place: &str, notices: &mut Vec<String>) -> Mat4 {
    if let Some(elements) = &node.matrix {
        let mut matrix = Mat4::from_cols_array(elements);
        if matrix.row(3) != Vec4::W {
            notices.push(format!("{place}: the last row of its matrix replaced by 0 0 0 1"));
            matrix.x_axis.w = 0.0;
            matrix.y_axis.w = 0.0;
            matrix.z_axis.w = 0.0;
            matrix.w_axis.w = 1.0;
        }
        return matrix;
    }
    Mat4::from_scale_rotation_translation(
        node.scale.map_or(Vec3::ONE, Vec3::from),
        rotation(node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |q| q.0)),
        node.translation.map_or(Vec3::ZERO, Vec3::from),
    )
}

/// Nearly unit quaternions are common, zero ones are a rotation by nothing.
fn rotation(elements: [f32; 4]) -> Quat {
    Vec4::from(elements).try_normalize().map_or(Quat::IDENTITY, Quat::from_vec4)
}

/// Whether all elements are finite, and small enough to be multiplied.
pub(super) fn is_sane(matrix: &Mat4) -> bool {
    matrix.to_cols_array().iter().all(|element| element.abs() <= MAX_ELEMENT)
}

fn is_visible(node: &Node) -> bool {
    extension(node, "KHR_node_visibility").and_then(|extension| extension.get("visible")?.as_bool()).unwrap_or(true)
}

/// An extension of a node that the parser has no type for.
fn extension<'a>(node: &'a Node, name: &str) -> Option<&'a serde_json::Value> {
    node.extensions.as_ref().and_then(|extensions: &extensions::scene::Node| extensions.others.get(name))
}

/// The world matrices under which a node's mesh is drawn: its own, or those of EXT_mesh_gpu_instancing.
pub(super) fn copies(document: &Document, node: &Node, place: &str, world: Mat4) -> Result<Vec<Mat4>, Problem> {
    let attributes = extension(node, "EXT_mesh_gpu_instancing").and_then(|extension| extension.get("attributes"));
    let Some(attributes) = attributes else { return Ok(vec![world]) };

    let read = |name: &str, dimensions: usize| {
        let Some(number) = attributes.get(name).and_then(|value| value.as_u64()) else { return Ok(None) };
        let accessor = u32::try_from(number).unwrap_or(u32::MAX);
        document
            .elements(Index::<Accessor>::new(accessor))
            .and_then(
                |e| if e.dimensions() == dimensions { Ok(e) } else { Err("wrong number of components".to_owned()) },
            )
            .map(Some)
            .map_err(|reason| Problem::Accessor { place: place.to_owned(), accessor: accessor as usize, reason })
    };
    let (translations, rotations, scales) = (read("TRANSLATION", 3)?, read("ROTATION", 4)?, read("SCALE", 3)?);
    let given = || [&translations, &rotations, &scales].into_iter().flatten();
    // Attributes of other names alone make no copies.
    let Some(count) = given().map(|elements| elements.len()).min() else { return Ok(vec![world]) };
    if count > MAX_INSTANCES {
        return Err(Problem::TooLarge { what: format!("{place}: the instances"), limit: MAX_INSTANCES });
    }

    let mut matrices = Vec::with_capacity(count);
    for i in 0..count {
        let matrix = world
            * Mat4::from_scale_rotation_translation(
                scales.as_ref().map_or(Vec3::ONE, |e| e.floats(i).into()),
                rotations.as_ref().map_or(Quat::IDENTITY, |e| rotation(e.floats(i))),
                translations.as_ref().map_or(Vec3::ZERO, |e| e.floats(i).into()),
            );
        if !is_sane(&matrix) {
            return Err(Problem::Transform { place: format!("{place}, instance {i}") });
        }
        matrices.push(matrix);
    }
    Ok(matrices)
}
