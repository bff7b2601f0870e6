//! Rays: the host's meshes and their instances, and what a shader needs to trace through them.
//!
//! A [`Mesh`] is built into a [`BottomLevel`] once, on any thread. A [`RayScene`] holds bottom levels on the GPU and a
//! top level over the [`Instance`]s of the frame, which may move without rebuilding the bottom levels.

mod attributes;
mod mesh;
mod query;
mod scene;

pub use attributes::Attributes;
pub use mesh::{BottomLevel, MAX_COORDINATE, Mesh};
pub use query::{QUERY_FEATURES, query_limits};
pub use scene::{Instance, MAX_INSTANCES, MeshId, RayScene};

/// The WGSL of `DaaRay`, `DaaHit` and `daa_trace(ray, flags, through)`, for the host's own shaders. The module must
/// declare what it reads:
///
/// ```wgsl
/// @group(0) @binding(0) var<storage, read> daa_ray_meshes: array<vec4u>;
/// @group(0) @binding(1) var<storage, read> daa_ray_top: array<vec4u>;
/// // false in the holes of a masked mesh
/// fn daa_ray_solid(material: u32, uv: vec2f, user: u32) -> bool { return true; }
/// ```
///
/// at any group and binding, bound to [`RayScene::buffers`].
pub const SOFTWARE_WGSL: &str = concat!(
    include_str!("../../shaders/shared/user.wgsl"),
    include_str!("../../shaders/rays/rays.wgsl"),
    include_str!("../../shaders/swap/rays_software.wgsl")
);

/// The same functions, traced by the adapter's ray query. The module begins with `enable wgpu_ray_query;`, and also
/// declares
///
/// ```wgsl
/// @group(0) @binding(0) var daa_ray_tlas: acceleration_structure;
/// ```
///
/// bound to [`RayScene::top_level`].
pub const QUERY_WGSL: &str = concat!(
    include_str!("../../shaders/shared/user.wgsl"),
    include_str!("../../shaders/rays/rays.wgsl"),
    include_str!("../../shaders/swap/rays_query.wgsl")
);

/// How rays are traced. Both tiers find the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RayTier {
    /// Rays are traced in WGSL, on any adapter.
    #[default]
    Software,
    /// Rays are traced by the adapter. Needs [`QUERY_FEATURES`] and [`query_limits`].
    Query,
}

/// The number of entries of the traversal stack in rays_software.wgsl.
const STACK: u32 = 60;

/// A mesh or an instance can't be traced.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// A vertex is not finite, or too far from the mesh's origin.
    #[error("mesh '{mesh}': vertex {vertex} is at {position:?}; coordinates are finite and within ±1e12")]
    Vertex {
        /// The name of the mesh.
        mesh: String,
        /// The index of the vertex.
        vertex: usize,
        /// The position of the vertex.
        position: [f32; 3],
    },
    /// The number of indices is not a multiple of 3.
    #[error("mesh '{mesh}' has {indices} indices; a triangle has 3, so give a multiple of 3")]
    Indices {
        /// The name of the mesh.
        mesh: String,
        /// The number of indices.
        indices: usize,
    },
    /// An index is beyond the vertices.
    #[error("mesh '{mesh}': index {at} is {index}, but there are {vertices} vertices")]
    Index {
        /// The name of the mesh.
        mesh: String,
        /// The position in the list of indices.
        at: usize,
        /// The index.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// There is not one set of attributes for each vertex, or a masked mesh has none.
    #[error(
        "mesh '{mesh}' has {vertices} vertices, but attributes of {attributes}; give one for each, or none if it is not masked"
    )]
    Attributes {
        /// The name of the mesh.
        mesh: String,
        /// The number of attributes.
        attributes: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A mesh without a tree was added to a scene whose rays are traced in software.
    #[error(
        "mesh '{mesh}' was made by BottomLevel::untraced; build it with BottomLevel::build, or trace no rays in software"
    )]
    NoTree {
        /// The name of the mesh.
        mesh: String,
    },
    /// A mesh without attributes was added to a scene for a visibility buffer.
    #[error("mesh '{mesh}' has no attributes, from which a visibility buffer is shaded; give one for each vertex")]
    NoAttributes {
        /// The name of the mesh.
        mesh: String,
    },
    /// The material or the object of an instance is too large for the 16 bits that a sample has for it.
    #[error(
        "instance {instance} has {what} {id}; a G-buffer tells 65536 apart, from 0 on, so split the scene or reuse ids"
    )]
    Id {
        /// The index of the instance.
        instance: usize,
        /// `material` or `object`.
        what: &'static str,
        /// The id.
        id: u32,
    },
    /// An attribute is not finite.
    #[error("mesh '{mesh}': vertex {vertex} has a normal, tangent or uv that is not finite")]
    Attribute {
        /// The name of the mesh.
        mesh: String,
        /// The index of the vertex.
        vertex: usize,
    },
    /// A buffer of the scene exceeds the device's limits.
    #[error(
        "{what} of the ray scene take {bytes} bytes, the device binds {limit}; request a greater max_storage_buffer_binding_size, or split the scene"
    )]
    TooLarge {
        /// The content of the buffer.
        what: &'static str,
        /// The bytes that it needs.
        bytes: u64,
        /// The most bytes that the device binds.
        limit: u64,
    },
    /// An acceleration structure exceeds the device's limits.
    #[error(
        "{count} {what}, the device holds {limit}; request greater limits for acceleration structures, or use RayTier::Software"
    )]
    Structures {
        /// What there are too many of.
        what: &'static str,
        /// Their number.
        count: usize,
        /// The most that the device holds.
        limit: usize,
    },
    /// A top level of the host's own was given to a scene of [`RayTier::Software`].
    #[error("a top level of the host's own can only be traced by RayTier::Query; use RayScene::update")]
    HostTopLevel,
    /// There are more instances than shaders can tell apart.
    #[error("{instances} instances; a frame traces at most {limit}")]
    Instances {
        /// The number of instances.
        instances: usize,
        /// The most instances of a frame.
        limit: usize,
    },
    /// An instance refers to a mesh that the scene does not have.
    #[error("instance {instance} is of mesh {mesh}, but the scene has {meshes}")]
    NoMesh {
        /// The index of the instance.
        instance: usize,
        /// The id of the mesh.
        mesh: u32,
        /// The number of meshes in the scene.
        meshes: usize,
    },
    /// The transform of an instance can't be inverted.
    #[error("instance {instance} (mesh '{mesh}') has a transform that {why}; leave it out of the frame's instances")]
    Transform {
        /// The index of the instance.
        instance: usize,
        /// The name of its mesh.
        mesh: String,
        /// What is wrong with the transform.
        why: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_has_the_same_numbers() {
        assert!(SOFTWARE_WGSL.contains(&format!("const DAA_RAY_STACK: u32 = {STACK}u;")));
        assert!(SOFTWARE_WGSL.contains(&format!("const DAA_RAY_RECORD: u32 = {}u;", scene::RECORD)));
        assert!(QUERY_WGSL.contains(&format!("const DAA_RAY_MASK_SHADOW: u32 = {}u;", query::MASK_SHADOW)));
        for (name, flag) in [("MASKED", scene::MASKED), ("CULLED", scene::CULLED), ("CLEAR", scene::CLEAR)] {
            assert!(SOFTWARE_WGSL.contains(&format!("const DAA_INSTANCE_{name}: u32 = {flag}u;")), "{name}");
        }
    }
}
