//! Scenes by name or path.

use super::load::{self, LoadError};
use super::{Scene, builtin};
use crate::names::did_you_mean;
use std::path::Path;

/// A scene could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// It is neither a file nor a built-in scene.
    #[error("no built-in scene '{name}':{} choose {} or a .gltf or .glb file", did_you_mean(name, &builtin::NAMES), builtin::NAMES.join(", "))]
    Unknown {
        /// As it was asked for.
        name: String,
    },
    /// An index was given for a built-in scene.
    #[error("--scene-index {index}: the built-in scene '{name}' is a single one; leave it out")]
    Single {
        /// The built-in scene.
        name: String,
        /// The index.
        index: usize,
    },
    /// The file can't be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
}

/// Opens a built-in scene by its name, or the file of this path; `index` chooses among the scenes of a file.
pub fn open(name: &str, index: Option<usize>) -> Result<Scene, OpenError> {
    if let Some(scene) = builtin::builtin(name) {
        return match index {
            Some(index) => Err(OpenError::Single { name: name.to_owned(), index }),
            None => Ok(scene),
        };
    }
    let path = Path::new(name);
    if path.extension().is_none() && !path.exists() {
        return Err(OpenError::Unknown { name: name.to_owned() });
    }
    Ok(load::load(path, index)?)
}
