//! References, which pictures are held against: a regular grid of samples in each pixel, all of them shaded, and their
//! mean.

use crate::host::raster::crop;
use crate::picture::Picture;
use deferred_aa::{Camera, Settings, Technique, Weight};
use glam::Vec2;

/// The settings of the reference of one grid: all samples, exact mean.
pub fn grid(base: Settings) -> Settings {
    Settings { technique: Technique::Full, weight: Weight::Linear, goal: None, ..base }
}

/// The settings of the truth: all samples of the scene with the same effects, whatever else is set.
pub fn truth(base: Settings) -> Settings {
    let Settings { shadows, reflections, refraction, .. } = base;
    grid(Settings { shadows, reflections, refraction, ..Settings::default() })
}

/// The mean of `side`² samples a pixel: frames of all m² samples, each moved by part of a pixel, so that all of them
/// together lie on a regular grid.
#[derive(Debug)]
pub struct MovedFrames {
    width: u32,
    height: u32,
    side: u32,
    /// Frames along one side of the grid.
    steps: u32,
    done: u32,
    sum: Vec<[f64; 3]>,
}

impl MovedFrames {
    /// Before the first frame. `side` is a multiple of `m`.
    pub fn new((width, height): (u32, u32), side: u32, m: u32) -> Self {
        let steps = (side / m).max(1);
        Self { width, height, side, steps, done: 0, sum: vec![[0.0; 3]; (width * height) as usize] }
    }

    /// The frames that were added, and all that there are to be.
    pub fn progress(&self) -> (u32, u32) {
        (self.done, self.steps * self.steps)
    }

    /// The camera of the next frame, where `camera` is that of the picture.
    pub fn moved(&self, camera: Camera) -> Camera {
        let full = Vec2::new(self.width as f32, self.height as f32);
        // In pixels, so that the mean of all moves is no move.
        let place = Vec2::new((self.done % self.steps) as f32, (self.done / self.steps) as f32);
        let at = (place + 0.5 - self.steps as f32 * 0.5) / self.side as f32;
        crop(camera, full, at, full)
    }

    /// Adds the next frame.
    pub fn add(&mut self, frame: &Picture) {
        for (sum, c) in self.sum.iter_mut().zip(&frame.rgba) {
            (0..3).for_each(|i| sum[i] += f64::from(c[i]));
        }
        self.done += 1;
    }

    /// The mean of the frames that were added.
    pub fn mean(&self) -> Picture {
        let frames = f64::from(self.done);
        let rgba = self.sum.iter().map(|s| [0, 1, 2].map(|i| (s[i] / frames) as f32)).map(|[r, g, b]| [r, g, b, 1.0]);
        Picture { width: self.width, height: self.height, rgba: rgba.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::raster::node_camera;
    use crate::scene::builtin::builtin;
    use glam::Vec3;

    #[test]
    fn the_samples_of_moved_frames_lie_on_one_grid() {
        let (width, height) = (64, 32);
        let still = node_camera(&builtin("cornell").unwrap().default_camera(), width, height);
        let mut frames = MovedFrames::new((width, height), 8, 2);
        let pixels = |camera: Camera| {
            let clip = camera.clip_from_view.project_point3(Vec3::NEG_Z);
            Vec2::new(clip.x * width as f32, -clip.y * height as f32) * 0.5
        };
        let mut moves = Vec::new();
        let (_, all) = frames.progress();
        for value in 0..all {
            moves.push(pixels(frames.moved(still)) - pixels(still));
            let rgba = vec![[value as f32, 1.0, 0.0, 0.0]; (width * height) as usize];
            frames.add(&Picture { width, height, rgba });
        }
        assert_eq!(frames.progress(), (16, 16));
        assert_eq!(frames.mean().rgba[0], [7.5, 1.0, 0.0, 1.0]);
        // The samples of a window of 2 × 2 are half a pixel apart: four moves along a side, an eighth of a pixel apart,
        // fill that.
        let expected = [3.0, 1.0, -1.0, -3.0].map(|sixteenths| sixteenths / 16.0);
        for (i, found) in moves.iter().enumerate() {
            let expected = Vec2::new(expected[i % 4], expected[i / 4]);
            assert!((*found - expected).length() < 1e-3, "{i}: {found} and not {expected}");
        }
    }
}
