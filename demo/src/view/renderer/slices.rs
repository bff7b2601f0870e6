//! The reference, rendered a frame at a time between more urgent things.

use super::wanted::{Reference, View};
use crate::host::raster::node_camera;
use crate::host::{Host, HostError, Shot};
use crate::measure::reference::MovedFrames;
use crate::picture::Picture;
use deferred_aa::Settings;
use std::sync::Arc;

/// Which reference.
#[derive(Clone, PartialEq)]
pub struct Which {
    pub view: Arc<View>,
    pub settings: Settings,
    pub kind: Reference,
}

/// The reference that is under way, and the one that is done.
#[derive(Default)]
pub struct Slices {
    under_way: Option<(Which, MovedFrames)>,
    finished: Option<(Which, Option<Made>)>,
}

/// A reference, and the last one of its frames.
#[derive(Clone)]
pub struct Made {
    pub picture: Arc<Picture>,
    pub shot: Shot,
}

/// What one more frame of a reference came to.
pub enum Slice {
    /// Frames that are done, of all.
    Part(u32, u32, Shot),
    /// The last frame, of so many.
    Last(u32, Made),
}

impl Slices {
    /// Whether frames of this reference are still to be rendered.
    pub fn owe(&self, which: &Which) -> bool {
        which.kind.side(which.view.options.m).is_some() && self.finished.as_ref().map(|(of, _)| of) != Some(which)
    }

    /// Renders one more frame of a reference, from the first one on if another reference was under way.
    pub fn render(&mut self, host: &mut Host, which: &Which) -> Result<Slice, HostError> {
        let (width, height, m) = (which.view.options.width, which.view.options.height, which.view.options.m);
        let frames = match &mut self.under_way {
            Some((of, frames)) if of == which => frames,
            under_way => {
                let side = which.kind.side(m).unwrap_or(m);
                &mut under_way.insert((which.clone(), MovedFrames::new((width, height), side, m))).1
            }
        };
        let moved = frames.moved(node_camera(&which.view.camera, width, height));
        let shot = host.frame_with(moved, which.settings)?;
        frames.add(&host.picture());
        let (done, all) = frames.progress();
        if done < all {
            return Ok(Slice::Part(done, all, shot));
        }
        let made = Made { picture: Arc::new(frames.mean()), shot };
        self.finish(which.clone(), Some(made.clone()));
        Ok(Slice::Last(all, made))
    }

    /// Asks for no more of this reference.
    pub fn finish(&mut self, which: Which, made: Option<Made>) {
        self.under_way = None;
        self.finished = Some((which, made));
    }

    /// This reference, once it is there.
    pub fn made(&self, which: &Which) -> Option<Made> {
        self.finished.as_ref().filter(|(of, _)| of == which).and_then(|(_, made)| made.clone())
    }
}
