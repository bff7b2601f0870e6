//! What is around the pointer, pixel by pixel, on both sides.

use super::super::app::App;
use egui::{Color32, Painter, Pos2, Rect, Stroke, pos2, vec2};

/// Pixels along one side of the magnifier, and points of each.
const MAGNIFIED: f32 = 15.0;
const MAGNIFIED_POINTS: f32 = 12.0;

impl App {
    /// The sides that are shown, pixel by pixel, around the pointer; to its right and above it where there is room.
    pub(super) fn magnifier(&self, painter: &Painter, clip: Rect, size: egui::Vec2, pixel: [u32; 2], pointer: Pos2) {
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
