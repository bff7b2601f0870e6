//! Why a report can't go on.

use crate::host::HostError;
use crate::measure::quality::QualityError;
use crate::picture::PictureError;
use std::path::{Path, PathBuf};

/// The reason why a report can't go on.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A frame could not be rendered.
    #[error(transparent)]
    Host(#[from] HostError),
    /// A picture could not be made or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A picture could not be measured.
    #[error(transparent)]
    Quality(#[from] QualityError),
    /// A file or folder could not be used.
    #[error("{path}: {source}; {cure}", path = .path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// What the user can do.
        cure: &'static str,
    },
    /// The folder has the report of another command.
    #[error("--out: {path} holds a finished report of `{command}`; name another folder, or replace it with --force", path = .path.display())]
    Taken {
        /// The folder.
        path: PathBuf,
        /// What made its report.
        command: String,
    },
    /// The disk is too small.
    #[error("{path}: {free} MB are free and about {needed} MB are needed; free some or name another folder with --out", path = .path.display())]
    Space {
        /// The folder.
        path: PathBuf,
        /// Megabytes that are free.
        free: u64,
        /// Megabytes that are needed.
        needed: u64,
    },
    /// A reference holds a NaN or an infinity.
    #[error("the {what} is not finite{}: its shading gives NaN or infinity there; look at the lights and materials that meet in it", .pixel.map(|(x, y)| format!(" at pixel ({x}, {y})")).unwrap_or_default())]
    NotFinite {
        /// Which reference it is: the truth or that of a grid.
        what: String,
        /// The pixel, from the top left corner, if it could be found.
        pixel: Option<(u32, u32)>,
    },
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
    /// Only a part of the report is finished.
    #[error("{why}; {kept} of {planned} entries are kept in {}: go on with --resume", .folder.display())]
    Unfinished {
        /// Why it went no further.
        why: String,
        /// Entries that are finished, in the folder.
        kept: usize,
        /// Entries that were planned.
        planned: usize,
        /// The folder with what is finished.
        folder: PathBuf,
    },
}

impl ReportError {
    /// Whether what is finished stays of use: the user stopped, or the device went away.
    pub fn keeps_what_is_finished(&self) -> bool {
        match self {
            Self::Interrupted => true,
            Self::Host(e) => e.is_loss(),
            _ => false,
        }
    }

    pub(super) fn file(path: &Path, cure: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, source, cure }
    }
}
