//! Why a report can't go on.

use crate::host::HostError;
use crate::measure::quality::QualityError;
use crate::picture::PictureError;
use std::path::{Path, PathBuf};

/// The report can't go on.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The frame.
    #[error(transparent)]
    Host(#[from] HostError),
    /// A picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A measure.
    #[error(transparent)]
    Quality(#[from] QualityError),
    /// A file or folder.
    #[error("{path}: {source}; {cure}", path = .path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// What to do.
        cure: &'static str,
    },
    /// The disk is too small.
    #[error("{path}: {free} MB are free and about {needed} MB are needed; free some or name another folder with --out", path = .path.display())]
    Space {
        /// Where.
        path: PathBuf,
        /// Megabytes.
        free: u64,
        /// Megabytes.
        needed: u64,
    },
    /// A reference holds a NaN or an infinity.
    #[error("the {what} is not finite{}: its shading gives NaN or infinity there; look at the lights and materials that meet in it", .pixel.map(|(x, y)| format!(" at pixel ({x}, {y})")).unwrap_or_default())]
    NotFinite {
        /// Truth or grid reference.
        what: String,
        /// From the top left corner, where it could be found.
        pixel: Option<(u32, u32)>,
    },
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
    /// Part of it is there.
    #[error("{why}; {kept} of {planned} entries are kept in {}: go on with --resume", .folder.display())]
    Unfinished {
        /// What happened.
        why: String,
        /// Entries in the folder.
        kept: usize,
        /// Entries that were planned.
        planned: usize,
        /// Where they are.
        folder: PathBuf,
    },
}

impl ReportError {
    /// What is finished stays of use: the user stopped, or the device went away.
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
