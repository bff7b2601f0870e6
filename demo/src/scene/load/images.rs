//! Decoding pictures, in parallel.

use std::borrow::Cow;
use std::io::Cursor;
use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::thread;

use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, ImageResult, Limits};

use super::accessor::Document;
use super::error::Problem;
use super::limits::{MAX_SIDE, label};
use crate::scene::Image;

/// Of one picture, while it is decoded.
const MAX_BYTES: u64 = 1 << 30;
/// Of all pictures together.
const MAX_TOTAL_BYTES: u64 = 4 << 30;

const JPEG_SCAN: [u8; 2] = [0xff, 0xda];
const JPEG_END: [u8; 2] = [0xff, 0xd9];

/// Reads and decodes the file's images with these numbers, in this order. Notes those of which a part is missing.
pub(super) fn decode_all(
    document: &Document,
    folder: &Path,
    wanted: &[usize],
    notices: &mut Vec<String>,
) -> Result<Vec<Image>, Problem> {
    let next = AtomicUsize::new(0);
    let total = AtomicU64::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some(&number) = wanted.get(next.fetch_add(1, Relaxed)) {
            done.push((number, decode(document, folder, number, &total)));
        }
        done
    };
    let threads = thread::available_parallelism().map_or(1, NonZero::get).min(wanted.len());
    let mut decoded: Vec<_> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        // A decoder that panics costs its thread's pictures, which are then found missing.
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    let mut images = Vec::with_capacity(wanted.len());
    for number in wanted {
        let Some(at) = decoded.iter().position(|(done, _)| done == number) else {
            let (place, reason) = (format!("image {number}"), "its decoder gave up".to_owned());
            return Err(Problem::Image { place, reason });
        };
        let (image, notice) = decoded.swap_remove(at).1?;
        images.push(image);
        notices.extend(notice);
    }
    Ok(images)
}

/// The picture, and a notice if its file is cut short.
fn decode(
    document: &Document,
    folder: &Path,
    number: usize,
    total: &AtomicU64,
) -> Result<(Image, Option<String>), Problem> {
    let broken = |place: &str, reason: String| Problem::Image { place: place.to_owned(), reason };
    let Some(image) = document.root.images.get(number) else {
        return Err(broken(&format!("image {number}"), "it does not exist".to_owned()));
    };
    let name = image.name.as_deref().or(image.uri.as_deref().filter(|uri| !uri.starts_with("data:")));
    let place = label("image", number, name);
    let mut encoded: Cow<[u8]> = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => Cow::Owned(super::uri::read(uri, folder, &place)?),
        (None, Some(view)) => Cow::Borrowed(document.view(view).map_err(|reason| broken(&place, reason))?.0),
        (None, None) => return Err(broken(&place, "it has neither a uri nor a buffer view".to_owned())),
    };

    let format =
        image::guess_format(&encoded).map_err(|_| broken(&place, "it is in no known picture format".to_owned()))?;
    let cut = match format {
        ImageFormat::Jpeg => is_jpeg_cut(&encoded),
        ImageFormat::Png => is_png_cut(&encoded),
        _ => false,
    };
    if cut && format == ImageFormat::Jpeg {
        end_jpeg(encoded.to_mut());
    }
    let mut reader = ImageReader::with_format(Cursor::new(&encoded), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits.clone());
    let decoded = if cut {
        reader.into_decoder().and_then(|decoder| {
            // As `decode` does: the size that a file claims need not be that of a picture.
            limits.reserve(decoder.total_bytes())?;
            DynamicImage::from_decoder(Lenient(decoder))
        })
    } else {
        reader.decode()
    };
    let rgba = decoded.map_err(|error| broken(&place, error.to_string()))?.into_rgba8();

    let (width, height) = rgba.dimensions();
    if width == 0 || height == 0 {
        return Err(broken(&place, "it is empty".to_owned()));
    }
    let bytes = rgba.into_raw();
    if total.fetch_add(bytes.len() as u64, Relaxed) + bytes.len() as u64 > MAX_TOTAL_BYTES {
        return Err(Problem::TooLarge {
            what: "decoded pictures, in bytes,".to_owned(),
            limit: MAX_TOTAL_BYTES as usize,
        });
    }
    let notice = cut.then(|| format!("{place}: cut short, its file ends early; what there is of it is shown"));
    let name = name.map_or_else(|| place.clone(), str::to_owned);
    Ok((Image { name, width, height, rgba: bytes.into() }, notice))
}

/// A decoder whose picture is what it read before an error.
struct Lenient<D>(D);

impl<D: ImageDecoder> ImageDecoder for Lenient<D> {
    fn dimensions(&self) -> (u32, u32) {
        self.0.dimensions()
    }

    fn color_type(&self) -> ColorType {
        self.0.color_type()
    }

    fn read_image(self, pixels: &mut [u8]) -> ImageResult<()> {
        let _ = self.0.read_image(pixels);
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, pixels: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(pixels)
    }
}

/// Whether a JPEG's end marker is missing. Decoders fill what is lost with grey, and say nothing.
fn is_jpeg_cut(file: &[u8]) -> bool {
    let mut at = 2;
    // Segments up to the first scan. In scans, markers stand for themselves; before, thumbnails have some of their own.
    while let Some(&[0xff, marker, high, low]) = file.get(at..at + 4).and_then(|head| head.as_array()) {
        if [0xff, marker] == JPEG_SCAN {
            return !file[at..].windows(2).any(|pair| pair == JPEG_END);
        }
        // Any number of bytes may fill the space between segments.
        at += if marker == 0xff { 1 } else { 2 + usize::from(u16::from_be_bytes([high, low])) };
    }
    true
}

/// Ends a cut JPEG after its last whole scan if it has several: decoders show nothing of a progressive picture with a
/// scan that breaks off.
fn end_jpeg(file: &mut Vec<u8>) {
    let mut scans = (0..file.len()).filter(|&at| file[at..].starts_with(&JPEG_SCAN));
    if let (Some(_), Some(last)) = (scans.next(), scans.next_back()) {
        file.truncate(last);
        file.extend(JPEG_END);
    }
}

/// Whether a PNG's chunks do not reach its last one.
fn is_png_cut(file: &[u8]) -> bool {
    let mut rest = file.get(8..).unwrap_or_default();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let Some(next) = (u32::from_be_bytes(*length) as usize).checked_add(8).and_then(|size| after.get(size..))
        else {
            break;
        };
        if after.starts_with(b"IEND") {
            return false;
        }
        rest = next;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let noise = |x: u32, y: u32| image::Rgb([(x * 37 + y * 91) as u8, (x * y) as u8, ((x * 11) ^ (y * 5)) as u8]);
        image::RgbImage::from_fn(48, 48, noise).write_to(&mut file, format).unwrap();
        file.into_inner()
    }

    #[test]
    fn a_file_is_cut_unless_its_end_is_there() {
        for (format, is_cut) in [(ImageFormat::Jpeg, is_jpeg_cut as fn(&[u8]) -> bool), (ImageFormat::Png, is_png_cut)]
        {
            let file = encoded(format);
            assert!(!is_cut(&file) && !is_cut(&[&file[..], b"trailing"].concat()), "{format:?}");
            for length in 0..file.len() {
                // The checksum of the end marker holds nothing.
                assert!(is_cut(&file[..length]) || length + 4 > file.len(), "{format:?} of {length} bytes");
            }
        }
    }

    #[test]
    fn a_progressive_picture_ends_with_its_last_whole_scan() {
        let mut several = [&[0xff, 0xd8][..], &JPEG_SCAN, b"one", &JPEG_SCAN, b"half"].concat();
        end_jpeg(&mut several);
        assert_eq!(several, [&[0xff, 0xd8][..], &JPEG_SCAN, b"one", &JPEG_END].concat());
        let mut one = [&[0xff, 0xd8][..], &JPEG_SCAN, b"half"].concat();
        end_jpeg(&mut one);
        assert_eq!(one, [&[0xff, 0xd8][..], &JPEG_SCAN, b"half"].concat());
    }

    #[test]
    fn the_end_of_a_thumbnail_is_not_that_of_the_picture() {
        let mut file = encoded(ImageFormat::Jpeg);
        let thumbnail = [&[0xff, 0xe1, 0, 8][..], b"Ex", &[0xff, 0xd9, 0xff, 0xd9]].concat();
        file.splice(2..2, thumbnail);
        assert!(!is_jpeg_cut(&file));
        assert!(is_jpeg_cut(&file[..file.len() / 2]));
    }
}
