//! Rows of the panel: names in one column, where they wrap, and controls in the other.

use super::super::controls::{self, Control, Kind};
use super::super::renderer::{Maker, Recipe};
use super::names::about;
use deferred_aa::{SettingRange, SettingScale, Settings};
use egui::{
    Align, ComboBox, DragValue, Label, Layout, RectAlign, Response, RichText, Slider, SliderClamping, Tooltip, Ui,
};
use serde_json::{Value, json};

/// Width of what puts a setting back to its default, in points.
const RESET: f32 = 18.0;

/// A row: its name, and what `add` puts beside it.
pub fn labelled<R>(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    let width = (ui.available_width() * 0.4).min(130.0);
    ui.horizontal(|ui| {
        ui.vertical(|ui| {
            ui.set_width(width);
            // As high as the control beside it.
            ui.add_space(2.0);
            ui.add(Label::new(name).wrap());
        });
        add(ui)
    })
    .inner
}

/// A slider with its value, as wide as there is room, but for `spare` points.
pub fn slider(ui: &mut Ui, slider: Slider<'_>, spare: f32) -> Response {
    let value = 66.0;
    ui.spacing_mut().slider_width = (ui.available_width() - value - spare - ui.spacing().item_spacing.x).max(24.0);
    ui.add(slider)
}

/// A list to choose from, as wide as there is room, but for `spare` points.
pub fn list<R>(
    ui: &mut Ui,
    name: &str,
    chosen: impl Into<String>,
    spare: f32,
    add: impl FnOnce(&mut Ui) -> R,
) -> Response {
    let width = (ui.available_width() - spare).max(40.0);
    ComboBox::from_id_salt(name).wrap().width(width).selected_text(chosen.into()).show_ui(ui, add).response
}

/// A setting's row. Returns the new value if it was changed.
pub fn setting(
    ui: &mut Ui,
    control: &Control,
    now: &Value,
    default: &Value,
    reason: Option<&str>,
    has_timestamps: bool,
) -> Option<Value> {
    let mut new = None;
    ui.add_enabled_ui(reason.is_none(), |ui| {
        let switch = matches!(control.kind, Kind::Switch);
        labelled(ui, if switch { "" } else { &control.label }, |ui| {
            let spare = RESET + ui.spacing().item_spacing.x;
            let response = match &control.kind {
                Kind::Slider(range) => number(ui, range, [now, default], spare, &mut new),
                Kind::Switch => {
                    let mut on = now.as_bool().unwrap_or_default();
                    let response = ui.checkbox(&mut on, &control.label);
                    if response.changed() {
                        new = Some(json!(on));
                    }
                    response
                }
                Kind::Choice(choices) => choice(ui, control, choices, now, spare, &mut new),
                Kind::Goal => goal(ui, control, now, has_timestamps, &mut new),
            };
            let range = match &control.kind {
                Kind::Slider(range) => limits(range, default),
                _ => String::new(),
            };
            beside(&response, &format!("{}\n\n{range}{}", control.doc, control.path), reason.unwrap_or_default());
            if now != default && reset(ui, default) {
                new = Some(default.clone());
            }
        });
    });
    new
}

/// Shows a hint at the side of a control, where it covers none of the next ones: `off` where it is disabled.
fn beside(response: &Response, on: &str, off: &str) {
    let (mut hint, text) =
        if response.enabled() { (Tooltip::for_enabled(response), on) } else { (Tooltip::for_disabled(response), off) };
    hint.popup = hint.popup.align(RectAlign::RIGHT_START);
    hint.width(360.0).show(|ui| ui.label(text));
}

/// What the slider spans, if more can be typed.
fn limits(range: &SettingRange, default: &Value) -> String {
    let (soft, most) = (controls::useful(range, default.as_f64().unwrap_or_default()), f64::from(range.most));
    if *soft.end() >= most {
        return String::new();
    }
    format!("The slider goes up to {}; up to {} can be typed.\n\n", soft.end(), most)
}

/// Whether the way back to the default was taken.
fn reset(ui: &mut Ui, default: &Value) -> bool {
    let button = ui.add(egui::Button::new("⟲").small().frame(false));
    button.on_hover_text(format!("Back to the default, {default}")).clicked()
}

fn choice(
    ui: &mut Ui,
    control: &Control,
    choices: &[(String, String)],
    now: &Value,
    spare: f32,
    new: &mut Option<Value>,
) -> Response {
    let chosen = now.as_str().unwrap_or_default();
    list(ui, &control.path, chosen.replace('_', " "), spare, |ui| {
        for (name, doc) in choices {
            let label = ui.selectable_label(name == chosen, name.replace('_', " "));
            if label.on_hover_text(doc).clicked() {
                *new = Some(json!(name));
            }
        }
    })
}

/// The list of techniques, and of what else may make a picture, each with what it does. Returns the recipe with the one
/// that was chosen.
pub fn kinds(ui: &mut Ui, chosen: &Recipe, doc: &str) -> Option<Recipe> {
    let mut new = None;
    let shown = list(ui, "technique", chosen.name(), RESET + 8.0, |ui| {
        ui.set_min_width(240.0);
        for kind in Recipe::kinds() {
            let name = RichText::new(kind.name()).strong();
            if ui.selectable_label(kind.name() == chosen.name(), name).clicked() {
                let technique = if kind.maker == Maker::Node { kind } else { *chosen }.settings.technique;
                new = Some(Recipe { maker: kind.maker, settings: Settings { technique, ..chosen.settings } });
            }
            ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
                ui.add_space(8.0);
                ui.add(Label::new(RichText::new(about(&kind)).size(11.0)).wrap());
            });
        }
    });
    beside(&shown, &format!("{}: {}.\n\n{doc}", chosen.name(), about(chosen)), "");
    new
}

fn number(
    ui: &mut Ui,
    range: &SettingRange,
    [now, default]: [&Value; 2],
    spare: f32,
    new: &mut Option<Value>,
) -> Response {
    let whole = range.scale == SettingScale::Whole;
    let (least, most) = (f64::from(range.least), f64::from(range.most));
    let useful = controls::useful(range, default.as_f64().unwrap_or_default());
    // A step to the smallest value above 0 is one of many.
    let smallest = (useful.end() * 1e-5).max(1e-4);
    let get_set = |value: Option<f64>| {
        if let Some(value) = value {
            let value = value.clamp(least, most);
            // As an f32 prints, so that files and tooltips read well.
            *new = Some(if whole { json!(value.round() as i64) } else { shortest(value as f32) });
            return value;
        }
        // What was just set, or the handle would follow a frame behind.
        new.as_ref()
            .unwrap_or(now)
            .as_f64()
            .map_or(0.0, |v| if whole { v } else { shortest(v as f32).as_f64().unwrap_or(v) })
    };
    let mut widget = Slider::from_get_set(useful, get_set)
        .clamping(SliderClamping::Never)
        .logarithmic(range.scale == SettingScale::Logarithmic)
        .smallest_positive(smallest)
        .max_decimals(7);
    if whole {
        widget = widget.integer();
    }
    slider(ui, widget, spare)
}

fn goal(ui: &mut Ui, control: &Control, now: &Value, has_timestamps: bool, new: &mut Option<Value>) -> Response {
    let of = |kind: &str| now.get(kind).and_then(Value::as_f64);
    let shown = match (of("error"), of("time")) {
        (Some(_), _) => "error",
        (_, Some(_)) => "time",
        _ => "none",
    };
    let width = if shown == "none" { ui.available_width() - RESET - 8.0 } else { 52.0 };
    let combo = ComboBox::from_id_salt(&control.path).width(width).selected_text(shown).show_ui(ui, |ui| {
        for (name, value) in
            [("none", Value::Null), ("error", json!({ "error": 0.01 })), ("time", json!({ "time": 10.0 }))]
        {
            let can = name != "time" || has_timestamps;
            let label = ui.add_enabled(can, egui::Button::selectable(name == shown, name));
            if label.on_disabled_hover_text("this device has no timestamps").clicked() {
                *new = Some(value);
            }
        }
    });
    // Less than these is not worth a drag.
    let bounds = |path: &str, least: f64| {
        controls::range(path).map(|range| f64::from(range.least).max(least)..=f64::from(range.most))
    };
    if let (Some(mut error), Some(bounds)) = (of("error"), bounds("goal.error", 5e-4)) {
        let drag = DragValue::new(&mut error).range(bounds).speed(5e-4).max_decimals(4);
        let hint = "Root mean square error of the displayed image, 0 to 1: 0.01 is 40 dB";
        if ui.add(drag).on_hover_text(hint).changed() {
            *new = Some(json!({ "error": error as f32 }));
        }
    }
    if let (Some(mut time), Some(bounds)) = (of("time"), bounds("goal.time", 1e-2)) {
        let drag = DragValue::new(&mut time).range(bounds).suffix(" ms");
        if ui.add(drag).on_hover_text("GPU time of the node's passes").changed() {
            *new = Some(json!({ "time": time as f32 }));
        }
    }
    combo.response
}

/// The number with the fewest digits that gives the same f32.
fn shortest(value: f32) -> Value {
    value.to_string().parse::<f64>().map_or(Value::Null, |v| json!(v))
}
