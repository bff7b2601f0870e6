//! A frame of the window: the bar, the panels and the log around the picture.

use super::app::App;
use super::input::dialog::{self, Dialog};
use super::rust_source;
use egui::Ui;
use std::time::Duration;

/// What the buttons of the zoom say.
const ZOOM: &str = "Pixels of the screen for one of the picture. One that is larger than its place is moved by the arrow keys, or \
                    dragged with the right button.";

impl App {
    /// A frame of the window.
    pub fn ui(&mut self, ui: &mut Ui) {
        self.receive(ui.ctx());
        self.watch_report(ui.ctx());
        self.keys(ui);
        egui::Panel::top("bar").show(ui, |ui| self.bar(ui));
        egui::Panel::bottom("log").show(ui, |ui| self.log(ui));
        if self.look.panels {
            // Large text must leave room for the picture: what a panel has no room for, it scrolls.
            let widest = ui.available_width() * 0.35;
            let [settings, cost] = [360f32, 380.0].map(|points| points.min(widest));
            let panel = egui::Panel::left("settings").default_size(settings).max_size(widest);
            panel.show(ui, |ui| self.settings(ui));
            egui::Panel::right("cost").default_size(cost).max_size(widest).show(ui, |ui| self.cost(ui));
        }
        egui::CentralPanel::default().show(ui, |ui| self.picture(ui));
        self.dialogs(ui);
        self.sync();
    }

    fn bar(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Open…").on_hover_text("Ctrl+O, or drop a file").clicked() {
                self.dialog = Some(dialog::open(self.scene_name()));
            }
            ui.menu_button("Settings", |ui| {
                if ui.button("Save…   Ctrl+S").clicked() {
                    self.dialog = Some(dialog::save_settings());
                    ui.close();
                }
                if ui.button("Load…").clicked() {
                    self.dialog = Some(dialog::load_settings());
                    ui.close();
                }
                if ui.button("Copy as Rust").clicked() {
                    ui.ctx().copy_text(rust_source::of(&self.sides[self.edited].settings));
                    self.say("the settings are in the clipboard, as Rust");
                    ui.close();
                }
            });
            if ui.button("Save image…").clicked() {
                self.dialog = Some(dialog::save_image());
            }
            let running = self.report.is_some();
            let report = ui.add_enabled(!running, egui::Button::new("Report…"));
            if report.on_hover_text("Measures every technique on this view, in a process of its own").clicked() {
                self.dialog = Some(dialog::report());
            }
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
            if ui.button("Keys").on_hover_text("F1").clicked() {
                self.dialog = Some(Dialog::Keys);
            }
            ui.separator();
            for (scale, name) in [(None, "fit"), (Some(1.0), "1:1"), (Some(2.0), "2:1"), (Some(4.0), "4:1")] {
                let label = ui.selectable_label(self.look.scale == scale, name);
                if label.on_hover_text(ZOOM).clicked() {
                    self.look.scale = scale;
                }
            }
            ui.separator();
            ui.label(self.scene_name());
            if !self.status.busy.is_empty() {
                // Nothing that turns: where the CPU draws, that takes as much of it as the frame that is waited for.
                ui.label(self.status.busy_text());
                ui.ctx().request_repaint_after(Duration::from_millis(500));
            }
        });
    }

    fn log(&mut self, ui: &mut Ui) {
        if let Some(why) = &self.status.failed {
            ui.colored_label(
                ui.visuals().error_fg_color,
                format!("{why}. Settings are saved; start the viewer again."),
            );
        }
        let last = self.status.messages.last().map_or("", String::as_str);
        egui::CollapsingHeader::new(last).id_salt("messages").show(ui, |ui| {
            egui::ScrollArea::vertical().max_height(160.0).stick_to_bottom(true).show(ui, |ui| {
                for message in &self.status.messages {
                    ui.label(message);
                }
            });
        });
    }
}
