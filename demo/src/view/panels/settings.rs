//! The settings of a side: technique, preset, m and goal at hand, all others in folded groups, each with its range and
//! documentation, a way back to its default, and the reason where it can't be changed.

use super::super::app::App;
use super::super::controls::{self, Control};
use super::super::renderer::{Maker, Recipe, Reference};
use super::super::state::Side;
use super::names::about;
use super::row;
use deferred_aa::{Preset, Settings, Surfaces, Technique};
use egui::{CollapsingHeader, Slider, Ui};
use std::iter;

/// The settings that are never folded away.
const AT_HAND: [&str; 2] = ["technique", "goal"];

impl App {
    /// What is never folded away.
    pub(super) fn at_hand(&mut self, ui: &mut Ui) {
        self.sides_row(ui);
        if let Some(why) = &self.sides[self.edited].refused {
            ui.colored_label(ui.visuals().error_fg_color, why);
        }
        let chosen = self.sides[self.edited].recipe;
        let doc = controls::all().iter().find(|c| c.path == "technique").map_or("", |c| &c.doc);
        if let Some(recipe) = row::labelled(ui, "technique", |ui| row::kinds(ui, &chosen, doc)) {
            if recipe.maker == Maker::Reference && self.kept.reference == Reference::Off {
                self.kept.reference = Reference::default();
            }
            self.sides[self.edited].take(recipe, "technique");
        }
        let of_node = chosen.maker == Maker::Node;
        if of_node {
            self.presets(ui);
        }
        row::labelled(ui, "m", |ui| {
            let slider = row::slider(ui, Slider::new(&mut self.options.m, 1..=8), 0.0);
            slider.on_hover_text(
                "Samples along one side of a pixel, 1 to 8: a pixel has m × m. Higher: better edges and textures; \
                 memory and raster time grow with m². Both sides have the same. Changing it compiles anew.",
            );
        });
        if of_node {
            self.setting_rows(ui, |control| control.path == "goal");
        } else {
            ui.weak(about(&chosen));
        }
    }

    fn sides_row(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            for (side, name) in [(0, "Left"), (1, "Right")] {
                let title = format!("{name}: {}", self.sides[side].recipe.name());
                let label = ui.selectable_label(self.edited == side, title);
                if label.on_hover_text("The controls below are those of this side").clicked() {
                    self.edited = side;
                }
            }
        });
        ui.horizontal_wrapped(|ui| {
            let (past, future) = self.sides[self.edited].steps();
            if ui.add_enabled(past > 0, egui::Button::new("Undo")).on_hover_text("Ctrl+Z").clicked() {
                self.sides[self.edited].undo();
            }
            if ui.add_enabled(future > 0, egui::Button::new("Redo")).on_hover_text("Ctrl+Y").clicked() {
                self.sides[self.edited].redo();
            }
            if ui.button("Reset").on_hover_text("All settings of this side but the technique, as by default").clicked()
            {
                let technique = self.sides[self.edited].recipe.settings.technique;
                self.sides[self.edited].set(Settings { technique, ..Side::defaults() }, "reset");
            }
            if ui.button("Swap").on_hover_text("Swaps the sides").clicked() {
                let [a, b] = [self.sides[0].recipe, self.sides[1].recipe];
                self.sides[0].take(b, "swap");
                self.sides[1].take(a, "swap");
            }
            if ui.button("Copy").on_hover_text("The other side gets these settings too").clicked() {
                let recipe = self.sides[self.edited].recipe;
                self.sides[1 - self.edited].take(recipe, "copy");
            }
        });
    }

    /// Groups of settings: that of the technique, those of all techniques, and those of the others.
    pub(super) fn technique_settings(&mut self, ui: &mut Ui) {
        let Recipe { maker, settings } = self.sides[self.edited].recipe;
        let technique = settings.technique;
        if maker != Maker::Node {
            CollapsingHeader::new("Rays and weights").show(ui, |ui| self.group(ui, ""));
            return;
        }
        let of = |own: bool| controls::groups().filter(move |(_, of)| (*of == technique) == own);
        for (path, of) in of(true) {
            CollapsingHeader::new(format!("{of:?}")).id_salt(path).show(ui, |ui| self.group(ui, path));
        }
        CollapsingHeader::new("Rays and weights").show(ui, |ui| self.group(ui, ""));
        CollapsingHeader::new("Other techniques").show(ui, |ui| {
            for (path, of) in of(false) {
                CollapsingHeader::new(format!("{of:?}")).id_salt(path).show(ui, |ui| self.group(ui, path));
            }
        });
    }

    fn group(&mut self, ui: &mut Ui, path: &str) {
        let own: Vec<&str> = controls::group(path).map(|control| control.path.as_str()).collect();
        self.setting_rows(ui, |control| {
            own.contains(&control.path.as_str()) && !AT_HAND.contains(&control.path.as_str())
        });
    }

    fn presets(&mut self, ui: &mut Ui) {
        let settings = self.sides[self.edited].recipe.settings;
        let presets: Vec<(String, Settings)> = match settings.technique {
            Technique::Windowed => Preset::ALL
                .map(|preset| (format!("{preset:?}"), Settings { windowed: preset.windowed(), ..settings }))
                .into(),
            Technique::Surfaces => iter::once(("Once".to_owned(), Surfaces::ONCE))
                .chain(Preset::ALL.map(|preset| (format!("{preset:?}"), preset.surfaces())))
                .map(|(name, surfaces)| (name, Settings { surfaces, ..settings }))
                .collect(),
            _ => return,
        };
        row::labelled(ui, "preset", |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for (name, chosen) in presets {
                    if ui.selectable_label(settings == chosen, name).clicked() {
                        self.sides[self.edited].set(chosen, "preset");
                    }
                }
            });
        });
    }

    fn setting_rows(&mut self, ui: &mut Ui, which: impl Fn(&Control) -> bool) {
        let settings = self.sides[self.edited].recipe.settings;
        let tree = serde_json::to_value(settings).unwrap_or_default();
        let defaults = serde_json::to_value(Side::defaults()).unwrap_or_default();
        for control in controls::all().iter().filter(|control| which(control)) {
            let pointer = controls::pointer(&control.path);
            let (Some(now), Some(default)) = (tree.pointer(&pointer), defaults.pointer(&pointer)) else { continue };
            let reason = self.unavailable(control, &settings);
            if let Some(value) = row::setting(ui, control, now, default, reason.as_deref(), self.has_timestamps())
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
}
