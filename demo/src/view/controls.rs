//! The viewer's controls: for every setting its kind and range, and its documentation from the library's source.
//!
//! The tests hold that every setting has a control and that every control takes what the library takes.

use deferred_aa::{SETTINGS_SOURCE, SettingRange, SettingScale, Settings, Technique};
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::OnceLock;

/// The control of one setting.
#[derive(Debug, Clone)]
pub struct Control {
    /// Path in the tree of the settings, such as `windowed.depth_scale`.
    pub path: String,
    /// The last part of the path, spelled out.
    pub label: String,
    /// What the setting does, and in which unit.
    pub doc: String,
    /// Type in Rust.
    pub ty: String,
    /// How the setting is changed.
    pub kind: Kind,
}

/// How a setting is changed.
#[derive(Debug, Clone)]
pub enum Kind {
    /// A number.
    Slider(SettingRange),
    /// On or off.
    Switch,
    /// One of several values, by name, each with its documentation.
    Choice(Vec<(String, String)>),
    /// No goal, an error or a time.
    Goal,
}

/// The range of the number at this path.
pub fn range(path: &str) -> Option<SettingRange> {
    Settings::RANGES.iter().find(|range| range.path == path).copied()
}

/// The part of a range that a slider spans: up to a hundred times the default where the range spans many magnitudes.
/// What lies beyond can be typed.
pub fn useful(range: &SettingRange, default: f64) -> RangeInclusive<f64> {
    let (least, most) = (f64::from(range.least), f64::from(range.most));
    if range.scale != SettingScale::Logarithmic || most <= 10.0 {
        return least..=most;
    }
    let wanted = if default > 0.0 { default * 100.0 } else { 100.0 };
    // A number that is easily read.
    let wanted = 10f64.powf(wanted.log10().ceil());
    least..=wanted.clamp(1.0, most)
}

/// All controls, in the order of the library's fields.
pub fn all() -> &'static [Control] {
    static ALL: OnceLock<Vec<Control>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut controls = Vec::new();
        source().controls("Settings", "", &mut controls);
        controls
    })
}

fn source() -> &'static Source {
    static READ: OnceLock<Source> = OnceLock::new();
    READ.get_or_init(|| Source::read(SETTINGS_SOURCE))
}

/// The techniques that have settings of their own, and the paths of these.
pub fn groups() -> impl Iterator<Item = (&'static str, Technique)> {
    let fields = source().structs.get("Settings").into_iter().flatten();
    fields.filter_map(|(field, ty, _)| {
        let of = Technique::ALL.into_iter().find(|technique| format!("{technique:?}") == *ty)?;
        Some((field.as_str(), of))
    })
}

/// The struct at this path, such as `Lattice` at `multi_resolution.rays`.
pub fn struct_at(path: &str) -> Option<&'static str> {
    let mut name = "Settings";
    for part in path.split('.').filter(|part| !part.is_empty()) {
        name = source().structs.get(name)?.iter().find(|(field, ..)| field == part).map(|(_, ty, _)| ty.as_str())?;
    }
    source().structs.contains_key(name).then_some(name)
}

/// Settings with one of them changed. The error says why the library refuses it.
pub fn with(settings: &Settings, path: &str, value: Value) -> Result<Settings, String> {
    let mut tree = serde_json::to_value(settings).map_err(|e| e.to_string())?;
    let place = tree.pointer_mut(&pointer(path)).ok_or_else(|| format!("no setting '{path}'"))?;
    *place = value;
    let settings: Settings = serde_json::from_value(tree).map_err(|e| e.to_string())?;
    settings.validate().map(|()| settings).map_err(|e| e.to_string())
}

/// The JSON pointer of a path into the tree of the settings.
pub fn pointer(path: &str) -> String {
    format!("/{}", path.replace('.', "/"))
}

/// The controls of the group at this path, its own groups included. "": those in no group.
pub fn group(path: &str) -> impl Iterator<Item = &'static Control> {
    let path = path.to_owned();
    all().iter().filter(move |c| match path.as_str() {
        "" => !c.path.contains('.'),
        path => c.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')),
    })
}

/// What the library's source says about its settings.
#[derive(Debug, Default)]
struct Source {
    /// The fields of each struct, in order: name, type, documentation.
    structs: BTreeMap<String, Vec<(String, String, String)>>,
    /// The variants of each enum, in order: name as serialised, documentation.
    enums: BTreeMap<String, Vec<(String, String)>>,
}

impl Source {
    /// Reads source as rustfmt writes it: one field or variant per line, its documentation right above.
    fn read(texts: &[&str]) -> Self {
        let mut source = Self::default();
        let mut inside: Option<(bool, String)> = None;
        let mut doc = String::new();
        for line in texts.iter().flat_map(|text| text.lines()) {
            if let Some(item) = line.strip_prefix("pub struct ").or_else(|| line.strip_prefix("pub enum ")) {
                let name = item.trim_end_matches(" {").to_owned();
                inside = Some((line.starts_with("pub struct "), name));
            } else if line == "}" {
                inside = None;
            } else if let Some(words) = line.strip_prefix("    /// ") {
                doc.push_str(words.trim());
                doc.push(' ');
                continue;
            } else if line.starts_with("    #[") {
                continue;
            } else if let Some((is_struct, name)) = &inside {
                let line = line.trim().trim_end_matches(',');
                if let (true, Some((field, ty))) =
                    (*is_struct, line.strip_prefix("pub ").and_then(|l| l.split_once(": ")))
                {
                    let fields = source.structs.entry(name.clone()).or_default();
                    fields.push((field.to_owned(), ty.to_owned(), plain(&doc)));
                } else if !is_struct {
                    let variant = line.split([' ', '(']).next().unwrap_or_default();
                    source.enums.entry(name.clone()).or_default().push((snake_case(variant), plain(&doc)));
                }
            }
            doc.clear();
        }
        source
    }

    fn controls(&self, of: &str, prefix: &str, controls: &mut Vec<Control>) {
        for (field, ty, doc) in self.structs.get(of).into_iter().flatten() {
            let path = format!("{prefix}{field}");
            let kind = match ty.as_str() {
                "bool" => Kind::Switch,
                "Option<Goal>" => Kind::Goal,
                ty if self.structs.contains_key(ty) => {
                    self.controls(ty, &format!("{path}."), controls);
                    continue;
                }
                ty if self.enums.contains_key(ty) => Kind::Choice(self.enums[ty].clone()),
                _ => match range(&path) {
                    Some(range) => Kind::Slider(range),
                    None => continue,
                },
            };
            controls.push(Control { label: label(&path), path, doc: doc.clone(), ty: ty.clone(), kind });
        }
    }
}

/// The last part of a path, and the one before where many share it.
fn label(path: &str) -> String {
    let mut parts: Vec<&str> = path.rsplit('.').take(2).collect();
    if !["shading", "rays", "enabled"].contains(parts.last().unwrap_or(&"")) {
        parts.truncate(1);
    }
    parts.reverse();
    parts.join(" ").replace('_', " ").replace("tau ", "τ ")
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
    }
    snake
}

/// Documentation without its markup and the targets of its links.
fn plain(doc: &str) -> String {
    let mut text = String::new();
    let mut rest = doc.trim();
    while let Some(end) = rest.find("](") {
        text.push_str(&rest[..end]);
        let target = &rest[end + 2..];
        rest = target.find(')').map_or("", |close| &target[close + 1..]);
    }
    text.push_str(rest);
    text.replace("Self::", "").replace("crate::", "").replace(['`', '[', ']'], "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn leaves(tree: &Value, prefix: &str, found: &mut Vec<String>) {
        match tree.as_object() {
            Some(fields) => {
                for (key, value) in fields {
                    let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
                    leaves(value, &path, found);
                }
            }
            None => found.push(prefix.to_owned()),
        }
    }

    fn with(path: &str, value: Value) -> Result<Settings, String> {
        super::with(&Settings::default(), path, value)
    }

    #[test]
    fn every_setting_has_a_control_and_every_control_a_setting() {
        let mut settings = Vec::new();
        leaves(&serde_json::to_value(Settings::default()).unwrap(), "", &mut settings);
        let mut controls: Vec<String> = all().iter().map(|c| c.path.clone()).collect();
        controls.sort();
        settings.sort();
        assert_eq!(controls, settings);
        assert!(settings.len() > 60, "{}", settings.len());
    }

    #[test]
    fn sliders_span_what_is_useful() {
        let defaults = serde_json::to_value(Settings::default()).unwrap();
        for c in all() {
            let Kind::Slider(range) = &c.kind else { continue };
            let default = defaults.pointer(&pointer(&c.path)).and_then(Value::as_f64).unwrap();
            let useful = useful(range, default);
            assert!(useful.contains(&default), "{}: {default} in {useful:?}", c.path);
            assert!(*useful.start() >= f64::from(range.least) && *useful.end() <= f64::from(range.most), "{}", c.path);
        }
        let depth = range("windowed.depth_scale").unwrap();
        assert_eq!(useful(&depth, 4000.0), 0.0..=f64::from(depth.most).min(1e6));
        let luminance = range("windowed.luminance_scale").unwrap();
        assert_eq!(*useful(&luminance, 72.0).end(), f64::from(luminance.most).min(1e4));
    }

    #[test]
    fn every_control_says_what_it_does() {
        for c in all() {
            assert!(c.doc.len() > 10, "{}: {:?}", c.path, c.doc);
            assert!(!c.doc.contains(['`', '[', ']']) && !c.doc.contains("::Self"), "{}: {}", c.path, c.doc);
            if let Kind::Choice(choices) = &c.kind {
                assert!(choices.len() > 1 && choices.iter().all(|(_, doc)| doc.len() > 3), "{c:?}");
            }
        }
        let doc = |path: &str| all().iter().find(|c| c.path == path).unwrap().doc.clone();
        assert!(doc("windowed.tile_limit").contains("0 to 4032 = 64 · 63"));
        assert_eq!(doc("selective.enabled.pte"), "Whether Selective::tau_pte applies.");
    }

    #[test]
    fn every_control_takes_what_the_library_takes() {
        for c in all() {
            let values = match &c.kind {
                Kind::Slider(range) if range.scale == SettingScale::Whole => {
                    vec![json!(range.least as u32), json!(range.most as u32)]
                }
                Kind::Slider(range) => vec![json!(range.least), json!(range.most)],
                Kind::Switch => vec![json!(true), json!(false)],
                Kind::Choice(choices) => choices.iter().map(|(name, _)| json!(name)).collect(),
                Kind::Goal => vec![Value::Null, json!({ "error": 0.01 }), json!({ "time": 10.0 })],
            };
            for value in values {
                with(&c.path, value).unwrap_or_else(|e| panic!("{}: {e}", c.path));
            }
        }
        assert!(range("goal.error").is_some() && range("goal.time").is_some());
    }
}
