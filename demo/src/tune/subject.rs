//! A view on which settings are tried.

use super::tunable::Tunable;
use crate::host::{Host, HostError, Shot};
use crate::measure::quality::{self, QualityError};
use crate::picture::Picture;
use crate::scene::Camera;
use deferred_aa::{Settings, Technique};
use serde::Serialize;

/// What settings give on a view, against full supersampling at the same m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Shaded samples over n · w · h.
    pub ratio: f64,
    /// What the search keeps low: that ratio, or that of lights and material reads where they are apart.
    pub cost: f64,
    /// Over all pixels.
    pub psnr_db: f64,
    /// Over the pixels whose window holds an edge; that of all pixels where none does.
    pub edge_psnr_db: f64,
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

/// A view, its host kept open, its reference, and all that was tried on it.
#[derive(Debug)]
pub struct Subject<T> {
    /// As given on the command line.
    pub name: String,
    /// Every point with what it gave, in the order of trial.
    pub tried: Vec<(T, Figures)>,
    host: Host,
    camera: Camera,
    reference: Picture,
    edges: Vec<bool>,
}

/// The settings that all are held against.
pub fn full() -> Settings {
    Settings { technique: Technique::Full, ..Default::default() }
}

impl<T: Tunable> Subject<T> {
    /// Renders the reference.
    pub fn new(name: String, mut host: Host, camera: Camera) -> Result<Self, SubjectError> {
        host.frame(&camera, full())?;
        let (reference, edges) = (host.picture(), host.edge_mask());
        Ok(Self { name, tried: Vec::new(), host, camera, reference, edges })
    }

    /// The figures of these settings; what was tried before is not rendered again.
    pub fn figures(&mut self, settings: T) -> Result<Figures, SubjectError> {
        if let Some((_, figures)) = self.tried.iter().find(|(tried, _)| *tried == settings) {
            return Ok(*figures);
        }
        let shot = self.host.shade_again(&self.camera, settings.settings())?;
        let image = self.host.picture();
        let psnr_db = quality::psnr(&image, &self.reference)?;
        let edge_psnr_db = quality::edge_psnr(&image, &self.reference, &self.edges)?.unwrap_or(psnr_db);
        let figures = Figures { ratio: shot.statistics.ratio, cost: T::cost(&shot.statistics), psnr_db, edge_psnr_db };
        self.tried.push((settings, figures));
        Ok(figures)
    }

    /// A frame with its times.
    pub fn shot(&mut self, settings: Settings) -> Result<Shot, SubjectError> {
        Ok(self.host.shade_again(&self.camera, settings)?)
    }

    /// The graphics adapter.
    pub fn adapter(&self) -> String {
        self.host.gpu.adapter.get_info().name
    }
}
