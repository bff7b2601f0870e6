//! What keys and buttons do.

use crate::view::app::App;
use deferred_aa::{DebugView, Settings};

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

    /// The debug view of the first side that is shown.
    pub fn view(&self) -> DebugView {
        self.sides[usize::from(!self.shows(0))].settings.view
    }

    /// Shows a debug view, or the image, of all sides that are shown.
    pub fn show_view(&mut self, view: DebugView) {
        for side in (0..2).filter(|&side| self.shows(side)).collect::<Vec<_>>() {
            let settings = Settings { view, ..self.sides[side].settings };
            self.sides[side].set(settings, "view");
        }
    }
}
