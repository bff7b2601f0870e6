//! The plot of error against time, docked in sight: a point for everything that is tried.

use super::super::app::App;
use super::super::renderer::Recipe;
use super::super::state::Tried;
use super::colors::recipe_color;
use crate::measure::quality::IDENTICAL_DB;
use egui::{Color32, FontId, Rangef, RichText, Sense, Ui, vec2};
use egui_plot::{AxisHints, GridInput, GridMark, Line, Plot, PlotPoint, PlotPoints, Points};

impl App {
    pub(super) fn frontier(&mut self, ui: &mut Ui) {
        let comparison = &self.comparison;
        let shown: Vec<&Tried> =
            comparison.tried.iter().filter(|t| t.db < IDENTICAL_DB && comparison.is_of_scene(t)).collect();
        let (present, past): (Vec<&Tried>, Vec<&Tried>) = shown.iter().partition(|t| comparison.is_present(t));
        let kinds: Vec<Recipe> =
            Recipe::kinds().filter(|kind| present.iter().any(|t| t.recipe.name() == kind.name())).collect();
        legend(ui, &kinds, !past.is_empty());
        if shown.is_empty() {
            ui.weak("A point appears with every picture that was held against the reference.");
            return;
        }
        let at = |t: &Tried| [t.ms, t.db];
        let rings: Vec<[f64; 2]> = (0..2)
            .filter_map(|side| {
                let rendered = self.sides[side].rendered.as_ref()?;
                present.iter().find(|t| t.recipe == rendered.recipe && t.m == rendered.view.options.m).map(|t| at(t))
            })
            .collect();
        let line: Vec<[f64; 2]> = frontier(&present).iter().map(|t| at(t)).collect();
        let ring = ui.visuals().strong_text_color();
        let grey = ui.visuals().weak_text_color().gamma_multiply(0.6);
        // It always shows all of its points: neither the wheel nor a drag moves it.
        let plot = Plot::new("frontier").height(ui.available_height()).include_x(0.0).auto_bounds(true);
        let plot = plot.allow_drag(false).allow_zoom(false).allow_scroll(false).allow_boxed_zoom(false);
        let plot = plot.allow_axis_zoom_drag(false).allow_double_click_reset(false).show_crosshair(false);
        let plot = plot.set_margin_fraction(vec2(0.08, 0.12)).label_formatter(|_| None);
        let plot = plot.x_grid_spacer(marks).y_grid_spacer(marks);
        let plot = plot.custom_x_axes(vec![AxisHints::new_x().label_spacing(Rangef::new(12.0, 24.0))]);
        // However near to each other they are, some decibels are written beside them.
        let middle = shown.iter().map(|t| t.db).sum::<f64>() / shown.len() as f64;
        let plot = plot.include_y(middle - 3.0).include_y(middle + 3.0);
        let response = plot.show(ui, |plot| {
            let past: Vec<_> = past.iter().map(|t| at(t)).collect();
            plot.points(Points::new("past", PlotPoints::from(past)).radius(3.0).color(grey).allow_hover(false));
            plot.line(Line::new("frontier", PlotPoints::from(line)).color(Color32::GRAY).allow_hover(false));
            for kind in kinds {
                let name = kind.name();
                let points: Vec<_> = present.iter().filter(|t| t.recipe.name() == name).map(|t| at(t)).collect();
                let points = Points::new(name, PlotPoints::from(points));
                plot.points(points.radius(4.0).color(recipe_color(&kind)).allow_hover(false));
            }
            let rings = Points::new("shown", PlotPoints::from(rings));
            plot.points(rings.radius(7.0).filled(false).color(ring).allow_hover(false));
            plot.pointer_coordinate().map(|p| (p, plot.plot_bounds()))
        });
        let Some((pointer, bounds)) = response.inner.filter(|_| response.response.hovered()) else { return };
        let near = nearest(&shown, pointer, [bounds.width(), bounds.height()]).map(|t| (*t).clone());
        let Some(near) = near else { return };
        let Tried { m, db, flip, ms, mean_k, .. } = near;
        let elsewhere = if self.comparison.is_present(&near) { "" } else { ", in another view" };
        let name = near.recipe.name();
        let text = format!("{name} at m = {m}{elsewhere}: {db:.2} dB, FLIP {flip:.4}, {ms:.2} ms, k {mean_k:.2}");
        let clicked = response.response.clicked();
        response.response.on_hover_text_at_pointer(text);
        if clicked {
            self.options.m = near.m;
            self.sides[self.edited].take(near.recipe, "point");
        }
    }
}

/// A few numbers along an axis: multiples of 1, 2 or 5 times a power of ten.
fn marks(input: GridInput) -> Vec<GridMark> {
    let (least, most) = input.bounds;
    let rough = ((most - least) / 4.0).max(1e-9);
    let power = 10f64.powf(rough.log10().floor());
    let step_size = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
    let step_size = step_size.unwrap_or(10.0 * power);
    let all = (least / step_size).ceil() as i64..=(most / step_size).floor() as i64;
    all.take(20).map(|i| GridMark { value: i as f64 * step_size, step_size }).collect()
}

/// The title, and the colour of each kind.
fn legend(ui: &mut Ui, kinds: &[Recipe], has_past: bool) {
    let font = 11.0;
    let title = ui.label(RichText::new("PSNR, dB, against the node's time, ms").size(font));
    title.on_hover_text(
        "Every setting that you try is a point; the line joins those that no other beats. Point at one to read it, \
         click it to go back to its settings. A ring: what is shown. Grey: points of other views, or of another \
         reference; they count again in their own.",
    );
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let grey = has_past.then(|| ("other views".to_owned(), ui.visuals().weak_text_color()));
        for (name, color) in kinds.iter().map(|kind| (kind.name(), recipe_color(kind))).chain(grey) {
            // One widget each, so that a name goes to the next line with its colour.
            let galley = ui.painter().layout_no_wrap(name, FontId::proportional(font), ui.visuals().text_color());
            let (rect, _) = ui.allocate_exact_size(galley.size() + vec2(12.0, 0.0), Sense::hover());
            ui.painter().circle_filled(rect.left_center() + vec2(4.0, 0.0), 4.0, color);
            ui.painter().galley(rect.min + vec2(11.0, 0.0), galley, ui.visuals().text_color());
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

    #[test]
    fn the_frontier_is_what_nothing_beats() {
        let tried = |ms: f64, db: f64| Tried::made(ms, db);
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
