//! The picture: two sides and their divider, where they are wrong, a magnifier, and the samples of the pixel under the
//! pointer.

mod board;
mod captions;
mod legend;
mod magnifier;
mod scale;
mod toolbar;

pub use scale::coarse_enough;

use super::app::App;
use super::input::fly;
use egui::{
    Align2, Color32, CursorIcon, FontId, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke, TextureId, Ui,
    pos2, vec2,
};
use glam::{Vec2, Vec3};

/// Width of what drags the divider, in points.
const HANDLE: f32 = 12.0;

impl App {
    pub(super) fn picture(&mut self, ui: &mut Ui) {
        let area = ui.available_rect_before_wrap();
        let pixels = ui.ctx().pixels_per_point();
        self.has_place([area.width(), area.height()].map(|side| (side * pixels).round().max(1.0) as u32));
        let response = ui.allocate_rect(area, Sense::click_and_drag());
        let painter = ui.painter_at(area);
        let bottom = self.toolbar(ui, area);
        let Some(size) = self.size() else {
            let refused = (0..2).filter(|&side| self.shows(side) && self.sides[side].refused.is_some());
            let mut lines: Vec<_> = refused.map(|side| self.caption(side)).collect();
            if lines.is_empty() && self.status.failed.is_none() && self.status.busy.is_empty() {
                lines.push("no picture".to_owned());
            }
            let (font, ink) = (FontId::proportional(18.0), ui.visuals().text_color());
            let galley = painter.layout(lines.join("\n"), font, ink, (area.width() - 24.0).max(60.0));
            painter.galley(Align2::CENTER_CENTER.anchor_size(area.center(), galley.size()).min, galley, ink);
            self.news(&painter, area, bottom);
            return;
        };
        let fit = scale::fitting(area.size() * pixels, size);
        let scale = self.look.scale.unwrap_or(fit) / pixels;
        let full = vec2(size.x * scale, size.y * scale);
        if [PointerButton::Secondary, PointerButton::Middle].iter().any(|&button| response.dragged_by(button)) {
            self.look.pan += response.drag_delta();
        }
        let spare = ((full - area.size()) / 2.0).max(egui::Vec2::ZERO);
        self.look.pan = self.look.pan.clamp(-spare, spare);
        let rect = scale::snapped(Rect::from_center_size(area.center() + self.look.pan, full), pixels);
        self.look.rect = rect;
        let divider = self.divider(ui, rect);
        self.draw(&painter, rect, divider);
        self.captions(&painter, area, rect, divider);
        self.news(&painter, area, bottom);
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
            // A picture of something else than what is wanted is dark.
            let tint = if self.sides[side].refused.is_some() { Color32::from_gray(80) } else { Color32::WHITE };
            painter.with_clip_rect(clip.intersect(painter.clip_rect())).image(texture, rect, all, tint);
        }
        if let Some(x) = divider {
            painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::BLACK));
            painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::WHITE));
        }
    }

    fn steer(&mut self, ui: &Ui, response: &Response, area: Rect) {
        let (Some(camera), Some(opened), false) = (self.camera, &self.opened, self.look.frozen) else { return };
        let orbits = self.look.orbit || ui.input(|i| i.modifiers.alt);
        if response.dragged_by(PointerButton::Primary) {
            let drag = response.drag_delta() / area.height().max(1.0);
            let drag = Vec2::new(drag.x, drag.y);
            self.camera = Some(if orbits { fly::orbited(camera, drag) } else { fly::turned(camera, drag) });
        }
        if response.hovered() {
            let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            if zoom != 1.0 {
                self.camera = Some(fly::zoomed(camera, 1.0 / zoom));
            } else if scroll != 0.0 {
                self.camera = Some(if orbits {
                    fly::neared(camera, (-scroll * 0.002).exp())
                } else {
                    fly::moved(camera, Vec3::Z * scroll * opened.radius() * 0.001)
                });
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
            board::samples(&painter, clip, own, rendered, pixel, pointer);
        }
    }
}
