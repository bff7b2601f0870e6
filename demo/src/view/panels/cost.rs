//! What it costs: times by pass, samples, rays and bytes.

use super::super::app::App;
use super::colors::pass_color;
use super::hints;
use super::names::{bytes, count};
use crate::measure::stats::Spread;
use deferred_aa::PassKind;
use egui::{Align2, FontId, Grid, Rect, RichText, Sense, Ui, pos2, vec2};
use std::collections::BTreeMap;

/// Height of the bar of a side, in points.
const BAR: f32 = 16.0;

impl App {
    pub(super) fn cost(&mut self, ui: &mut Ui) {
        let times = [self.sides[0].times(), self.sides[1].times()];
        self.bars(ui, &times);
        self.passes(ui, &times);
        ui.weak("Medians of the measured frames, in milliseconds of GPU time. Medians of passes do not add up to that of the node.");
        let saved = self.saved();
        if !saved.is_empty() {
            ui.label(format!("Skipped (nothing in this scene needs them): {}.", saved.join(", ")))
                .on_hover_text("Passes that these settings would record if the scene called for every effect");
        }
    }

    /// The times of both sides to one scale.
    fn bars(&self, ui: &mut Ui, times: &[BTreeMap<String, Spread>; 2]) {
        let names = self.pass_names();
        let of = |side: usize, name: &str| times[side].get(name).map_or(0.0, |spread| spread.median);
        let sum = |side: usize| names.iter().map(|(name, _)| of(side, name)).sum::<f64>();
        let longest = sum(0).max(sum(1));
        for side in (0..2).filter(|&side| self.shows(side)) {
            let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), BAR), Sense::hover());
            if longest <= 0.0 {
                continue;
            }
            let painter = ui.painter_at(rect);
            let text = format!("{:.2} ms", of(side, "total"));
            let ink = ui.visuals().text_color();
            let number = painter.layout_no_wrap(text, FontId::proportional(11.0), ink);
            let scale = (rect.width() - number.size().x - 6.0).max(1.0) / longest as f32;
            let mut left = rect.left();
            let mut under = None;
            for (name, kind) in &names {
                let width = of(side, name) as f32 * scale;
                let part = Rect::from_min_size(pos2(left, rect.top() + 1.0), vec2(width, BAR - 2.0));
                painter.rect_filled(part, 0.0, self.faded(side, pass_color(*kind)));
                if response.hover_pos().is_some_and(|p| part.contains(p)) {
                    under = Some(format!("{name}: {:.2} ms", of(side, name)));
                }
                left += width;
            }
            let at = Align2::LEFT_CENTER.anchor_size(pos2(left + 4.0, rect.center().y), number.size());
            painter.galley(at.min, number, ink);
            response.on_hover_text_at_pointer(under.unwrap_or_else(|| "G-buffer and node".to_owned()));
        }
    }

    /// A colour that says whether the numbers are those of what is wanted.
    fn faded(&self, side: usize, color: egui::Color32) -> egui::Color32 {
        if self.is_stale(side) { color.gamma_multiply(0.35) } else { color }
    }

    /// Of both sides, in their order. The G-buffer's kind is none of the node's.
    fn pass_names(&self) -> Vec<(String, Option<PassKind>)> {
        let mut names = vec![("gbuffer".to_owned(), None)];
        for side in (0..2).filter(|&side| self.shows(side)) {
            for pass in self.sides[side].rendered.iter().flat_map(|r| &r.shot.statistics.passes) {
                if !names.iter().any(|(name, _)| name == pass.name) {
                    names.push((pass.name.to_owned(), Some(pass.kind)));
                }
            }
        }
        names
    }

    fn passes(&self, ui: &mut Ui, times: &[BTreeMap<String, Spread>; 2]) {
        let shown: Vec<usize> = (0..2).filter(|&side| self.shows(side)).collect();
        Grid::new("passes").num_columns(4).striped(true).show(ui, |ui| {
            ui.label("");
            ui.label("pass");
            for &side in &shown {
                ui.strong(["left, ms", "right, ms"][side]);
            }
            ui.end_row();
            let sums = [("node", "All passes of the node."), ("total", "The node and the G-buffer.")];
            let passes = self.pass_names();
            let passes = passes.iter().map(|(name, kind)| (name.as_str(), Some(pass_color(*kind)), hints::pass(*kind)));
            for (name, color, hint) in passes.chain(sums.map(|(name, hint)| (name, None, hint))) {
                let (swatch, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                if let Some(color) = color {
                    ui.painter().rect_filled(swatch, 1.0, color);
                }
                let text = RichText::new(name);
                ui.label(if color.is_none() { text.strong() } else { text }).on_hover_text(hint);
                for &side in &shown {
                    self.time(ui, side, times[side].get(name));
                }
                ui.end_row();
            }
        });
    }

    fn time(&self, ui: &mut Ui, side: usize, spread: Option<&Spread>) {
        let text = RichText::new(spread.map_or("–".to_owned(), |s| format!("{:.2}", s.median)));
        let label = ui.label(if self.is_stale(side) { text.weak() } else { text });
        if let Some(s) = spread {
            let frames = self.sides[side].shots.len();
            label.on_hover_text(format!("fastest {:.2}, 19 of 20 below {:.2}, {frames} frames", s.min, s.p95));
        }
    }

    /// Passes of every effect that this scene does not call for.
    pub fn saved(&self) -> Vec<&'static str> {
        let mut saved = Vec::new();
        for rendered in (0..2).filter(|&side| self.shows(side)).filter_map(|side| self.sides[side].rendered.as_ref()) {
            let [own, all] = &rendered.passes;
            for pass in all {
                let name = pass.info.name;
                if !own.iter().any(|p| p.info.name == name) && !saved.contains(&name) {
                    saved.push(name);
                }
            }
        }
        saved
    }

    pub(super) fn counts(&mut self, ui: &mut Ui) {
        let sides: Vec<usize> = (0..2).filter(|&side| self.shows(side)).collect();
        Grid::new("counts").num_columns(3).striped(true).show(ui, |ui| {
            let mut row = |name: &str, doc: &str, value: &dyn Fn(usize) -> Option<String>| {
                ui.label(name).on_hover_text(doc);
                for &side in &sides {
                    let text = RichText::new(value(side).unwrap_or_else(|| "–".to_owned()));
                    ui.label(if self.is_stale(side) { text.weak() } else { text });
                }
                ui.end_row();
            };
            let statistics = |side: usize| self.sides[side].rendered.as_ref().map(|r| &r.shot.statistics);
            row("samples", "Samples that the host's code shaded", &|side| statistics(side).map(|s| count(s.shaded)));
            row("share", "Shaded samples of all", &|side| {
                statistics(side).map(|s| format!("{:.1} %", s.ratio * 100.0))
            });
            row("k", "Shaded samples a pixel", &|side| statistics(side).map(|s| format!("{:.2}", s.mean_k)));
            for (name, doc, of) in [
                ("shadow rays", "Rays towards lights", 0),
                ("mirrored rays", "Rays from mirrors", 1),
                ("refracted rays", "Rays through glass", 2),
            ] {
                row(name, doc, &|side| {
                    let all = statistics(side).map(|s| [s.shadow_rays, s.reflection_rays, s.refraction_rays]);
                    all.map(|all| count(u64::from(all[of])))
                });
            }
            let memory = |side: usize| Some(self.sides[side].rendered.as_ref()?.stats.as_ref()?.memory_bytes.clone());
            row("G-buffer", "Memory of the G-buffer", &|side| memory(side).map(|m| bytes(m.gbuffer())));
            row("node", "All else that the node holds for this size", &|side| memory(side).map(|m| bytes(m.others())));
        });
    }
}
