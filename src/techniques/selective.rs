//! `Selective`: shades four samples of each quadrant that contrasts with the pixels at its corner (Jin, Ihm, Chang,
//! Park, Lee, Jung 2009).

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows, nothing};
use super::rays;
use crate::gpu::binding::PassData;
use crate::gpu::buffers::check_marks;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::Steps;
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::{FrameUniform, SelectiveUniform, flag};
use crate::host::error::RecordError;
use crate::host::needs::{Needs, RayInputs};
use crate::host::plan::PlanWord;
use crate::host::statistics::Counters;
use crate::passes::{first, list, quadrants, resolve, select};
use crate::settings::{ColorReference, LuminanceCurve, Settings};
use crate::window;

pub(super) struct Selective;

/// `DAA_OFF` of select.wgsl: greater than any contrast and than any threshold that is on.
pub(crate) const OFF: f32 = 2.0;

/// The ranks beyond the first that each quadrant uses, a bit each: `daa_ranks_of` of sample.wgsl.
fn quadrant_ranks(order: &[(u8, u8)], m: u32) -> [[u32; 4]; 2] {
    let mut ranks = [[0; 4]; 2];
    for (rank, &(x, y)) in order.iter().enumerate().skip(1) {
        let quadrants = window::quadrants(m, x, y);
        for quadrant in (0..4).filter(|quadrant| quadrants >> quadrant & 1 != 0) {
            ranks[quadrant / 2][quadrant % 2 * 2 + rank / 32] |= 1 << (rank % 32);
        }
    }
    ranks
}

impl Method for Selective {
    fn check(&self, _: &Settings, needs: &Needs<'_>, _: [u32; 2], _: u32) -> Result<(), RecordError> {
        check_marks(needs)
    }

    fn uniform(&self, settings: &Settings, m: u32, _: Option<Effort>, uniform: &mut FrameUniform) {
        let s = &settings.selective;
        uniform.flag(flag::SELECTIVE, true);
        uniform.flag(flag::LUMINANCE_PERCEPTUAL, s.curve == LuminanceCurve::Perceptual);
        uniform.flag(flag::EDGE_AWARE_FIRST, s.edge_aware_first);
        uniform.flag(flag::SHADOW_LIGHTS, s.shadow_lights);
        uniform.flag(flag::BILINEAR, s.bilinear);
        uniform.flag(flag::FOCUSED, s.focused);
        uniform.flag(flag::BY_LUMINANCE, s.reference == ColorReference::Luminance);
        uniform.flag(flag::BY_GRADIENT, s.reference == ColorReference::Gradient);
        uniform.footprint = s.footprint;
        let thresholds = s.thresholds().map(|tau| tau.unwrap_or(OFF));
        uniform.selective = SelectiveUniform {
            primary: std::array::from_fn(|i| thresholds[1 + i]),
            reflected: std::array::from_fn(|i| thresholds[5 + i]),
            color: thresholds[0],
            contrast_min: s.contrast_min,
            normal_cosine: s.normal_cosine,
            samples: window::quadrant_samples(m),
            ranks: quadrant_ranks(&self.order(settings, m), m),
        };
    }

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let (shade, image): (&'static PassData, &'static PassData) = if settings.selective.bilinear {
            (&quadrants::BETWEEN, &resolve::COLOR)
        } else {
            (&quadrants::ACTIVE, &resolve::BY_PLAN)
        };
        Steps::default()
            .then_all(rays::classified(inputs))
            .then_all(rays::cast(inputs, CastSamples::First))
            .then(&first::FIRST)
            .then(&select::SELECT)
            .then_all(rays::cast_planned(inputs))
            .then(&list::PIXELS)
            .then(shade)
            .then(image_or_view(
                settings,
                &Shown { image, planned: true, surfaces: false, classified: inputs.any(), inputs },
            ))
    }

    fn order(&self, _: &Settings, m: u32) -> Vec<(u8, u8)> {
        window::centred(m)
    }

    fn shaded(&self, settings: &Settings, m: u32, word: PlanWord) -> Option<Vec<usize>> {
        let chosen =
            |&(rank, (x, y)): &(usize, (u8, u8))| rank == 0 || window::quadrants(m, x, y) & word.quadrants() != 0;
        Some(self.order(settings, m).into_iter().enumerate().filter(chosen).map(|(rank, _)| rank).collect())
    }

    fn casting(&self, _: &Settings, _: u32) -> CastingRanks {
        CastingRanks::Planned
    }

    fn count(&self, counters: &Counters, of: Windows) -> Counted {
        Counted::by_k(counters, of.n, nothing(of))
    }

    fn apron(&self, settings: &Settings, _: RayInputs) -> u32 {
        // Gradients are differences of the neighbours' neighbours.
        if settings.selective.reference == ColorReference::Gradient { 2 } else { 1 }
    }

    fn reads_marks(&self) -> bool {
        true
    }

    fn reads_hits(&self) -> bool {
        true
    }
}
