//! The picture: two sides and their divider, where they are wrong, a magnifier, and the samples of the pixel under the
//! pointer.

use super::app::App;
use super::input::fly;
use super::renderer::{Rendered, casts};
use super::state::Side;
use crate::host::Sent;
use deferred_aa::{PlanWord, Settings, Technique};
use egui::{
    Align2, Color32, CursorIcon, FontId, Galley, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke,
    TextureId, Ui, pos2, vec2,
};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Width of what drags the divider, in points.
const HANDLE: f32 = 12.0;

/// Pixels along one side of the magnifier, and points of each.
const MAGNIFIED: f32 = 15.0;
const MAGNIFIED_POINTS: f32 = 12.0;

impl App {
    pub(super) fn picture(&mut self, ui: &mut Ui) {
        let area = ui.available_rect_before_wrap();
        let pixels = ui.ctx().pixels_per_point();
        self.place = [area.width(), area.height()].map(|side| (side * pixels).round().max(1.0) as u32);
        let response = ui.allocate_rect(area, Sense::click_and_drag());
        let painter = ui.painter_at(area);
        let Some(size) = self.size() else {
            let waits = if self.status.busy.is_empty() { "no picture".to_owned() } else { self.status.busy_text() };
            let text = self.status.failed.clone().unwrap_or(waits);
            painter.text(
                area.center(),
                Align2::CENTER_CENTER,
                text,
                FontId::proportional(18.0),
                ui.visuals().text_color(),
            );
            return;
        };
        let fit = (area.width() * pixels / size.x).min(area.height() * pixels / size.y);
        let scale = self.look.scale.unwrap_or(fit) / pixels;
        let full = vec2(size.x * scale, size.y * scale);
        if [PointerButton::Secondary, PointerButton::Middle].iter().any(|&button| response.dragged_by(button)) {
            self.look.pan += response.drag_delta();
        }
        let spare = ((full - area.size()) / 2.0).max(egui::Vec2::ZERO);
        self.look.pan = self.look.pan.clamp(-spare, spare);
        let rect = Rect::from_center_size(area.center() + self.look.pan, full);
        let divider = self.divider(ui, rect);
        self.draw(&painter, rect, divider);
        self.captions(&painter, area, rect, divider);
        self.steer(ui, &response, area);
        if let Some(pointer) = response.hover_pos().filter(|p| rect.contains(*p)) {
            self.under_pointer(ui, rect, size, pointer, divider);
        }
    }

    /// Of the picture, in its own pixels.
    fn size(&self) -> Option<egui::Vec2> {
        let shown = (0..2).filter(|&side| self.shows(side));
        shown.filter_map(|side| self.sides[side].texture.as_ref()).map(egui::TextureHandle::size_vec2).next()
    }

    /// What is left of it shows the left side. None if one side is shown alone.
    fn divider(&mut self, ui: &Ui, rect: Rect) -> Option<f32> {
        if !(self.shows(0) && self.shows(1)) {
            return None;
        }
        let x = rect.left() + rect.width() * self.kept.divider;
        let handle = Rect::from_center_size(pos2(x, rect.center().y), vec2(HANDLE, rect.height()));
        let response = ui
            .interact(handle, ui.scope_id().with("divider"), Sense::drag())
            .on_hover_cursor(CursorIcon::ResizeHorizontal);
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            self.kept.divider = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        Some(rect.left() + rect.width() * self.kept.divider)
    }

    /// The texture of a side: its picture, or where it is wrong.
    fn texture(&self, side: usize) -> Option<TextureId> {
        let s = &self.sides[side];
        let error = s.error.as_ref().filter(|_| self.look.show_error);
        error.or(s.texture.as_ref()).map(egui::TextureHandle::id)
    }

    fn draw(&self, painter: &Painter, rect: Rect, divider: Option<f32>) {
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        for side in (0..2).filter(|&side| self.shows(side)) {
            let Some(texture) = self.texture(side) else { continue };
            let clip = match (divider, side) {
                (Some(x), 0) => rect.with_max_x(x),
                (Some(x), _) => rect.with_min_x(x),
                (None, _) => rect,
            };
            painter.with_clip_rect(clip.intersect(painter.clip_rect())).image(texture, rect, all, Color32::WHITE);
        }
        if let Some(x) = divider {
            painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::BLACK));
            painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::WHITE));
        }
    }

    fn captions(&self, painter: &Painter, area: Rect, rect: Rect, divider: Option<f32>) {
        let mut first: Option<Rect> = None;
        for side in (0..2).filter(|&side| self.shows(side)) {
            let text = self.caption(side);
            let (at, align) = match (divider, side) {
                (Some(_), 1) => {
                    (pos2(rect.right().min(area.right()) - 6.0, rect.top().max(area.top()) + 6.0), Align2::RIGHT_TOP)
                }
                _ => (pos2(rect.left().max(area.left()) + 6.0, rect.top().max(area.top()) + 6.0), Align2::LEFT_TOP),
            };
            // Where both have no room beside each other, the second is below.
            let galley = painter.layout_no_wrap(text, FontId::proportional(13.0), Color32::WHITE);
            let mut own = align.anchor_size(at, galley.size()).expand(3.0);
            if let Some(first) = first.filter(|first| first.intersects(own)) {
                own = own.translate(vec2(0.0, first.height() + 3.0));
            }
            first = Some(own);
            on_dark(painter, own, galley);
        }
        if self.look.frozen {
            let text = "frozen: F lets go".to_owned();
            let galley = painter.layout_no_wrap(text, FontId::proportional(13.0), Color32::WHITE);
            let at = pos2(area.center().x, area.bottom() - 6.0);
            on_dark(painter, Align2::CENTER_BOTTOM.anchor_size(at, galley.size()).expand(3.0), galley);
        }
    }

    /// Technique, samples, time and quality.
    fn caption(&self, side: usize) -> String {
        let s = &self.sides[side];
        let Some(rendered) = &s.rendered else { return String::new() };
        let mut parts = vec![super::settings_panel::technique(&rendered.settings)];
        parts.push(format!("k {:.2}", rendered.shot.statistics.mean_k));
        parts.extend(s.node_ms().map(|ms| format!("{ms:.1} ms")));
        parts.extend(s.quality.and_then(|q| q.psnr_db).map(super::cost_panel::decibels));
        if self.look.show_error {
            parts.push("error".to_owned());
        }
        parts.join("  ")
    }

    fn steer(&mut self, ui: &Ui, response: &Response, area: Rect) {
        let (Some(camera), Some(opened), false) = (self.camera, &self.opened, self.look.frozen) else { return };
        if response.dragged_by(PointerButton::Primary) {
            let drag = response.drag_delta() / area.height().max(1.0);
            self.camera = Some(fly::turned(camera, Vec2::new(drag.x, drag.y)));
        }
        if response.hovered() {
            let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            if zoom != 1.0 {
                self.camera = Some(fly::zoomed(camera, 1.0 / zoom));
            } else if scroll != 0.0 {
                self.camera = Some(fly::moved(camera, Vec3::Z * scroll * opened.radius * 0.001));
            }
        }
        if response.clicked() || response.drag_started() {
            // So that keys fly.
            ui.memory_mut(|m| m.stop_text_input());
            if let Some(focused) = ui.memory(|m| m.focused()) {
                ui.memory_mut(|m| m.surrender_focus(focused));
            }
        }
    }

    fn under_pointer(&self, ui: &Ui, rect: Rect, size: egui::Vec2, pointer: Pos2, divider: Option<f32>) {
        let at = (pointer - rect.min) / rect.size() * size;
        let pixel = [at.x.min(size.x - 1.0) as u32, at.y.min(size.y - 1.0) as u32];
        let painter =
            ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, ui.scope_id().with("pointer")));
        let side = match divider {
            Some(x) => usize::from(pointer.x >= x),
            None => usize::from(!self.shows(0)),
        };
        if self.look.magnify {
            self.magnifier(&painter, ui.ctx().content_rect(), size, pixel, pointer);
        }
        let own = &self.sides[side];
        if let Some(rendered) = own.rendered.as_deref().filter(|r| r.picture.width as f32 == size.x) {
            let clip = ui.ctx().content_rect();
            samples(&painter, clip, own, rendered, pixel, pointer);
        }
    }

    /// The sides that are shown, pixel by pixel, around the pointer; to its right and above it where there is room.
    fn magnifier(&self, painter: &Painter, clip: Rect, size: egui::Vec2, pixel: [u32; 2], pointer: Pos2) {
        let side_points = MAGNIFIED * MAGNIFIED_POINTS;
        let shown: Vec<_> = (0..2).filter(|&side| self.shows(side)).collect();
        let step = side_points + 4.0;
        let width = step * shown.len() as f32;
        let right = pointer.x + 24.0;
        let left = if right + width <= clip.right() { right } else { pointer.x - 24.0 - width };
        let top = (pointer.y - side_points - 24.0).max(clip.top() + 4.0);
        for (i, &side) in shown.iter().enumerate() {
            let Some(texture) = self.texture(side) else { continue };
            let rect = Rect::from_min_size(pos2(left + i as f32 * step, top), vec2(side_points, side_points));
            let half = (MAGNIFIED - 1.0) / 2.0;
            let corner = pos2((pixel[0] as f32 - half) / size.x, (pixel[1] as f32 - half) / size.y);
            let uv = Rect::from_min_size(corner, vec2(MAGNIFIED / size.x, MAGNIFIED / size.y));
            painter.rect_filled(rect.expand(2.0), 2.0, Color32::BLACK);
            painter.image(texture, rect, uv, Color32::WHITE);
            let centre = Rect::from_center_size(rect.center(), vec2(MAGNIFIED_POINTS, MAGNIFIED_POINTS));
            painter.rect_stroke(centre, 0.0, Stroke::new(1.0, Color32::WHITE), egui::StrokeKind::Outside);
        }
    }
}

fn on_dark(painter: &Painter, rect: Rect, galley: Arc<Galley>) {
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(170));
    painter.galley(rect.min + vec2(3.0, 3.0), galley, Color32::WHITE);
}

/// Which samples of a window were shaded.
#[derive(Debug, Clone, PartialEq)]
pub enum Shaded {
    /// These places of the window, row by row.
    Places(Vec<bool>),
    /// So many, and it is not written down which.
    Count(u32),
}

/// The samples of a pixel whose word of the plan this is.
pub fn shaded(settings: &Settings, m: u32, word: PlanWord) -> Shaded {
    let Some(shaded) = deferred_aa::shaded_places(settings, m, word) else { return Shaded::Count(word.k().max(1)) };
    let mut places = vec![false; (m * m) as usize];
    shaded.into_iter().for_each(|(x, y)| places[(u32::from(y) * m + u32::from(x)) as usize] = true);
    Shaded::Places(places)
}

/// Of shadow rays alone, and of others too.
const SENDS: [Color32; 2] = [Color32::from_rgb(40, 90, 220), Color32::from_rgb(220, 40, 160)];

/// The rays of the pixel's samples, in words; none if its frame traces nothing.
fn rays(rendered: &Rendered, own: Option<&[Sent]>) -> Option<String> {
    if casts(&rendered.shot) == [false; 2] {
        return None;
    }
    let Some(own) = own else {
        let moves = rendered.settings.goal.is_some();
        let why =
            if moves { "rays: not known, as the goal moves them from frame to frame" } else { "rays: being counted" };
        return Some(why.to_owned());
    };
    let sum = |of: fn(&Sent) -> u8| own.iter().map(|s| u32::from(of(s))).sum::<u32>();
    let kinds = [(sum(|s| s.shadow), "shadow"), (sum(|s| s.mirrored), "mirrored"), (sum(|s| s.refracted), "refracted")];
    let some: Vec<_> = kinds.iter().filter(|k| k.0 > 0).map(|(rays, kind)| format!("{rays} {kind}")).collect();
    Some(if some.is_empty() { "no rays".to_owned() } else { format!("rays: {}", some.join(", ")) })
}

/// The pixel's window as a board, its samples that were shaded bright, a dot in those that send rays, and its values.
fn samples(painter: &Painter, clip: Rect, side: &Side, rendered: &Rendered, pixel: [u32; 2], pointer: Pos2) {
    let m = rendered.view.options.m;
    let at = (pixel[1] * rendered.picture.width + pixel[0]) as usize;
    let word = rendered.plan.get(at).copied().unwrap_or(PlanWord(1));
    let shaded = shaded(&rendered.settings, m, word);
    let [r, g, b, _] = rendered.picture.rgba.get(at).copied().unwrap_or_default();
    let n = (m * m) as usize;
    let sent = side.sent.as_ref().and_then(|all| all.get(at * n..(at + 1) * n));
    let count = match &shaded {
        Shaded::Places(places) => places.iter().filter(|&&p| p).count() as u32,
        Shaded::Count(k) => *k,
    };
    let lit = rendered.settings.technique == Technique::Surfaces;
    let of = if lit { "lights".to_owned() } else { format!("of {} samples", m * m) };
    let mut lines = vec![format!("{}, {}   {count} {of}", pixel[0], pixel[1]), format!("{r:.3} {g:.3} {b:.3}")];
    lines.extend(rays(rendered, sent));
    let others = |s: &Sent| s.mirrored + s.refracted > 0;
    let casting = |s: &Sent| s.shadow > 0 || others(s);
    if let Some(sent) = sent.filter(|sent| sent.iter().any(casting)) {
        let pink = if sent.iter().any(others) { "; pink: mirrored or refracted" } else { "" };
        lines.push(format!("a dot: the sample sends rays{pink}"));
    }
    if matches!(shaded, Shaded::Count(_)) && !lit {
        lines.push("the others are reconstructed".to_owned());
    }
    let galley = painter.layout_no_wrap(lines.join("\n"), FontId::proportional(12.0), Color32::WHITE);
    let cell = (72.0 / m as f32).floor().max(6.0);
    let board = cell * m as f32;
    let full = vec2(board + galley.size().x + 18.0, board.max(galley.size().y) + 12.0);
    let beside = pointer + vec2(24.0, 24.0);
    let min = pos2(beside.x.min(clip.right() - full.x), beside.y.min(clip.bottom() - full.y));
    let rect = Rect::from_min_size(min, full);
    painter.rect_filled(rect, 4.0, Color32::from_black_alpha(210));
    let corner = rect.min + vec2(6.0, 6.0);
    for i in 0..m * m {
        let min = corner + vec2((i % m) as f32, (i / m) as f32) * cell;
        let on = matches!(&shaded, Shaded::Places(places) if places[i as usize]);
        let color = if on { Color32::from_rgb(255, 190, 60) } else { Color32::from_gray(60) };
        painter.rect_filled(Rect::from_min_size(min, vec2(cell - 1.0, cell - 1.0)), 0.0, color);
    }
    for (sent, (x, y)) in
        sent.into_iter().flatten().zip(deferred_aa::sample_order(&rendered.settings, m)).filter(|(s, _)| casting(s))
    {
        let centre = corner + vec2(f32::from(x) + 0.5, f32::from(y) + 0.5) * cell - vec2(0.5, 0.5);
        painter.circle(
            centre,
            (cell * 0.24).max(2.0),
            SENDS[usize::from(others(sent))],
            Stroke::new(1.0, Color32::WHITE),
        );
    }
    painter.galley(corner + vec2(board + 6.0, 0.0), galley, Color32::WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::Technique;

    #[test]
    fn the_board_shows_what_was_shaded() {
        let of = |technique, m, word| match shaded(&Settings { technique, ..Default::default() }, m, PlanWord(word)) {
            Shaded::Places(places) => places.iter().map(|&p| if p { '#' } else { '.' }).collect::<String>(),
            Shaded::Count(k) => k.to_string(),
        };
        assert_eq!(of(Technique::Full, 2, 0), "####");
        assert_eq!(of(Technique::Single, 2, 0), "#...");
        assert_eq!(of(Technique::Windowed, 2, 2), "#..#");
        assert_eq!(of(Technique::MultiResolution, 2, 0), "....");
        assert_eq!(of(Technique::Reconstructed, 4, 5), "5");
        // The upper left quadrant, and the first sample, which is nearest to the centre.
        assert_eq!(of(Technique::Selective, 4, 5 | 1 << 16), "##..##....#.....");
    }
}
