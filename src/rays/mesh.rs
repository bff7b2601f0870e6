//! The bottom level: the triangles of a mesh in a wide, compressed BVH (Ylitie, Karras, Laine 2017), built by `obvhs`.

use super::attributes::{self, Attributes};
use super::{RayError, STACK};
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::{Bvh2, reinsertion::ReinsertionOptimizer};
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// The greatest absolute coordinate of a vertex. Up to it no product in the traversal overflows.
pub const MAX_COORDINATE: f32 = 1e12;

/// A mesh that rays may hit, in its own space.
#[derive(Debug, Clone, Copy)]
pub struct Mesh<'a> {
    /// The name of the mesh, for error messages.
    pub name: &'a str,
    /// The positions of the vertices.
    pub positions: &'a [[f32; 3]],
    /// The vertex indices, three for each triangle.
    pub indices: &'a [u32],
    /// The attributes from which hits and the samples of a visibility buffer are shaded, one for each vertex. Empty if
    /// only shadow rays are traced.
    pub attributes: &'a [Attributes],
    /// Whether the material has holes: `daa_ray_solid` is called for each triangle that a ray hits. Needs attributes.
    pub masked: bool,
}

/// A mesh prepared for tracing: built once, on any thread, and shared by all of its instances.
#[derive(Debug, Clone)]
pub struct BottomLevel {
    pub(super) name: String,
    /// The nodes. Their indices of children and triangles are relative to the first ones of this mesh.
    pub(super) nodes: Vec<CwBvhNode>,
    /// The triangles in the order of the leaves: three vertices, and the index of the triangle in the mesh.
    pub(super) triangles: Vec<[u32; 4]>,
    pub(super) positions: Vec<[f32; 3]>,
    /// The attributes as `daa_ray_meshes` stores them, and the host's 32 bits.
    pub(super) attributes: Vec<([u32; 4], u32)>,
    pub(super) masked: bool,
    pub(super) bounds: Option<[Vec3; 2]>,
    dropped: u32,
    has_tree: bool,
}

impl BottomLevel {
    /// Checks the mesh and builds its BVH. Triangles without an area are dropped and counted, since no ray can hit
    /// them.
    pub fn build(mesh: &Mesh<'_>) -> Result<Self, RayError> {
        Self::check(mesh)?;
        Ok(Self::checked(mesh))
    }

    /// Checks the mesh without building a BVH, for a scene that is only drawn
    /// ([`RayScene::for_visibility`](super::RayScene::for_visibility)) or traced by the adapter
    /// ([`RayTier::Query`](super::RayTier::Query)).
    pub fn untraced(mesh: &Mesh<'_>) -> Result<Self, RayError> {
        Self::check(mesh)?;
        let triangles = (0..).zip(mesh.indices.as_chunks::<3>().0).map(|(id, &[a, b, c])| [a, b, c, id]).collect();
        let all = mesh.indices.iter().map(|&i| Vec3::from(mesh.positions[i as usize]));
        let bounds = all.map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)]);
        Ok(Self { triangles, bounds, ..Self::without_triangles(mesh) })
    }

    fn without_triangles(mesh: &Mesh<'_>) -> Self {
        Self {
            name: mesh.name.into(),
            nodes: Vec::new(),
            triangles: Vec::new(),
            positions: mesh.positions.to_vec(),
            attributes: mesh.attributes.iter().map(|a| (attributes::packed(a), a.user)).collect(),
            masked: mesh.masked,
            bounds: None,
            dropped: 0,
            has_tree: false,
        }
    }

    fn check(mesh: &Mesh<'_>) -> Result<(), RayError> {
        let name = mesh.name;
        let vertices = mesh.positions.len();
        if let Some(vertex) = mesh.positions.iter().position(|p| !is_in_range(p)) {
            return Err(RayError::Vertex { mesh: name.into(), vertex, position: mesh.positions[vertex] });
        }
        if !mesh.indices.len().is_multiple_of(3) {
            return Err(RayError::Indices { mesh: name.into(), indices: mesh.indices.len() });
        }
        if let Some(at) = mesh.indices.iter().position(|&i| i as usize >= vertices) {
            return Err(RayError::Index { mesh: name.into(), at, index: mesh.indices[at], vertices });
        }
        let wanted = if mesh.masked || !mesh.attributes.is_empty() { vertices } else { 0 };
        if mesh.attributes.len() != wanted {
            return Err(RayError::Attributes { mesh: name.into(), attributes: mesh.attributes.len(), vertices });
        }
        if let Some(vertex) = mesh.attributes.iter().position(|a| !a.is_finite()) {
            return Err(RayError::Attribute { mesh: name.into(), vertex });
        }
        Ok(())
    }

    fn checked(mesh: &Mesh<'_>) -> Self {
        let all = mesh.indices.as_chunks::<3>().0;
        let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
        let kept: Vec<u32> = (0..all.len() as u32).filter(|&i| has_area(corners(&all[i as usize]))).collect();
        let boxes: Vec<Aabb> =
            kept.iter().map(|&i| Aabb::from_points(&corners(&all[i as usize]).map(Vec3A::from))).collect();

        let (nodes, order) = wide(&boxes, Quality::Static);
        let triangles = order.iter().map(|&i| {
            let id = kept[i as usize];
            let [a, b, c] = all[id as usize];
            [a, b, c, id]
        });
        let bounds = (!boxes.is_empty()).then(|| {
            let total = boxes.iter().fold(Aabb::INVALID, |total, b| union(&total, b));
            [total.min.into(), total.max.into()]
        });
        let dropped = (all.len() - kept.len()) as u32;
        let triangles = triangles.collect();
        Self { nodes, triangles, bounds, dropped, has_tree: true, ..Self::without_triangles(mesh) }
    }

    /// Whether it was built to be traced in software.
    pub(super) fn has_tree(&self) -> bool {
        self.has_tree
    }

    /// The diagonal of the largest triangle's box.
    pub(super) fn extent(&self) -> f32 {
        let diagonal = |&[a, b, c, _]: &[u32; 4]| {
            let [a, b, c] = [a, b, c].map(|i| Vec3::from(self.positions[i as usize]));
            (a.max(b).max(c) - a.min(b).min(c)).length()
        };
        self.triangles.iter().map(diagonal).fold(0.0, f32::max)
    }

    /// The triangles in the order of the leaves, then the dropped ones, which are degenerate.
    pub(super) fn leaves_first(&self) -> Vec<[u32; 4]> {
        let mut all = self.triangles.clone();
        all.extend(self.as_they_were().into_iter().filter(|t| t[0] == t[1] && t[1] == t[2]));
        all
    }

    /// The number of triangles that were dropped because they have no area.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// The number of triangles that rays may hit.
    pub fn triangles(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// The triangles in the order of the mesh, with their indices. Dropped ones are degenerate.
    pub(super) fn as_they_were(&self) -> Vec<[u32; 4]> {
        let mut all: Vec<_> = (0..self.triangles() + self.dropped()).map(|id| [0, 0, 0, id]).collect();
        for &triangle in &self.triangles {
            all[triangle[3] as usize] = triangle;
        }
        all
    }

    /// The bytes that its nodes and triangles take on the GPU, without the vertices.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..])) as u64
    }
}

/// The kind of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quality {
    /// A tree over triangles, built once.
    Static,
    /// A tree over instances, built in each frame.
    Dynamic,
}

impl Quality {
    /// The most levels of nodes. A balanced tree over n boxes has at most ⌈log₂ n⌉ + 1 levels; n is below 2³² for
    /// triangles and below 2²⁴ for instances.
    pub const fn levels(self) -> u32 {
        match self {
            Self::Static => 33,
            Self::Dynamic => 25,
        }
    }
}

// In both trees each level leaves at most one group on the stack, and an entered instance two more.
const _: () = assert!(Quality::Static.levels() + Quality::Dynamic.levels() + 2 <= STACK);

/// Builds a tree: its nodes, root first, and the indices of the boxes in the order of the leaves.
pub(super) fn wide(boxes: &[Aabb], quality: Quality) -> (Vec<CwBvhNode>, Vec<u32>) {
    if boxes.is_empty() {
        return Default::default();
    }
    let (distance, threshold) = match quality {
        Quality::Static => (PlocSearchDistance::Low, 2),
        Quality::Dynamic => (PlocSearchDistance::Minimum, 0),
    };
    let indices = (0..boxes.len() as u32).collect();
    let mut binary =
        PlocBuilder::with_capacity(boxes.len()).build(distance, boxes, indices, SortPrecision::U64, threshold);
    if quality == Quality::Static {
        ReinsertionOptimizer::default().run(&mut binary, 0.02, None);
    }
    let mut wide = bvh2_to_cwbvh(&binary, 3, true, false);
    // Some boxes, such as ones that each halve in size, make a tree as deep as their number.
    if levels(&wide.nodes) > quality.levels() {
        wide = bvh2_to_cwbvh(&balanced(boxes), 3, true, false);
    }
    (wide.nodes, wide.primitive_indices)
}

/// The number of levels of nodes, including the root. Parents lie before their children.
fn levels(nodes: &[CwBvhNode]) -> u32 {
    let mut levels = vec![1; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        let first = node.child_base_idx as usize;
        for child in first..first + node.imask.count_ones() as usize {
            levels[child] = levels[i] + 1;
        }
    }
    levels.into_iter().max().unwrap_or(0)
}

/// A binary tree that halves the boxes along their widest axis.
fn balanced(boxes: &[Aabb]) -> Bvh2 {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let around = |part: &[u32]| part.iter().fold(Aabb::INVALID, |sum, &i| union(&sum, &boxes[i as usize]));
    let mut nodes = vec![Bvh2Node::new(around(&order), 1, 0)];
    let mut open = vec![(0, 0..boxes.len())];
    while let Some((node, range)) = open.pop() {
        if range.len() == 1 {
            nodes[node] = Bvh2Node::new(*nodes[node].aabb(), 1, range.start as u32);
            continue;
        }
        let size = nodes[node].aabb().max - nodes[node].aabb().min;
        let axis = (0..3).fold(0, |widest, axis| if size[axis] > size[widest] { axis } else { widest });
        let middle = range.start + range.len() / 2;
        let key = |&i: &u32| boxes[i as usize].min[axis] + boxes[i as usize].max[axis];
        let by_place = |a: &u32, b: &u32| key(a).total_cmp(&key(b)).then(a.cmp(b));
        order[range.clone()].select_nth_unstable_by(range.len() / 2, by_place);
        let first = nodes.len();
        nodes[node] = Bvh2Node::new(*nodes[node].aabb(), 0, first as u32);
        for (child, half) in (first..).zip([range.start..middle, middle..range.end]) {
            nodes.push(Bvh2Node::new(around(&order[half.clone()]), 1, 0));
            open.push((child, half));
        }
    }
    Bvh2 { nodes, primitive_indices: order, children_are_ordered_after_parents: true, ..Default::default() }
}

pub(super) fn is_in_range(p: &[f32; 3]) -> bool {
    p.iter().all(|c| c.abs() <= MAX_COORDINATE)
}

fn union(a: &Aabb, b: &Aabb) -> Aabb {
    Aabb::new(a.min.min(b.min), a.max.max(b.max))
}

/// Products of f32 are exact in f64, and their differences almost.
fn has_area([a, b, c]: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = [a, b, c].map(|p| DVec3::from(p.map(f64::from)));
    (b - a).cross(c - a) != DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use insta::assert_snapshot;

    fn mesh<'a>(positions: &'a [[f32; 3]], indices: &'a [u32]) -> Mesh<'a> {
        Mesh { name: "chair", positions, indices, attributes: &[], masked: false }
    }

    const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];

    #[test]
    fn bad_meshes_are_refused_by_name() {
        let refused =
            |positions: &[[f32; 3]], indices: &[u32]| BottomLevel::build(&mesh(positions, indices)).unwrap_err();
        assert_snapshot!(refused(&CORNERS, &[0, 1]), @"mesh 'chair' has 2 indices; a triangle has 3, so give a multiple of 3");
        assert_snapshot!(refused(&CORNERS, &[0, 1, 9]), @"mesh 'chair': index 2 is 9, but there are 4 vertices");
        assert_snapshot!(refused(&[[0.0, f32::NAN, 0.0]], &[]), @"mesh 'chair': vertex 0 is at [0.0, NaN, 0.0]; coordinates are finite and within ±1e12");
        assert_snapshot!(refused(&[[0.0, 0.0, f32::INFINITY]], &[]), @"mesh 'chair': vertex 0 is at [0.0, 0.0, inf]; coordinates are finite and within ±1e12");
    }

    #[test]
    fn triangles_without_an_area_are_left_out_and_counted() {
        let built = BottomLevel::build(&mesh(&CORNERS, &[0, 1, 3, 0, 1, 2, 2, 2, 1])).unwrap();
        assert_eq!((built.triangles(), built.dropped()), (1, 2));
        assert_eq!(built.triangles, [[0, 1, 2, 1]]);
        let none = BottomLevel::build(&mesh(&[], &[])).unwrap();
        assert_eq!((none.triangles(), none.nodes.len(), none.bounds), (0, 0, None));
    }

    /// Triangles that each halve in size: each is nearer to all smaller ones than to the next larger one.
    #[test]
    fn a_tree_that_would_be_too_deep_is_balanced() {
        let side = |i: i32| 0.5f32.powi(i);
        let positions: Vec<_> = (0..120).flat_map(|i| [[side(i), 0.0, 0.0], [side(i), side(i), 0.0]]).collect();
        let indices: Vec<_> = (0..238).flat_map(|i| [i, i + 1, i + 2]).collect();
        let built = BottomLevel::build(&mesh(&positions, &indices)).unwrap();
        assert!(levels(&built.nodes) <= 9, "{}", levels(&built.nodes));
        let mut seen: Vec<_> = built.triangles.iter().map(|t| t[3]).collect();
        seen.sort_unstable();
        assert_eq!(seen.len() as u32, 238 - built.dropped());
        assert!(seen.windows(2).all(|w| w[0] < w[1]));
    }
}
