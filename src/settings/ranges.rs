//! The range of every numeric setting.

use super::{Goal, MOST_SHADOW_REACH, Settings, Surfaces, Windowed};

/// The values that a numeric setting may take.
#[derive(Debug, Clone, Copy)]
pub struct SettingRange {
    /// The path of the setting in [`Settings`], such as `windowed.depth_scale`.
    pub path: &'static str,
    /// The least allowed value.
    pub least: f32,
    /// The greatest allowed value.
    pub most: f32,
    /// How a slider over the range should step.
    pub scale: SettingScale,
    get: fn(&Settings) -> Option<f32>,
}

/// How a slider over a [`SettingRange`] should step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SettingScale {
    /// Equal steps.
    Linear,
    /// Steps by equal factors, for values of many magnitudes. The range may begin at 0.
    Logarithmic,
    /// Whole numbers: the setting is an integer.
    Whole,
}

/// A setting is out of its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{field} is {value}, it must lie in {least} to {most}")]
pub struct SettingsError {
    /// The path of the setting, such as `windowed.depth_scale`.
    pub field: &'static str,
    /// The value it was set to.
    pub value: f32,
    /// The least allowed value.
    pub least: f32,
    /// The greatest allowed value.
    pub most: f32,
}

impl SettingRange {
    /// The setting's value. `None` for a [`Goal`] that is not set.
    pub fn value(&self, settings: &Settings) -> Option<f32> {
        (self.get)(settings)
    }

    fn check(&self, value: f32) -> Result<(), SettingsError> {
        let &Self { path: field, least, most, .. } = self;
        // Written so that NaN fails.
        if (least..=most).contains(&value) { Ok(()) } else { Err(SettingsError { field, value, least, most }) }
    }
}

/// Writes a setting's path once, for its name and for its value.
macro_rules! range {
    ($group:ident $(. $field:ident)*, $least:expr, $most:expr, $scale:ident) => {
        SettingRange {
            path: concat!(stringify!($group) $(, ".", stringify!($field))*),
            least: $least,
            most: $most,
            scale: SettingScale::$scale,
            get: |s| Some(s.$group $(. $field)* as f32),
        }
    };
}

impl Settings {
    /// The range of every numeric setting, in the order of the fields. [`Goal::Error`] and [`Goal::Time`] have the
    /// paths `goal.error` and `goal.time`.
    pub const RANGES: &'static [SettingRange] = &[
        range!(windowed.depth_scale, 0.0, Windowed::MOST_DEPTH_SCALE, Logarithmic),
        range!(windowed.normal_scale, 0.0, Windowed::MOST_SCALE, Logarithmic),
        range!(windowed.luminance_scale, 0.0, Windowed::MOST_SCALE, Logarithmic),
        range!(windowed.luminance_min, 0.0, 1e6, Logarithmic),
        range!(windowed.luminance_edge, 0.0, 1.0, Linear),
        range!(windowed.identity_samples, 0.0, Windowed::MOST_SAMPLES, Linear),
        range!(windowed.shadow_samples, 0.0, Windowed::MOST_SAMPLES, Linear),
        range!(windowed.shadow_reach, 0.0, MOST_SHADOW_REACH as f32, Whole),
        range!(windowed.user_scale, 0.0, Windowed::MOST_SCALE, Logarithmic),
        range!(windowed.least_samples, 1.0, Windowed::MOST_SAMPLES, Linear),
        range!(windowed.footprint, 0.0, 4.0, Linear),
        range!(windowed.tile_limit, 0.0, Windowed::NO_TILE_LIMIT as f32, Whole),
        range!(reconstructed.depth_scale, 0.0, 1e6, Logarithmic),
        range!(reconstructed.normal_scale, 0.0, 1e6, Logarithmic),
        range!(reconstructed.least_weight, 1e-6, 10.0, Logarithmic),
        range!(reconstructed.contrast_scale, 0.0, 1e6, Logarithmic),
        range!(reconstructed.contrast_min, 0.0, 1.0, Logarithmic),
        range!(reconstructed.footprint, 0.0, 4.0, Linear),
        range!(selective.tau_col, 0.0, 1.0, Logarithmic),
        range!(selective.tau_poid, 0.0, 1.0, Logarithmic),
        range!(selective.tau_psn, 0.0, 1.0, Logarithmic),
        range!(selective.tau_psc, 0.0, 1.0, Logarithmic),
        range!(selective.tau_pte, 0.0, 1.0, Logarithmic),
        range!(selective.tau_soid, 0.0, 1.0, Logarithmic),
        range!(selective.tau_ssn, 0.0, 1.0, Logarithmic),
        range!(selective.tau_ssc, 0.0, 1.0, Logarithmic),
        range!(selective.tau_ste, 0.0, 1.0, Logarithmic),
        range!(selective.contrast_min, 0.0, 1.0, Logarithmic),
        range!(selective.normal_cosine, -1.0, 1.0, Linear),
        range!(selective.footprint, 0.0, 4.0, Linear),
        range!(multi_resolution.shading.coarsest, 0.0, 3.0, Whole),
        range!(multi_resolution.rays.coarsest, 0.0, 3.0, Whole),
        range!(multi_resolution.color_threshold, 0.0, 1.0, Logarithmic),
        range!(multi_resolution.position_threshold, 0.0, 1.0, Logarithmic),
        range!(multi_resolution.footprint, 0.0, 4.0, Linear),
        range!(surfaces.spread, 0.0, 1e6, Logarithmic),
        range!(surfaces.groups, 1.0, Surfaces::MOST_GROUPS as f32, Whole),
        range!(surfaces.taps, 1.0, Surfaces::MOST_TAPS as f32, Whole),
        range!(surfaces.first_taps, 1.0, Surfaces::MOST_TAPS as f32, Whole),
        range!(surfaces.tap_spread, 0.0, 1e6, Logarithmic),
        range!(surfaces.block_spread, 0.0, 1e6, Logarithmic),
        range!(surfaces.block_contrast, 0.0, 1.0, Logarithmic),
        range!(surfaces.shadow_reach, 0.0, MOST_SHADOW_REACH as f32, Whole),
        range!(surfaces.surfaces, 1.0, Surfaces::MOST_SURFACES as f32, Whole),
        range!(surfaces.normal_cosine, -1.0, 1.0, Linear),
        range!(surfaces.plane, 0.0, 1.0, Logarithmic),
        range!(surfaces.widening, 0.0, 1.0, Linear),
        range!(surfaces.footprint, 0.0, 4.0, Linear),
        range!(ray_samples, 0.0, 63.0, Linear),
        range!(ray_bias, 0.0, 1.0, Logarithmic),
        SettingRange {
            path: "goal.error",
            least: 0.0,
            most: 1.0,
            scale: SettingScale::Logarithmic,
            get: |s| if let Some(Goal::Error(error)) = s.goal { Some(error) } else { None },
        },
        SettingRange {
            path: "goal.time",
            least: f32::MIN_POSITIVE,
            most: 1e6,
            scale: SettingScale::Logarithmic,
            get: |s| if let Some(Goal::Time(milliseconds)) = s.goal { Some(milliseconds) } else { None },
        },
    ];

    /// Checks every numeric setting against [`RANGES`](Self::RANGES) and names the first that is out of its range.
    /// [`record`](crate::DeferredAa::record) calls it.
    pub fn validate(&self) -> Result<(), SettingsError> {
        Self::RANGES.iter().try_for_each(|range| range.value(self).map_or(Ok(()), |value| range.check(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};
    use std::collections::HashMap;

    /// The defaults as trees: without a goal, with an error and with a time.
    fn trees() -> [Value; 3] {
        [None, Some(Goal::Error(0.01)), Some(Goal::Time(10.0))]
            .map(|goal| serde_json::to_value(Settings { goal, ..Default::default() }).unwrap())
    }

    fn numbers(tree: &Value, path: &str, found: &mut Vec<String>) {
        for (key, value) in tree.as_object().into_iter().flatten() {
            numbers(value, &format!("{path}{}{key}", if path.is_empty() { "" } else { "." }), found);
        }
        found.extend(tree.is_number().then(|| path.to_owned()));
    }

    #[test]
    fn every_number_has_one_range_and_every_range_a_number() {
        let mut found = Vec::new();
        trees().iter().for_each(|tree| numbers(tree, "", &mut found));
        found.sort();
        found.dedup();
        let mut ranges: Vec<_> = Settings::RANGES.iter().map(|range| range.path).collect();
        ranges.sort_unstable();
        assert_eq!(ranges, found);
    }

    /// Settings with one of them changed.
    fn with(range: &SettingRange, value: f32) -> Settings {
        let pointer = format!("/{}", range.path.replace('.', "/"));
        let mut tree = trees().into_iter().find(|tree| tree.pointer(&pointer).is_some()).unwrap();
        let whole = range.scale == SettingScale::Whole;
        *tree.pointer_mut(&pointer).unwrap() = if whole { json!(value as u32) } else { json!(value) };
        serde_json::from_value(tree).unwrap()
    }

    #[test]
    fn bounds_are_taken_and_what_lies_beyond_is_not() {
        for range in Settings::RANGES {
            let &SettingRange { path, least, most, .. } = range;
            for value in [least, most] {
                assert_eq!(range.value(&with(range, value)), Some(value), "{path}");
                assert_eq!(with(range, value).validate(), Ok(()), "{path}");
            }
            let beyond = match range.scale {
                SettingScale::Whole => vec![most + 1.0],
                _ => vec![least.next_down(), most.next_up()],
            };
            for value in beyond {
                let error = SettingsError { field: path, value, least, most };
                assert_eq!(with(range, value).validate(), Err(error), "{path}");
            }
            let error = range.check(f32::NAN).unwrap_err();
            assert!(error.field == path && error.value.is_nan(), "{error}");
        }
    }

    /// The type and the documentation of each field and variant, by the type that has it.
    fn documented() -> HashMap<(String, String), (String, String)> {
        let (mut found, mut owner, mut doc) = (HashMap::new(), String::new(), String::new());
        for line in crate::SETTINGS_SOURCE.iter().flat_map(|source| source.lines()) {
            if let Some(item) = line.strip_prefix("pub struct ").or(line.strip_prefix("pub enum ")) {
                owner = item.trim_end_matches(" {").to_owned();
            }
            let line = line.trim();
            if let Some(words) = line.strip_prefix("/// ") {
                doc = format!("{doc}{words} ");
                continue;
            }
            let field = line.strip_prefix("pub ").and_then(|line| line.split_once(": "));
            let variant = || line.split_once('(').filter(|(name, _)| name.starts_with(char::is_uppercase));
            if let Some((name, ty)) = field.or_else(variant) {
                let ty = ty.trim_end_matches([',', ')']).to_owned();
                found.insert((owner.clone(), name.to_lowercase()), (ty, doc.clone()));
            }
            doc.clear();
        }
        found
    }

    /// A bound as the documentation writes it.
    fn written(value: f32) -> String {
        let (plain, scientific) = (value.to_string(), format!("{value:e}"));
        if value == f32::MIN_POSITIVE {
            "above 0".to_owned()
        } else if scientific.len() < plain.len() {
            scientific
        } else {
            plain
        }
    }

    #[test]
    fn documentation_states_the_ranges() {
        let documented = documented();
        for range in Settings::RANGES {
            let (mut ty, mut doc) = ("Settings".to_owned(), "");
            for part in range.path.split('.') {
                let (inner, words) = &documented[&(ty, part.to_owned())];
                doc = words;
                ty = inner.trim_start_matches("Option<").trim_end_matches('>').to_owned();
            }
            let bounds = format!(" {} to {}", written(range.least), written(range.most));
            let mut after = doc.split(&bounds).skip(1);
            // "0 to 4" is neither said by "0 to 4032" nor by "0 to 4.5".
            let ends = |rest: &str| {
                let rest = rest.strip_prefix('.').unwrap_or(rest);
                !rest.starts_with(|c: char| c.is_alphanumeric())
            };
            assert!(after.any(ends), "{} does not say that it lies in{bounds}: {doc}", range.path);
        }
    }
}
