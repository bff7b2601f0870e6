//! Why a file was refused.

use std::path::{Path, PathBuf};

/// A file that could not be loaded: which one, what is wrong where, and what helps. One line.
#[derive(Debug, thiserror::Error)]
#[error("{}: {}", path.display(), one_line(problem))]
pub struct LoadError {
    /// The scene file, as given.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: Problem,
}

impl LoadError {
    pub(super) fn new(path: &Path, problem: Problem) -> Self {
        Self { path: path.to_owned(), problem }
    }
}

/// Files can smuggle line breaks into messages through the names in them.
fn one_line(problem: &Problem) -> String {
    problem.to_string().replace(char::is_control, " ")
}

/// What is wrong with a scene file. Messages name the place in the file and the cure.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The file, or one it refers to, cannot be read.
    #[error("cannot read {}: {source}; check the path and that the whole model folder is there", file.display())]
    Read {
        /// What was opened.
        file: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// Neither JSON nor a sound GLB container.
    #[error("not a usable .glb: {reason}; export or download it again")]
    Container {
        /// What the container breaks.
        reason: String,
    },
    /// Another kind of file.
    #[error("not glTF but {0}; name a .gltf or .glb file")]
    Kind(String),
    /// JSON that is broken, or not shaped like glTF.
    #[error("not glTF: {0}; export or download it again")]
    Json(#[from] serde_json::Error),
    /// glTF 1.0, or newer than 2.x.
    #[error("glTF version {0:?} is not supported; convert it to glTF 2.0")]
    Version(String),
    /// The file cannot be shown without something this loader lacks.
    #[error("the required extension {0} is not supported; export without it (or decompress with gltf-transform)")]
    Extension(String),
    /// The scene asked for does not exist.
    #[error("there is no scene {index}: the file has {count}; choose a smaller number")]
    NoSuchScene {
        /// Asked for, from 0.
        index: usize,
        /// In the file.
        count: usize,
    },
    /// A reference into an array of the file that is too short.
    #[error("{from} refers to {kind} {index}, but the file has {count}; export it again")]
    Reference {
        /// What refers.
        from: String,
        /// What it refers to.
        kind: &'static str,
        /// The reference.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A uri that cannot or must not be followed.
    #[error("{place}: {reason}; use files beside the model, or data uris")]
    Uri {
        /// The buffer or image.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// A buffer without its data.
    #[error("{place}: {reason}; the file is damaged, export it again")]
    Buffer {
        /// The buffer.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// Vertex or index data that cannot be read as declared.
    #[error("{place}, accessor {accessor}: {reason}; the file is damaged, export it again")]
    Accessor {
        /// The primitive or node that reads it.
        place: String,
        /// Which accessor.
        accessor: usize,
        /// What is wrong.
        reason: String,
    },
    /// A triangle corner that does not exist.
    #[error("{place}: index {index} is out of range, there are {vertices} vertices; export it again")]
    Index {
        /// The primitive.
        place: String,
        /// The bad index.
        index: u32,
        /// The vertex count.
        vertices: usize,
    },
    /// A vertex bound to a joint that does not exist.
    #[error("{place}: vertex {vertex} is bound to joint {joint}, but {skin} has {joints}; export it again")]
    Joint {
        /// The primitive.
        place: String,
        /// The vertex.
        vertex: u32,
        /// The joint that it asks for.
        joint: usize,
        /// The skin.
        skin: String,
        /// The number of its joints.
        joints: usize,
    },
    /// A picture that a drawn material needs and that cannot be had.
    #[error("{place}: {reason}; supply it as PNG or JPEG, at most {} texels a side", super::limits::MAX_SIDE)]
    Image {
        /// The image.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// A placement that no picture can show.
    #[error("{place}: its transform has elements that are not finite or beyond 1e30; correct the node")]
    Transform {
        /// The node.
        place: String,
    },
    /// Nodes that are not a tree.
    #[error("{place} is reached twice: it has two parents or is its own ancestor; nodes must form trees")]
    Hierarchy {
        /// The node.
        place: String,
    },
    /// More than this program takes.
    #[error("{what} are more than {limit}; split or simplify the model")]
    TooLarge {
        /// What there is too much of, in the plural.
        what: String,
        /// The most there may be.
        limit: usize,
    },
}
