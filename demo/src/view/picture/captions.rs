//! What is written on the picture: technique, samples, time and quality of each side, and what its colours mean.

use super::super::app::App;
use super::super::panels::decibels;
use super::super::renderer::Maker;
use super::legend::Legend;
use deferred_aa::Technique;
use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, pos2, vec2};
use std::sync::Arc;
use std::time::Duration;

impl App {
    /// `area` is the place of the picture, `rect` the picture, which may be larger.
    pub(super) fn captions(&self, painter: &Painter, area: Rect, rect: Rect, divider: Option<f32>) {
        let seen = rect.intersect(area).shrink(6.0);
        let width = (seen.width() - 6.0).max(60.0);
        let mut first: Option<Rect> = None;
        for side in (0..2).filter(|&side| self.shows(side)) {
            let (at, align) = match (divider, side) {
                (Some(_), 1) => (seen.right_top(), Align2::RIGHT_TOP),
                _ => (seen.left_top(), Align2::LEFT_TOP),
            };
            let ink = if self.is_stale(side) && self.sides[side].refused.is_none() {
                Color32::from_gray(150)
            } else {
                Color32::WHITE
            };
            let galley = painter.layout(self.caption(side), FontId::proportional(13.0), ink, width);
            let mut own = align.anchor_size(at, galley.size() + vec2(6.0, 6.0));
            // Where both have no room beside each other, the second is below.
            if let Some(first) = first.filter(|first| first.intersects(own)) {
                own = own.translate(vec2(0.0, first.bottom() - own.top() + 3.0));
            }
            on_dark(painter, own, galley);
            let mut all = own;
            if let Some(legend) = self.legend(side) {
                let corner = align.pos_in_rect(&own);
                let below = pos2(corner.x, own.bottom() + 3.0);
                all = own.union(legend.draw(painter, below, align, width));
            }
            first = Some(all);
        }
    }

    /// What the colours of a side mean, if it does not show its picture.
    fn legend(&self, side: usize) -> Option<Legend> {
        let own = &self.sides[side];
        let rendered = own.rendered.as_ref()?;
        if self.look.show_error && own.error.is_some() {
            return Some(Legend::of_error());
        }
        Legend::of_view(&rendered.recipe.recorded(), rendered.view.options.m)
    }

    /// Technique, samples, time and quality, or why there is no such picture.
    pub(super) fn caption(&self, side: usize) -> String {
        let s = &self.sides[side];
        if let Some(why) = &s.refused {
            return format!("{}: {why}", s.recipe.name());
        }
        let Some(rendered) = &s.rendered else { return String::new() };
        let mut parts = vec![rendered.recipe.name()];
        if rendered.recipe.maker == Maker::Reference {
            parts.push(self.kept.reference.name().to_owned());
        } else if rendered.recipe.is_forward() {
            parts.extend(s.node_ms().map(|ms| format!("frame {ms:.1} ms")));
            parts.extend(s.quality.and_then(|q| q.psnr_db).map(decibels));
        } else {
            parts.push(format!("k {:.2}", rendered.shot.statistics.mean_k));
            if let Some(ms) = s.node_ms() {
                let against = self.against_full(side, ms).unwrap_or_default();
                parts.push(format!("node {ms:.1} ms{against}"));
            }
            parts.extend(s.quality.and_then(|q| q.psnr_db).map(decibels));
        }
        if rendered.unsettled > 0 {
            parts.push("settling".to_owned());
        }
        if self.look.show_error {
            parts.push("error".to_owned());
        }
        parts.join("  ")
    }

    /// How a time of the node compares with that of full supersampling of the same view, where that was measured.
    fn against_full(&self, side: usize, ms: f64) -> Option<String> {
        let rendered = self.sides[side].rendered.as_ref()?;
        let recorded = rendered.recipe.recorded();
        if recorded.technique == Technique::Full {
            return None;
        }
        let factor = self.comparison.full_ms(&rendered.view)? / ms;
        Some(if factor >= 1.0 {
            format!(", {factor:.1}× cheaper than Full")
        } else {
            format!(", {:.1}× dearer than Full", 1.0 / factor)
        })
    }

    /// What the renderer is at, the last message for a while, and what keeps the viewer from working, above `bottom`.
    pub(super) fn news(&self, painter: &Painter, area: Rect, bottom: f32) {
        let mut lines = Vec::new();
        if self.look.frozen {
            lines.push("The camera is locked: L unlocks it.".to_owned());
        }
        lines.extend(self.status.recent().map(str::to_owned));
        if !self.status.busy.is_empty() {
            let frames = self.comparison.progress.filter(|(done, all)| done < all && *all > 1);
            let frames =
                frames.map_or(String::new(), |(done, all)| format!("  {done} of {all} frames of the reference"));
            lines.push(self.status.busy_text() + &frames);
        }
        if !lines.is_empty() {
            // Seconds count up, and messages go. Nothing turns: where the CPU draws, that takes as much of it as the
            // frame that is waited for.
            painter.ctx().request_repaint_after(Duration::from_millis(500));
        }
        if let Some(why) = &self.status.failed {
            lines.push(format!("{why}. Settings are saved; start the viewer again."));
        }
        if lines.is_empty() {
            return;
        }
        let text = lines.join("\n");
        let galley = painter.layout(text, FontId::proportional(12.0), Color32::WHITE, (area.width() - 24.0).max(60.0));
        let at: Pos2 = pos2(area.left() + 6.0, bottom - 4.0);
        on_dark(painter, Align2::LEFT_BOTTOM.anchor_size(at, galley.size() + vec2(6.0, 6.0)), galley);
    }
}

/// Text on a dark ground, so that it can be read on any picture.
pub fn on_dark(painter: &Painter, rect: Rect, galley: Arc<Galley>) {
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(200));
    painter.galley(rect.min + vec2(3.0, 3.0), galley, Color32::WHITE);
}
