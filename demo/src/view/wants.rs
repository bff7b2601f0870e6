//! What the viewer wants from the renderer, and whether it is there.

use super::app::{App, FRAMES};
use super::picture::coarse_enough;
use super::renderer::{View, Wanted};
use crate::host::Options;

impl App {
    /// Whether what a side shows is not yet what is wanted.
    pub fn is_stale(&self, side: usize) -> bool {
        let seen = self.sides[side].rendered.as_ref().map(|r| &*r.view);
        !self.shown_is_wanted(side) || seen != self.wanted_view().as_ref()
    }

    /// The picture has this place in the window, in pixels.
    pub fn has_place(&mut self, place: [u32; 2]) {
        self.place = place;
        if let Some(most) = self.most_pixels.take() {
            self.fill = Some(coarse_enough(place, most));
            self.usual_fill = self.fill;
        }
    }

    fn wanted_view(&self) -> Option<View> {
        self.opened.as_ref().zip(self.camera).map(|(opened, camera)| View {
            opening: opened.opening,
            options: self.options,
            lights: self.lights,
            camera,
        })
    }

    /// Tells the renderer what is wanted, if that has changed.
    pub fn sync(&mut self) {
        let size = match self.fill {
            Some(coarse) => self.place.map(|side| side / coarse.max(1)),
            None => [self.options.width, self.options.height],
        };
        self.options = Options { width: size[0].max(1), height: size[1].max(1), ..self.options };
        let view = self.wanted_view();
        self.comparison.look_at(view.as_ref(), self.kept.reference);
        // Both are rendered where they can be flipped between.
        let wanted = |side: usize| {
            (self.kept.split || self.look.alone.is_some() || self.shows(side)).then_some(self.sides[side].recipe)
        };
        let next = Wanted {
            scene: self.source.clone(),
            view,
            cuts: self.cuts,
            sides: [wanted(0), wanted(1)],
            frames: FRAMES,
            reference: self.kept.reference,
            paused: self.hidden,
            quit: false,
        };
        self.threads.want(next);
    }
}
