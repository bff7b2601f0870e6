//! Settings as Rust source, to paste into a host.

use super::controls::{self, Control, Kind};
use deferred_aa::Settings;
use serde_json::Value;

/// Writes what differs from the defaults; `..Default::default()` stands for the rest of each struct.
pub fn of(settings: &Settings) -> String {
    let tree = |s: &Settings| serde_json::to_value(s).unwrap_or_default();
    body("", &tree(settings), &tree(&Settings::default()), 0) + "\n"
}

fn body(path: &str, found: &Value, default: &Value, depth: usize) -> String {
    let name = controls::struct_at(path).unwrap_or("Settings");
    let Some(fields) = found.as_object() else { return String::new() };
    let indent = "    ".repeat(depth + 1);
    let mut lines = Vec::new();
    let mut whole = true;
    for (key, value) in fields {
        if default.get(key) == Some(value) {
            whole = false;
            continue;
        }
        let below = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let text = match controls::all().iter().find(|c| c.path == below) {
            Some(control) => literal(control, value),
            None => body(&below, value, default.get(key).unwrap_or(&Value::Null), depth + 1),
        };
        lines.push(format!("{indent}{key}: {text},\n"));
    }
    if !whole {
        lines.push(format!("{indent}..Default::default()\n"));
    }
    format!("{name} {{\n{}{}}}", lines.concat(), "    ".repeat(depth))
}

fn literal(control: &Control, value: &Value) -> String {
    match &control.kind {
        Kind::Choice(_) => format!("{}::{}", control.ty, camel_case(value.as_str().unwrap_or_default())),
        Kind::Goal => match value.as_object().and_then(|goal| goal.iter().next()) {
            Some((kind, amount)) => format!("Some(Goal::{}({}))", camel_case(kind), float(amount)),
            None => "None".to_owned(),
        },
        Kind::Slider(_) if control.ty == "f32" => float(value),
        _ => value.to_string(),
    }
}

/// The number with the fewest digits that gives the same f32.
fn float(value: &Value) -> String {
    format!("{:?}", value.as_f64().unwrap_or_default() as f32)
}

fn camel_case(name: &str) -> String {
    let words = name.split('_').filter(|w| !w.is_empty());
    words.map(|w| w[..1].to_uppercase() + &w[1..]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::{Effect, Execution, Goal, Pattern, Technique};

    #[test]
    fn only_what_differs_is_written() {
        assert_eq!(of(&Settings::default()), "Settings {\n    ..Default::default()\n}\n");
        let mut s = Settings {
            technique: Technique::MultiResolution,
            execution: Execution::MaxFiltered,
            shadows: Effect::On,
            goal: Some(Goal::Error(0.01)),
            ..Default::default()
        };
        s.windowed.luminance_scale = 83.0;
        s.windowed.tile_limit = 7;
        s.selective.enabled.pte = false;
        s.multi_resolution.rays.pattern = Pattern::Triangular;
        s.multi_resolution.rays.coarsest = 1;
        let expected = "Settings {
    execution: Execution::MaxFiltered,
    goal: Some(Goal::Error(0.01)),
    multi_resolution: MultiResolution {
        rays: Lattice {
            coarsest: 1,
            pattern: Pattern::Triangular,
        },
        ..Default::default()
    },
    selective: Selective {
        enabled: Enabled {
            pte: false,
            ..Default::default()
        },
        ..Default::default()
    },
    shadows: Effect::On,
    technique: Technique::MultiResolution,
    windowed: Windowed {
        luminance_scale: 83.0,
        tile_limit: 7,
        ..Default::default()
    },
}
";
        // The last line of all: something of Settings is as by default.
        assert_eq!(of(&s), expected.replace("    },\n}\n", "    },\n    ..Default::default()\n}\n"));
    }
}
