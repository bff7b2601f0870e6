//! What the renderer says.

use super::recipe::Recipe;
use super::wanted::{Source, View};
use crate::host::{Options, Sent, Shot};
use crate::measure::stats::Stats;
use crate::picture::Picture;
use crate::scene::{Bounds, Camera, Sun};
use deferred_aa::{Pass, PassKind, PlanWord, Settings};
use std::sync::Arc;

/// A picture, and what it cost.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The view that it shows.
    pub view: Arc<View>,
    /// What it was made by.
    pub recipe: Recipe,
    /// The picture in the target.
    pub picture: Arc<Picture>,
    /// Frames of a still camera until a picture with a history is what it stays; 0 for all others.
    pub unsettled: u32,
    /// What is compared: the picture, or where a debug view is shown, the picture that it is of.
    pub shot: Shot,
    /// The plan's words, row by row; empty where the technique has none.
    pub plan: Arc<Vec<PlanWord>>,
    /// Everything that is counted, as `render` writes it.
    pub stats: Option<Arc<Stats>>,
    /// The passes of the frame, and those that it would pay for if its scene called for every effect.
    pub passes: [Vec<Pass>; 2],
}

/// What the renderer says.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are a few a second")]
pub enum Event {
    /// A scene is open, and the one before it is gone.
    Opened(Box<Opened>),
    /// A scene could not be opened, and the one before it stays.
    NotOpened(u64, String),
    /// The picture of a side is there.
    Picture(usize, Box<Rendered>),
    /// One more frame of a side was measured.
    Measured(usize, Arc<View>, Recipe, Shot),
    /// The rays that each sample of a side's picture sent, as [`Host::sent`](crate::host::Host::sent) has them.
    Sent(usize, Arc<View>, Recipe, Arc<Vec<Sent>>),
    /// A side's settings were refused; its last picture stays.
    Refused(usize, Recipe, String),
    /// One frame of full supersampling, from the reference of this view.
    Full(Arc<View>, Shot),
    /// Frames of the reference that are done, of all.
    Progress(u32, u32),
    /// The reference is there.
    Reference(Arc<View>, Settings, Arc<Picture>),
    /// The renderer is at something else; the text is empty if it is at nothing.
    Busy(&'static str),
    /// The device was lost and is there again.
    Recovered(String),
    /// The node can't be built as wanted: the old one stays.
    NotBuilt(Options, String),
    /// Nothing can be rendered any more.
    Failed(String),
}

/// What the window must know of a scene.
#[derive(Debug)]
pub struct Opened {
    /// The number of this opening.
    pub opening: u64,
    /// The source, as it was given.
    pub source: Source,
    /// Its views, the default one first.
    pub cameras: Vec<Camera>,
    /// A box around all of it; none around nothing.
    pub bounds: Option<Bounds>,
    /// A box around each of its objects.
    pub objects: Vec<Bounds>,
    /// Number of lights without the sun.
    pub lights: u32,
    /// Its sun.
    pub sun: Option<Sun>,
    /// What was ignored, replaced or repaired in the file.
    pub notices: Vec<String>,
    /// The adapter that renders.
    pub adapter: Adapter,
    /// The device that renders.
    #[cfg(test)]
    pub device: wgpu::Device,
}

impl Opened {
    /// Half the diagonal of the scene's box, in metres.
    pub fn radius(&self) -> f32 {
        self.bounds.map_or(1.0, |bounds| bounds.radius())
    }
}

/// The adapter that renders, and what it lacks.
#[derive(Debug, Clone, Default)]
pub struct Adapter {
    /// Its name, as the driver says.
    pub name: String,
    /// What the binding tier lacks; `None` if it is available.
    pub no_bindings: Option<String>,
    /// What ray queries lack; `None` if they are available.
    pub no_ray_query: Option<String>,
    /// What it lacks for a visibility buffer, if anything.
    pub no_triangles: Option<String>,
    /// Whether it has timestamps, without which there are no goals in milliseconds.
    pub has_timestamps: bool,
    /// The longest side of a G-buffer.
    pub longest: u32,
}

/// Whether a frame casts rays towards lights, and whether it casts others.
pub fn casts(shot: &Shot) -> [bool; 2] {
    [PassKind::Trace, PassKind::Reflect].map(|kind| shot.statistics.passes.iter().any(|pass| pass.kind == kind))
}
