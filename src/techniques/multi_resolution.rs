//! `MultiResolution`: refines a coarse lattice of points into finer ones, and on request into more samples a pixel
//! (University of Alaska Fairbanks thesis on tri-adaptive sampling).

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows, nothing};
use super::planned::{blocks, planned};
use super::rays;
use super::reconstructed::weights;
use crate::gpu::binding::PassData;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::{Step, Steps};
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::{FrameUniform, MultiResolutionUniform, flag};
use crate::gpu::uniforms::lattice::{self, LatticeStep, LatticeSteps, LatticeUse};
use crate::host::error::RecordError;
use crate::host::needs::{Needs, RayInputs};
use crate::host::statistics::Counters;
use crate::passes::lattice::{lattice_to_pixels, points, refine};
use crate::passes::resolve;
use crate::settings::{DebugView, Execution, LuminanceCurve, Pattern, Settings};

pub(super) struct MultiResolution;

/// The lattice of pixels, from which S is computed.
const PIXELS: LatticeStep = LatticeStep { of: LatticeUse::Shading, level: lattice::Level::Pixels };

/// The steps over the lattices of a use, from the coarsest: each lattice is refined from the one before, and its chosen
/// points are sampled.
fn levels<T: IntoIterator<Item = Step>>(
    settings: &Settings,
    of: LatticeUse,
    refine: &'static PassData,
    sample: impl Fn(LatticeStep) -> T,
) -> Vec<Step> {
    let mut steps = Steps::default();
    for (i, level) in lattice::levels(&settings.multi_resolution, of).enumerate() {
        let at = LatticeStep { of, level };
        steps = steps.then_if(i > 0, Step::on(refine, at)).then_all(sample(at));
    }
    steps.0
}

impl Method for MultiResolution {
    /// Checks that the lattices fit the image and the node.
    fn check(&self, settings: &Settings, _: &Needs<'_>, [width, height]: [u32; 2], m: u32) -> Result<(), RecordError> {
        let lattices = &settings.multi_resolution;
        let most = width.max(height).ilog2();
        for (lattice, coarsest) in [("shading", lattices.shading.coarsest), ("rays", lattices.rays.coarsest)] {
            if coarsest > most {
                return Err(RecordError::Coarsest { lattice, coarsest, width, height, most });
            }
        }
        match lattices.shading.pattern {
            pattern @ (Pattern::Triangular | Pattern::Equilateral) if m == 1 => Err(RecordError::Shifted(pattern)),
            _ => Ok(()),
        }
    }

    fn uniform(&self, settings: &Settings, m: u32, _: Option<Effort>, uniform: &mut FrameUniform) {
        let l = &settings.multi_resolution;
        weights(settings, m, uniform);
        uniform.flag(flag::LATTICE, true);
        uniform.flag(flag::LUMINANCE_PERCEPTUAL, l.curve == LuminanceCurve::Perceptual);
        uniform.flag(flag::VETO, l.veto);
        uniform.flag(flag::WEIGHTED, l.weighted);
        uniform.flag(flag::SUPERSAMPLED, l.supersampled);
        uniform.around = if l.supersampled { blocks(settings.execution) } else { 0 };
        uniform.footprint = if l.supersampled { l.footprint } else { 1.0 };
        uniform.multi_resolution =
            MultiResolutionUniform { color: l.color_threshold, position: l.position_threshold, padding: [0; 2] };
    }

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let more = settings.multi_resolution.supersampled;
        // Lattices cast rays from their points, so tiles only matter for the planned samples.
        let classified = inputs.any() && more;
        let image: &'static PassData = if more { &resolve::BY_PLAN } else { &resolve::LATTICE };
        let to_pixels: &'static PassData = if more { &lattice_to_pixels::COUNTED } else { &lattice_to_pixels::FINAL };
        let cast = |at: LatticeStep| rays::cast(inputs, CastSamples::Points(at.level));
        let shade = |at: LatticeStep| [Step::on(&points::POINTS, at)];
        let of_rays = levels(settings, LatticeUse::Rays, &refine::RAYS, cast);
        let beyond = if more { planned(settings.execution, inputs) } else { Vec::new() };
        Steps::default()
            .then_all(rays::classified(inputs).filter(|_| classified))
            .then_all(of_rays.into_iter().filter(|_| inputs.any()))
            .then_all(levels(settings, LatticeUse::Shading, &refine::COLORS, shade))
            .then_if(more || settings.view != DebugView::Image, Step::on(to_pixels, PIXELS))
            .then_all(beyond)
            .then(image_or_view(settings, &Shown { image, planned: true, surfaces: false, classified, inputs }))
    }

    fn casting(&self, settings: &Settings, m: u32) -> CastingRanks {
        let l = &settings.multi_resolution;
        // The points of shifted rows may be any samples.
        if [l.shading.pattern, l.rays.pattern].into_iter().any(|pattern| pattern != Pattern::Quad) {
            CastingRanks::First(m * m)
        } else if l.supersampled {
            CastingRanks::Planned
        } else {
            CastingRanks::First(1)
        }
    }

    fn count(&self, counters: &Counters, of: Windows) -> Counted {
        let points = counters.points.sum();
        let mut counted = Counted::by_k(counters, of.n, counters.decided);
        if counted.histogram_k.iter().all(|&windows| windows == 0) {
            // No plan pass has counted the windows.
            counted.histogram_k[0] = points.min(of.windows) as u32;
            counted.decided = nothing(of);
        }
        let beyond = counted.histogram_k.iter().zip(0u64..).map(|(&windows, more)| u64::from(windows) * more);
        counted.shaded = beyond.sum::<u64>() + points;
        counted
    }

    fn execution(&self, settings: &Settings) -> Option<Execution> {
        Some(settings.execution)
    }

    fn lattices(
        &self,
        settings: &Settings,
        size: [u32; 2],
        image: [u32; 2],
        inputs: RayInputs,
    ) -> Option<LatticeSteps> {
        Some(LatticeSteps::new(&settings.multi_resolution, size, image, inputs.code()))
    }

    fn apron(&self, settings: &Settings, inputs: RayInputs) -> u32 {
        let reach = |of| lattice::reach(&settings.multi_resolution, of);
        let rays = if inputs.any() { reach(LatticeUse::Rays) } else { 0 };
        // `lattice_to_pixels` judges windows by their neighbours.
        let more = settings.multi_resolution.supersampled;
        let judged = if more { 1 + blocks(settings.execution) } else { 0 };
        reach(LatticeUse::Shading) + rays + judged
    }
}
