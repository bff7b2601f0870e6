//! Truths that were rendered before, by what they depend on.
//!
//! A truth is an .exr of 32-bit floats beside a .json that says what it is and how many bytes and which hash the .exr
//! has. The folder is `--cache`, else `$XDG_CACHE_HOME/deferred-aa`, else `~/.cache/deferred-aa`
//! (`%LOCALAPPDATA%\deferred-aa` on Windows). Everything in it may be deleted at any time.

use super::ReportError;
use super::folder::write_whole;
use crate::picture::Picture;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// A cache folder, if there is one to be had.
#[derive(Debug, Clone)]
pub struct Cache {
    folder: Option<PathBuf>,
}

/// The .json of a truth.
#[derive(Debug, Serialize, Deserialize)]
struct Label {
    scene: String,
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    seconds: f64,
    exr_sha256: String,
}

/// A picture that was found.
#[derive(Debug)]
pub struct Hit {
    /// The picture as it was stored.
    pub picture: Picture,
    /// Seconds that it took to render.
    pub seconds: f64,
}

/// What there is to say of a truth that is stored.
#[derive(Debug, Clone, Copy)]
pub struct About<'a> {
    /// The scene's name, for people who look into the folder.
    pub scene: &'a str,
    /// Samples of each pixel, on a regular grid.
    pub samples_per_pixel: u32,
    /// Seconds that it took to render.
    pub seconds: f64,
}

impl Cache {
    /// The folder given, else the user's own.
    pub fn new(folder: Option<&Path>) -> Self {
        let set = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
        let own = || {
            if cfg!(windows) {
                return set("LOCALAPPDATA");
            }
            // Relative paths in it are invalid, says the XDG base directory specification.
            set("XDG_CACHE_HOME").filter(|p| p.is_absolute()).or_else(|| Some(set("HOME")?.join(".cache")))
        };
        Self { folder: folder.map(Path::to_owned).or_else(|| Some(own()?.join("deferred-aa"))) }
    }

    /// The truth of this key, or none, with a reason where one is there that can't be used.
    pub fn load(&self, key: &str, width: u32, height: u32) -> Result<Option<Hit>, String> {
        let Some((exr, json)) = self.files(key) else { return Ok(None) };
        if !json.exists() {
            return Ok(None);
        }
        let broken = |why: &str| format!("{}: {why}; rendered anew", exr.display());
        let label: Label = std::fs::read(&json)
            .ok()
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
            .ok_or_else(|| broken("its .json can't be read"))?;
        let bytes = std::fs::read(&exr).map_err(|e| broken(&e.to_string()))?;
        if hash(&bytes) != label.exr_sha256 {
            return Err(broken("the file has changed since it was written"));
        }
        let image = image::load_from_memory_with_format(&bytes, image::ImageFormat::OpenExr)
            .map_err(|e| broken(&e.to_string()))?
            .into_rgb32f();
        if image.dimensions() != (width, height) {
            return Err(broken("of another size"));
        }
        let rgba = image.pixels().map(|p| [p.0[0], p.0[1], p.0[2], 1.0]).collect();
        Ok(Some(Hit { picture: Picture { width, height, rgba }, seconds: label.seconds }))
    }

    /// Stores a truth: the .json last, so that what it speaks of is there.
    pub fn store(&self, key: &str, picture: &Picture, about: About<'_>) -> Result<(), ReportError> {
        let Some((exr, json)) = self.files(key) else { return Ok(()) };
        let cure = "name another folder with --cache";
        if let Some(folder) = &self.folder {
            std::fs::create_dir_all(folder).map_err(ReportError::file(folder, cure))?;
        }
        picture.write_exr(&exr)?;
        let bytes = std::fs::read(&exr).map_err(ReportError::file(&exr, cure))?;
        let About { scene, samples_per_pixel, seconds } = about;
        let (width, height) = (picture.width, picture.height);
        let exr_sha256 = hash(&bytes);
        let label = Label { scene: scene.to_owned(), width, height, samples_per_pixel, seconds, exr_sha256 };
        let text = serde_json::to_vec_pretty(&label).map_err(|e| ReportError::file(&json, cure)(e.into()))?;
        write_whole(&json, &text)
    }

    fn files(&self, key: &str) -> Option<(PathBuf, PathBuf)> {
        let at = |extension| Some(self.folder.as_ref()?.join(format!("truth-{key}.{extension}")));
        Some((at("exr")?, at("json")?))
    }
}

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
