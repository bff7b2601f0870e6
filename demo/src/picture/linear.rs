//! A linear HDR picture.

use super::display::{display, is_finite, to_8bit};
use super::error::PictureError;
use super::files::{write_file, write_png};
use super::size::{check_size, image_of};
use image::codecs::openexr::OpenExrEncoder;
use image::{ExtendedColorType, ImageEncoder, RgbImage};
use std::path::Path;

/// A linear HDR picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One entry a pixel, rows from the top. Alpha is carried, but neither shown, written nor measured.
    pub rgba: Vec<[f32; 4]>,
}

impl Picture {
    /// A picture of `rgba`, which must have `width`·`height` entries.
    pub fn new(width: u32, height: u32, rgba: Vec<[f32; 4]>) -> Result<Self, PictureError> {
        let picture = Self { width, height, rgba };
        picture.check()?;
        Ok(picture)
    }

    /// Whether there is a pixel, and as many as the size says.
    pub fn check(&self) -> Result<(), PictureError> {
        check_size(self.width, self.height, self.rgba.len())
    }

    /// How many pixels hold a NaN or an infinity in red, green or blue.
    pub fn not_finite(&self) -> usize {
        self.rgba.iter().filter(|&&[r, g, b, _]| !is_finite([r, g, b])).count()
    }

    /// The picture as shown, [`display`] rounded to 8 bits: the pixels of `image.png`, on which quality is measured.
    pub fn to_srgb8(&self) -> Vec<[u8; 3]> {
        self.rgba.iter().map(|&[r, g, b, _]| display([r, g, b]).map(to_8bit)).collect()
    }

    /// [`Self::to_srgb8`] as an image.
    pub fn to_image(&self) -> Result<RgbImage, PictureError> {
        self.check()?;
        image_of(self.width, self.height, self.to_srgb8())
    }

    /// Writes the picture as shown, 8-bit sRGB without alpha.
    pub fn write_png(&self, path: &Path) -> Result<(), PictureError> {
        write_png(&self.to_image()?, path)
    }

    /// Writes linear 32-bit floats, bit for bit, a NaN included, as RGB without alpha.
    pub fn write_exr(&self, path: &Path) -> Result<(), PictureError> {
        self.check()?;
        let bytes: Vec<u8> = self.rgba.iter().flat_map(|p| &p[..3]).flat_map(|c| c.to_ne_bytes()).collect();
        write_file(path, |file| {
            OpenExrEncoder::new(file).write_image(&bytes, self.width, self.height, ExtendedColorType::Rgb32F)
        })
    }
}
