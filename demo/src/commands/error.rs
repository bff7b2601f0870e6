//! Why a command failed.

use crate::host::HostError;
use crate::host::gpu::GpuError;
use crate::measure::quality::QualityError;
use crate::picture::PictureError;
use crate::report::ReportError;
use crate::scene::open::OpenError;
use crate::settings_file::SettingsFileError;
use crate::shaders::ShadersError;
use crate::view::ViewError;
use std::path::PathBuf;

/// A command failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// No device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The frame.
    #[error(transparent)]
    Host(#[from] HostError),
    /// A picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A measure.
    #[error(transparent)]
    Quality(#[from] QualityError),
    /// The report.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The window.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The shaders.
    #[error(transparent)]
    Shaders(#[from] ShadersError),
    /// A settings file.
    #[error(transparent)]
    Settings(#[from] SettingsFileError),
    /// Something on the command line.
    #[error("{argument}: {problem}")]
    Argument {
        /// Which.
        argument: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A file or folder.
    #[error("{path}: {source}", path = .path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// A mistake on the command line.
pub fn wrong(argument: &str, problem: String) -> CommandError {
    CommandError::Argument { argument: argument.to_owned(), problem }
}
