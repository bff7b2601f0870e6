//! `Windowed`: shades k samples of each window, by how much its samples differ (Holländer, Boubekeur, Eisemann 2013).

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows};
use super::planned::{blocks, planned};
use super::rays;
use crate::gpu::binding::PassData;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::Steps;
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::{FrameUniform, WindowedUniform, flag};
use crate::host::needs::RayInputs;
use crate::host::statistics::Counters;
use crate::passes::{audit, first, metrics, resolve};
use crate::settings::{DepthMeasure, Execution, Goal, LuminanceCurve, Settings};
use crate::window;

pub(super) struct Windowed;

impl Method for Windowed {
    fn uniform(&self, settings: &Settings, m: u32, effort: Option<Effort>, uniform: &mut FrameUniform) {
        let at = |effort: f32| settings.windowed.at_effort(effort, m);
        let w = effort.map_or(settings.windowed, |e| at(e.effort));
        uniform.flag(flag::DEPTH_PLANE, w.depth == DepthMeasure::Discontinuity);
        uniform.flag(flag::TWO_SIDED, w.two_sided);
        uniform.flag(flag::LUMINANCE_PERCEPTUAL, w.luminance == LuminanceCurve::Perceptual);
        uniform.flag(flag::LUMINANCE_CENTRE, w.luminance_centre);
        uniform.flag(flag::LUMINANCE_CHANNELS, w.luminance_channels);
        uniform.flag(flag::EDGE_AWARE_FIRST, w.edge_aware_first);
        uniform.around = blocks(settings.execution);
        uniform.footprint = w.footprint;
        uniform.surfaces.shadow_reach = w.shadow_reach;
        uniform.least_samples = w.least_samples;
        uniform.tile_limit = w.tile_limit;
        uniform.windowed = WindowedUniform {
            depth_scale: w.depth_scale,
            normal_scale: w.normal_scale,
            luminance_scale: w.luminance_scale * m as f32 / 4.0,
            luminance_min: w.luminance_min,
            luminance_edge: w.luminance_edge,
            identity_samples: w.identity_samples,
            shadow_samples: w.shadow_samples,
            user_scale: w.user_scale,
        };
        if let Some(e) = effort {
            uniform.audit.least_samples = at(e.effort - e.step).least_samples;
        }
        if w.centred {
            uniform.set_centres(m, &window::order(m));
        }
    }

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let shown =
            Shown { image: &resolve::BY_PLAN, planned: true, surfaces: false, classified: inputs.any(), inputs };
        let probe = rays::probed(inputs, settings.windowed.shadow_reach);
        let metrics: &'static PassData = if probe.is_some() { &metrics::PROBED } else { &metrics::METRICS };
        let steps = Steps::default()
            .then_all(rays::classified(inputs))
            .then_all(rays::cast(inputs, CastSamples::First))
            .then_all(probe)
            .then(&first::FIRST)
            .then(metrics)
            .then_all(planned(settings.execution, inputs))
            .then(image_or_view(settings, &shown));
        if !matches!(settings.goal, Some(Goal::Error(_))) {
            return steps;
        }
        // The audit runs after the image, which does not wait for it.
        steps.then_all(rays::cast(inputs, CastSamples::Audited)).then(&audit::AUDIT)
    }

    fn casting(&self, _: &Settings, _: u32) -> CastingRanks {
        CastingRanks::Planned
    }

    fn count(&self, counters: &Counters, of: Windows) -> Counted {
        Counted::by_k(counters, of.n, counters.decided)
    }

    fn execution(&self, settings: &Settings) -> Option<Execution> {
        Some(settings.execution)
    }

    fn apron(&self, settings: &Settings, inputs: RayInputs) -> u32 {
        let reach = if inputs.shadows { settings.windowed.shadow_reach } else { 0 };
        reach.max(1) + blocks(settings.execution)
    }
}
