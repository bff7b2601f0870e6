//! A view on which settings are tried.

use super::tunable::Tunable;
use crate::host::{Host, HostError, Shot};
use crate::measure::quality::{self, QualityError};
use crate::measure::temporal::{self, FRAMES, Flicker, FrameErrors, Motion};
use crate::picture::Picture;
use crate::scene::Camera;
use deferred_aa::{Settings, Technique};
use serde::Serialize;

/// Frames of a view, which moves by a part of a pixel in between: settings that suit one sampling grid alone don't win,
/// and what flickers is seen.
pub const PHASES: u32 = 2;

/// What settings give on a view, against full supersampling at the same m, over [`PHASES`] frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Shaded samples over n · w · h.
    pub ratio: f64,
    /// What the search keeps low: that ratio, or that of lights and material reads where they are apart.
    pub cost: f64,
    /// Over all pixels of all frames.
    pub psnr_db: f64,
    /// Over the pixels whose window holds an edge; that of all pixels where none does.
    pub edge_psnr_db: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// Mean standard deviation of the error over the frames, of displayed values in 0 to 1.
    pub flicker: f64,
}

/// Errors below this are the reference but for rounding, in dB.
const SAME_DB: f64 = 80.0;

/// A hundredth of a step of eight bits.
const LEAST_DEVIATION: f64 = 0.01 / 255.0;

impl Figures {
    /// The means over views: of dB as they are, up to 80, of all else geometric, so that each view counts as much.
    pub fn mean(of: &[Self]) -> Self {
        let count = of.len().max(1) as f64;
        let mean = |value: fn(&Self) -> f64| of.iter().map(value).sum::<f64>() / count;
        Self {
            ratio: mean(|f| f.ratio.ln()).exp(),
            cost: mean(|f| f.cost.ln()).exp(),
            psnr_db: mean(|f| f.psnr_db.min(SAME_DB)),
            edge_psnr_db: mean(|f| f.edge_psnr_db.min(SAME_DB)),
            flip: mean(|f| f.flip.max(LEAST_DEVIATION).ln()).exp(),
            flicker: mean(|f| f.flicker.max(LEAST_DEVIATION).ln()).exp(),
        }
    }
}

/// A view could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum SubjectError {
    /// The frame.
    #[error(transparent)]
    Host(#[from] HostError),
    /// The measure.
    #[error(transparent)]
    Quality(#[from] QualityError),
}

/// A view, its host kept open, its references, and all that was tried on it.
#[derive(Debug)]
pub struct Subject<T> {
    /// As given on the command line.
    pub name: String,
    /// Every point with what it gave, in the order of trial.
    pub tried: Vec<(T, Figures)>,
    host: Host,
    phases: Vec<Phase>,
}

/// A frame of the view by full supersampling.
#[derive(Debug)]
struct Phase {
    camera: deferred_aa::Camera,
    reference: Picture,
    edges: Vec<bool>,
}

/// The settings that all are held against.
pub fn full() -> Settings {
    Settings { technique: Technique::Full, ..Default::default() }
}

impl<T: Tunable> Subject<T> {
    /// Renders the references.
    pub fn new(name: String, mut host: Host, view: Camera) -> Result<Self, SubjectError> {
        let (width, height) = (host.options.width, host.options.height);
        let phase = |i| {
            let camera = temporal::camera(Motion::Pan, &view, i * FRAMES / PHASES, width, height);
            host.frame_with(camera, full())?;
            Ok::<_, SubjectError>(Phase { camera, reference: host.picture(), edges: host.edge_mask() })
        };
        let phases = (0..PHASES).map(phase).collect::<Result<_, _>>()?;
        Ok(Self { name, tried: Vec::new(), host, phases })
    }

    /// The figures of these settings; what was tried before is not rendered again.
    pub fn figures(&mut self, settings: T) -> Result<Figures, SubjectError> {
        if let Some((_, figures)) = self.tried.iter().find(|(tried, _)| *tried == settings) {
            return Ok(*figures);
        }
        let mut sums = [0.0; 3];
        let (mut errors, mut at_edges) = (Vec::new(), Vec::new());
        let mut flicker = None;
        for Phase { camera, reference, edges } in &self.phases {
            let shot = self.host.frame_with(*camera, settings.settings())?;
            let image = self.host.picture();
            let of_frame = [shot.statistics.ratio, T::cost(&shot.statistics), quality::flip(&image, reference)?.mean];
            sums = std::array::from_fn(|i| sums[i] + of_frame[i] / f64::from(PHASES));
            errors.push(quality::psnr(&image, reference)?);
            at_edges.extend(quality::edge_psnr(&image, reference, edges)?);
            flicker.get_or_insert_with(|| Flicker::new(image.rgba.len())).push(&image, reference)?;
        }
        let pooled = |frames: &[f64]| FrameErrors::of(frames).map(|e| e.psnr_db);
        let psnr_db = pooled(&errors).unwrap_or(quality::IDENTICAL_DB);
        let [ratio, cost, flip] = sums;
        let figures = Figures {
            ratio,
            cost,
            psnr_db,
            edge_psnr_db: pooled(&at_edges).unwrap_or(psnr_db),
            flip,
            flicker: flicker.and_then(Flicker::finish).map_or(0.0, |d| d.mean),
        };
        self.tried.push((settings, figures));
        Ok(figures)
    }

    /// A frame with its times.
    pub fn shot(&mut self, settings: Settings) -> Result<Shot, SubjectError> {
        Ok(self.host.frame_with(self.phases[0].camera, settings)?)
    }

    /// The graphics adapter.
    pub fn adapter(&self) -> String {
        self.host.gpu.adapter.get_info().name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_counts_as_much() {
        let view = |factor: f64, psnr_db, edge_psnr_db| Figures {
            ratio: 0.1 * factor,
            cost: 0.2 * factor,
            psnr_db,
            edge_psnr_db,
            flip: 0.01 * factor,
            flicker: if factor > 1.0 { 0.0 } else { LEAST_DEVIATION * 4.0 },
        };
        let mean = Figures::mean(&[view(1.0, 40.0, 60.0), view(4.0, 50.0, 200.0)]);
        let near = |is: f64, expected: f64| assert!((is / expected - 1.0).abs() < 1e-12, "{is}, not {expected}");
        near(mean.ratio, 0.2);
        near(mean.cost, 0.4);
        near(mean.psnr_db, 45.0);
        near(mean.edge_psnr_db, 70.0);
        near(mean.flip, 0.02);
        near(mean.flicker, LEAST_DEVIATION * 2.0);
    }
}
