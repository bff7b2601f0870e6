//! Why shaders could not be had.

use super::lang::Lang;
use crate::host::gpu::GpuError;
use deferred_aa::{BuildError, RecordError};

/// Shaders could not be had.
#[derive(Debug, thiserror::Error)]
pub enum ShadersError {
    /// No device of the backend that draws nothing.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The node could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Such a frame can't be.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A constant of the host's has no value, or the like.
    #[error("{shader}: {message}")]
    Shader {
        /// The entry point.
        shader: String,
        /// What naga said.
        message: String,
    },
    /// A language has no words for something.
    #[error("{shader}: {lang} can't say this: {message}")]
    Language {
        /// The entry point.
        shader: String,
        /// Which.
        lang: Lang,
        /// What naga said, and what helps.
        message: String,
    },
}

/// An error and what is behind it, in one line.
pub fn causes(error: &dyn std::error::Error) -> String {
    let chain = std::iter::successors(Some(error), |e| e.source());
    chain.map(|e| e.to_string().split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>().join(": ")
}
