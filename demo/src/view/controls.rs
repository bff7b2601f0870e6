//! What stands beside every setting in the viewer: its kind, its range and its documentation, which is that of the library's source.
//!
//! Only ranges are written here. That each setting has a control, and each control the range that the library holds it to, is
//! tested.

use deferred_aa::Settings;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::OnceLock;

const SOURCE: &str = include_str!("../../../src/settings.rs");

/// Of one setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// In the tree of the settings, such as `windowed.depth_scale`.
    pub path: String,
    /// The last part of it, spelled out.
    pub label: String,
    /// What it does, in which unit.
    pub doc: String,
    /// In Rust.
    pub ty: String,
    /// How it is set.
    pub kind: Kind,
}

/// How a setting is set.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A number.
    Slider(Range),
    /// On or off.
    Switch,
    /// One of several, by name, each with its documentation.
    Choice(Vec<(String, String)>),
    /// Nothing, an error or a time.
    Goal,
}

/// Of a number: what the library takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub most: f64,
    /// Of the steps along the slider.
    pub scale: Scale,
}

/// Of the steps along a slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal.
    Linear,
    /// By a factor, for what ranges over magnitudes.
    Logarithmic,
    /// Whole numbers.
    Whole,
}

const fn range(path: &'static str, least: f64, most: f64, scale: Scale) -> (&'static str, Range) {
    (path, Range { least, most, scale })
}

/// By path, from the start of it: the first that fits counts.
const RANGES: [(&str, Range); 22] = [
    range("windowed.depth_scale", 0.0, 1e9, Scale::Logarithmic),
    range("windowed.normal_scale", 0.0, 1e6, Scale::Logarithmic),
    range("windowed.luminance_scale", 0.0, 1e6, Scale::Logarithmic),
    range("windowed.luminance_min", 0.0, 1e6, Scale::Logarithmic),
    range("windowed.luminance_edge", 0.0, 1.0, Scale::Linear),
    range("windowed.identity_samples", 0.0, 64.0, Scale::Linear),
    range("windowed.shadow_samples", 0.0, 64.0, Scale::Linear),
    range("windowed.least_samples", 1.0, 64.0, Scale::Linear),
    range("windowed.footprint", 0.0, 4.0, Scale::Linear),
    range("windowed.tile_limit", 0.0, 4032.0, Scale::Whole),
    range("reconstructed.depth_scale", 0.0, 1e6, Scale::Logarithmic),
    range("reconstructed.normal_scale", 0.0, 1e6, Scale::Logarithmic),
    range("reconstructed.least_weight", 1e-6, 10.0, Scale::Logarithmic),
    range("reconstructed.contrast_scale", 0.0, 1e6, Scale::Logarithmic),
    range("reconstructed.contrast_min", 0.0, 1.0, Scale::Logarithmic),
    range("reconstructed.footprint", 0.0, 4.0, Scale::Linear),
    range("selective.normal_cosine", -1.0, 1.0, Scale::Linear),
    range("selective.footprint", 0.0, 4.0, Scale::Linear),
    // The thresholds and the least contrast.
    range("selective.", 0.0, 1.0, Scale::Logarithmic),
    range("multi_resolution.footprint", 0.0, 4.0, Scale::Linear),
    range("multi_resolution.shading.coarsest", 0.0, 3.0, Scale::Whole),
    range("multi_resolution.rays.coarsest", 0.0, 3.0, Scale::Whole),
];
/// The thresholds of the lattices.
const LATTICE_THRESHOLD: Range = Range { least: 0.0, most: 1.0, scale: Scale::Logarithmic };

fn range_of(path: &str) -> Option<Range> {
    let found = RANGES.iter().find(|(start, _)| path.starts_with(start)).map(|(_, range)| *range);
    found.or_else(|| path.starts_with("multi_resolution.").then_some(LATTICE_THRESHOLD))
}

/// All of them, in the order of the source.
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
    READ.get_or_init(|| Source::read(SOURCE))
}

/// The struct at this path, such as `Lattice` at `multi_resolution.rays`.
pub fn struct_at(path: &str) -> Option<&'static str> {
    let mut name = "Settings";
    for part in path.split('.').filter(|part| !part.is_empty()) {
        name = source().structs.get(name)?.iter().find(|(field, ..)| field == part).map(|(_, ty, _)| ty.as_str())?;
    }
    source().structs.contains_key(name).then_some(name)
}

/// Settings with one of them changed. An error says what the library has against it.
pub fn with(settings: &Settings, path: &str, value: Value) -> Result<Settings, String> {
    let mut tree = serde_json::to_value(settings).map_err(|e| e.to_string())?;
    let place = tree.pointer_mut(&pointer(path)).ok_or_else(|| format!("no setting '{path}'"))?;
    *place = value;
    let settings: Settings = serde_json::from_value(tree).map_err(|e| e.to_string())?;
    settings.validate().map(|()| settings).map_err(|e| e.to_string())
}

/// Of a path, into the tree of the settings.
pub fn pointer(path: &str) -> String {
    format!("/{}", path.replace('.', "/"))
}

/// Of the group at this path, "" for those of no group: those right below it and those in its own groups.
pub fn group(path: &str) -> impl Iterator<Item = &'static Control> {
    let path = path.to_owned();
    all().iter().filter(move |c| match path.as_str() {
        "" => !c.path.contains('.'),
        path => c.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')),
    })
}

/// What the library's source says of its settings.
#[derive(Debug, Default)]
struct Source {
    /// By struct, in order: field, type, documentation.
    structs: BTreeMap<String, Vec<(String, String, String)>>,
    /// By enum, in order: name as serialised, documentation.
    enums: BTreeMap<String, Vec<(String, String)>>,
}

impl Source {
    /// Of source as rustfmt writes it: a field or variant a line, its documentation right above.
    fn read(text: &str) -> Self {
        let mut source = Self::default();
        let mut inside: Option<(bool, String)> = None;
        let mut doc = String::new();
        for line in text.lines() {
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
                _ => match range_of(&path) {
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

/// Documentation without its marks and the targets of its links.
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
    fn every_control_says_what_it_does() {
        for c in all() {
            assert!(c.doc.len() > 10, "{}: {:?}", c.path, c.doc);
            assert!(!c.doc.contains(['`', '[', ']']) && !c.doc.contains("::Self"), "{}: {}", c.path, c.doc);
            if let Kind::Choice(choices) = &c.kind {
                assert!(choices.len() > 1 && choices.iter().all(|(_, doc)| doc.len() > 3), "{c:?}");
            }
        }
        let doc = |path: &str| all().iter().find(|c| c.path == path).unwrap().doc.clone();
        assert!(doc("windowed.tile_limit").contains("up to 4032 = 64 · 63"));
        assert_eq!(doc("selective.enabled.pte"), "Selective::tau_pte.");
    }

    #[test]
    fn ranges_are_the_librarys() {
        for c in all() {
            let number =
                |v: f64, range: Range| if range.scale == Scale::Whole { json!(v as i64) } else { json!(v as f32) };
            match &c.kind {
                Kind::Slider(range) => {
                    for end in [range.least, range.most] {
                        with(&c.path, number(end, *range)).unwrap_or_else(|e| panic!("{}: {e}", c.path));
                    }
                    let span = range.most - range.least;
                    for beyond in [range.least - span * 1e-3 - 1.0, range.most + span * 1e-3 + 1.0] {
                        assert!(with(&c.path, number(beyond, *range)).is_err(), "{} takes {beyond}", c.path);
                    }
                }
                Kind::Switch => drop([true, false].map(|on| with(&c.path, json!(on)).unwrap())),
                Kind::Choice(choices) => {
                    for (name, _) in choices {
                        with(&c.path, json!(name)).unwrap_or_else(|e| panic!("{}: {e}", c.path));
                    }
                }
                Kind::Goal => drop(with(&c.path, json!({ "error": 0.01 })).unwrap()),
            }
        }
    }
}
