//! Pictures: the display transform, files, the heat map of sample counts, and the strip that compares techniques.
//!
//! Everything 8-bit is an [`RgbImage`] in sRGB. Files appear whole or not at all: they are written under another name
//! in the same folder and then renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use ab_glyph::{Font, FontRef, ScaleFont, point};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError, ImageResult, Rgb, RgbImage};

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

/// What a pixel that holds a NaN or an infinity is shown as: magenta, which no sane image has in full.
pub const NOT_FINITE: [u8; 3] = [255, 0, 255];

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
        write_whole(path, |file| {
            OpenExrEncoder::new(file).write_image(&bytes, self.width, self.height, ExtendedColorType::Rgb32F)
        })
    }
}

/// From linear radiance to sRGB in [0, 1]: c/(1+c) per channel, then the sRGB transfer function. Negative radiance is
/// black, and a pixel with a NaN or an infinity is [`NOT_FINITE`].
pub fn display(c: [f32; 3]) -> [f32; 3] {
    if !is_finite(c) {
        return NOT_FINITE.map(|c| f32::from(c) / 255.0);
    }
    c.map(|c| {
        let c = c.max(0.0);
        srgb(c / (1.0 + c))
    })
}

/// Writes an 8-bit image.
pub fn write_png(image: &RgbImage, path: &Path) -> Result<(), PictureError> {
    let (width, height) = image.dimensions();
    check_size(width, height, pixels(width, height))?;
    write_whole(path, |file| {
        PngEncoder::new_with_quality(file, CompressionType::Default, FilterType::Adaptive).write_image(
            image,
            width,
            height,
            ExtendedColorType::Rgb8,
        )
    })
}

fn is_finite(c: [f32; 3]) -> bool {
    c.iter().all(|c| c.is_finite())
}

/// IEC 61966-2-1.
fn srgb(c: f32) -> f32 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

fn to_8bit(c: f32) -> u8 {
    (c * 255.0).round() as u8
}

fn pixels(width: u32, height: u32) -> usize {
    usize::try_from(u64::from(width) * u64::from(height)).unwrap_or(usize::MAX)
}

fn check_size(width: u32, height: u32, found: usize) -> Result<(), PictureError> {
    if width == 0 || height == 0 {
        Err(PictureError::Empty { width, height })
    } else if found != pixels(width, height) {
        Err(PictureError::Length { width, height, found })
    } else {
        Ok(())
    }
}

fn image_of(width: u32, height: u32, data: Vec<[u8; 3]>) -> Result<RgbImage, PictureError> {
    let found = data.len();
    RgbImage::from_raw(width, height, data.into_flattened()).ok_or(PictureError::Length { width, height, found })
}

/// Runs `encode` on a file of another name beside `path`, then renames it.
fn write_whole(path: &Path, encode: impl FnOnce(&mut BufWriter<File>) -> ImageResult<()>) -> Result<(), PictureError> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let fail = |source| PictureError::Write { path: path.to_owned(), source };
    let Some(name) = path.file_name() else {
        return Err(fail(ImageError::IoError(io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"))));
    };
    let (process, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let part = path.with_file_name(format!(".{}.{process}-{count}.part", name.to_string_lossy()));
    let write = || {
        let mut file = BufWriter::new(File::create(&part)?);
        encode(&mut file)?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(fs::rename(&part, path)?)
    };
    write().map_err(|source| {
        // What remains after an error is of no use, and there may be nothing to remove.
        let _ = fs::remove_file(&part);
        fail(source)
    })
}

/// The colour of a count of 0, where nothing was shaded and the colour came from neighbours.
pub const NOT_SHADED: [u8; 3] = [16, 52, 62];
/// The colour of a count above the maximum, which no technique may reach.
pub const OVER_MAX: [u8; 3] = [0, 255, 255];

/// The colour of `k` samples out of `n_max`: near-black for 1, pale yellow for all, lightness rising in between.
///
/// The scale is logarithmic, since 2 samples instead of 1 double a pixel's cost and 16 instead of 15 do not matter.
/// 0 is [`NOT_SHADED`] and more than `n_max` [`OVER_MAX`].
pub fn heat(k: u32, n_max: u32) -> [u8; 3] {
    match k {
        0 => NOT_SHADED,
        _ if k > n_max.max(1) => OVER_MAX,
        1 => inferno(0.0),
        _ => inferno((k as f32).ln() / (n_max as f32).ln()),
    }
}

/// The colour map Inferno by Nathaniel Smith and Stéfan van der Walt (CC0), whose lightness is monotone, as the
/// polynomial of degree 6 fitted by Matt Zucker (shadertoy.com/view/WlfXRN, CC0). Within 0.034 of matplotlib's table.
pub(crate) fn inferno(t: f32) -> [u8; 3] {
    #[rustfmt::skip]
    const C: [[f32; 3]; 7] = [
        [  0.000219,   0.001651,  -0.019481],
        [  0.106513,   0.563956,   3.932712],
        [ 11.602493,  -3.972854, -15.942394],
        [-41.704,     17.4364,    44.35415 ],
        [ 77.1629,   -33.4024,   -81.8073  ],
        [-71.3194,    32.6261,    73.2095  ],
        [ 25.1311,   -12.2427,   -23.0703  ],
    ];
    std::array::from_fn(|i| to_8bit(C.iter().rev().fold(0.0, |sum, c| sum * t + c[i]).clamp(0.0, 1.0)))
}

/// The sample counts as an image of the same size, coloured by [`heat`]. `counts` has one entry a pixel.
pub fn heat_map(counts: &[u32], width: u32, height: u32, n_max: u32) -> Result<RgbImage, PictureError> {
    check_size(width, height, counts.len())?;
    image_of(width, height, counts.iter().map(|&k| heat(k, n_max)).collect())
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

/// Part of a picture, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// Leftmost column.
    pub x: u32,
    /// Topmost row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Rect {
    /// The part that lies inside `width`×`height`, at least one pixel of it.
    fn clip(self, width: u32, height: u32) -> Self {
        let (x, y) = (self.x.min(width - 1), self.y.min(height - 1));
        Self { x, y, width: self.width.clamp(1, width - x), height: self.height.clamp(1, height - y) }
    }

    /// Whether less than `space` pixels lie between the two.
    fn near(self, other: Self, space: u32) -> bool {
        let apart = |a: u32, a_len: u32, b: u32, b_len: u32| {
            let (a, b, space) = (u64::from(a), u64::from(b), u64::from(space));
            a + u64::from(a_len) + space <= b || b + u64::from(b_len) + space <= a
        };
        !apart(self.x, self.width, other.x, other.width) && !apart(self.y, self.height, other.y, other.height)
    }
}

/// At most `count` windows of `size`×`size` pixels, clipped to the picture, that show where `a` and `b` differ most.
///
/// Each in turn is the window with the largest sum of |a − b| as shown, among those that keep `size` pixels from the
/// windows before it, or, when none with a difference does, that do not overlap them. The uppermost, then leftmost,
/// wins a tie, and is centred on what differs where that costs nothing. Windows without any difference are not given.
pub fn pick_crops(a: &Picture, b: &Picture, count: usize, size: u32) -> Result<Vec<Rect>, PictureError> {
    a.check()?;
    b.check()?;
    let (width, height) = (a.width, a.height);
    if (b.width, b.height) != (width, height) {
        let found = (b.width, b.height);
        return Err(PictureError::Differ { what: "the second picture".into(), found, first: (width, height) });
    }
    let difference: Vec<u32> = a
        .to_srgb8()
        .iter()
        .zip(&b.to_srgb8())
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum())
        .collect();
    let sums = Sums::new(&difference, width as usize, height as usize);
    let window = Rect { x: 0, y: 0, width: size.clamp(1, width), height: size.clamp(1, height) };

    let mut chosen: Vec<Rect> = Vec::new();
    while chosen.len() < count {
        let free = |r: Rect, space| chosen.iter().all(|c| !c.near(r, space));
        let best = |space| {
            let mut best: Option<(u64, Rect)> = None;
            for y in 0..=height - window.height {
                for x in 0..=width - window.width {
                    let at = Rect { x, y, ..window };
                    let sum = sums.of(at);
                    if sum > best.map_or(0, |(sum, _)| sum) && free(at, space) {
                        best = Some((sum, at));
                    }
                }
            }
            best
        };
        let Some((sum, at)) = best(size).or_else(|| best(0)) else { break };
        let centred = sums.centred(at);
        chosen.push(if sums.of(centred) >= sum && free(centred, 0) { centred } else { at });
    }
    Ok(chosen)
}

/// Summed areas, so that any window's sum costs four reads.
struct Sums {
    width: usize,
    height: usize,
    /// Entry (x, y) of (width + 1)·(height + 1) is the sum of all values above and to the left of it.
    sums: Vec<u64>,
}

impl Sums {
    fn new(values: &[u32], width: usize, height: usize) -> Self {
        let mut sums = vec![0; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row = 0;
            for x in 0..width {
                row += u64::from(values[y * width + x]);
                sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
            }
        }
        Self { width, height, sums }
    }

    fn of(&self, r: Rect) -> u64 {
        let at = |x: u32, y: u32| self.sums[y as usize * (self.width + 1) + x as usize];
        let (right, bottom) = (r.x + r.width, r.y + r.height);
        at(right, bottom) + at(r.x, r.y) - at(right, r.y) - at(r.x, bottom)
    }

    /// The window moved onto the centre of gravity of the values inside it.
    fn centred(&self, r: Rect) -> Rect {
        let total = self.of(r).max(1);
        let column = |x| u64::from(x) * self.of(Rect { x, width: 1, ..r });
        let row = |y| u64::from(y) * self.of(Rect { y, height: 1, ..r });
        let x = ((r.x..r.x + r.width).map(column).sum::<u64>() / total) as u32;
        let y = ((r.y..r.y + r.height).map(row).sum::<u64>() / total) as u32;
        let (right, bottom) = (self.width as u32 - r.width, self.height as u32 - r.height);
        Rect { x: x.saturating_sub(r.width / 2).min(right), y: y.saturating_sub(r.height / 2).min(bottom), ..r }
    }
}

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
const FRAME: u32 = 2;

const BACKGROUND: [u8; 3] = [19, 21, 26];
const BRIGHT: [u8; 3] = [240, 242, 246];
const MUTED: [u8; 3] = [164, 172, 186];
const RULE: [u8; 3] = [52, 57, 68];
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
    let crops: Vec<Rect> = crops.iter().map(|r| r.clip(width, height)).collect();

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

/// A font with its size in pixels.
#[derive(Clone, Copy)]
struct Type {
    font: &'static [u8],
    pixels: f32,
}

const HEADING: Type = Type { font: epaint_default_fonts::UBUNTU_LIGHT, pixels: 19.0 };
const TITLE: Type = Type { font: epaint_default_fonts::UBUNTU_LIGHT, pixels: 27.0 };
const CAPTION: Type = Type { font: epaint_default_fonts::HACK_REGULAR, pixels: 15.0 };

impl Type {
    fn font(self) -> impl Font {
        FontRef::try_from_slice(self.font).expect("the embedded font is whole")
    }

    /// Every printable character with its glyph and where it begins, and where the text ends.
    fn lay_out(self, font: &impl Font, text: &str) -> (Vec<(ab_glyph::GlyphId, f32)>, f32) {
        let scaled = font.as_scaled(self.pixels);
        let (mut glyphs, mut x, mut last) = (Vec::new(), 0.0, None);
        for c in text.chars().filter(|c| !c.is_control()) {
            let glyph = font.glyph_id(c);
            x += last.map_or(0.0, |last| scaled.kern(last, glyph));
            glyphs.push((glyph, x));
            x += scaled.h_advance(glyph);
            last = Some(glyph);
        }
        (glyphs, x)
    }

    fn width(self, text: &str) -> u32 {
        self.lay_out(&self.font(), text).1.ceil() as u32
    }
}

/// `text`, cut and ended with an ellipsis where it is wider than `room`.
fn fitted(text: &str, style: Type, room: u32) -> String {
    if style.width(text) <= room {
        return text.to_owned();
    }
    let mut cut: Vec<char> = text.chars().collect();
    loop {
        if cut.pop().is_none() {
            return String::new();
        }
        let shorter = format!("{}…", cut.iter().collect::<String>().trim_end());
        if style.width(&shorter) <= room {
            return shorter;
        }
    }
}

/// The figures of a caption in lines of at most `room` pixels.
fn wrap(caption: &str, room: u32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for figure in caption.split("  ").map(str::trim).filter(|f| !f.is_empty()) {
        if let Some(last) = lines.last_mut() {
            let longer = format!("{last}  {figure}");
            if CAPTION.width(&longer) <= room {
                *last = longer;
                continue;
            }
        }
        lines.push(fitted(figure, CAPTION, room));
    }
    lines
}

/// An image that is drawn on; what would fall outside is left out.
struct Canvas(RgbImage);

impl Canvas {
    fn new(width: u32, height: u32) -> Result<Self, PictureError> {
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(PictureError::TooLarge { width, height });
        }
        Ok(Self(RgbImage::from_pixel(width, height, Rgb(BACKGROUND))))
    }

    fn fill(&mut self, x: u32, y: u32, width: u32, height: u32, colour: [u8; 3]) {
        let (right, bottom) = (x.saturating_add(width), y.saturating_add(height));
        for y in y..bottom.min(self.0.height()) {
            for x in x..right.min(self.0.width()) {
                self.0.put_pixel(x, y, Rgb(colour));
            }
        }
    }

    fn blit(&mut self, image: &RgbImage, x: u32, y: u32) {
        for (dx, dy, &pixel) in image.enumerate_pixels() {
            if let Some(to) = self.0.get_pixel_mut_checked(x.saturating_add(dx), y.saturating_add(dy)) {
                *to = pixel;
            }
        }
    }

    /// A frame of `colour` with a dark rim around `r`, which lies in the picture `whole` whose corner is at (x, y). Where
    /// `r` touches the picture's border, the frame stays inside.
    fn mark(&mut self, x: u32, y: u32, r: Rect, whole: Rect, colour: [u8; 3]) {
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
    fn text(&mut self, text: &str, x: u32, y: u32, style: Type, colour: [u8; 3]) {
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
    fn legend(&mut self, x: u32, y: u32, width: u32, n_max: u32) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
        let at = |i: u32| {
            let [r, g, b] = pixel(i % width, i / width);
            [r, g, b, 1.0]
        };
        Picture { width, height, rgba: (0..width * height).map(at).collect() }
    }

    /// A folder of its own for one test, gone afterwards.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("daa-picture-{}-{name}", std::process::id()));
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        fn names(&self) -> Vec<String> {
            let names = fs::read_dir(&self.0).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
            names.collect()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn display_transform_in_closed_form() {
        assert_eq!(picture(1, 1, |_, _| [0.0, -1.0, f32::MAX]).to_srgb8(), [[0, 0, 255]]);
        // c = 1 gives linear 1/2, whose sRGB value is 0.7353569.
        assert!((display([1.0; 3])[0] - 0.735_356_9).abs() < 1e-6);
        // The straight part: c = 0.001 gives 12.92·0.001/1.001.
        assert!((display([0.001; 3])[0] - 0.012_907_09).abs() < 1e-7);
        let steps: Vec<f32> = (0..1000).map(|i| display([i as f32 * 0.01; 3])[0]).collect();
        assert!(steps.is_sorted());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(picture(1, 1, |_, _| [0.5, bad, 0.5]).to_srgb8(), [NOT_FINITE]);
        }
        assert_eq!(picture(2, 1, |x, _| [1.0, if x == 0 { f32::NAN } else { 1.0 }, 1.0]).not_finite(), 1);
    }

    #[test]
    fn files_hold_what_was_written_and_nothing_else_is_left() {
        let folder = Folder::new("files");
        for (width, height) in [(1, 1), (7, 5), (64, 3)] {
            let original = picture(width, height, |x, y| [x as f32 * 0.37, y as f32 * 12.5, 1e-7]);
            let (png, exr) = (folder.0.join("image.png"), folder.0.join("image.exr"));
            original.write_png(&png).unwrap();
            original.write_exr(&exr).unwrap();
            assert_eq!(image::open(&png).unwrap(), original.to_image().unwrap().into());
            let read = image::open(&exr).unwrap().into_rgba32f();
            let read: Vec<[f32; 4]> = read.pixels().map(|p| p.0).collect();
            assert_eq!(read, original.rgba);
        }
        assert_eq!(folder.names().len(), 2, "{:?}", folder.names());
    }

    #[test]
    fn a_nan_survives_in_exr() {
        let folder = Folder::new("nan");
        let path = folder.0.join("nan.exr");
        picture(2, 2, |x, _| [x as f32, f32::NAN, f32::INFINITY]).write_exr(&path).unwrap();
        let read = image::open(&path).unwrap().into_rgb32f();
        assert!(read.pixels().all(|p| p[1].is_nan() && p[2] == f32::INFINITY));
    }

    #[test]
    fn a_failed_write_names_the_file_and_leaves_nothing() {
        let folder = Folder::new("failed");
        let one = picture(1, 1, |_, _| [0.0; 3]);
        let missing = folder.0.join("no such folder").join("image.png");
        let message = one.write_png(&missing).unwrap_err().to_string();
        assert!(message.starts_with(&format!("can't write {}: ", missing.display())), "{message}");
        // The rename fails on a folder: the picture was already encoded by then.
        let taken = folder.0.join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(matches!(one.write_exr(&taken), Err(PictureError::Write { path, .. }) if path == taken));
        assert!(one.write_png(Path::new("")).is_err() && one.write_png(Path::new("..")).is_err());
        assert_eq!(folder.names(), ["taken"]);
        let broken = Picture { width: 2, ..one };
        assert!(matches!(broken.write_png(&missing), Err(PictureError::Length { found: 1, .. })));
        assert!(matches!(broken.write_exr(&missing), Err(PictureError::Length { found: 1, .. })));
        assert!(matches!(write_png(&RgbImage::new(0, 3), &missing), Err(PictureError::Empty { .. })));
    }

    #[test]
    fn heat_rises_from_near_black() {
        let lightness = |c: [u8; 3]| 0.2126 * f32::from(c[0]) + 0.7152 * f32::from(c[1]) + 0.0722 * f32::from(c[2]);
        for n in [1, 2, 4, 9, 16, 64, 256] {
            let steps: Vec<f32> = (1..=n).map(|k| lightness(heat(k, n))).collect();
            // 256 steps in 8 bits: neighbours may be a rounding of red apart.
            let rise = if n <= 16 { 1.0 } else { -0.22 };
            assert!(steps.is_sorted_by(|a, b| b - a >= rise), "{n}: {steps:?}");
            assert!(steps[0] < 3.0 && (n == 1 || steps[steps.len() - 1] > 230.0), "{n}: {steps:?}");
            assert_eq!((heat(0, n), heat(n + 1, n)), (NOT_SHADED, OVER_MAX));
        }
        assert_eq!(heat(1, 0), heat(1, 1));
        // matplotlib's Inferno at 0, 1/2 and 1.
        for (k, expected) in [(1, [0, 0, 4]), (4, [188, 55, 84]), (16, [252, 255, 164])] {
            let found = heat(k, 16);
            assert!(found.iter().zip(expected).all(|(a, b): (&u8, u8)| a.abs_diff(b) <= 9), "{k}: {found:?}");
        }
    }

    #[test]
    fn heat_map_checks_its_size() {
        let map = heat_map(&[0, 1, 4, 16, 17, 2], 3, 2, 16).unwrap();
        assert_eq!(map.get_pixel(0, 1).0, heat(16, 16));
        assert!(matches!(heat_map(&[1; 5], 3, 2, 16), Err(PictureError::Length { found: 5, .. })));
        assert!(matches!(heat_map(&[], 0, 0, 16), Err(PictureError::Empty { .. })));
        let legend = with_legend(&map, 16).unwrap();
        assert_eq!(legend.get_pixel(0, 1).0, heat(16, 16));
        assert!(legend.pixels().any(|p| p.0 == heat(15, 16)));
    }

    #[test]
    fn crops_find_the_differences_and_keep_apart() {
        let a = picture(64, 48, |_, _| [0.2; 3]);
        let spots = [(50, 40, 9.0), (10, 10, 5.0), (12, 30, 2.0)];
        let b = picture(64, 48, |x, y| spots.iter().find(|s| (s.0, s.1) == (x, y)).map_or([0.2; 3], |s| [s.2; 3]));
        let crops = pick_crops(&a, &b, 5, 8).unwrap();
        assert_eq!(crops.len(), 3, "{crops:?}");
        for (crop, (x, y, _)) in crops.iter().zip(spots) {
            assert_eq!((crop.x, crop.y), (x - 4, y - 4), "the spot is in the middle");
        }
        assert_eq!(crops, pick_crops(&b, &a, 5, 8).unwrap());
        assert!(pick_crops(&a, &a, 5, 8).unwrap().is_empty());
        assert!(pick_crops(&a, &b, 0, 8).unwrap().is_empty());
    }

    #[test]
    fn crops_never_overlap_nor_leave_the_picture() {
        for (width, height) in [(1, 1), (1, 9), (5, 4), (31, 17)] {
            let a = picture(width, height, |_, _| [0.0; 3]);
            let b = picture(width, height, |x, y| [((x * 7 + y * 13) % 5) as f32 + 0.1; 3]);
            for size in [0, 1, 3, 8, u32::MAX] {
                let crops = pick_crops(&a, &b, 6, size).unwrap();
                assert!(!crops.is_empty());
                for (i, r) in crops.iter().enumerate() {
                    assert_eq!(*r, r.clip(width, height));
                    assert!(crops[..i].iter().all(|other| !other.near(*r, 0)), "{crops:?}");
                }
            }
        }
        let (a, b) = (picture(2, 2, |_, _| [0.0; 3]), picture(2, 1, |_, _| [0.0; 3]));
        assert!(matches!(pick_crops(&a, &b, 1, 1), Err(PictureError::Differ { .. })));
    }

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

    #[test]
    fn captions_break_between_figures() {
        assert_eq!(wrap("k 4.1  25.6 %   43.2 dB", 1000), ["k 4.1  25.6 %  43.2 dB"]);
        let lines = wrap("k 4.1  25.6 %  43.2 dB  812 ms", 150);
        assert_eq!(lines.join("  "), "k 4.1  25.6 %  43.2 dB  812 ms");
        assert!(lines.len() == 2 && lines.iter().all(|l| CAPTION.width(l) <= 150), "{lines:?}");
        assert!(fitted("Reconstructed", TITLE, 60).ends_with('…'));
        assert_eq!(fitted("Reconstructed", TITLE, 1), "");
    }
}
