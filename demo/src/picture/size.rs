//! How many pixels a picture has, and whether its data fill them.

use super::error::PictureError;
use image::RgbImage;

pub fn pixels(width: u32, height: u32) -> usize {
    usize::try_from(u64::from(width) * u64::from(height)).unwrap_or(usize::MAX)
}

pub fn check_size(width: u32, height: u32, found: usize) -> Result<(), PictureError> {
    if width == 0 || height == 0 {
        Err(PictureError::Empty { width, height })
    } else if found != pixels(width, height) {
        Err(PictureError::Length { width, height, found })
    } else {
        Ok(())
    }
}

pub fn image_of(width: u32, height: u32, data: Vec<[u8; 3]>) -> Result<RgbImage, PictureError> {
    let found = data.len();
    RgbImage::from_raw(width, height, data.into_flattened()).ok_or(PictureError::Length { width, height, found })
}
