//! Settings as a file, which `view` writes and reads and `render --settings` reads: `{"version": 1, "settings": {…}}`.
//! Settings that are left out have their defaults. A file with any mistake is refused as a whole; the error names the
//! mistake.

use crate::files;
use crate::names::did_you_mean;
use deferred_aa::Settings;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The version of the files that are written, and the only one that is read.
pub const VERSION: u64 = 1;

/// A settings file could not be read or written. No setting of it was used.
#[derive(Debug, thiserror::Error)]
pub enum SettingsFileError {
    /// The file could not be read or written.
    #[error("{path}: {source}", path = .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file is not JSON. JSON has no `NaN` and no infinities.
    #[error("{path}: no JSON: {problem}; write it anew with the viewer's Save", path = .path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong, and at which line and column.
        problem: String,
    },
    /// The file has another version than [`VERSION`].
    #[error("{path}: version {found}, this program reads {VERSION}; save it anew from the program that wrote it", path = .path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// The version in the file.
        found: String,
    },
    /// A key or a value is wrong.
    #[error("{path}: {key}: {problem}", path = .path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Path of the value in the file, such as `settings.windowed.depth`.
        key: String,
        /// What is wrong with it.
        problem: String,
    },
}

/// The settings as the content of a file.
pub fn to_text(settings: &Settings) -> String {
    let tree = json!({ "version": VERSION, "settings": settings });
    serde_json::to_string_pretty(&tree).unwrap_or_default() + "\n"
}

/// Writes a settings file, whole or not at all.
pub fn save(path: &Path, settings: &Settings) -> Result<(), SettingsFileError> {
    files::write(path, to_text(settings).as_bytes())
        .map_err(|source| SettingsFileError::File { path: path.to_owned(), source })
}

/// Reads a settings file and checks all of it.
pub fn load(path: &Path) -> Result<Settings, SettingsFileError> {
    let text =
        std::fs::read_to_string(path).map_err(|source| SettingsFileError::File { path: path.to_owned(), source })?;
    parse(path, &text)
}

/// Like [`load`], from a file's content; errors name it `path`.
pub fn parse(path: &Path, text: &str) -> Result<Settings, SettingsFileError> {
    let path = || path.to_owned();
    let tree: Value =
        serde_json::from_str(text).map_err(|e| SettingsFileError::Json { path: path(), problem: e.to_string() })?;
    let wrong = |key: String, problem: String| SettingsFileError::Value { path: path(), key, problem };
    let fields = tree.as_object().ok_or_else(|| wrong("the file".to_owned(), "is no object".to_owned()))?;
    match fields.get("version") {
        Some(found) if found.as_u64() == Some(VERSION) => {}
        found => {
            let found = found.map_or("none".to_owned(), Value::to_string);
            return Err(SettingsFileError::Version { path: path(), found });
        }
    }
    if let Some(key) = fields.keys().find(|key| !["version", "settings"].contains(&key.as_str())) {
        let meant = did_you_mean(key, &["version", "settings"]);
        return Err(wrong(key.clone(), format!("no such key:{meant} choose version or settings")));
    }
    let mut known = serde_json::to_value(Settings::default()).unwrap_or_default();
    let found = fields.get("settings").cloned().unwrap_or_else(|| json!({}));
    // One value after the other, so that the message names the one at fault.
    let mut values = Vec::new();
    leaves(&found, &known, "", &mut values).map_err(|(key, problem)| wrong(named(&key), problem))?;
    let mut settings = Settings::default();
    for (key, value) in values {
        let pointer = format!("/{}", key.replace('.', "/"));
        if let Some(place) = known.pointer_mut(&pointer) {
            *place = value;
        }
        settings = serde_json::from_value(known.clone()).map_err(|e| wrong(named(&key), e.to_string()))?;
        settings.validate().map_err(|e| wrong(named(&key), e.to_string()))?;
    }
    Ok(settings)
}

fn named(key: &str) -> String {
    if key.is_empty() { "settings".to_owned() } else { format!("settings.{key}") }
}

/// Collects the plain values below `found` with their paths. All paths must be in `known`; the error is the path that
/// is not, and why.
fn leaves(
    found: &Value,
    known: &Value,
    prefix: &str,
    values: &mut Vec<(String, Value)>,
) -> Result<(), (String, String)> {
    let Some(known) = known.as_object() else {
        values.push((prefix.to_owned(), found.clone()));
        return Ok(());
    };
    let found = found.as_object().ok_or_else(|| (prefix.to_owned(), format!("{found} is no object")))?;
    for (key, value) in found {
        let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        let Some(below) = known.get(key) else {
            let names: Vec<&str> = known.keys().map(String::as_str).collect();
            let problem = format!("no such setting:{} choose {}", did_you_mean(key, &names), names.join(", "));
            return Err((path, problem));
        };
        leaves(value, below, &path, values)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::{Goal, Technique};

    fn read(text: &str) -> Result<Settings, String> {
        parse(Path::new("s.json"), text).map_err(|e| e.to_string())
    }

    #[test]
    fn what_is_written_is_read() {
        let mut settings =
            Settings { technique: Technique::Selective, goal: Some(Goal::Error(0.01)), ..Default::default() };
        settings.selective.tau_col = 0.123;
        settings.selective.enabled.pte = false;
        settings.multi_resolution.rays.coarsest = 3;
        assert_eq!(read(&to_text(&settings)), Ok(settings));
        assert_eq!(read(&to_text(&Settings::default())), Ok(Settings::default()));
        let part = r#"{"version": 1, "settings": {"windowed": {"depth_scale": 7}}}"#;
        assert_eq!(read(part).map(|s| s.windowed.depth_scale), Ok(7.0));
    }

    #[test]
    fn a_file_with_a_mistake_is_refused_by_its_name() {
        for (text, part) in [
            (r#"{"version": 2, "settings": {}}"#, "s.json: version 2, this program reads 1"),
            (r#"{"settings": {}}"#, "version none"),
            (
                r#"{"version": 1, "settings": {"windowed": {"depth_scal": 1}}}"#,
                "settings.windowed.depth_scal: no such setting: did you mean depth_scale?",
            ),
            (r#"{"version": 1, "settings": {"windowed": 3}}"#, "settings.windowed: 3 is no object"),
            (
                r#"{"version": 1, "settings": {"windowed": {"depth_scale": NaN}}}"#,
                "no JSON: expected value at line 1 column",
            ),
            (r#"{"version": 1, "settings": {"windowed": {"depth_scale": 1e999}}}"#, "no JSON: number out of range"),
            (
                r#"{"version": 1, "settings": {"windowed": {"depth_scale": null}}}"#,
                "settings.windowed.depth_scale: invalid type: null",
            ),
            (
                r#"{"version": 1, "settings": {"windowed": {"depth_scale": "7"}}}"#,
                "settings.windowed.depth_scale: invalid type: string",
            ),
            (
                r#"{"version": 1, "settings": {"windowed": {"depth_scale": -7}}}"#,
                "settings.windowed.depth_scale: windowed.depth_scale is -7",
            ),
            (r#"{"version": 1, "settings": {"technique": "magic"}}"#, "settings.technique: unknown variant `magic`"),
            (r#"{"version": 1, "settings": {"goal": {"error": 2}}}"#, "settings.goal: goal.error is 2"),
            (r#"{"version": 1, "setings": {}}"#, "setings: no such key: did you mean settings?"),
            ("[]", "the file: is no object"),
            ("", "no JSON: EOF"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
