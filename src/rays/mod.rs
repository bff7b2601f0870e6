//! Rays: the host's meshes and their instances, and what a shader needs to trace through them.
//!
//! A [`Mesh`] becomes a [`BottomLevel`] once, on any thread. A [`RayScene`] holds bottom levels on the GPU, and a top level
//! over the [`Instance`]s of the frame, which move without touching the bottom.

mod attributes;
mod mesh;
mod query;
mod scene;

pub use attributes::Attributes;
pub use mesh::{BottomLevel, MAX_COORDINATE, Mesh};
pub use query::{QUERY_FEATURES, query_limits};
pub use scene::{Instance, MAX_INSTANCES, MeshId, RayScene};

/// WGSL of `DaaRay`, `DaaHit` and `daa_trace(ray, any, through)`, for shaders of the host's own. The module declares what it
/// reads:
///
/// ```wgsl
/// @group(0) @binding(0) var<storage, read> daa_ray_nodes: array<vec4u>;
/// @group(0) @binding(1) var<storage, read> daa_ray_geometry: array<vec4u>;
/// @group(0) @binding(2) var<storage, read> daa_ray_top: array<vec4u>;
/// fn daa_ray_solid(material: u32, uv: vec2f) -> bool { return true; } // false in the holes of a masked mesh
/// ```
///
/// at any group and binding, bound to [`RayScene::buffers`].
pub const SOFTWARE_WGSL: &str =
    concat!(include_str!("../../shaders/rays/rays.wgsl"), "\n", include_str!("../../shaders/swap/rays_software.wgsl"));

/// The same functions by the adapter's ray query. The module begins with `enable wgpu_ray_query;`, and declares instead of the
/// nodes
///
/// ```wgsl
/// @group(0) @binding(0) var daa_ray_tlas: acceleration_structure;
/// ```
///
/// bound to [`RayScene::top_level`].
pub const QUERY_WGSL: &str =
    concat!(include_str!("../../shaders/rays/rays.wgsl"), "\n", include_str!("../../shaders/swap/rays_query.wgsl"));

/// How rays are traced. Both find the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RayTier {
    /// In WGSL, on any adapter.
    #[default]
    Software,
    /// By the adapter. Needs [`QUERY_FEATURES`] and [`query_limits`].
    Query,
}

/// Entries of the traversal's stack in rays_software.wgsl.
const STACK: u32 = 60;

/// Meshes or instances that can't be traced.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// A vertex is not a number, or too far.
    #[error("mesh '{mesh}': vertex {vertex} is at {position:?}; coordinates are finite and within ±1e12")]
    Vertex {
        /// Its name.
        mesh: String,
        /// Counted from 0.
        vertex: usize,
        /// As given.
        position: [f32; 3],
    },
    /// No whole number of triangles.
    #[error("mesh '{mesh}' has {indices} indices; a triangle has 3, so give a multiple of 3")]
    Indices {
        /// Its name.
        mesh: String,
        /// How many.
        indices: usize,
    },
    /// An index beyond the vertices.
    #[error("mesh '{mesh}': index {at} is {index}, but there are {vertices} vertices")]
    Index {
        /// Its name.
        mesh: String,
        /// Counted from 0.
        at: usize,
        /// As given.
        index: u32,
        /// How many there are.
        vertices: usize,
    },
    /// Not one for each vertex, or a masked mesh has none.
    #[error(
        "mesh '{mesh}' has {vertices} vertices, but attributes of {attributes}; give one for each, or none if it is not masked"
    )]
    Attributes {
        /// The mesh's name.
        mesh: String,
        /// As given.
        attributes: usize,
        /// Of the mesh.
        vertices: usize,
    },
    /// An attribute is not a number.
    #[error("mesh '{mesh}': vertex {vertex} has a normal, tangent or uv that is not finite")]
    Attribute {
        /// The mesh's name.
        mesh: String,
        /// Counted from 0.
        vertex: usize,
    },
    /// The device does not bind so much.
    #[error(
        "{what} of the ray scene take {bytes} bytes, the device binds {limit}; request a greater max_storage_buffer_binding_size, or split the scene"
    )]
    TooLarge {
        /// Which part.
        what: &'static str,
        /// What it takes.
        bytes: u64,
        /// What the device binds.
        limit: u64,
    },
    /// More than the device's acceleration structures hold.
    #[error(
        "{count} {what}, the device holds {limit}; request greater limits for acceleration structures, or use RayTier::Software"
    )]
    Structures {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
        /// Most.
        limit: usize,
    },
    /// A top level of the host's own where WGSL traces.
    #[error("a top level of the host's own can only be traced by RayTier::Query; use RayScene::update")]
    HostTopLevel,
    /// More than shaders can tell apart.
    #[error("{instances} instances; a frame traces at most {limit}")]
    Instances {
        /// How many.
        instances: usize,
        /// Most.
        limit: usize,
    },
    /// A mesh of another scene.
    #[error("instance {instance} is of mesh {mesh}, but the scene has {meshes}")]
    NoMesh {
        /// Counted from 0.
        instance: usize,
        /// As given.
        mesh: u32,
        /// How many the scene has.
        meshes: usize,
    },
    /// A transform that can't be undone.
    #[error("instance {instance} (mesh '{mesh}') has a transform that {why}; leave it out of the frame's instances")]
    Transform {
        /// Counted from 0.
        instance: usize,
        /// The name of its mesh.
        mesh: String,
        /// What is wrong with it.
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
    }
}
