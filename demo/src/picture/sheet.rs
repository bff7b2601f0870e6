//! A sheet of crops: what one looks at to compare techniques, and nothing else.

use super::canvas::{Canvas, MUTED, RULE};
use super::crops::clip;
use super::error::PictureError;
use super::strip::Panel;
use super::text::{CAPTION, HEADING, TITLE, fitted};
use deferred_aa::Rect;
use image::{RgbImage, imageops};

const MARGIN: u32 = 16;
const GAP: u32 = 8;
const LINE: u32 = 20;
const BRIGHT: [u8; 3] = [240, 242, 246];

/// A column a panel: title, each figure of the caption on a line, and the same `crops` of each picture below each
/// other, magnified `zoom` times without smoothing.
pub fn sheet(heading: &str, panels: &[Panel<'_>], crops: &[Rect], zoom: u32) -> Result<RgbImage, PictureError> {
    let (width, height) = panels.first().ok_or(PictureError::NoPanel)?.image.dimensions();
    let crops: Vec<Rect> = crops.iter().map(|&r| clip(r, width, height)).collect();
    let column = crops.iter().map(|r| r.width * zoom).max().unwrap_or(0).max(120);
    let figures = |panel: &Panel<'_>| panel.caption.split("  ").filter(|f| !f.is_empty()).count() as u32;
    let lines = panels.iter().map(figures).max().unwrap_or(0);
    let titles_at = MARGIN + 36;
    let crops_at = titles_at + 36 + lines * LINE + GAP;
    let total = MARGIN * 2 + panels.len() as u32 * (column + GAP) - GAP;
    let bottom =
        crops_at + crops.iter().map(|r| r.height * zoom + GAP).sum::<u32>() - GAP.min(crops.len() as u32 * GAP);
    let mut canvas = Canvas::new(total, bottom + MARGIN)?;
    canvas.text(&fitted(heading, HEADING, total - 2 * MARGIN), MARGIN, MARGIN - 6, HEADING, MUTED);
    canvas.fill(MARGIN, MARGIN + 22, total - 2 * MARGIN, 1, RULE);
    for (i, panel) in panels.iter().enumerate() {
        let x = MARGIN + i as u32 * (column + GAP);
        canvas.text(&fitted(panel.title, TITLE, column), x, titles_at, TITLE, BRIGHT);
        for (line, figure) in (0..).zip(panel.caption.split("  ").filter(|f| !f.is_empty())) {
            canvas.text(&fitted(figure, CAPTION, column), x, titles_at + 36 + line * LINE, CAPTION, MUTED);
        }
        let mut y = crops_at;
        for &r in &crops {
            let part = imageops::crop_imm(panel.image, r.x, r.y, r.width, r.height).to_image();
            let magnified = imageops::resize(&part, r.width * zoom, r.height * zoom, imageops::FilterType::Nearest);
            canvas.blit(&magnified, x, y);
            y += r.height * zoom + GAP;
        }
    }
    Ok(canvas.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn crops_are_shown_as_they_are() {
        let image = RgbImage::from_fn(64, 40, |x, y| Rgb([x as u8, y as u8, 200]));
        let panel = Panel { title: "Full", caption: "16 lit  40 dB", image: &image, legend: None };
        let crop = Rect { x: 10, y: 20, width: 40, height: 30 };
        let sheet = sheet("heading", &[panel; 2], &[crop], 3).unwrap();
        // Clipped to the picture: 20 rows of it are left.
        let at = |x: u32, y: u32| sheet.get_pixel(sheet.width() - MARGIN - 120 + x, sheet.height() - MARGIN - 60 + y).0;
        assert_eq!((at(0, 0), at(119, 59), at(4, 7)), ([10, 20, 200], [49, 39, 200], [11, 22, 200]));
        assert!(matches!(super::sheet("", &[], &[], 3), Err(PictureError::NoPanel)));
        assert!(super::sheet("", &[panel], &[], 3).is_ok());
    }
}
