//! The settings panel: a control for every setting of every technique, with its range and documentation, a way back to
//! its default, and the reason where it can't be changed.

use super::app::App;
use super::controls::{self, Control, Kind};
use super::renderer::to_sun;
use super::state::Side;
use crate::host::Options;
use crate::scene::Sun;
use deferred_aa::rays::RayTier;
use deferred_aa::{GBufferTier, Ids, Preset, SettingRange, SettingScale, Settings, Technique, TextureTier};
use egui::{CollapsingHeader, ComboBox, DragValue, ScrollArea, Slider, SliderClamping, Ui};
use serde_json::{Value, json};
use std::f32::consts::PI;

impl App {
    pub(super) fn settings(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            for (side, name) in [(0, "Left"), (1, "Right")] {
                let title = format!("{name}: {}", technique(&self.sides[side].settings));
                if ui.selectable_label(self.edited == side, title).clicked() {
                    self.edited = side;
                }
            }
            if ui.button("swap").on_hover_text("Swaps the sides").clicked() {
                let [a, b] = [self.sides[0].settings, self.sides[1].settings];
                self.sides[0].set(b, "swap");
                self.sides[1].set(a, "swap");
            }
            if ui.button("copy").on_hover_text("The other side gets these settings too").clicked() {
                let settings = self.sides[self.edited].settings;
                self.sides[1 - self.edited].set(settings, "copy");
            }
        });
        ui.horizontal(|ui| {
            let (past, future) = self.sides[self.edited].steps();
            if ui.add_enabled(past > 0, egui::Button::new("Undo")).on_hover_text("Ctrl+Z").clicked() {
                self.sides[self.edited].undo();
            }
            if ui.add_enabled(future > 0, egui::Button::new("Redo")).on_hover_text("Ctrl+Y").clicked() {
                self.sides[self.edited].redo();
            }
            if ui.button("Reset all").clicked() {
                let technique = self.sides[self.edited].settings.technique;
                self.sides[self.edited].set(Settings { technique, ..Side::defaults() }, "reset");
            }
        });
        if let Some(why) = &self.sides[self.edited].refused {
            ui.colored_label(ui.visuals().error_fg_color, why);
        }
        ui.separator();
        ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
            self.group(ui, "", "Technique");
            self.presets(ui);
            let technique = self.sides[self.edited].settings.technique;
            for (path, of) in controls::groups() {
                let open = technique == of;
                // Another id where it is open by itself, so that it opens when its technique is chosen.
                CollapsingHeader::new(format!("{of:?}"))
                    .id_salt((path, open))
                    .default_open(open)
                    .show(ui, |ui| self.controls(ui, path));
            }
            CollapsingHeader::new("Node").default_open(true).show(ui, |ui| self.node(ui));
            CollapsingHeader::new("Lights").show(ui, |ui| self.lamps(ui));
        });
    }

    fn group(&mut self, ui: &mut Ui, path: &str, title: &str) {
        CollapsingHeader::new(title).default_open(true).show(ui, |ui| self.controls(ui, path));
    }

    fn presets(&mut self, ui: &mut Ui) {
        let settings = self.sides[self.edited].settings;
        let with = |preset: Preset| match settings.technique {
            Technique::Windowed => Some(Settings { windowed: preset.windowed(), ..settings }),
            Technique::Surfaces => Some(Settings { surfaces: preset.surfaces(), ..settings }),
            _ => None,
        };
        let presets = Preset::ALL.map(|preset| with(preset).map(|settings| (preset, settings)));
        if presets[0].is_none() {
            return;
        }
        ui.horizontal(|ui| {
            ui.label("Preset:");
            for (preset, chosen) in presets.into_iter().flatten() {
                if ui.selectable_label(settings == chosen, format!("{preset:?}")).clicked() {
                    self.sides[self.edited].set(chosen, "preset");
                }
            }
        });
    }

    fn controls(&mut self, ui: &mut Ui, path: &str) {
        let settings = self.sides[self.edited].settings;
        let tree = serde_json::to_value(settings).unwrap_or_default();
        let defaults = serde_json::to_value(Side::defaults()).unwrap_or_default();
        for control in controls::group(path) {
            let pointer = controls::pointer(&control.path);
            let (Some(now), Some(default)) = (tree.pointer(&pointer), defaults.pointer(&pointer)) else { continue };
            let reason = self.unavailable(control, &settings);
            let changed = row(ui, control, now, default, reason.as_deref(), self.has_timestamps());
            if let Some(value) = changed
                && let Err(why) = self.set(self.edited, &control.path, value)
            {
                self.sides[self.edited].refused = Some(why);
            }
        }
    }

    fn has_timestamps(&self) -> bool {
        self.opened.as_ref().is_none_or(|opened| opened.adapter.has_timestamps)
    }

    /// Why a control does nothing here.
    pub fn unavailable(&self, control: &Control, settings: &Settings) -> Option<String> {
        let technique = settings.technique;
        match control.path.as_str() {
            "execution"
                if matches!(
                    technique,
                    Technique::Full
                        | Technique::Single
                        | Technique::Reconstructed
                        | Technique::Selective
                        | Technique::Surfaces
                ) =>
            {
                Some(format!("{technique:?} has a way of its own to run: there is nothing to choose"))
            }
            "goal" if !technique.follows_goals() => {
                Some(format!("{technique:?} has nothing to scale: goals are for Windowed and Surfaces"))
            }
            "multi_resolution.shading.pattern" if self.options.m == 1 => {
                Some("Triangles want m of 2 or more: their rows are shifted by half a pixel".to_owned())
            }
            _ => None,
        }
    }

    fn node(&mut self, ui: &mut Ui) {
        let adapter = self.opened.as_ref().map(|o| o.adapter.clone()).unwrap_or_default();
        let Options { mut width, mut height, mut m, mut anisotropy, mut textures, mut rays, mut gbuffer, .. } =
            self.options;
        ui.add(Slider::new(&mut m, 1..=8).text("m")).on_hover_text(
            "Samples along one side of a pixel's window. Higher: better edges and textures; memory and raster time grow with m². \
             Compiles anew.",
        );
        ui.checkbox(&mut self.fill, "as large as its place")
            .on_hover_text("The picture has the pixels of its place in the window");
        ui.add_enabled_ui(!self.fill, |ui| {
            ui.horizontal(|ui| {
                // Not known before the first scene is there.
                let most = if adapter.longest == 0 { 16_384 } else { (adapter.longest / m).max(1) };
                ui.add(DragValue::new(&mut width).range(1..=most).suffix(" px")).on_hover_text("Width of the picture");
                ui.label("×");
                ui.add(DragValue::new(&mut height).range(1..=most).suffix(" px"))
                    .on_hover_text("Height of the picture");
            });
        });
        ui.add(Slider::new(&mut anisotropy, 1..=16).text("anisotropy"))
            .on_hover_text("Of texture reads. Higher: sharper at grazing angles, slower. The scene is uploaded anew.");
        for (label, missing, is, set) in [
            ("arrays", &None, textures == TextureTier::Arrays, TextureTier::Arrays),
            ("bindings", &adapter.no_bindings, textures == TextureTier::Bindings, TextureTier::Bindings),
        ] {
            if choice(ui, &format!("textures in {label}"), is, missing.as_deref()) {
                textures = set;
            }
        }
        for (label, missing, is, set) in [
            ("rays in software", &None, rays == RayTier::Software, RayTier::Software),
            ("rays by the adapter's ray query", &adapter.no_ray_query, rays == RayTier::Query, RayTier::Query),
        ] {
            if choice(ui, label, is, missing.as_deref()) {
                rays = set;
            }
        }
        let visible = matches!(gbuffer, GBufferTier::Visibility(_));
        for (label, missing, is, set) in [
            ("G-buffer of triangles", &adapter.no_triangles, visible, GBufferTier::Visibility(Ids::Wide)),
            ("G-buffer of attributes", &None, !visible, GBufferTier::default()),
        ] {
            if choice(ui, label, is, missing.as_deref()) {
                gbuffer = set;
            }
        }
        self.options = Options { width, height, m, textures, anisotropy, rays, gbuffer, ..self.options };
    }

    fn lamps(&mut self, ui: &mut Ui) {
        let most = self.opened.as_ref().map_or(0, |o| o.lights);
        let mut count = self.lights.count.min(most);
        ui.add_enabled_ui(most > 0, |ui| {
            let slider = ui.add(Slider::new(&mut count, 0..=most).text("lamps"));
            if slider
                .on_hover_text("The scene's first lamps that shine")
                .on_disabled_hover_text("The scene has no lamps")
                .changed()
            {
                self.lights.count = count;
            }
        });
        ui.add(Slider::new(&mut self.lights.stall, 1..=64).logarithmic(true).text("cost of light"))
            .on_hover_text("How often the light loop runs, to stand for costly shading");
        let sun = self.sun();
        let mut shines = sun.is_some_and(|s| s.irradiance.max_element() > 0.0);
        if ui.checkbox(&mut shines, "sun").changed() {
            let own = self.opened.as_ref().and_then(|o| o.sun).unwrap_or_default();
            let irradiance = if shines { own.irradiance.max(glam::Vec3::splat(1e-3)) } else { glam::Vec3::ZERO };
            self.lights.sun = Some(Sun { irradiance, ..sun.unwrap_or(own) });
        }
        let Some(sun) = sun.filter(|_| shines) else { return };
        let mut azimuth = sun.to_sun.z.atan2(sun.to_sun.x).to_degrees();
        let mut elevation = sun.to_sun.y.clamp(-1.0, 1.0).asin().to_degrees();
        let mut strength = sun.irradiance.max_element() / PI;
        let mut casts = sun.casts;
        let changed = [
            ui.add(Slider::new(&mut azimuth, -180.0..=180.0).suffix("°").text("azimuth")).changed(),
            ui.add(Slider::new(&mut elevation, -90.0..=90.0).suffix("°").text("elevation")).changed(),
            ui.add(Slider::new(&mut strength, 0.01..=100.0).logarithmic(true).text("strength"))
                .on_hover_text("Radiance of white paper that faces it")
                .changed(),
            ui.checkbox(&mut casts, "casts shadows").changed(),
        ];
        if changed.contains(&true) {
            let irradiance = sun.irradiance / sun.irradiance.max_element() * (strength * PI);
            self.lights.sun = Some(Sun { to_sun: to_sun(azimuth, elevation), irradiance, casts });
        }
        if ui.button("The scene's own sun").clicked() {
            self.lights.sun = None;
        }
    }
}

/// A choice that is disabled if something is missing for it. Returns whether it was clicked.
fn choice(ui: &mut Ui, label: &str, is: bool, missing: Option<&str>) -> bool {
    let radio = ui.add_enabled(missing.is_none(), egui::RadioButton::new(is, label));
    radio.on_disabled_hover_text(format!("this adapter lacks {}", missing.unwrap_or_default())).clicked()
}

/// A setting's row. Returns the new value if it was changed.
fn row(
    ui: &mut Ui,
    control: &Control,
    now: &Value,
    default: &Value,
    reason: Option<&str>,
    has_timestamps: bool,
) -> Option<Value> {
    let mut new = None;
    ui.add_enabled_ui(reason.is_none(), |ui| {
        ui.horizontal(|ui| {
            let differs = now != default;
            let reset = ui.add_enabled(differs, egui::Button::new("×").small());
            if reset.on_hover_text(format!("Back to {default}")).clicked() {
                new = Some(default.clone());
            }
            let response = match &control.kind {
                Kind::Slider(range) => slider(ui, control, *range, now, &mut new),
                Kind::Switch => {
                    let mut on = now.as_bool().unwrap_or_default();
                    let response = ui.checkbox(&mut on, &control.label);
                    if response.changed() {
                        new = Some(json!(on));
                    }
                    response
                }
                Kind::Choice(choices) => {
                    let chosen = now.as_str().unwrap_or_default();
                    let combo = ComboBox::from_label(&control.label).selected_text(chosen.replace('_', " "));
                    let shown = combo.show_ui(ui, |ui| {
                        for (name, doc) in choices {
                            let label = ui.selectable_label(name == chosen, name.replace('_', " "));
                            if label.on_hover_text(doc).clicked() {
                                new = Some(json!(name));
                            }
                        }
                    });
                    shown.response
                }
                Kind::Goal => goal(ui, control, now, has_timestamps, &mut new),
            };
            let doc = format!("{}\n\n{}", control.doc, control.path);
            response.on_hover_text(doc).on_disabled_hover_text(reason.unwrap_or_default());
        });
    });
    new
}

fn slider(ui: &mut Ui, control: &Control, range: SettingRange, now: &Value, new: &mut Option<Value>) -> egui::Response {
    let whole = range.scale == SettingScale::Whole;
    let get_set = |value: Option<f64>| {
        if let Some(value) = value {
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
    let mut slider = Slider::from_get_set(f64::from(range.least)..=f64::from(range.most), get_set)
        .text(&control.label)
        .clamping(SliderClamping::Edits)
        .logarithmic(range.scale == SettingScale::Logarithmic)
        .smallest_positive(1e-4)
        .max_decimals(7);
    if whole {
        slider = slider.integer();
    }
    ui.add(slider)
}

fn goal(ui: &mut Ui, control: &Control, now: &Value, has_timestamps: bool, new: &mut Option<Value>) -> egui::Response {
    let of = |kind: &str| now.get(kind).and_then(Value::as_f64);
    let shown = match (of("error"), of("time")) {
        (Some(_), _) => "error",
        (_, Some(_)) => "time",
        _ => "none",
    };
    let combo = ComboBox::from_label(&control.label).selected_text(shown).show_ui(ui, |ui| {
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

/// The technique's name on the screen.
pub fn technique(settings: &Settings) -> String {
    format!("{:?}", settings.technique)
}
