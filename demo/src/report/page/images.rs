//! Pictures for the page, and maps.

use crate::picture::{self, Picture, PictureError};
use crate::report::ReportError;
use crate::report::schema::{Crop, Entry};
use crate::report::session::Session;
use base64::Engine as _;
use deferred_aa::Technique;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::imageops::FilterType;
use image::{ImageError, RgbImage};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The name of the page in the folder.
pub const PAGE_FILE: &str = "report.html";

/// The difference that has the brightest colour of an error map, of [0, 1].
const BRIGHTEST: f32 = 0.25;

/// Most entries with pictures on the page.
const SHOWN: usize = 13;

/// Most pixels of a picture on the page; larger ones are made smaller, and crops stay as they are.
const MOST_PIXELS: f64 = 1.2e6;

/// Of JPEG: of pictures, and of maps, where nobody counts pixels.
const QUALITY: (u8, u8) = (90, 80);

/// Worst places, and the pixels of a side.
const CROPS: (usize, u32) = (6, 64);

/// What the page gets besides the report.
#[derive(Debug, Default, Serialize)]
pub struct Images {
    entries: BTreeMap<String, Shown>,
    truth: Option<String>,
    crops: Vec<CropImages>,
}

#[derive(Debug, Serialize)]
struct Shown {
    image: String,
    samples: Option<String>,
    error: Option<String>,
}

#[derive(Debug, Serialize)]
struct CropImages {
    #[serde(flatten)]
    place: Crop,
    truth: String,
    entries: BTreeMap<String, String>,
}

/// White where the mask is set.
pub fn mask(mask: &[bool], width: u32) -> Result<RgbImage, PictureError> {
    let height = (mask.len() / width.max(1) as usize) as u32;
    let bytes = mask.iter().flat_map(|&edge| [if edge { 255 } else { 0 }; 3]).collect();
    RgbImage::from_raw(width, height, bytes).ok_or(PictureError::Length { width, height, found: mask.len() })
}

/// The greatest difference of a channel as shown, by the square root so that faint ones are seen: black none, pale
/// yellow [`BRIGHTEST`] and above.
pub fn error_map(image: &Picture, truth: &Picture) -> Result<RgbImage, PictureError> {
    let mut map = image.to_image()?;
    for (a, b) in map.pixels_mut().zip(truth.to_srgb8()) {
        let most = a.0.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
        a.0 = picture::inferno((f32::from(most) / 255.0 / BRIGHTEST).sqrt().min(1.0));
    }
    Ok(map)
}

/// Where `image` differs most from the truth, worst first.
pub fn worst(session: &Session, image: &Entry, truth: &Picture) -> Result<Vec<Crop>, ReportError> {
    let shown = linear(&session.folder.file(&image.files.exr))?;
    Ok(picture::pick_crops(&shown, truth, CROPS.0, CROPS.1)?.into_iter().map(Crop::from).collect())
}

/// The entry whose worst places are shown: Windowed as given at the largest m, else the first one.
pub fn judged(entries: &[Entry]) -> Option<&Entry> {
    let is_default = |e: &&Entry| e.id == format!("windowed-m{}", e.stats.m);
    entries.iter().find(is_default).or(entries.first())
}

/// Everything for the page, read from the folder.
pub fn images(session: &Session, entries: &[Entry], crops: &[Crop]) -> Result<Images, ReportError> {
    let mut images = Images::default();
    let truth = rgb(&session.folder.file("truth.png"))?;
    for &crop in crops {
        let truth = png(&part(&truth, crop))?;
        images.crops.push(CropImages { place: crop, truth, entries: BTreeMap::new() });
    }
    images.truth = Some(jpeg(&truth, QUALITY.0)?);
    for entry in shown(entries) {
        let image = rgb(&session.folder.file(&entry.files.png))?;
        for (crop, at) in images.crops.iter_mut().zip(crops) {
            crop.entries.insert(entry.id.clone(), png(&part(&image, *at))?);
        }
        let map = |name: &Option<String>| {
            name.as_ref().map(|name| jpeg(&rgb(&session.folder.file(name))?, QUALITY.1)).transpose()
        };
        let shown = Shown {
            image: jpeg(&image, QUALITY.0)?,
            samples: map(&entry.files.samples)?,
            error: map(&entry.files.error)?,
        };
        images.entries.insert(entry.id.clone(), shown);
    }
    Ok(images)
}

/// Plain shading, the peers, Windowed by its names, Selective, MultiResolution, Surfaces, and Full, of the largest m.
pub fn shown(entries: &[Entry]) -> Vec<&Entry> {
    let m = entries.iter().map(|e| e.stats.m).max().unwrap_or(1);
    let windowed = |e: &&Entry| e.stats.settings.technique == Technique::Windowed && e.stats.m == m;
    let find = |id: String| entries.iter().filter(move |e| e.id == id);
    let mut all: Vec<_> = find("single-m1".to_owned()).collect();
    all.extend(entries.iter().filter(|e| e.stats.m == 1 && e.id != "single-m1"));
    all.extend(entries.iter().filter(windowed).filter(|e| e.preset.is_some() || e.id == format!("windowed-m{m}")));
    all.truncate(SHOWN - 4);
    all.extend(find(format!("selective-m{m}")));
    all.extend(find(format!("multiresolution-m{m}")));
    all.extend(find(format!("surfaces-m{m}")));
    all.extend(find(format!("full-m{m}")));
    if all.is_empty() {
        all.extend(entries.iter().take(SHOWN));
    }
    all
}

fn rgb(path: &Path) -> Result<RgbImage, ReportError> {
    Ok(open(path)?.into_rgb8())
}

/// A picture of the folder, linear.
fn linear(path: &Path) -> Result<Picture, ReportError> {
    let image = open(path)?.into_rgb32f();
    let rgba = image.pixels().map(|p| [p.0[0], p.0[1], p.0[2], 1.0]).collect();
    Ok(Picture::new(image.width(), image.height(), rgba)?)
}

fn open(path: &Path) -> Result<image::DynamicImage, ReportError> {
    image::open(path).map_err(|e| {
        let source = match e {
            ImageError::IoError(e) => e,
            other => std::io::Error::other(other),
        };
        ReportError::file(path, "it was written by this report: start again without --resume")(source)
    })
}

fn part(image: &RgbImage, crop: Crop) -> RgbImage {
    // Cut off at the border by itself.
    image::imageops::crop_imm(image, crop.x, crop.y, crop.size, crop.size).to_image()
}

fn png(image: &RgbImage) -> Result<String, ReportError> {
    let mut bytes = Vec::new();
    image.write_with_encoder(PngEncoder::new(&mut bytes)).map_err(encoding)?;
    Ok(data("png", &bytes))
}

fn jpeg(image: &RgbImage, quality: u8) -> Result<String, ReportError> {
    let scale = (MOST_PIXELS / (f64::from(image.width()) * f64::from(image.height()))).sqrt();
    let small = (scale < 1.0).then(|| {
        let side = |s: u32| ((f64::from(s) * scale) as u32).max(1);
        image::imageops::resize(image, side(image.width()), side(image.height()), FilterType::Triangle)
    });
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode_image(small.as_ref().unwrap_or(image))
        .map_err(encoding)?;
    Ok(data("jpeg", &bytes))
}

fn encoding(source: ImageError) -> ReportError {
    PictureError::Write { path: PAGE_FILE.into(), source }.into()
}

fn data(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_maps_are_black_where_nothing_differs_and_brightest_where_much_does() {
        let gray = |v: f32| Picture::new(2, 1, vec![[0.5, 0.5, 0.5, 1.0], [v, 0.5, 0.5, 1.0]]).unwrap();
        let map = error_map(&gray(60.0), &gray(0.5)).unwrap();
        assert_eq!(map.get_pixel(0, 0).0, picture::inferno(0.0));
        assert_eq!(map.get_pixel(1, 0).0, picture::inferno(1.0));
    }

    #[test]
    fn masks_are_white_at_edges() {
        let image = mask(&[true, false], 2).unwrap();
        assert_eq!((image.get_pixel(0, 0).0, image.get_pixel(1, 0).0), ([255; 3], [0; 3]));
    }
}
