//! The plot of error against time, docked in sight: a point for everything that is tried.

use super::super::app::App;
use super::super::state::Tried;
use super::colors::technique_color;
use super::names::technique;
use crate::measure::quality::IDENTICAL_DB;
use deferred_aa::Technique;
use egui::{Color32, RichText, Sense, Ui, vec2};
use egui_plot::{Line, Plot, PlotPoint, PlotPoints, Points};

impl App {
    pub(super) fn frontier(&mut self, ui: &mut Ui) {
        let shown: Vec<&Tried> = self.comparison.tried.iter().filter(|t| t.db < IDENTICAL_DB).collect();
        let techniques: Vec<Technique> =
            Technique::ALL.into_iter().filter(|of| shown.iter().any(|t| t.settings.technique == *of)).collect();
        legend(ui, &techniques);
        let at = |t: &Tried| [t.ms, t.db];
        let present: Vec<[f64; 2]> = (0..2)
            .filter_map(|side| {
                let rendered = self.sides[side].rendered.as_ref()?;
                shown.iter().find(|t| t.settings == rendered.settings && t.m == rendered.view.options.m).map(|t| at(t))
            })
            .collect();
        let line: Vec<[f64; 2]> = frontier(&shown).iter().map(|t| at(t)).collect();
        let ring = ui.visuals().strong_text_color();
        // It always shows all of its points: neither the wheel nor a drag moves it.
        let plot = Plot::new("frontier").height(ui.available_height()).include_x(0.0).auto_bounds(true);
        let plot = plot.allow_drag(false).allow_zoom(false).allow_scroll(false).allow_boxed_zoom(false);
        let plot = plot.allow_axis_zoom_drag(false).allow_double_click_reset(false).show_crosshair(false);
        let plot = plot.set_margin_fraction(vec2(0.08, 0.12)).label_formatter(|_| None);
        let response = plot.show(ui, |plot| {
            plot.line(Line::new("frontier", PlotPoints::from(line)).color(Color32::GRAY).allow_hover(false));
            for of in techniques {
                let points: Vec<_> = shown.iter().filter(|t| t.settings.technique == of).map(|t| at(t)).collect();
                let points = Points::new(format!("{of:?}"), PlotPoints::from(points));
                plot.points(points.radius(4.0).color(technique_color(of)).allow_hover(false));
            }
            let present = Points::new("shown", PlotPoints::from(present));
            plot.points(present.radius(7.0).filled(false).color(ring).allow_hover(false));
            plot.pointer_coordinate().map(|p| (p, plot.plot_bounds()))
        });
        let Some((pointer, bounds)) = response.inner.filter(|_| response.response.hovered()) else { return };
        let near = nearest(&shown, pointer, [bounds.width(), bounds.height()]).map(|t| (*t).clone());
        let Some(near) = near else { return };
        let text = format!(
            "{} at m = {}: {:.2} dB, FLIP {:.4}, {:.2} ms, k {:.2}",
            technique(&near.settings),
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

/// The title, and the colour of each technique.
fn legend(ui: &mut Ui, techniques: &[Technique]) {
    let title = ui.label(RichText::new("PSNR, dB, against the node's time, ms").small());
    title.on_hover_text(
        "Every setting that you try is a point; the line joins those that no other beats. Point at one to read it, \
         click it to go back to its settings. A ring: what is shown.",
    );
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        for &of in techniques {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 3.0;
                let (swatch, _) = ui.allocate_exact_size(vec2(8.0, 8.0), Sense::hover());
                ui.painter().circle_filled(swatch.center(), 4.0, technique_color(of));
                ui.label(RichText::new(format!("{of:?}")).small());
            });
        }
    });
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
