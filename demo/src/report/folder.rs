//! The folder of a report: pictures, and what is finished, each file whole or not there.
//!
//! What is finished lies in DIR/entries and DIR/parts with the fingerprint of what it depends on. `--resume` takes it
//! up where the fingerprint is still the same.

use super::ReportError;
use crate::files;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What a cure for files says.
const CURE: &str = "name a folder that can be written with --out";

/// A report's folder.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
    resume: bool,
}

/// One finished result.
#[derive(Debug, Serialize, Deserialize)]
struct Kept<T> {
    fingerprint: String,
    value: T,
}

/// Which kind of result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An entry.
    Entry,
    /// All else.
    Part,
}

impl Folder {
    /// Makes the folder, and shows that about `bytes` can be written before any work is done. With `resume`, what is
    /// finished in it is taken up.
    ///
    /// A finished report of something else is not touched, unless `force` says so.
    pub fn open(path: &Path, bytes: u64, resume: bool, subject: &Subject, force: bool) -> Result<Self, ReportError> {
        if let Some(other) = finished(path).filter(|other| !force && other.is_replaced_by(subject, resume)) {
            return Err(ReportError::Taken { path: path.to_owned(), command: other.subject.command });
        }
        let folder = Self { path: path.to_owned(), resume };
        for kind in [Kind::Entry, Kind::Part] {
            let at = folder.path.join(kind.name());
            std::fs::create_dir_all(&at).map_err(ReportError::file(&at, CURE))?;
        }
        let probe = folder.path.join(".probe");
        std::fs::write(&probe, [0; 4096]).map_err(ReportError::file(path, CURE))?;
        std::fs::remove_file(&probe).map_err(ReportError::file(&probe, CURE))?;
        let free = fs4::available_space(path).map_err(ReportError::file(path, CURE))?;
        if free < bytes {
            let (free, needed) = (free >> 20, bytes.div_ceil(1 << 20));
            return Err(ReportError::Space { path: path.to_owned(), free, needed });
        }
        Ok(folder)
    }

    /// Where a file of this name is.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A finished result of an earlier run, if it depends on the same.
    pub fn finished<T: DeserializeOwned>(&self, kind: Kind, name: &str, fingerprint: &str) -> Option<T> {
        let bytes = std::fs::read(self.kept(kind, name)).ok().filter(|_| self.resume)?;
        let kept: Kept<T> = serde_json::from_slice(&bytes).ok()?;
        (kept.fingerprint == fingerprint).then_some(kept.value)
    }

    /// Keeps a result.
    pub fn keep<T: Serialize>(&self, kind: Kind, name: &str, fingerprint: &str, value: T) -> Result<(), ReportError> {
        self.write_json(&self.kept(kind, name), &Kept { fingerprint: fingerprint.to_owned(), value })
    }

    /// Writes JSON, whole or not at all.
    pub fn write_json(&self, path: &Path, value: &impl Serialize) -> Result<(), ReportError> {
        let text = serde_json::to_string_pretty(value).map_err(|e| ReportError::file(path, CURE)(e.into()))?;
        write_whole(path, (text + "\n").as_bytes())
    }

    fn kept(&self, kind: Kind, name: &str) -> PathBuf {
        self.path.join(kind.name()).join(format!("{name}.json"))
    }
}

/// What a report is of.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Subject {
    /// The command line.
    pub command: String,
    /// The name of the scene.
    pub scene: String,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// How often the light loop runs.
    pub stall: u32,
}

/// The begin of a report.json.
#[derive(Deserialize)]
struct Head {
    #[serde(flatten)]
    subject: Subject,
    unfinished: Vec<String>,
}

/// The finished report in a folder.
fn finished(folder: &Path) -> Option<Head> {
    let head: Head = serde_json::from_slice(&std::fs::read(folder.join("report.json")).ok()?).ok()?;
    Some(head).filter(|head| head.unfinished.is_empty())
}

impl Head {
    /// Whether nothing would be left of it. A report that takes it up may have other entries of the same picture.
    fn is_replaced_by(&self, new: &Subject, resumed: bool) -> bool {
        let picture = |s: &Subject| (s.scene.clone(), s.width, s.height, s.stall);
        picture(&self.subject) != picture(new)
            || (!resumed && without_modes(&self.subject.command) != without_modes(&new.command))
    }
}

/// A command without its program and what does not change the report.
fn without_modes(command: &str) -> Vec<&str> {
    command.split(' ').skip(1).filter(|word| !["--resume", "--force"].contains(word)).collect()
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Entry => "entries",
            Self::Part => "parts",
        }
    }
}

/// Writes a file, whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    files::write(path, bytes).map_err(ReportError::file(path, "free some space or name another folder"))
}
