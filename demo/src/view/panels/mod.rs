//! A frame of the window: the bar above, the controls beside the picture, and the plot below them.

mod bar;
mod colors;
mod cost;
mod hints;
mod lights;
mod names;
mod node;
mod plot;
mod quality;
mod row;
mod settings;

pub use names::decibels;
pub use row::labelled;

use super::app::App;
use egui::{CollapsingHeader, ScrollArea, Ui};

/// Width of the controls in points, where the window has room for it.
const WIDTH: f32 = 320.0;

impl App {
    /// A frame of the window.
    pub fn ui(&mut self, ui: &mut Ui) {
        self.receive(ui.ctx());
        self.watch_report(ui.ctx());
        self.keys(ui);
        egui::Panel::top("bar").show(ui, |ui| self.bar(ui));
        if self.look.panels {
            // Large text must leave room for the picture, and the width must come back with smaller text: where the
            // window limits it, the panel has another name, and so a memory of its own.
            let width = WIDTH.min(ui.available_width() * 0.5);
            let panel = egui::Panel::left(("controls", width as u32)).default_size(width);
            panel.size_range(width.min(200.0)..=ui.available_width() * 0.5).show(ui, |ui| self.controls(ui));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui));
        self.dialogs(ui);
        self.sync();
    }

    fn controls(&mut self, ui: &mut Ui) {
        let height = (ui.available_height() * 0.34).clamp(110.0, 260.0);
        egui::Panel::bottom("plot").exact_size(height).show(ui, |ui| self.frontier(ui));
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            self.at_hand(ui);
            ui.separator();
            self.technique_settings(ui);
            CollapsingHeader::new("Picture and node").show(ui, |ui| self.node(ui));
            CollapsingHeader::new("Lights").show(ui, |ui| self.lamps(ui));
            CollapsingHeader::new("Time by pass").show(ui, |ui| self.cost(ui));
            CollapsingHeader::new("Samples and memory").show(ui, |ui| self.counts(ui));
            CollapsingHeader::new("Accuracy").show(ui, |ui| self.accuracy(ui));
            CollapsingHeader::new("Messages").show(ui, |ui| self.log(ui));
        });
    }

    fn log(&self, ui: &mut Ui) {
        for message in self.status.messages.iter().rev() {
            ui.add(egui::Label::new(message).wrap());
        }
    }
}
