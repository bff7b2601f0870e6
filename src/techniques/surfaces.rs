//! `Surfaces`: gathers the samples of a window into surfaces, reads their materials at several taps, and lights each
//! group of taps that are alike once.

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows, nothing};
use super::rays;
use crate::gpu::binding::PassData;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::{Step, Steps};
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::{FrameUniform, SurfacesUniform, flag};
use crate::host::needs::RayInputs;
use crate::host::plan::PlanWord;
use crate::host::statistics::Counters;
use crate::passes::surfaces::{audit, cover, light};
use crate::passes::{first, plan, resolve};
use crate::settings::{DebugView, Goal, Settings};
use crate::window;

pub(super) struct Surfaces;

impl Method for Surfaces {
    fn uniform(&self, settings: &Settings, m: u32, effort: Option<Effort>, uniform: &mut FrameUniform) {
        let s = effort.map_or(settings.surfaces, |e| settings.surfaces.at_effort(e.effort));
        uniform.flag(flag::SURFACES, true);
        uniform.footprint = s.footprint;
        uniform.surfaces = SurfacesUniform {
            normal_cosine: s.normal_cosine,
            plane: s.plane,
            most: s.surfaces,
            taps: s.taps,
            first_taps: s.first_taps,
            most_groups: s.groups,
            tap_spread: s.tap_spread,
            spread: s.spread,
            widening: s.widening,
            block_spread: s.block_spread,
            block_contrast: s.block_contrast,
            shadow_reach: s.shadow_reach,
        };
        uniform.set_centres(m, &self.order(settings, m));
    }

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let light: &'static PassData = if inputs.any() { &light::TRACED } else { &light::LIGHT };
        let shown = Shown { image: &resolve::COLOR, planned: false, surfaces: true, classified: inputs.any(), inputs };
        let audit: &'static PassData = if inputs.any() { &audit::TRACED } else { &audit::AUDIT };
        let probe = rays::probed(inputs, settings.surfaces.shadow_reach);
        let cover: &'static PassData = if probe.is_some() { &cover::PROBED } else { &cover::COVER };
        let steps = Steps::default()
            .then_all(rays::classified(inputs))
            .then_all(rays::cast(inputs, CastSamples::First))
            .then_all(probe)
            .then_if(settings.view == DebugView::First, &first::FIRST)
            .then(cover)
            .then_all(inputs.any().then(|| Step::from(&plan::PLAN)))
            .then_all(rays::cast_planned(inputs))
            .then(light)
            .then(image_or_view(settings, &shown));
        if !matches!(settings.goal, Some(Goal::Error(_))) {
            return steps;
        }
        // The audit runs after the image, which does not wait for it.
        steps.then_all(rays::cast(inputs, CastSamples::Audited)).then(audit)
    }

    /// The first taps of a window lie in rows and columns of their own, so that fewer edges pass between them.
    fn order(&self, _: &Settings, m: u32) -> Vec<(u8, u8)> {
        window::rotated(m)
    }

    fn shaded(&self, _: &Settings, _: u32, _: PlanWord) -> Option<Vec<usize>> {
        None
    }

    fn cast(&self, _: &Settings, _: u32, word: PlanWord) -> Option<Vec<usize>> {
        Some((0..word.k() as usize).collect())
    }

    fn casting(&self, _: &Settings, _: u32) -> CastingRanks {
        CastingRanks::Planned
    }

    fn count(&self, counters: &Counters, of: Windows) -> Counted {
        Counted::by_k(counters, of.n, nothing(of))
    }

    fn apron(&self, settings: &Settings, inputs: RayInputs) -> u32 {
        // Edges of shadows and reflections are those of the windows around, too, and edges are looked for within the reach.
        let reach = if inputs.shadows { settings.surfaces.shadow_reach } else { 0 };
        if inputs.any() { 1 + reach } else { 0 }
    }
}
