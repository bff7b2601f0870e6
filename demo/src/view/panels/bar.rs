//! The bar above everything: scenes, files and the window itself.

use super::super::app::App;
use super::super::input::dialog::{self, Dialog};
use super::super::rust_source;
use egui::Ui;

impl App {
    pub(super) fn bar(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Open…").on_hover_text("Opens a scene: Ctrl+O, or drop a file").clicked() {
                self.dialog = Some(dialog::open(self.scene_name()));
            }
            let recent = self.kept.recent.clone();
            ui.add_enabled_ui(recent.len() > 1, |ui| {
                ui.menu_button("Recent", |ui| {
                    for name in &recent {
                        if ui.button(short(name)).on_hover_text(name).clicked() {
                            self.open(name);
                            ui.close();
                        }
                    }
                });
            });
            ui.menu_button("Settings", |ui| self.settings_menu(ui));
            if ui.button("Save image…").clicked() {
                self.dialog = Some(dialog::save_image());
            }
            self.report_button(ui);
            ui.separator();
            let mut dark = ui.visuals().dark_mode;
            if ui.selectable_label(dark, "Dark").clicked() {
                dark = !dark;
                ui.ctx().set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
                self.kept.dark = Some(dark);
            }
            for (text, factor) in [("A−", 1.0 / 1.1), ("A+", 1.1)] {
                if ui.button(text).on_hover_text("Smaller or larger text: Ctrl+minus, Ctrl+plus").clicked() {
                    ui.ctx().set_zoom_factor((ui.ctx().zoom_factor() * factor).clamp(0.3, 4.0));
                }
            }
            self.kept.zoom = ui.ctx().zoom_factor().clamp(0.3, 4.0);
            if ui.button("Keys").on_hover_text("All keys: F1").clicked() {
                self.dialog = Some(Dialog::Keys);
            }
            let panels = ui.selectable_label(self.look.panels, "Panel");
            if panels.on_hover_text("Shows or hides the controls and the plot: P").clicked() {
                self.look.panels = !self.look.panels;
            }
            ui.separator();
            ui.label(self.scene_name());
        });
    }

    /// Begins a report, or says how far one has come and ends it.
    fn report_button(&mut self, ui: &mut Ui) {
        let Some(report) = &self.report else {
            let hint = "Measures every technique on this view, in a process of its own";
            if ui.button("Report…").on_hover_text(hint).clicked() {
                self.dialog = Some(dialog::report());
            }
            return;
        };
        ui.label(format!("Report {}", report.said())).on_hover_text(report.folder().display().to_string());
        let hint = "Ends it; what is finished is kept, and the same command with --resume goes on";
        if ui.button("Cancel").on_hover_text(hint).clicked() {
            let folder = report.folder().display().to_string();
            self.report = None;
            self.say(format!("the report was cancelled; what is finished is kept in {folder}: go on with --resume"));
        }
    }

    fn settings_menu(&mut self, ui: &mut Ui) {
        if ui.button("Save…   Ctrl+S").clicked() {
            self.dialog = Some(dialog::save_settings());
            ui.close();
        }
        if ui.button("Load…").clicked() {
            self.dialog = Some(dialog::load_settings());
            ui.close();
        }
        if ui.button("Copy as Rust").clicked() {
            ui.ctx().copy_text(rust_source::of(&self.sides[self.edited].recipe.settings));
            self.say("the settings are in the clipboard, as Rust");
            ui.close();
        }
    }
}

/// The end of a long path.
fn short(name: &str) -> String {
    const MOST: usize = 40;
    let skipped = name.chars().count().saturating_sub(MOST);
    let end: String = name.chars().skip(skipped).collect();
    if skipped > 0 { format!("…{end}") } else { end }
}
