//! What the renderer says.

use super::wanted::{Source, View};
use crate::host::{Options, Sent, Shot};
use crate::measure::stats::Stats;
use crate::pass_kind;
use crate::picture::Picture;
use crate::scene::{Camera, Sun};
use deferred_aa::{Pass, Settings};
use std::sync::Arc;

/// A picture, and what it cost.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// Of what.
    pub view: Arc<View>,
    /// By what.
    pub settings: Settings,
    /// The target.
    pub picture: Arc<Picture>,
    /// What is compared: the picture, or where a debug view is shown, the picture that it is of.
    pub shot: Shot,
    /// The plan's words, row by row; empty where the technique has none.
    pub plan: Arc<Vec<u32>>,
    /// Everything that is counted, as `render` writes it.
    pub stats: Option<Arc<Stats>>,
    /// The passes of the frame, and those that it would pay for if its scene called for every effect.
    pub passes: [Vec<Pass>; 2],
}

/// What the thread says.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are a few a second")]
pub enum Event {
    /// A scene is there. The old one is gone.
    Opened(Box<Opened>),
    /// It could not be opened: the old one stays.
    NotOpened(u64, String),
    /// A side's picture.
    Picture(usize, Box<Rendered>),
    /// A further frame of the same, measured.
    Measured(usize, Arc<View>, Settings, Shot),
    /// The rays that each sample of a side's picture sent, as [`Host::sent`](crate::host::Host::sent) has them.
    Sent(usize, Arc<View>, Settings, Arc<Vec<Sent>>),
    /// A side's settings were refused; its last picture stays.
    Refused(usize, Settings, String),
    /// Parts of the reference that are done, of all.
    Progress(u32, u32),
    /// The reference.
    Reference(Arc<View>, Settings, Arc<Picture>),
    /// What is under way, "" if nothing.
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
    /// Which one this is.
    pub opening: u64,
    /// As given.
    pub source: Source,
    /// Its views, the default one first.
    pub cameras: Vec<Camera>,
    /// Half the diagonal of its box, metres.
    pub radius: f32,
    /// Lights but the sun.
    pub lights: u32,
    /// Its sun.
    pub sun: Option<Sun>,
    /// What was ignored, replaced or repaired.
    pub notices: Vec<String>,
    /// Who renders.
    pub adapter: Adapter,
    /// On what.
    #[cfg(test)]
    pub device: wgpu::Device,
}

/// Who renders, and what it can't.
#[derive(Debug, Clone, Default)]
pub struct Adapter {
    /// As the driver says.
    pub name: String,
    /// What the binding tier lacks; nothing if it is there.
    pub no_bindings: Option<String>,
    /// What the ray query lacks.
    pub no_ray_query: Option<String>,
    /// Without them no goal in milliseconds.
    pub has_timestamps: bool,
    /// The longest side of a G-buffer.
    pub longest: u32,
}

/// Whether a frame casts shadow rays, and others.
pub fn casts(shot: &Shot) -> [bool; 2] {
    let any = |is: fn(&str) -> bool| shot.statistics.passes.iter().any(|pass| is(pass.name));
    [any(pass_kind::traces_shadows), any(pass_kind::bounces)]
}
