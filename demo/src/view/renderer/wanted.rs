//! What the window wants from the renderer.

use super::recipe::Recipe;
use crate::host::Options;
use crate::scene::{Camera, Sun};
use glam::Vec3;

/// A scene as [`open`](crate::scene::open::open) takes it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    /// The name of a built-in scene, or the path of a file.
    pub name: String,
    /// The scene in a file that has several.
    pub index: Option<usize>,
}

/// The lights, as the user has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lights {
    /// How often the light loop runs, at least once.
    pub stall: u32,
    /// How many of the scene's lights shine, the first ones; all if it has no more.
    pub count: u32,
    /// The sun in place of the scene's own.
    pub sun: Option<Sun>,
}

/// The kind of reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// There is no reference, and no quality is measured.
    Off,
    /// Full supersampling at this m, which shows what the technique left out.
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
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Off, Self::Grid, Self::Truth64, Self::Truth256, Self::Truth1024];

    /// The name on the screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Grid => "full supersampling at this m",
            Self::Truth64 => "truth, 64 samples a pixel",
            Self::Truth256 => "truth, 256 samples a pixel",
            Self::Truth1024 => "truth, 1024 samples a pixel",
        }
    }

    /// Samples along one side of a pixel, a multiple of m; `None` without a reference.
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

/// All that a picture depends on except for its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The number of the scene, which counts up with every one that is opened.
    pub opening: u64,
    /// The options that are fixed for a node.
    pub options: Options,
    /// The lights.
    pub lights: Lights,
    /// The camera.
    pub camera: Camera,
}

/// What the window wants.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// The scene, and how many were opened.
    pub scene: (Source, u64),
    /// What to look at, once the scene is open.
    pub view: Option<View>,
    /// How often the camera was cut so far: no history outlives a cut.
    pub cuts: u64,
    /// What makes the pictures on either side of the divider.
    pub sides: [Option<Recipe>; 2],
    /// How many frames of each side to measure.
    pub frames: u32,
    /// The reference that they are held against.
    pub reference: Reference,
    /// Whether to render nothing, while the window is not seen.
    pub paused: bool,
    /// Whether the thread is to end.
    pub quit: bool,
}

/// Whether both want the same.
pub fn same(a: &Wanted, b: &Wanted) -> bool {
    (&a.scene, &a.view, a.cuts, &a.sides, a.frames, a.reference, a.paused)
        == (&b.scene, &b.view, b.cuts, &b.sides, b.frames, b.reference, b.paused)
}

/// The direction towards a sun: azimuth from +x towards +z, elevation above the horizon, degrees.
pub fn to_sun(azimuth: f32, elevation: f32) -> Vec3 {
    let (a, e) = (azimuth.to_radians(), elevation.to_radians());
    Vec3::new(a.cos() * e.cos(), e.sin(), a.sin() * e.cos())
}
