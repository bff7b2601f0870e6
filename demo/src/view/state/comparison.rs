//! What the pictures are held against, and what came of it.

use super::side::Side;
use crate::host::Options;
use crate::picture::Picture;
use crate::view::renderer::{Reference, View};
use deferred_aa::Settings;
use std::sync::Arc;

/// A point of the plot of error against time.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// The settings that gave it.
    pub settings: Settings,
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
}

/// The reference, and the points that were held against it.
#[derive(Default)]
pub struct Comparison {
    /// What pictures are held against, once it is there.
    pub reference: Option<(Arc<View>, Settings, Arc<Picture>)>,
    /// The reference's frames that are done, of all.
    pub progress: Option<(u32, u32)>,
    /// The points of this view and reference.
    pub tried: Vec<Tried>,
    tried_of: Option<(Arc<View>, Reference)>,
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

    /// Adds the point of a side that is measured and judged, or its newer figures. Points of another view or of another
    /// kind of reference are dropped.
    pub fn try_point(&mut self, side: &Side, kind: Reference) {
        let (Some(rendered), Some(quality)) = (&side.rendered, side.quality) else { return };
        let (Some(ms), Some(db), Some(flip)) = (side.node_ms(), quality.psnr_db, quality.flip_mean) else { return };
        let of = |view: &View| View { options: Options { m: 0, ..view.options }, ..view.clone() };
        let same = self.tried_of.as_ref().is_some_and(|(view, k)| of(view) == of(&rendered.view) && *k == kind);
        if !same {
            self.tried.clear();
            self.tried_of = Some((rendered.view.clone(), kind));
        }
        let (settings, m) = (rendered.settings, rendered.view.options.m);
        let point = Tried { settings, m, ms, db, flip, mean_k: rendered.shot.statistics.mean_k };
        match self.tried.iter_mut().find(|t| t.m == m && t.settings == settings) {
            Some(tried) => *tried = point,
            None => self.tried.push(point),
        }
    }
}
