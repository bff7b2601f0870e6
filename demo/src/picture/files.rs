//! Picture files, which appear whole or not at all.

use super::error::PictureError;
use super::size::{check_size, pixels};
use crate::files;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageResult, RgbImage};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Writes an 8-bit image.
pub fn write_png(image: &RgbImage, path: &Path) -> Result<(), PictureError> {
    let (width, height) = image.dimensions();
    check_size(width, height, pixels(width, height))?;
    write_file(path, |file| {
        PngEncoder::new_with_quality(file, CompressionType::Default, FilterType::Adaptive).write_image(
            image,
            width,
            height,
            ExtendedColorType::Rgb8,
        )
    })
}

/// Writes a file of what `encode` gives.
pub fn write_file(
    path: &Path,
    encode: impl FnOnce(&mut BufWriter<File>) -> ImageResult<()>,
) -> Result<(), PictureError> {
    files::write_with(path, encode).map_err(|source| PictureError::Write { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;
    use crate::picture::made::picture;
    use std::fs;
    use std::path::PathBuf;

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
}
