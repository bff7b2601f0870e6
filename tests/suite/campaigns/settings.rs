//! Random settings within their ranges.

use super::random::Random;
use deferred_aa::{
    ColorReference, DebugView, DepthMeasure, Effect, Execution, Goal, LuminanceCurve, Pattern, SettingRange,
    SettingScale, Settings, Technique, Weight, Windowed,
};
use serde_json::{Value, json};

/// Settings of any technique: most numbers as they are by default, some anywhere in their range or at its ends.
pub fn settings(random: &mut Random) -> Settings {
    let goal = random.pick(&[None, None, None, Some(Goal::Error(0.01)), Some(Goal::Time(1.0))]);
    let mut tree = serde_json::to_value(Settings { goal, ..Default::default() }).expect("a tree");
    flip(random, &mut tree);
    for range in Settings::RANGES {
        let pointer = format!("/{}", range.path.replace('.', "/"));
        if let Some(number) = tree.pointer_mut(&pointer)
            && random.once_in(3)
        {
            *number = value(random, range);
        }
    }
    let mut settings: Settings = serde_json::from_value(tree).expect("settings");
    choose(random, &mut settings);
    settings
}

/// Flips a third of what is on or off.
fn flip(random: &mut Random, tree: &mut Value) {
    match tree {
        Value::Bool(on) => *on ^= random.once_in(3),
        Value::Object(members) => members.values_mut().for_each(|member| flip(random, member)),
        _ => {}
    }
}

fn value(random: &mut Random, range: &SettingRange) -> Value {
    let &SettingRange { least, most, scale, .. } = range;
    let value = match (random.below(4), scale) {
        (0, _) => least,
        (1, _) => most,
        (_, SettingScale::Logarithmic) => random.magnitude(least.max(most * 1e-9), most),
        _ => random.within(least, most),
    };
    if scale == SettingScale::Whole { json!(value as u32) } else { json!(value) }
}

/// Chooses what is no number.
fn choose(random: &mut Random, settings: &mut Settings) {
    const EFFECTS: [Effect; 4] = [Effect::Auto, Effect::Auto, Effect::On, Effect::Off];
    const CURVES: [LuminanceCurve; 2] = [LuminanceCurve::Linear, LuminanceCurve::Perceptual];
    const PATTERNS: [Pattern; 3] = [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral];
    const REFERENCES: [ColorReference; 3] =
        [ColorReference::Color, ColorReference::Luminance, ColorReference::Gradient];
    settings.technique = random.pick(&Technique::ALL);
    settings.execution = random.pick(&Execution::ALL);
    settings.weight = random.pick(&[Weight::Linear, Weight::Luminance]);
    settings.shadows = random.pick(&EFFECTS);
    settings.reflections = random.pick(&EFFECTS);
    settings.refraction = random.pick(&EFFECTS);
    settings.view = if random.once_in(3) { random.pick(&DebugView::ALL) } else { DebugView::Image };
    settings.windowed.depth = random.pick(&[DepthMeasure::Variance, DepthMeasure::Discontinuity]);
    settings.windowed.luminance = random.pick(&CURVES);
    settings.selective.curve = random.pick(&CURVES);
    settings.selective.reference = random.pick(&REFERENCES);
    settings.multi_resolution.curve = random.pick(&CURVES);
    settings.multi_resolution.shading.pattern = random.pick(&PATTERNS);
    settings.multi_resolution.rays.pattern = random.pick(&PATTERNS);
}

/// Metrics of scales for which f32 keeps within the rounding band of the twin, with no tile cut off.
pub fn metrics(random: &mut Random) -> Windowed {
    let mut scale = |off: u32, least: f32, most: f32| {
        if random.once_in(off) { 0.0 } else { random.magnitude(least, most) }
    };
    let scales =
        [scale(3, 1.0, 2e3), scale(3, 0.1, 2e3), scale(3, 0.1, 40.0), scale(3, 0.1, 64.0), scale(3, 0.1, 300.0)];
    let [depth_scale, normal_scale, luminance_scale, identity_samples, user_scale] = scales;
    Windowed {
        depth: random.pick(&[DepthMeasure::Variance, DepthMeasure::Discontinuity]),
        depth_scale,
        normal_scale,
        two_sided: random.once_in(2),
        luminance_scale,
        luminance_min: random.pick(&[0.0, 0.05]),
        luminance_edge: random.pick(&[0.0, 0.1]),
        luminance: random.pick(&[LuminanceCurve::Linear, LuminanceCurve::Perceptual]),
        luminance_channels: random.once_in(2),
        luminance_centre: random.once_in(2),
        identity_samples,
        shadow_samples: 0.0,
        user_scale,
        least_samples: if random.once_in(4) { random.within(1.0, 5.0) } else { 1.0 },
        edge_aware_first: random.once_in(2),
        tile_limit: Windowed::NO_TILE_LIMIT,
        ..Windowed::default()
    }
}
