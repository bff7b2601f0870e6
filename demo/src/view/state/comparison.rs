//! What the pictures are held against, and what came of it.

use super::side::Side;
use crate::host::{Options, Shot};
use crate::measure::stats::times;
use crate::picture::Picture;
use crate::view::renderer::{Maker, Recipe, Reference, View};
use deferred_aa::Settings;
use std::sync::Arc;

/// The most points that are kept.
const MOST_TRIED: usize = 1000;

/// A point of the plot of error against time.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// What gave it.
    pub recipe: Recipe,
    /// Samples along one side of a window.
    pub m: u32,
    /// The time of the node's passes, in milliseconds.
    pub ms: f64,
    /// PSNR against the reference.
    pub db: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// Samples a pixel.
    pub mean_k: f64,
    /// What it can be compared with: points of the same view, at any m, and of the same kind of reference.
    of: (View, Reference),
}

/// The reference, and the points that were held against it.
#[derive(Default)]
pub struct Comparison {
    /// What pictures are held against, once it is there.
    pub reference: Option<(Arc<View>, Settings, Arc<Picture>)>,
    /// The reference's frames that are done, of all.
    pub progress: Option<(u32, u32)>,
    /// All points, also those of other views.
    pub tried: Vec<Tried>,
    present: Option<(View, Reference)>,
    /// Frames of full supersampling of a view.
    full: Option<(Arc<View>, Vec<Shot>)>,
}

impl Comparison {
    /// The reference, if it is of this view.
    pub fn reference_of(&self, view: &View) -> Option<Arc<Picture>> {
        self.reference.as_ref().filter(|(of, ..)| **of == *view).map(|(.., picture)| picture.clone())
    }

    /// Whether this is the present reference.
    pub fn is_held_against(&self, picture: &Arc<Picture>) -> bool {
        self.reference.as_ref().is_some_and(|(.., reference)| Arc::ptr_eq(reference, picture))
    }

    /// Adds the point of a side that is measured and judged, or its newer figures.
    pub fn try_point(&mut self, side: &Side, kind: Reference) {
        let (Some(rendered), Some(quality)) = (&side.rendered, side.quality) else { return };
        let (Some(ms), Some(db), Some(flip)) = (side.node_ms(), quality.psnr_db, quality.flip_mean) else { return };
        // What draws the scene forward has no time of a node.
        if rendered.recipe.maker == Maker::Reference || rendered.recipe.is_forward() {
            return;
        }
        let of = (of_any_m(&rendered.view), kind);
        let (recipe, m) = (rendered.recipe, rendered.view.options.m);
        let mean_k = rendered.shot.statistics.mean_k;
        let point = Tried { recipe, m, ms, db, flip, mean_k, of };
        self.add(point);
    }

    fn add(&mut self, point: Tried) {
        match self.tried.iter_mut().find(|t| t.m == point.m && t.recipe == point.recipe && t.of == point.of) {
            Some(tried) => *tried = point,
            None => self.tried.push(point),
        }
        if self.tried.len() > MOST_TRIED {
            self.tried.remove(0);
        }
    }

    /// Says which view is seen, so that its points can be told from others.
    pub fn look_at(&mut self, view: Option<&View>, kind: Reference) {
        self.present = view.map(|view| (of_any_m(view), kind));
    }

    /// Whether a point is of the view that is seen.
    pub fn is_present(&self, tried: &Tried) -> bool {
        self.present.as_ref().is_some_and(|present| *present == tried.of)
    }

    /// Whether a point is of the scene that is seen.
    pub fn is_of_scene(&self, tried: &Tried) -> bool {
        self.present.as_ref().is_some_and(|present| present.0.opening == tried.of.0.opening)
    }

    /// Adds a frame of full supersampling.
    pub fn measured_full(&mut self, view: &Arc<View>, shot: Shot) {
        match &mut self.full {
            Some((of, shots)) if **of == **view => shots.push(shot),
            full => *full = Some((view.clone(), vec![shot])),
        }
    }

    /// Median milliseconds of the node for full supersampling, if that was measured in this view.
    pub fn full_ms(&self, view: &View) -> Option<f64> {
        let (_, shots) = self.full.as_ref().filter(|(of, _)| **of == *view)?;
        // The first one may have been compiled for.
        times(&shots[usize::from(shots.len() > 2)..]).get("node").map(|spread| spread.median)
    }
}

#[cfg(test)]
impl Tried {
    /// A point of no view, for tests.
    pub fn made(ms: f64, db: f64) -> Self {
        let lens = crate::scene::Lens::Perspective { fov_y: 1.0 };
        let (eye, target, up) = (glam::Vec3::X, glam::Vec3::ZERO, glam::Vec3::Y);
        let camera = crate::scene::Camera { eye, target, up, lens, near: 0.1 };
        let lights = crate::view::renderer::Lights { stall: 1, count: 1, sun: None };
        let view = View { opening: 1, options: Options::new(8, 8, 2), lights, camera };
        let (recipe, of) = (Recipe::default(), (of_any_m(&view), Reference::Grid));
        Self { recipe, m: 2, ms, db, flip: 0.0, mean_k: 1.0, of }
    }
}

fn of_any_m(view: &View) -> View {
    View { options: Options { m: 0, ..view.options }, ..view.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_other_views_stay() {
        let view = |x: f32| {
            let mut view = Tried::made(0.0, 0.0).of.0;
            view.camera.eye.x = x;
            view
        };
        let point = |x: f32, ms: f64| Tried { of: (view(x), Reference::Grid), ..Tried::made(ms, 30.0) };
        let mut comparison = Comparison::default();
        for (x, ms) in [(1.0, 5.0), (2.0, 6.0), (1.0, 4.0)] {
            comparison.add(point(x, ms));
        }
        let seen = |comparison: &Comparison| {
            comparison.tried.iter().map(|t| (t.ms, comparison.is_present(t))).collect::<Vec<_>>()
        };
        comparison.look_at(Some(&view(2.0)), Reference::Grid);
        assert_eq!(seen(&comparison), [(4.0, false), (6.0, true)]);
        assert!(comparison.tried.iter().all(|t| comparison.is_of_scene(t)));
        // Back again, they count again.
        comparison.look_at(Some(&view(1.0)), Reference::Grid);
        assert_eq!(seen(&comparison), [(4.0, true), (6.0, false)]);
        comparison.look_at(Some(&view(1.0)), Reference::Truth64);
        assert!(!comparison.tried.iter().any(|t| comparison.is_present(t)));
    }
}
