//! Following the uris of buffers and images.

use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::error::Problem;

/// Padding is often forgotten; its absence is no ambiguity.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// No single file of a model may be longer.
const MAX_FILE: u64 = 4 << 30;

/// The bytes that `uri` stands for: inline data, or a file relative to `folder`. `place` is for messages.
pub(super) fn read(uri: &str, folder: &Path, place: &str) -> Result<Vec<u8>, Problem> {
    if let Some(data) = uri.strip_prefix("data:") {
        return inline(data).map_err(|reason| Problem::Uri { place: place.to_owned(), reason });
    }
    read_file(&resolve(uri, folder, place)?)
}

/// Reads a regular file of sane length; devices and pipes could go on for ever.
pub(super) fn read_file(file: &Path) -> Result<Vec<u8>, Problem> {
    let check_and_read = || {
        let meta = fs::metadata(file)?;
        if meta.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder, not a file"));
        }
        if !meta.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a file"));
        }
        if meta.len() > MAX_FILE {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, "longer than 4 GiB"));
        }
        fs::read(file)
    };
    check_and_read().map_err(|source| Problem::Read { file: file.to_owned(), source })
}

fn inline(data: &str) -> Result<Vec<u8>, String> {
    let (header, body) = data.split_once(',').ok_or("a data uri without a comma")?;
    let mut bytes: Vec<u8> = percent_decode_str(body).collect();
    if !header.ends_with(";base64") {
        return Ok(bytes);
    }
    bytes.retain(|byte| !byte.is_ascii_whitespace());
    BASE64.decode(bytes).map_err(|error| format!("a data uri with broken base64 ({error})"))
}

fn resolve(uri: &str, folder: &Path, place: &str) -> Result<PathBuf, Problem> {
    let refuse = |reason: String| Problem::Uri { place: place.to_owned(), reason };
    let decoded = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| refuse(format!("the uri {uri:?} is not UTF-8 after percent decoding")))?;
    if decoded.is_empty() {
        return Err(refuse("the uri is empty".to_owned()));
    }
    if has_scheme(&decoded) || decoded.starts_with(['/', '\\']) || Path::new(decoded.as_ref()).has_root() {
        return Err(refuse(format!("the uri {uri:?} is not relative")));
    }
    let path = folder.join(decoded.as_ref());
    // Some exporters forget to encode, so that "100%25.png" is meant to the letter.
    if matches!(decoded, Cow::Owned(_)) && !path.exists() {
        let literal = folder.join(uri);
        if literal.exists() {
            return Ok(literal);
        }
    }
    Ok(path)
}

/// RFC 3986: a letter, then letters, digits, `+`, `-`, `.`, up to a colon. Catches Windows drives as well.
fn has_scheme(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inline_data() {
        assert_eq!(inline("application/octet-stream;base64,AAEC").unwrap(), [0, 1, 2]);
        assert_eq!(inline(";base64,AA").unwrap(), [0], "padding may be missing");
        assert_eq!(inline(";base64,A%41%3D%3D").unwrap(), [0], "percent encoding may be used");
        assert_eq!(inline("text/plain,a%20b").unwrap(), b"a b");
        assert!(inline(";base64;AAEC").is_err());
        assert!(inline(";base64,A*EC").is_err());
    }

    #[test]
    fn only_relative_files() {
        let folder = Path::new("models");
        for uri in ["http://host/a.bin", "file:///etc/passwd", "/etc/passwd", "%2Fetc/passwd", "C:\\a.bin", "\\a", ""] {
            assert!(resolve(uri, folder, "buffer 0").is_err(), "{uri}");
        }
        assert_eq!(resolve("../a%20b/ü.bin", folder, "buffer 0").unwrap(), folder.join("../a b/ü.bin"));
    }

    #[test]
    fn devices_and_folders_are_not_read() {
        assert!(read_file(Path::new("/dev/zero")).is_err());
        assert!(read_file(Path::new(".")).is_err());
    }
}
