//! `Reconstructed`: shades one sample a window, and gives the geometric samples the colours of shaded ones around them
//! (WSCG 2012).

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows, nothing};
use super::rays;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::Steps;
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::{FrameUniform, ReconstructUniform, flag};
use crate::host::needs::RayInputs;
use crate::host::plan::PlanWord;
use crate::host::statistics::Counters;
use crate::passes::{first, reconstruct, resolve};
use crate::settings::Settings;
use crate::window;

pub(super) struct Reconstructed;

/// Sets the bilateral weights, which `MultiResolution` may use, too.
pub(super) fn weights(settings: &Settings, m: u32, uniform: &mut FrameUniform) {
    let r = &settings.reconstructed;
    uniform.flag(flag::PLANES, r.planes);
    uniform.flag(flag::CUT_IDENTITY, r.cut_identity);
    uniform.flag(flag::CUT_SHADOW, r.cut_shadow);
    uniform.reconstruct = ReconstructUniform {
        samples: r.samples(m),
        depth_scale: r.depth_scale,
        normal_scale: r.normal_scale,
        contrast_scale: r.contrast_scale * m as f32 / 4.0,
        contrast_min: r.contrast_min,
        least_weight: r.least_weight,
        padding: [0; 2],
    };
}

impl Method for Reconstructed {
    fn uniform(&self, settings: &Settings, m: u32, _: Option<Effort>, uniform: &mut FrameUniform) {
        let r = &settings.reconstructed;
        weights(settings, m, uniform);
        uniform.flag(flag::OWN_FIRST, r.own_first);
        uniform.flag(flag::TRACE_ALL, r.trace_all);
        uniform.flag(flag::REFLECTIONS_APART, r.reflections_apart);
        uniform.footprint = r.footprint;
    }

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let shown = Shown { image: &resolve::COLOR, planned: true, surfaces: false, classified: inputs.any(), inputs };
        Steps::default()
            .then_all(rays::classified(inputs))
            .then_all(rays::cast(inputs, CastSamples::First))
            .then(&first::FIRST)
            .then_all(rays::cast(inputs, CastSamples::Geometric))
            .then(&reconstruct::RECONSTRUCT)
            .then(image_or_view(settings, &shown))
    }

    fn apron(&self, _: &Settings, _: RayInputs) -> u32 {
        1
    }

    fn order(&self, settings: &Settings, m: u32) -> Vec<(u8, u8)> {
        if settings.reconstructed.rotated_grid { window::rotated(m) } else { window::order(m) }
    }

    fn shaded(&self, _: &Settings, _: u32, _: PlanWord) -> Option<Vec<usize>> {
        None
    }

    fn casting(&self, settings: &Settings, m: u32) -> CastingRanks {
        CastingRanks::First(settings.reconstructed.samples(m))
    }

    fn count(&self, counters: &Counters, of: Windows) -> Counted {
        Counted::by_k(counters, of.n, nothing(of))
    }
}
