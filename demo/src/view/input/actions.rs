//! What keys and buttons do.

use super::fly;
use crate::view::app::App;
use deferred_aa::{DebugView, Settings};
use egui::Pos2;
use glam::Vec2;

impl App {
    /// Shows the other side alone.
    pub fn flip(&mut self) {
        self.look.alone = match self.look.alone {
            Some(side) => Some(1 - side),
            None => Some(1 - self.edited),
        };
    }

    /// Shows both sides, or if both are shown, one.
    pub fn toggle_split(&mut self) {
        if self.look.alone.take().is_none() {
            self.kept.split = !self.kept.split;
        } else {
            self.kept.split = true;
        }
    }

    /// Frames the object at this place of the window; all of the scene, where there is none.
    pub fn frame_object(&mut self, at: Option<Pos2>) {
        let (Some(camera), Some(opened), false) = (self.camera, &self.opened, self.look.frozen) else { return };
        let rect = self.look.rect;
        let aspect = rect.width() / rect.height().max(1.0);
        let place = at.filter(|at| rect.contains(*at)).map(|at| (at - rect.center()) / rect.size() * 2.0);
        let object = place.and_then(|p| fly::picked(&camera, &opened.objects, Vec2::new(p.x, -p.y), aspect));
        if let Some(bounds) = object.or(opened.bounds.as_ref()) {
            self.cut_to(fly::framed(camera, bounds, aspect));
        }
    }

    /// The debug view of the first side that is shown.
    pub fn view(&self) -> DebugView {
        self.sides[usize::from(!self.shows(0))].recipe.settings.view
    }

    /// Shows a debug view, or the image, of all sides that are shown.
    pub fn show_view(&mut self, view: DebugView) {
        for side in (0..2).filter(|&side| self.shows(side)).collect::<Vec<_>>() {
            let settings = Settings { view, ..self.sides[side].recipe.settings };
            self.sides[side].set(settings, "view");
        }
    }
}
