//! The strip that compares techniques: a column each, with the same crops magnified.

use super::canvas::{Canvas, FRAME, MUTED, RULE};
use super::crops::clip;
use super::error::PictureError;
use super::size::{check_size, pixels};
use super::text::{CAPTION, HEADING, TITLE, fitted, wrap};
use deferred_aa::Rect;
use image::{Rgb, RgbImage};

/// One column of a comparison [`strip`].
#[derive(Clone, Copy, Debug)]
pub struct Panel<'a> {
    /// What is shown, "Windowed".
    pub title: &'a str,
    /// Its figures, separated by two spaces, "k 4.1  25.6 %  43.2 dB  812 ms". Lines break between figures.
    pub caption: &'a str,
    /// The picture, all panels of one size.
    pub image: &'a RgbImage,
    /// For a heat map: the count that its hottest colour stands for.
    pub legend: Option<u32>,
}

/// Pictures narrower than this are enlarged by a whole factor, and columns are at least this wide.
const MIN_COLUMN: u32 = 300;
/// Pictures wider or higher than this are reduced by a whole factor; the crops are not.
const MAX_OVERVIEW: u32 = 960;
const MARGIN: u32 = 32;
const COLUMN_GAP: u32 = 24;
const CROP_GAP: u32 = 12;
/// Largest and least agreeable magnification of crops.
const MAGNIFY: (u32, u32) = (8, 4);

const BRIGHT: [u8; 3] = [240, 242, 246];
const FRAMES: [[u8; 3]; 6] =
    [[255, 176, 32], [64, 196, 255], [255, 96, 144], [128, 230, 150], [190, 150, 255], [255, 236, 120]];

/// The comparison picture: a column a panel with title, caption and the whole image, and under it the same `crops` of
/// each, magnified without smoothing and framed in the colour that marks them on the image. `heading` may be empty.
pub fn strip(heading: &str, panels: &[Panel], crops: &[Rect]) -> Result<RgbImage, PictureError> {
    let (width, height) = panels.first().ok_or(PictureError::NoPanel)?.image.dimensions();
    check_size(width, height, pixels(width, height))?;
    if let Some(p) = panels.iter().find(|p| p.image.dimensions() != (width, height)) {
        let what = format!("the picture of panel {:?}", p.title);
        return Err(PictureError::Differ { what, found: p.image.dimensions(), first: (width, height) });
    }
    let crops: Vec<Rect> = crops.iter().map(|&r| clip(r, width, height)).collect();

    let overview = Scale::fit(width, height, MIN_COLUMN, MAX_OVERVIEW);
    let column = overview.of(width).max(MIN_COLUMN);
    let grid = CropGrid::new(&crops, column);
    let captions: Vec<Vec<String>> = panels.iter().map(|p| wrap(p.caption, column)).collect();

    // From the top: heading, then in each column title, caption lines and legend, picture, crops.
    let lines = panels.iter().zip(&captions).map(|(p, c)| c.len() + usize::from(p.legend.is_some())).max().unwrap_or(0);
    let notes: Vec<String> = [
        overview.note().map(|n| format!("pictures {n}")),
        grid.scale.note().filter(|_| !crops.is_empty()).map(|n| format!("crops {n}")),
    ]
    .into_iter()
    .flatten()
    .collect();
    let note = notes.join(", ");
    let with_heading = !heading.is_empty() || !note.is_empty();
    let titles_at = MARGIN + if with_heading { 46 } else { 0 };
    let picture_at = titles_at + 36 + 21 * lines as u32 + if lines > 0 { 9 } else { 0 };
    let crops_at = picture_at + overview.of(height) + CROP_GAP + 4;
    let bottom = if crops.is_empty() { crops_at - CROP_GAP - 4 } else { crops_at.saturating_add(grid.height) };
    let columns = u32::try_from(panels.len()).unwrap_or(u32::MAX);
    let total = columns.saturating_mul(column + COLUMN_GAP).saturating_sub(COLUMN_GAP).saturating_add(2 * MARGIN);
    let mut canvas = Canvas::new(total, bottom.saturating_add(MARGIN))?;

    if with_heading {
        let right = CAPTION.width(&note);
        let room = (total - 2 * MARGIN).saturating_sub(right + if right > 0 { COLUMN_GAP } else { 0 });
        canvas.text(&fitted(heading, HEADING, room), MARGIN, MARGIN - 8, HEADING, MUTED);
        canvas.text(&note, total - MARGIN - right, MARGIN - 6, CAPTION, MUTED);
        canvas.fill(MARGIN, MARGIN + 26, total - 2 * MARGIN, 1, RULE);
    }
    for (i, (panel, caption)) in panels.iter().zip(&captions).enumerate() {
        let x = MARGIN + i as u32 * (column + COLUMN_GAP);
        canvas.text(&fitted(panel.title, TITLE, column), x, titles_at, TITLE, BRIGHT);
        for (i, line) in caption.iter().enumerate() {
            canvas.text(line, x, titles_at + 36 + 21 * i as u32, CAPTION, MUTED);
        }
        if let Some(n_max) = panel.legend {
            canvas.legend(x, titles_at + 36 + 21 * caption.len() as u32, column.min(420), n_max);
        }
        let whole = Rect { x: 0, y: 0, width, height };
        canvas.blit(&overview.apply(panel.image, whole), x, picture_at);
        for (i, &crop) in crops.iter().enumerate() {
            let colour = FRAMES[i % FRAMES.len()];
            canvas.mark(x, picture_at, overview.rect(crop), overview.rect(whole), colour);
            let (cell_x, cell_y) = grid.place(i);
            let (cell_x, cell_y) = (x + cell_x, crops_at + cell_y);
            let view = grid.scale.apply(panel.image, crop);
            canvas.fill(cell_x, cell_y, view.width() + 2 * FRAME, view.height() + 2 * FRAME, colour);
            canvas.blit(&view, cell_x + FRAME, cell_y + FRAME);
        }
    }
    Ok(canvas.0)
}

/// A whole factor of magnification or reduction.
#[derive(Clone, Copy)]
struct Scale {
    up: u32,
    down: u32,
}

impl Scale {
    /// Up while both sides stay within `min`, down until both are within `max`.
    fn fit(width: u32, height: u32, min: u32, max: u32) -> Self {
        let longest = width.max(height).max(1);
        Self { up: (min / longest).max(1), down: longest.div_ceil(max.max(1)).max(1) }
    }

    fn of(self, length: u32) -> u32 {
        length.div_ceil(self.down) * self.up
    }

    fn rect(self, r: Rect) -> Rect {
        let to = |v: u32| v / self.down * self.up;
        Rect { x: to(r.x), y: to(r.y), width: self.of(r.width), height: self.of(r.height) }
    }

    fn note(self) -> Option<String> {
        match self {
            Self { up: 1, down: 1 } => None,
            Self { up, down: 1 } => Some(format!("×{up}")),
            Self { down, .. } => Some(format!("1:{down}")),
        }
    }

    /// Part of an image: pixels repeated, or averaged in about linear light.
    fn apply(self, image: &RgbImage, part: Rect) -> RgbImage {
        let (right, bottom) = (part.x + part.width, part.y + part.height);
        RgbImage::from_fn(self.of(part.width), self.of(part.height), |x, y| {
            let (x0, y0) = (part.x + x / self.up * self.down, part.y + y / self.up * self.down);
            if self.down == 1 {
                return *image.get_pixel(x0, y0);
            }
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for y in y0..(y0 + self.down).min(bottom) {
                for x in x0..(x0 + self.down).min(right) {
                    let pixel = image.get_pixel(x, y).0.map(|c| f32::from(c).powi(2));
                    sum.iter_mut().zip(pixel).for_each(|(sum, c)| *sum += c);
                    count += 1.0;
                }
            }
            Rgb(sum.map(|c| (c / count).sqrt().round() as u8))
        })
    }
}

/// Where the crops of a column lie: as few rows as let them be magnified enough, spread over the column's width.
struct CropGrid {
    scale: Scale,
    cell: (u32, u32),
    per_row: u32,
    gap: u32,
    height: u32,
}

impl CropGrid {
    fn new(crops: &[Rect], column: u32) -> Self {
        let count = u32::try_from(crops.len()).unwrap_or(u32::MAX).max(1);
        let width = crops.iter().map(|r| r.width).max().unwrap_or(1);
        let height = crops.iter().map(|r| r.height).max().unwrap_or(1);
        let room = |per_row: u32| {
            (column.saturating_sub(CROP_GAP.saturating_mul(per_row - 1)) / per_row).saturating_sub(2 * FRAME)
        };
        let fits = |per_row: &u32| room(*per_row) / width >= MAGNIFY.1;
        let most = (1..=count.min(column)).rev().find(fits).unwrap_or(1);
        let per_row = count.div_ceil(count.div_ceil(most));
        let room = room(per_row);
        let up = (room / width).min(MAX_OVERVIEW / height).clamp(1, MAGNIFY.0);
        let down = width.div_ceil(room.max(1)).max(height.div_ceil(MAX_OVERVIEW));
        let scale = Scale { up, down };
        let cell = (scale.of(width) + 2 * FRAME, scale.of(height) + 2 * FRAME);
        // Spread over the column unless that would tear them apart.
        let spread = column.saturating_sub(per_row * cell.0) / (per_row - 1).max(1);
        let gap = if spread <= 3 * CROP_GAP { spread } else { CROP_GAP };
        let rows = count.div_ceil(per_row);
        Self { scale, cell, per_row, gap, height: rows.saturating_mul(cell.1 + CROP_GAP) - CROP_GAP }
    }

    fn place(&self, i: usize) -> (u32, u32) {
        let (row, column) = (i as u32 / self.per_row, i as u32 % self.per_row);
        (column * (self.cell.0 + self.gap), row * (self.cell.1 + CROP_GAP))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_shows_pictures_and_crops_unchanged() {
        let image = RgbImage::from_fn(320, 200, |x, y| Rgb([x as u8, y as u8, 7]));
        let panel = Panel { title: "Full", caption: "k 16.0  100 %", image: &image, legend: None };
        let crop = Rect { x: 100, y: 50, width: 40, height: 30 };
        let strip = strip("", &[panel], &[crop]).unwrap();
        // The first pixel of the picture, wherever it lies, begins an unchanged copy, but for the frame.
        let contains = |part: &RgbImage, factor: u32| {
            let starts = (0..strip.height() - part.height() * factor + 1)
                .flat_map(|y| (0..strip.width() - part.width() * factor + 1).map(move |x| (x, y)));
            starts.into_iter().any(|(x, y)| {
                (0..part.height() * factor).all(|dy| {
                    (0..part.width() * factor)
                        .all(|dx| strip.get_pixel(x + dx, y + dy) == part.get_pixel(dx / factor, dy / factor))
                })
            })
        };
        let cut = |r: Rect| image::imageops::crop_imm(&image, r.x, r.y, r.width, r.height).to_image();
        assert!(contains(&cut(Rect { x: 0, y: 0, width: 320, height: 40 }), 1));
        assert!(contains(&cut(crop), 7), "the crop is magnified 7 times");
        assert!(strip.pixels().any(|p| p.0 == FRAMES[0]));
    }

    #[test]
    fn strips_of_any_size_and_text() {
        let everywhere = Rect { x: u32::MAX, y: u32::MAX, width: u32::MAX, height: u32::MAX };
        let small = Rect { x: 0, y: 0, width: 0, height: 0 };
        for (width, height) in [(1, 1), (1, 1000), (1000, 1), (17, 3), (300, 300), (2000, 20), (961, 1200)] {
            let image = RgbImage::new(width, height);
            let long = "a figure that is far longer than any column can be  ".repeat(4);
            for (title, caption, legend) in
                [("", "", None), ("Windowed", "k 4.1  25.6 %", Some(16)), (&long, &long, Some(0)), ("\n\t🦀", "", None)]
            {
                let panel = Panel { title, caption, image: &image, legend };
                for crops in [&[][..], &[small], &[everywhere; 7], &[small, everywhere, small]] {
                    let strip = strip(title, &[panel; 3], crops).unwrap();
                    assert!(strip.width() >= 3 * MIN_COLUMN);
                }
            }
        }
        let (a, b, empty) = (RgbImage::new(2, 2), RgbImage::new(2, 3), RgbImage::new(0, 0));
        let panel = |image| Panel { title: "Full", caption: "", image, legend: None };
        assert!(matches!(strip("", &[], &[]), Err(PictureError::NoPanel)));
        assert!(matches!(strip("", &[panel(&empty)], &[]), Err(PictureError::Empty { .. })));
        let message = strip("", &[panel(&a), panel(&b)], &[]).unwrap_err().to_string();
        assert!(message.contains("the picture of panel \"Full\" is 2x3, the first picture 2x2"), "{message}");
        assert!(matches!(strip("", &vec![panel(&a); 100_000], &[]), Err(PictureError::TooLarge { .. })));
    }
}
