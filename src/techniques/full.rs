//! `Full`: shades every sample.

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows};
use super::rays;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::Steps;
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::{FrameUniform, flag};
use crate::host::needs::RayInputs;
use crate::host::plan::PlanWord;
use crate::host::statistics::Counters;
use crate::passes::{first, resolve, shade};
use crate::settings::{DebugView, Settings};

pub(super) struct Full;

impl Method for Full {
    fn uniform(&self, _: &Settings, _: u32, _: Option<Effort>, uniform: &mut FrameUniform) {
        uniform.flag(flag::FULL, true);
    }

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let shown = Shown { image: &resolve::COLOR, planned: false, surfaces: false, classified: inputs.any(), inputs };
        Steps::default()
            .then_all(rays::classified(inputs))
            .then_all(rays::cast(inputs, CastSamples::Full))
            .then_if(settings.view == DebugView::First, &first::FIRST)
            .then(&shade::FULL)
            .then(image_or_view(settings, &shown))
    }

    fn shaded(&self, _: &Settings, m: u32, _: PlanWord) -> Option<Vec<usize>> {
        Some((0..(m * m) as usize).collect())
    }

    fn casting(&self, _: &Settings, m: u32) -> CastingRanks {
        CastingRanks::First(m * m)
    }

    fn count(&self, _: &Counters, of: Windows) -> Counted {
        Counted::uniform(of.n, of)
    }
}
