//! Drawing on an image: areas, images, frames, text, and the colours of a heat map explained.

use super::error::{MAX_PIXELS, PictureError};
use super::heat::heat;
use super::size::{check_size, pixels};
use super::text::{CAPTION, Type};
use ab_glyph::{Font, ScaleFont, point};
use deferred_aa::Rect;
use image::{Rgb, RgbImage};

/// An image that is drawn on; what would fall outside is left out.
pub struct Canvas(pub RgbImage);

impl Canvas {
    pub fn new(width: u32, height: u32) -> Result<Self, PictureError> {
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(PictureError::TooLarge { width, height });
        }
        Ok(Self(RgbImage::from_pixel(width, height, Rgb(BACKGROUND))))
    }

    pub fn fill(&mut self, x: u32, y: u32, width: u32, height: u32, colour: [u8; 3]) {
        let (right, bottom) = (x.saturating_add(width), y.saturating_add(height));
        for y in y..bottom.min(self.0.height()) {
            for x in x..right.min(self.0.width()) {
                self.0.put_pixel(x, y, Rgb(colour));
            }
        }
    }

    pub fn blit(&mut self, image: &RgbImage, x: u32, y: u32) {
        for (dx, dy, &pixel) in image.enumerate_pixels() {
            if let Some(to) = self.0.get_pixel_mut_checked(x.saturating_add(dx), y.saturating_add(dy)) {
                *to = pixel;
            }
        }
    }

    /// A frame of `colour` with a dark rim around `r`, which lies in the picture `whole` whose corner is at (x, y).
    /// Where `r` touches the picture's border, the frame stays inside.
    pub fn mark(&mut self, x: u32, y: u32, r: Rect, whole: Rect, colour: [u8; 3]) {
        for (outset, thickness, colour) in [(FRAME + 1, FRAME + 1, BACKGROUND), (FRAME, FRAME, colour)] {
            let (left, top) = (x + r.x.saturating_sub(outset), y + r.y.saturating_sub(outset));
            let right = x + (r.x + r.width + outset).min(whole.width);
            let bottom = y + (r.y + r.height + outset).min(whole.height);
            let (across, down) = (thickness.min(right - left), thickness.min(bottom - top));
            self.fill(left, top, right - left, down, colour);
            self.fill(left, bottom - down, right - left, down, colour);
            self.fill(left, top, across, bottom - top, colour);
            self.fill(right - across, top, across, bottom - top, colour);
        }
    }

    /// Text whose line begins at (x, y), its upper left corner.
    pub fn text(&mut self, text: &str, x: u32, y: u32, style: Type, colour: [u8; 3]) {
        let font = style.font();
        let baseline = y as f32 + font.as_scaled(style.pixels).ascent().round();
        for (glyph, at) in style.lay_out(&font, text).0 {
            let glyph = glyph.with_scale_and_position(style.pixels, point(x as f32 + at, baseline));
            let Some(outline) = font.outline_glyph(glyph) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|dx, dy, coverage| {
                let (px, py) = (corner.x as i64 + i64::from(dx), corner.y as i64 + i64::from(dy));
                let (Ok(px), Ok(py)) = (u32::try_from(px), u32::try_from(py)) else { return };
                if let Some(pixel) = self.0.get_pixel_mut_checked(px, py) {
                    // Blended in about linear light, or light text on dark looks starved.
                    let coverage = coverage.clamp(0.0, 1.0);
                    for (to, ink) in pixel.0.iter_mut().zip(colour) {
                        let (from, ink) = (f32::from(*to).powi(2), f32::from(ink).powi(2));
                        *to = (from + (ink - from) * coverage).sqrt().round() as u8;
                    }
                }
            });
        }
    }

    /// "1 [colours] n" in a line of `width` pixels.
    pub fn legend(&mut self, x: u32, y: u32, width: u32, n_max: u32) {
        let n_max = n_max.max(1);
        let (least, most) = ("k 1", n_max.to_string());
        let (left, right) = (CAPTION.width(least) + 8, CAPTION.width(&most) + 8);
        self.text(least, x, y, CAPTION, MUTED);
        self.text(&most, (x + width).saturating_sub(right - 8), y, CAPTION, MUTED);
        let bar = width.saturating_sub(left + right);
        let (x, y) = (x + left, y + 3);
        self.fill(x, y, bar, 12, RULE);
        for i in 1..bar.saturating_sub(1) {
            let k = 1 + u64::from(i) * u64::from(n_max) / u64::from(bar);
            self.fill(x + i, y + 1, 1, 10, heat(k as u32, n_max));
        }
    }
}

/// `map` with the colours of 1 to `n_max` samples explained below it.
pub fn with_legend(map: &RgbImage, n_max: u32) -> Result<RgbImage, PictureError> {
    let (width, height) = map.dimensions();
    check_size(width, height, pixels(width, height))?;
    let mut canvas = Canvas::new(width.max(180), height.saturating_add(36))?;
    canvas.blit(map, 0, 0);
    canvas.legend(12, height + 10, width.clamp(180, 420) - 24, n_max);
    Ok(canvas.0)
}

pub const FRAME: u32 = 2;

pub const BACKGROUND: [u8; 3] = [19, 21, 26];

pub const MUTED: [u8; 3] = [164, 172, 186];

pub const RULE: [u8; 3] = [52, 57, 68];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::heat_map;

    #[test]
    fn a_legend_lies_below_its_map() {
        let map = heat_map(&[0, 1, 4, 16, 17, 2], 3, 2, 16).unwrap();
        let legend = with_legend(&map, 16).unwrap();
        assert_eq!(legend.get_pixel(0, 1).0, heat(16, 16));
        assert!(legend.pixels().any(|p| p.0 == heat(15, 16)));
    }
}
