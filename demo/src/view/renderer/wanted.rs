//! What the window wants from the renderer.

use crate::host::Options;
use crate::scene::{Camera, Sun};
use deferred_aa::{DebugView, Settings};
use glam::Vec3;

/// What is opened, by [`open`](crate::scene::open::open).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    /// A built-in scene or a file.
    pub name: String,
    /// Of a file with several.
    pub index: Option<usize>,
}

/// The lights, as the user has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lights {
    /// How often the light loop runs, from 1.
    pub stall: u32,
    /// The scene's first lights that shine; all if more than there are.
    pub count: u32,
    /// In place of the scene's own.
    pub sun: Option<Sun>,
}

/// What the reference is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// None, and no quality.
    Off,
    /// Full supersampling at this m: what the technique left out.
    #[default]
    Grid,
    /// 8 × 8 samples a pixel.
    Truth64,
    /// 16 × 16.
    Truth256,
    /// 32 × 32.
    Truth1024,
}

impl Reference {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Off, Self::Grid, Self::Truth64, Self::Truth256, Self::Truth1024];

    /// On the screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Grid => "full supersampling at this m",
            Self::Truth64 => "truth, 64 samples a pixel",
            Self::Truth256 => "truth, 256 samples a pixel",
            Self::Truth1024 => "truth, 1024 samples a pixel",
        }
    }

    /// Samples along one side of a pixel: a multiple of m.
    pub fn side(self, m: u32) -> Option<u32> {
        let side = match self {
            Self::Off => return None,
            Self::Grid => m,
            Self::Truth64 => 8,
            Self::Truth256 => 16,
            Self::Truth1024 => 32,
        };
        Some(side.next_multiple_of(m))
    }
}

/// All that a picture depends on but its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Counts up with every scene that is opened.
    pub opening: u64,
    /// What is fixed for a node.
    pub options: Options,
    /// What shines.
    pub lights: Lights,
    /// From where.
    pub camera: Camera,
}

/// What the window wants.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// The scene, and how many were opened.
    pub scene: (Source, u64),
    /// What to look at, once the scene is there.
    pub view: Option<View>,
    /// What is on either side of the divider.
    pub sides: [Option<Settings>; 2],
    /// Frames to measure of each.
    pub frames: u32,
    /// What they are held against.
    pub reference: Reference,
    /// Nothing is rendered while the window is not seen.
    pub paused: bool,
    /// The thread ends.
    pub quit: bool,
}

/// Whether both want the same.
pub fn same(a: &Wanted, b: &Wanted) -> bool {
    (&a.scene, &a.view, &a.sides, a.frames, a.reference, a.paused)
        == (&b.scene, &b.view, &b.sides, b.frames, b.reference, b.paused)
}

/// The direction towards a sun: azimuth from +x towards +z, elevation above the horizon, degrees.
pub fn to_sun(azimuth: f32, elevation: f32) -> Vec3 {
    let (a, e) = (azimuth.to_radians(), elevation.to_radians());
    Vec3::new(a.cos() * e.cos(), e.sin(), a.sin() * e.cos())
}

/// What a debug view shows is no image to judge.
pub fn is_image(settings: &Settings) -> bool {
    settings.view == DebugView::Image
}
