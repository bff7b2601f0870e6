//! What it costs and how good it is: times by pass, samples, rays and bytes, quality against the reference, and the
//! plot of error against time that gains a point with everything that is tried.

use super::app::App;
use super::renderer::Reference;
use super::state::Tried;
use crate::measure::quality::IDENTICAL_DB;
use egui::{Color32, ComboBox, Grid, RichText, ScrollArea, Ui, Vec2b};
use egui_plot::{Bar, BarChart, Line, Plot, PlotPoint, PlotPoints, Points};
use std::collections::BTreeMap;

impl App {
    pub(super) fn cost(&mut self, ui: &mut Ui) {
        ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
            ui.heading("Cost");
            self.bars(ui);
            self.passes(ui);
            self.counts(ui);
            ui.separator();
            ui.heading("Accuracy");
            self.accuracy(ui);
            self.frontier(ui);
        });
    }

    fn bars(&self, ui: &mut Ui) {
        let names = self.pass_names();
        let times = [self.sides[0].times(), self.sides[1].times()];
        let mut charts: Vec<BarChart> = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let bars = (0..2).filter(|&side| self.shows(side)).map(|side| {
                let ms = times[side].get(name).map_or(0.0, |spread| spread.median);
                Bar::new(1.0 - side as f64, ms).width(0.7).fill(color(i)).name(format!("{name}: {ms:.2} ms"))
            });
            let chart = BarChart::new(name.clone(), bars.collect()).horizontal().color(color(i));
            let chart = chart.stack_on(&charts.iter().collect::<Vec<_>>());
            charts.push(chart);
        }
        let plot =
            Plot::new("times").height(92.0).show_axes(Vec2b::new(true, false)).show_grid(Vec2b::new(true, false));
        let plot = plot.allow_drag(false).allow_zoom(false).allow_scroll(false).allow_boxed_zoom(false).include_x(0.0);
        plot.include_y(-0.5).include_y(1.5).x_axis_label("milliseconds of GPU time").show(ui, |plot| {
            charts.into_iter().for_each(|chart| plot.bar_chart(chart));
        });
    }

    /// Of both sides, in their order.
    fn pass_names(&self) -> Vec<String> {
        let mut names: Vec<String> = vec!["gbuffer".to_owned()];
        for side in (0..2).filter(|&side| self.shows(side)) {
            for pass in self.sides[side].rendered.iter().flat_map(|r| &r.passes[0]) {
                if !names.iter().any(|name| name == pass.info.name) {
                    names.push(pass.info.name.to_owned());
                }
            }
        }
        names
    }

    fn passes(&self, ui: &mut Ui) {
        let times = [self.sides[0].times(), self.sides[1].times()];
        Grid::new("passes").num_columns(4).striped(true).show(ui, |ui| {
            ui.label("");
            ui.label("pass");
            for side in (0..2).filter(|&side| self.shows(side)) {
                ui.strong(["left, ms", "right, ms"][side]);
            }
            ui.end_row();
            for (i, name) in self.pass_names().iter().map(String::as_str).chain(["node", "total"]).enumerate() {
                let sum = name == "node" || name == "total";
                let (swatch, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
                if !sum {
                    ui.painter().rect_filled(swatch, 1.0, color(i));
                }
                ui.label(if sum { RichText::new(name).strong() } else { RichText::new(name) });
                for side in (0..2).filter(|&side| self.shows(side)) {
                    ui.label(times[side].get(name).map_or("–".to_owned(), |s| format!("{:.2}", s.median)))
                        .on_hover_text(times[side].get(name).map_or(String::new(), |s| {
                            format!(
                                "fastest {:.2}, 19 of 20 below {:.2}, {} frames",
                                s.min,
                                s.p95,
                                self.sides[side].shots.len()
                            )
                        }));
                }
                ui.end_row();
            }
        });
        let saved = self.saved();
        if !saved.is_empty() {
            ui.label(format!("Not paid for in this scene: {}.", saved.join(", ")))
                .on_hover_text("Passes that these settings would record if the scene called for every effect");
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

    fn counts(&self, ui: &mut Ui) {
        Grid::new("counts").num_columns(3).striped(true).show(ui, |ui| {
            let sides: Vec<usize> = (0..2).filter(|&side| self.shows(side)).collect();
            let mut row = |name: &str, doc: &str, value: &dyn Fn(usize) -> Option<String>| {
                ui.label(name).on_hover_text(doc);
                for &side in &sides {
                    ui.label(value(side).unwrap_or_else(|| "–".to_owned()));
                }
                ui.end_row();
            };
            let statistics = |side: usize| self.sides[side].rendered.as_ref().map(|r| &r.shot.statistics);
            row("samples", "That the host's code shaded", &|side| {
                statistics(side).map(|s| format!("{} ({:.1} %)", count(s.shaded), s.ratio * 100.0))
            });
            row("k", "Samples a pixel", &|side| statistics(side).map(|s| format!("{:.2}", s.mean_k)));
            row("rays", "Towards lights, mirrored, refracted", &|side| {
                statistics(side).map(|s| {
                    let all = [s.shadow_rays, s.reflection_rays, s.refraction_rays];
                    all.map(|n| count(u64::from(n))).join(" / ")
                })
            });
            row("bytes", "G-buffer, and all else that the node holds for this size", &|side| {
                let memory = self.sides[side].rendered.as_ref()?.stats.as_ref()?.memory_bytes.clone();
                Some(format!("{} + {}", bytes(memory.gbuffer()), bytes(memory.others())))
            });
        });
    }

    fn accuracy(&mut self, ui: &mut Ui) {
        let before = self.kept.reference;
        ComboBox::from_label("reference").selected_text(before.name()).show_ui(ui, |ui| {
            for reference in Reference::ALL {
                ui.selectable_value(&mut self.kept.reference, reference, reference.name());
            }
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

    fn frontier(&mut self, ui: &mut Ui) {
        ui.label("Error against time: every setting that you try is a point. A click goes back to it.");
        let shown: Vec<&Tried> = self.comparison.tried.iter().filter(|t| t.db < IDENTICAL_DB).collect();
        let at = |t: &Tried| [t.ms, t.db];
        let frontier = frontier(&shown);
        let mut by_technique: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
        for tried in &shown {
            by_technique.entry(super::settings_panel::technique(&tried.settings)).or_default().push(at(tried));
        }
        let present: Vec<[f64; 2]> = (0..2)
            .filter_map(|side| {
                let rendered = self.sides[side].rendered.as_ref()?;
                shown.iter().find(|t| t.settings == rendered.settings && t.m == rendered.view.options.m).map(|t| at(t))
            })
            .collect();
        let line: Vec<[f64; 2]> = frontier.iter().map(|t| at(t)).collect();
        let plot = Plot::new("frontier").height(260.0).x_axis_label("node, ms").y_axis_label("PSNR, dB").include_x(0.0);
        let response = plot.show(ui, |plot| {
            plot.line(Line::new("frontier", PlotPoints::from(line)).color(Color32::GRAY));
            for (i, (name, points)) in by_technique.into_iter().enumerate() {
                plot.points(Points::new(name, PlotPoints::from(points)).radius(4.0).color(color(i)));
            }
            plot.points(
                Points::new("shown", PlotPoints::from(present)).radius(7.0).filled(false).color(Color32::WHITE),
            );
            plot.pointer_coordinate().map(|p| (p, plot.plot_bounds()))
        });
        let Some((pointer, bounds)) = response.inner.filter(|_| response.response.hovered()) else { return };
        let near = nearest(&shown, pointer, [bounds.width(), bounds.height()]).map(|t| (*t).clone());
        let Some(near) = near else { return };
        let text = format!(
            "{} at m = {}: {:.2} dB, FLIP {:.4}, {:.2} ms, k {:.2}",
            super::settings_panel::technique(&near.settings),
            near.m,
            near.db,
            near.flip,
            near.ms,
            near.mean_k
        );
        let clicked = response.response.clicked();
        response.response.on_hover_text_at_pointer(text);
        if clicked {
            self.options.m = near.m;
            self.sides[self.edited].set(near.settings, "point");
        }
    }
}

/// Those that no other beats in both time and error, the fastest first.
pub fn frontier<'a>(tried: &[&'a Tried]) -> Vec<&'a Tried> {
    let mut all = tried.to_vec();
    all.sort_by(|a, b| a.ms.total_cmp(&b.ms).then(b.db.total_cmp(&a.db)));
    let mut best = f64::NEG_INFINITY;
    all.retain(|t| {
        let better = t.db > best;
        best = best.max(t.db);
        better
    });
    all
}

/// The point next to the pointer, if it is within a twentieth of the plot.
fn nearest<'a>(tried: &[&'a Tried], pointer: PlotPoint, [width, height]: [f64; 2]) -> Option<&'a Tried> {
    let off = |t: &Tried| ((t.ms - pointer.x) / width).hypot((t.db - pointer.y) / height);
    tried.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).filter(|t| off(t) < 0.05)
}

/// Of the i-th pass or technique: apart in hue, alike in lightness.
fn color(i: usize) -> Color32 {
    let hue = (i as f32 * 0.381_966).fract();
    egui::ecolor::Hsva::new(hue, 0.65, 0.85, 1.0).into()
}

/// With its unit.
pub fn decibels(db: f64) -> String {
    if db >= IDENTICAL_DB { "the reference".to_owned() } else { format!("{db:.2} dB") }
}

fn count(n: u64) -> String {
    match n {
        0..10_000 => n.to_string(),
        10_000..10_000_000 => format!("{:.1} k", n as f64 / 1e3),
        _ => format!("{:.1} M", n as f64 / 1e6),
    }
}

fn bytes(n: u64) -> String {
    format!("{:.1} MB", n as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::Settings;

    #[test]
    fn the_frontier_is_what_nothing_beats() {
        let tried = |ms: f64, db: f64| Tried { settings: Settings::default(), m: 4, ms, db, flip: 0.0, mean_k: 1.0 };
        let all = [
            tried(5.0, 40.0),
            tried(1.0, 30.0),
            tried(2.0, 29.0),
            tried(3.0, 41.0),
            tried(9.0, 50.0),
            tried(1.0, 20.0),
        ];
        let all: Vec<&Tried> = all.iter().collect();
        let found: Vec<_> = frontier(&all).iter().map(|t| (t.ms, t.db)).collect();
        assert_eq!(found, [(1.0, 30.0), (3.0, 41.0), (9.0, 50.0)]);
        assert!(frontier(&[]).is_empty());
        let near = nearest(&all, PlotPoint::new(3.05, 41.0), [10.0, 30.0]).map(|t| t.ms);
        assert_eq!(near, Some(3.0));
        assert_eq!(nearest(&all, PlotPoint::new(6.5, 45.0), [10.0, 30.0]), None);
    }
}
