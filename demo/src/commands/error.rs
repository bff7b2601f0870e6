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

/// The reason why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// There is no device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene could not be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A frame could not be rendered.
    #[error(transparent)]
    Host(#[from] HostError),
    /// A picture could not be made or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A picture could not be measured.
    #[error(transparent)]
    Quality(#[from] QualityError),
    /// The report could not go on.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The viewer could not run.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The shaders could not be written.
    #[error(transparent)]
    Shaders(#[from] ShadersError),
    /// A settings file could not be used.
    #[error(transparent)]
    Settings(#[from] SettingsFileError),
    /// An argument on the command line is wrong.
    #[error("{argument}: {problem}")]
    Argument {
        /// The argument.
        argument: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A file or folder could not be used.
    #[error("{path}: {source}", path = .path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// A mistake on the command line.
pub fn wrong(argument: &str, problem: String) -> CommandError {
    CommandError::Argument { argument: argument.to_owned(), problem }
}
