//! Decoding pictures, in parallel.

use std::borrow::Cow;
use std::io::Cursor;
use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::thread;

use image::{ImageReader, Limits};

use super::accessor::Document;
use super::error::Problem;
use super::limits::{MAX_SIDE, label};
use crate::scene::Image;

/// Of one picture, while it is decoded.
const MAX_BYTES: u64 = 1 << 30;
/// Of all pictures together.
const MAX_TOTAL_BYTES: u64 = 4 << 30;

/// Reads and decodes the file's images with these numbers, in this order.
pub(super) fn decode_all(document: &Document, folder: &Path, wanted: &[usize]) -> Result<Vec<Image>, Problem> {
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
    wanted
        .iter()
        .map(|number| match decoded.iter().position(|(done, _)| done == number) {
            Some(at) => decoded.swap_remove(at).1,
            None => Err(Problem::Image { place: format!("image {number}"), reason: "its decoder gave up".to_owned() }),
        })
        .collect()
}

fn decode(document: &Document, folder: &Path, number: usize, total: &AtomicU64) -> Result<Image, Problem> {
    let broken = |place: &str, reason: String| Problem::Image { place: place.to_owned(), reason };
    let Some(image) = document.root.images.get(number) else {
        return Err(broken(&format!("image {number}"), "it does not exist".to_owned()));
    };
    let name = image.name.as_deref().or(image.uri.as_deref().filter(|uri| !uri.starts_with("data:")));
    let place = label("image", number, name);
    let encoded: Cow<[u8]> = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => Cow::Owned(super::uri::read(uri, folder, &place)?),
        (None, Some(view)) => Cow::Borrowed(document.view(view).map_err(|reason| broken(&place, reason))?.0),
        (None, None) => return Err(broken(&place, "it has neither a uri nor a buffer view".to_owned())),
    };

    let mut reader = ImageReader::new(Cursor::new(&encoded))
        .with_guessed_format()
        .map_err(|error| broken(&place, error.to_string()))?;
    if reader.format().is_none() {
        return Err(broken(&place, "it is in no known picture format".to_owned()));
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let rgba = reader.decode().map_err(|error| broken(&place, error.to_string()))?.into_rgba8();

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
    Ok(Image { name: name.map_or_else(|| place.clone(), str::to_owned), width, height, rgba: bytes.into() })
}
