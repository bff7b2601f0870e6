//! How near the pictures come to the reference.

use super::super::app::App;
use super::super::renderer::Reference;
use super::names::decibels;
use super::row;
use egui::{Grid, Ui};

impl App {
    pub(super) fn accuracy(&mut self, ui: &mut Ui) {
        let before = self.kept.reference;
        row::labelled(ui, "reference", |ui| {
            row::list(ui, "reference", before.name(), 0.0, |ui| {
                for reference in Reference::ALL {
                    ui.selectable_value(&mut self.kept.reference, reference, reference.name());
                }
            });
        });
        if self.kept.reference != before {
            self.comparison.reference = None;
            self.comparison.progress = None;
            for side in &mut self.sides {
                (side.quality, side.error) = (None, None);
            }
        }
        if let Some((done, all)) = self.comparison.progress {
            ui.add(egui::ProgressBar::new(done as f32 / all.max(1) as f32).text(format!("{done} of {all}")));
        }
        Grid::new("quality").num_columns(3).striped(true).show(ui, |ui| {
            let sides: Vec<usize> = (0..2).filter(|&side| self.shows(side)).collect();
            for (name, doc) in [
                ("PSNR", "Of the displayed image, dB. Higher is better."),
                ("SSIM", "Structural similarity, 1 is the same."),
                ("FLIP", "What a viewer notices, mean over the image: 0 is nothing."),
            ] {
                ui.label(name).on_hover_text(doc);
                for &side in &sides {
                    let quality = self.sides[side].quality;
                    let text = quality.and_then(|q| match name {
                        "PSNR" => q.psnr_db.map(decibels),
                        "SSIM" => q.ssim.map(|v| format!("{v:.4}")),
                        _ => q.flip_mean.map(|v| format!("{v:.4}")),
                    });
                    ui.label(text.unwrap_or_else(|| "–".to_owned()));
                }
                ui.end_row();
            }
        });
    }
}
