//! Why a picture can't be made or written.

use image::ImageError;
use std::path::PathBuf;

/// Why a picture can't be made or written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// A side of the picture is 0.
    #[error("a picture of {width}x{height} has no pixels: both sides must be at least 1")]
    Empty {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The data does not fit the size.
    #[error("{found} pixels do not fill {width}x{height}: give one entry a pixel, rows from the top")]
    Length {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Entries that are there.
        found: usize,
    },
    /// Two pictures that belong together differ in size.
    #[error("{what} is {}x{}, the first picture {}x{}: make all of one size", found.0, found.1, first.0, first.1)]
    Differ {
        /// The picture that differs.
        what: String,
        /// Its width and height.
        found: (u32, u32),
        /// Width and height of the first picture.
        first: (u32, u32),
    },
    /// A strip needs at least one panel.
    #[error("a comparison strip needs at least one panel")]
    NoPanel,
    /// The result would exceed [`MAX_PIXELS`].
    #[error("a picture of {width}x{height} is larger than {MAX_PIXELS} pixels: give fewer or smaller pictures")]
    TooLarge {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The file can't be written.
    #[error("can't write {}: {source}", path.display())]
    Write {
        /// The file that was asked for.
        path: PathBuf,
        /// What went wrong.
        source: ImageError,
    },
}

/// The most pixels that a composed picture may have.
pub const MAX_PIXELS: u64 = 1 << 28;
