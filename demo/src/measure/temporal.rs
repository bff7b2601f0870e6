//! How much a technique flickers: the deviation over time of its error, while the camera moves by less than a pixel a
//! frame; and how far its moving frames are from the truth.

use crate::host::raster::node_camera;
use crate::measure::quality::{self, QualityError};
use crate::picture::{self, Picture};
use crate::scene::{Camera, Lens};
use glam::{Mat4, Quat, Vec3};

/// Frames of one measure.
pub const FRAMES: u32 = 64;

/// A slow movement of the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// The image moves to the right by [`PAN_STEP`] pixels a frame, a whole pixel over [`FRAMES`]. The lens is shifted
    /// and not the eye, so that every surface moves alike, whatever its distance, and keeps its shading.
    Pan,
    /// The camera turns to its left about its up axis, so that what it looks at moves by [`TURN_STEP`] pixels a frame,
    /// four over [`FRAMES`]. Shading and perspective change with the view.
    Turn,
}

/// Pixels a frame, everywhere.
pub const PAN_STEP: f32 = 1.0 / 64.0;
/// Pixels a frame, in the middle of the image.
pub const TURN_STEP: f32 = 1.0 / 16.0;

impl Motion {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Pan, Self::Turn];
}

/// The camera of a frame, for an output of `width` × `height` pixels. Frame 0 is `camera` itself.
pub fn camera(motion: Motion, camera: &Camera, frame: u32, width: u32, height: u32) -> deferred_aa::Camera {
    match motion {
        Motion::Pan => {
            let still = node_camera(camera, width, height);
            let shift = Vec3::X * (2.0 * frame as f32 * PAN_STEP / width as f32);
            deferred_aa::Camera { clip_from_view: Mat4::from_translation(shift) * still.clip_from_view, ..still }
        }
        Motion::Turn => {
            let ahead = camera.target - camera.eye;
            let up = camera.up.normalize_or(Vec3::Y);
            // What lies off the plane of the turn moves on a smaller circle.
            let around = (ahead.reject_from_normalized(up).length() / ahead.length()).max(1e-3);
            let angle = frame as f32 * TURN_STEP * pixel_angle(camera, ahead.length(), height) / around;
            let target = camera.eye + Quat::from_axis_angle(up, angle) * ahead;
            node_camera(&Camera { target, ..*camera }, width, height)
        }
    }
}

/// Frames until [`uncovering`] ends.
pub const UNCOVERING_FRAMES: u32 = 8;
/// Pixels a frame, far behind what the camera looks at.
pub const UNCOVERING_STEP: f32 = 4.0;

/// The camera of a frame while it goes round what it looks at, so that what is in front moves across what lies behind
/// and uncovers it. `left` frames later it is `camera` itself.
pub fn uncovering(camera: &Camera, left: u32, width: u32, height: u32) -> deferred_aa::Camera {
    let ahead = camera.target - camera.eye;
    let angle = left as f32 * UNCOVERING_STEP * pixel_angle(camera, ahead.length(), height);
    let eye = camera.target - Quat::from_axis_angle(camera.up.normalize_or(Vec3::Y), angle) * ahead;
    let eye = if left == 0 { camera.eye } else { eye };
    node_camera(&Camera { eye, ..*camera }, width, height)
}

/// Radians that move what is `distance` ahead by a pixel.
fn pixel_angle(camera: &Camera, distance: f32, height: u32) -> f32 {
    match camera.lens {
        Lens::Perspective { fov_y } => 2.0 * (fov_y / 2.0).tan() / height as f32,
        Lens::Orthographic { half_height, .. } => 2.0 * half_height / height as f32 / distance,
    }
}

/// Standard deviation over time of (image − truth of that frame), of displayed values in [0, 1], averaged over RGB.
/// An error that stays is none: it is what the other measures see.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Deviation {
    /// Over all pixels; lower is better.
    pub mean: f64,
    /// 99th percentile by nearest rank: at least 99 % of the pixels do not exceed it.
    pub p99: f64,
}

/// How far moving frames are from the truth of each, as displayed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FrameErrors {
    /// Of one mean squared error over all frames, in dB.
    pub psnr_db: f64,
    /// Of the worst frame, in dB.
    pub worst_db: f64,
}

impl FrameErrors {
    /// From the PSNR of each frame. `None` without a frame.
    pub fn of(frames: &[f64]) -> Option<Self> {
        let worst_db = frames.iter().copied().min_by(f64::total_cmp)?;
        let mean = frames.iter().map(|db| 10f64.powf(-db / 10.0)).sum::<f64>() / frames.len() as f64;
        Some(Self { psnr_db: -10.0 * mean.log10(), worst_db })
    }
}

/// Gathers the frames of one technique and one motion.
#[derive(Debug, Clone)]
pub struct Flicker {
    frames: u32,
    pixels: Vec<[Moments; 3]>,
}

/// Welford's: the mean so far, and the sum of squared distances from it.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    mean: f64,
    squares: f64,
}

impl Moments {
    fn push(&mut self, value: f64, count: f64) {
        let before = value - self.mean;
        self.mean += before / count;
        self.squares += before * (value - self.mean);
    }
}

impl Flicker {
    /// For pictures of this many pixels.
    pub fn new(pixels: usize) -> Self {
        Self { frames: 0, pixels: vec![Default::default(); pixels] }
    }

    /// The next frame: what the technique made of it, and what it should have made. Nothing is taken in if it is
    /// refused.
    pub fn push(&mut self, image: &Picture, truth: &Picture) -> Result<(), QualityError> {
        quality::check(image, truth)?;
        if image.rgba.len() != self.pixels.len() {
            return Err(QualityError::Frames { expected: self.pixels.len(), found: image.rgba.len() });
        }
        self.frames += 1;
        let count = f64::from(self.frames);
        for (pixel, (image, truth)) in self.pixels.iter_mut().zip(image.rgba.iter().zip(&truth.rgba)) {
            let [image, truth] = [image, truth].map(|&[r, g, b, _]| picture::display([r, g, b]));
            for (channel, (image, truth)) in pixel.iter_mut().zip(image.into_iter().zip(truth)) {
                channel.push(f64::from(image) - f64::from(truth), count);
            }
        }
        Ok(())
    }

    /// The deviation over all frames. `None` for fewer than two, or for pictures without a pixel.
    pub fn finish(self) -> Option<Deviation> {
        if self.frames < 2 || self.pixels.is_empty() {
            return None;
        }
        let deviation = |m: &Moments| (m.squares / f64::from(self.frames)).sqrt();
        let mut pixels: Vec<f64> = self.pixels.iter().map(|p| p.iter().map(deviation).sum::<f64>() / 3.0).collect();
        let mean = pixels.iter().sum::<f64>() / pixels.len() as f64;
        let rank = (pixels.len() * 99).div_ceil(100) - 1;
        let (_, p99, _) = pixels.select_nth_unstable_by(rank, f64::total_cmp);
        Some(Deviation { mean, p99: *p99 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::gpu::{self, Gpu};
    use crate::host::{Host, Options};
    use crate::scene::builtin::builtin;

    use deferred_aa::{Settings, Technique};

    fn grey(values: &[f32]) -> Picture {
        Picture::new(values.len() as u32, 1, values.iter().map(|&v| [v, v, v, 1.0]).collect()).unwrap()
    }

    fn shown(value: f32) -> f64 {
        f64::from(picture::display([value; 3])[0])
    }

    #[test]
    fn an_error_that_stays_does_not_flicker() {
        let mut flicker = Flicker::new(2);
        // The truth moves, and the image is off by the same: by nothing, or by all from black to white.
        for frame in 0..FRAMES {
            let truth = if frame % 2 == 0 { 0.25 } else { 4.0 };
            flicker.push(&grey(&[truth, 1.0]), &grey(&[truth, 0.5])).unwrap();
        }
        assert_eq!(flicker.finish(), Some(Deviation { mean: 0.0, p99: 0.0 }));
    }

    #[test]
    fn a_swing_of_d_deviates_by_d() {
        let [low, middle, high] = [0.2, 0.5, 0.8];
        let mut flicker = Flicker::new(1);
        for frame in 0..FRAMES {
            flicker.push(&grey(&[if frame % 2 == 0 { low } else { high }]), &grey(&[middle])).unwrap();
        }
        let Deviation { mean, p99 } = flicker.finish().unwrap();
        let expected = (shown(high) - shown(low)) / 2.0;
        assert!((mean - expected).abs() < 1e-12 && (p99 - expected).abs() < 1e-12, "{mean} {p99} {expected}");
    }

    #[test]
    fn a_pixel_in_two_hundred_is_in_the_mean_and_three_are_in_the_percentile() {
        let swing = |flickering: usize| {
            let mut flicker = Flicker::new(200);
            for frame in 0..4 {
                let mut values = [0.0; 200];
                values[..flickering].fill(if frame % 2 == 0 { 0.0 } else { 1.0 });
                // One channel of three.
                let rgba = values.map(|v| [v, 0.0, 0.0, 1.0]).to_vec();
                let image = Picture::new(200, 1, rgba).unwrap();
                flicker.push(&image, &grey(&[0.0; 200])).unwrap();
            }
            flicker.finish().unwrap()
        };
        let d = shown(1.0) / 2.0 / 3.0;
        let (one, three) = (swing(1), swing(3));
        assert!((one.mean - d / 200.0).abs() < 1e-12 && one.p99 == 0.0, "{one:?}");
        assert!((three.mean - 3.0 * d / 200.0).abs() < 1e-12 && (three.p99 - d).abs() < 1e-12, "{three:?}");
    }

    #[test]
    fn what_does_not_belong_together_is_refused() {
        let mut flicker = Flicker::new(2);
        assert!(matches!(
            flicker.push(&grey(&[0.0]), &grey(&[0.0])),
            Err(QualityError::Frames { expected: 2, found: 1 })
        ));
        assert!(flicker.push(&grey(&[0.0, 0.0]), &grey(&[0.0])).is_err());
        assert!(flicker.push(&grey(&[0.0, 0.0]), &grey(&[0.0, f32::NAN])).is_err());
        flicker.push(&grey(&[0.0, 0.0]), &grey(&[0.0, 0.0])).unwrap();
        assert_eq!(flicker.finish(), None, "one frame has no deviation");
    }

    #[test]
    fn errors_of_frames_are_averaged_and_not_their_decibels() {
        assert_eq!(FrameErrors::of(&[]), None);
        let FrameErrors { psnr_db, worst_db } = FrameErrors::of(&[30.0, 20.0, 200.0]).unwrap();
        let expected = -10.0 * (0.011f64 / 3.0).log10();
        assert!((psnr_db - expected).abs() < 1e-9 && worst_db == 20.0, "{psnr_db} {worst_db}");
    }

    #[test]
    fn uncovering_moves_what_is_behind_and_not_the_target() {
        let (width, height) = (640, 360);
        for lens in [Lens::Perspective { fov_y: 0.9 }, Lens::Orthographic { half_height: 3.0, far: 100.0 }] {
            let end = Camera { eye: Vec3::ONE, target: Vec3::new(1.0, 1.0, -4.0), up: Vec3::Y, lens, near: 0.1 };
            assert_eq!(uncovering(&end, 0, width, height), node_camera(&end, width, height));
            let pixels = |left: u32, at: Vec3| {
                let moved = uncovering(&end, left, width, height);
                let clip = moved.clip_from_view * moved.world_from_view.inverse() * at.extend(1.0);
                clip.x / clip.w * width as f32 / 2.0
            };
            assert!((pixels(8, end.target) - pixels(0, end.target)).abs() < 0.01, "{lens:?}");
            // Twice as far as the target: half the parallax of what is infinitely far, in a perspective.
            let behind = Vec3::new(1.0, 1.0, -9.0);
            let step = (pixels(1, behind) - pixels(0, behind)).abs();
            let expected = if matches!(lens, Lens::Perspective { .. }) { 0.5 } else { 1.0 } * UNCOVERING_STEP;
            assert!((step - expected).abs() < 0.05, "{lens:?}: {step}");
        }
    }

    #[test]
    fn a_turn_moves_the_target_by_its_step() {
        let (width, height) = (640, 360);
        let near = 0.1;
        let ahead = Vec3::new(3.0, -1.0, -4.0);
        for lens in [Lens::Perspective { fov_y: 0.9 }, Lens::Orthographic { half_height: 3.0, far: 100.0 }] {
            let still = Camera { eye: Vec3::ONE, target: Vec3::ONE + ahead, up: Vec3::Y, lens, near };
            for frame in [0, 1, 64] {
                let moved = camera(Motion::Turn, &still, frame, width, height);
                let clip = moved.clip_from_view * moved.world_from_view.inverse() * still.target.extend(1.0);
                let pixels = clip.x / clip.w * width as f32 / 2.0;
                assert!((pixels - frame as f32 * TURN_STEP).abs() < 2e-3, "{lens:?}, frame {frame}: {pixels} pixels");
                assert!((clip.y / clip.w).abs() < 1e-4, "{clip}");
            }
        }
    }

    #[test]
    fn a_pan_of_all_frames_is_one_pixel() {
        let (width, height, m) = (64, 36, 2);
        let options = Options::new(width, height, m);
        let gpu = Gpu::new(gpu::choose(None).unwrap(), &options.descriptor()).unwrap();
        let mut host = Host::new(gpu, builtin("fence").unwrap(), options).unwrap();
        let view = host.scene.default_camera();
        let settings = Settings { technique: Technique::Full, ..Default::default() };
        let mut shoot = |frame| {
            host.frame_with(camera(Motion::Pan, &view, frame, width, height), settings).unwrap();
            host.picture().to_srgb8()
        };
        let (first, half, last) = (shoot(0), shoot(FRAMES / 2), shoot(FRAMES));
        let (mut same, mut compared) = (0, 0);
        for y in 0..height as usize {
            for x in 1..width as usize {
                let at = y * width as usize + x;
                compared += 1;
                same += usize::from(last[at] == first[at - 1]);
            }
        }
        assert!(same * 100 > compared * 98, "{same} of {compared}");
        assert_ne!(half, first);
    }
}
