//! What commands print and write.

use super::error::CommandError;
use crate::files;
use std::path::Path;

/// A line to stdout. A reader that has gone away (`| head`) is not an error.
pub fn say(line: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Writes JSON, whole or not at all.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), CommandError> {
    let file = |source| CommandError::File { path: path.to_owned(), source };
    let text = serde_json::to_string_pretty(value).map_err(|e| file(e.into()))?;
    files::write(path, (text + "\n").as_bytes()).map_err(file)
}
