//! `--set key=value`: any field of the settings by its path.

use super::args::{parse_preset, parse_technique};
use super::error::{CommandError, wrong};
use crate::names::{did_you_mean, nearest};
use crate::settings_file;
use deferred_aa::{Preset, Settings, Surfaces, Technique};
use serde_json::Value;
use std::path::PathBuf;

/// The settings of a frame: shared by the commands that take one set of them.
#[derive(Debug, clap::Args)]
pub struct SettingsArgs {
    /// full, single, windowed, reconstructed, selective, multiresolution or surfaces; windowed, or that of --settings,
    /// if not given.
    #[arg(long, value_parser = parse_technique)]
    technique: Option<Technique>,
    /// The settings of windowed and surfaces: fast, balanced or quality, and once of surfaces; balanced if not given.
    #[arg(long, value_parser = parse_named, conflicts_with = "file")]
    preset: Option<Named>,
    /// Settings that the viewer saved.
    #[arg(long = "settings", value_name = "FILE")]
    file: Option<PathBuf>,
    /// On top of these, any field of the settings by its path, such as windowed.luminance_scale=40 or execution=loop;
    /// may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

/// Settings that have a name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Named {
    Preset(Preset),
    /// [`Surfaces::ONCE`].
    Once,
}

impl Named {
    fn settings(self) -> Settings {
        match self {
            Self::Preset(preset) => preset.settings(),
            Self::Once => Settings { surfaces: Surfaces::ONCE, ..Settings::default() },
        }
    }
}

fn parse_named(text: &str) -> Result<Named, String> {
    if text == "once" {
        return Ok(Named::Once);
    }
    parse_preset(text).map(Named::Preset).map_err(|why| format!("{why}, or once of surfaces"))
}

impl SettingsArgs {
    /// All of these, applied in order.
    pub fn settings(&self) -> Result<Settings, CommandError> {
        let base = match &self.file {
            Some(path) => settings_file::load(path)?,
            None => self.preset.map_or_else(Settings::default, Named::settings),
        };
        let technique = self.technique.unwrap_or(base.technique);
        let name = format!("{technique:?}").to_lowercase();
        if self.preset == Some(Named::Once) && technique != Technique::Surfaces {
            let problem = "'once' is a setting of surfaces: add --technique surfaces, or choose another";
            return Err(wrong("--preset", format!("{name}: {problem}")));
        }
        if self.preset.is_some() && !matches!(technique, Technique::Windowed | Technique::Surfaces) {
            let problem = "the presets are settings of windowed and surfaces: leave it out, or use one of these";
            return Err(wrong("--preset", format!("{name}: {problem}")));
        }
        apply(Settings { technique, ..base }, &self.settings)
    }
}

/// The settings with all assignments applied, checked.
pub fn apply(settings: Settings, assignments: &[String]) -> Result<Settings, CommandError> {
    let mut tree = serde_json::to_value(settings).unwrap_or_default();
    let paths = paths(&tree, "");
    for assignment in assignments {
        let wrong = |problem| CommandError::Argument { argument: format!("--set {assignment}"), problem };
        let (path, value) = assignment.split_once('=').ok_or_else(|| wrong("write key=value".to_owned()))?;
        let mut place = &mut tree;
        for key in path.trim().split('.') {
            let choices = place.as_object().map(|o| o.keys().cloned().collect::<Vec<_>>().join(", "));
            place = place.as_object_mut().and_then(|o| o.get_mut(key)).ok_or_else(|| {
                wrong(match choices {
                    Some(choices) => format!("no setting '{key}':{} choose {choices}", meant(path.trim(), &paths)),
                    None => format!("'{key}' is below a plain value"),
                })
            })?;
        }
        if place.is_object() {
            return Err(wrong("names a group of settings: name one of its fields".to_owned()));
        }
        let value = value.trim();
        let before = place.take();
        *place = match value {
            "on" | "yes" if before.is_boolean() => Value::Bool(true),
            "off" | "no" if before.is_boolean() => Value::Bool(false),
            _ => serde_json::from_str(value).unwrap_or_else(|_| number(value).unwrap_or_else(|| value.into())),
        };
        // At once, so that the message names the assignment at fault.
        let settings: Settings = serde_json::from_value(tree.clone()).map_err(|e| {
            wrong(misfit(value, &before).unwrap_or_else(|| choices(&tree, path).unwrap_or(e.to_string())))
        })?;
        settings.validate().map_err(|e| wrong(e.to_string()))?;
    }
    serde_json::from_value(tree)
        .map_err(|e| CommandError::Argument { argument: "--set".to_owned(), problem: e.to_string() })
}

/// What is wrong with a value in the place of a number or a switch.
fn misfit(value: &str, before: &Value) -> Option<String> {
    match before {
        Value::Bool(_) => Some(format!("'{value}' is neither on nor off")),
        Value::Number(number) if number.is_u64() => Some(format!("'{value}' is not a whole number of 0 or more")),
        Value::Number(_) => Some(format!("'{value}' is not a number")),
        _ => None,
    }
}

/// What a name that no setting has is answered with: the names that this one may have.
fn choices(tree: &Value, path: &str) -> Option<String> {
    let mut tree = tree.clone();
    let place = path.trim().split('.').try_fold(&mut tree, |place, key| place.get_mut(key))?;
    let value = place.as_str().map_or_else(|| place.to_string(), str::to_owned);
    *place = "?".into();
    let answer = serde_json::from_value::<Settings>(tree).err()?.to_string();
    let names: Vec<&str> = answer.strip_prefix("unknown variant `?`, ")?.split('`').skip(1).step_by(2).collect();
    Some(format!("no choice '{value}':{} choose {}", did_you_mean(&value, &names), names.join(", ")))
}

/// As people write numbers and JSON does not: .05, 5., +5.
fn number(text: &str) -> Option<Value> {
    text.parse::<f64>().ok().and_then(serde_json::Number::from_f64).map(Value::Number)
}

/// Of all settings and groups of them, groups first.
fn paths(tree: &Value, prefix: &str) -> Vec<String> {
    let Some(fields) = tree.as_object() else { return Vec::new() };
    let named = |key: &str| format!("{prefix}{key}");
    let own = fields.keys().map(|key| named(key));
    own.chain(fields.iter().flat_map(|(key, value)| paths(value, &format!("{}.", named(key))))).collect()
}

/// A path whose last part is near to that of `path`, which may be in the wrong group or in none.
fn meant(path: &str, paths: &[String]) -> String {
    let last = |path: &'_ str| path.rfind('.').map_or(0, |dot| dot + 1);
    let names: Vec<&str> = paths.iter().map(|p| &p[last(p)..]).collect();
    let Some(name) = nearest(&path[last(path)..], &names) else { return String::new() };
    let found: Vec<&str> = paths.iter().map(String::as_str).filter(|p| p[last(p)..] == *name).collect();
    // In the group that was meant, if one was.
    let meant = nearest(path, &found).map_or(found.join(" or "), str::to_owned);
    format!(" did you mean {meant}?")
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::{DepthMeasure, Effect, Execution};

    fn set(assignments: &[&str]) -> Result<Settings, String> {
        let owned: Vec<_> = assignments.iter().map(|&a| a.to_owned()).collect();
        apply(Settings::default(), &owned).map_err(|e| e.to_string())
    }

    #[test]
    fn fields_are_set_by_path() {
        let s = set(&["windowed.depth_scale=3", "windowed.depth=variance", "execution=loop", "windowed.two_sided=on"]);
        let s = s.unwrap();
        assert_eq!(s.windowed.depth_scale, 3.0);
        assert_eq!(s.windowed.depth, DepthMeasure::Variance);
        assert_eq!(s.execution, Execution::Loop);
        assert!(s.windowed.two_sided);
        assert_eq!(set(&["shadows=on"]).unwrap().shadows, Effect::On);
        for number in [".5", "0.5", "+0.5", "5e-1"] {
            assert_eq!(set(&[&format!("windowed.luminance_edge={number}")]).unwrap().windowed.luminance_edge, 0.5);
        }
        assert_eq!(set(&["shadows=off", "shadows=auto"]).unwrap().shadows, Effect::Auto);
    }

    #[test]
    fn mistakes_name_the_cure() {
        for (assignment, part) in [
            ("windowed.depth_scale=-1", "must lie in 0 to"),
            ("windowed.depth_scale=NaN", "'NaN' is not a number"),
            ("windowed.depths=1", "did you mean windowed.depth? choose centred, depth,"),
            (
                "depht_scale=1",
                "did you mean reconstructed.depth_scale or windowed.depth_scale? choose execution, goal, multi_resolution, ray_bias, ray_samples,",
            ),
            ("windwed.footprint=1", "no setting 'windwed': did you mean windowed.footprint? choose"),
            ("windwed=1", "did you mean windowed? choose"),
            ("windowed.magic=1", "no setting 'magic': choose centred,"),
            ("windowed=1", "names a group"),
            ("execution=warp", "no choice 'warp': choose loop,"),
            ("execution", "key=value"),
            ("execution.x=1", "below a plain value"),
        ] {
            let message = set(&[assignment]).unwrap_err();
            assert!(message.contains(part), "{assignment}: {message}");
            assert!(message.starts_with(&format!("--set {assignment}")), "{message}");
        }
    }
}
