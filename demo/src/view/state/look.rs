//! How the pictures are looked at.

use super::tone::Tone;

/// What is shown of the pictures, how large, and with what around them.
pub struct Look {
    /// The only side that is shown, if it is one.
    pub alone: Option<usize>,
    /// No key and no drag moves the camera.
    pub frozen: bool,
    /// The controls and the plot are shown.
    pub panels: bool,
    /// The buttons over the picture are shown.
    pub buttons: bool,
    /// Drags of the picture turn around what is looked at.
    pub orbit: bool,
    /// How radiance becomes what the screen shows.
    pub tone: Tone,
    /// Where the picture is in the window, in points.
    pub rect: egui::Rect,
    /// Where a picture is wrong is shown in place of it.
    pub show_error: bool,
    /// What is around the pointer is magnified.
    pub magnify: bool,
    /// Pixels of the screen for one of the picture; it fits its place if not given.
    pub scale: Option<f32>,
    /// How far the picture's centre lies from that of its place, in points, where it is larger.
    pub pan: egui::Vec2,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            alone: None,
            frozen: false,
            panels: true,
            buttons: true,
            orbit: false,
            tone: Tone::default(),
            rect: egui::Rect::NOTHING,
            show_error: false,
            magnify: false,
            scale: None,
            pan: egui::Vec2::ZERO,
        }
    }
}
