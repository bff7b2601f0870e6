//! The reference, rendered a frame at a time between more urgent things.

use super::wanted::{Reference, View};
use crate::host::raster::node_camera;
use crate::host::{Host, HostError};
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
    finished: Option<Which>,
}

/// What one more frame of a reference came to.
pub enum Slice {
    /// Frames that are done, of all.
    Part(u32, u32),
    /// The last frame, of so many.
    Last(u32, Picture),
}

impl Slices {
    /// Whether frames of this reference are still to be rendered.
    pub fn owe(&self, which: &Which) -> bool {
        which.kind.side(which.view.options.m).is_some() && self.finished.as_ref() != Some(which)
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
        host.frame_with(moved, which.settings)?;
        frames.add(&host.picture());
        let (done, all) = frames.progress();
        if done < all {
            return Ok(Slice::Part(done, all));
        }
        let picture = frames.mean();
        self.finish(which.clone());
        Ok(Slice::Last(all, picture))
    }

    /// Asks for no more of this reference.
    pub fn finish(&mut self, which: Which) {
        self.under_way = None;
        self.finished = Some(which);
    }
}
