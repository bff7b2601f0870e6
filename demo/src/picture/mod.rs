//! Pictures: the display transform, files, the heat map of sample counts, and the strip that compares techniques.
//!
//! Everything 8-bit is an [`RgbImage`](image::RgbImage) in sRGB.

mod canvas;
mod crops;
mod display;
mod error;
mod files;
mod heat;
mod linear;
mod sheet;
mod size;
mod strip;
mod text;

pub use canvas::with_legend;
pub use crops::pick_crops;
pub use display::{NOT_FINITE, display};
pub use error::{MAX_PIXELS, PictureError};
pub use files::write_png;
pub(crate) use heat::inferno;
pub use heat::{NOT_SHADED, OVER_MAX, heat, heat_map};
pub use linear::Picture;
pub use sheet::sheet;
pub use strip::{Panel, strip};

/// Pictures made for tests.
#[cfg(test)]
mod made {
    use super::Picture;

    pub fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
        let at = |i: u32| {
            let [r, g, b] = pixel(i % width, i / width);
            [r, g, b, 1.0]
        };
        Picture { width, height, rgba: (0..width * height).map(at).collect() }
    }
}
