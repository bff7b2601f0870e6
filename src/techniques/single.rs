//! `Single`: shades one sample a pixel, as plain deferred shading does.

use super::image::{Shown, image_or_view};
use super::method::{Counted, Effort, Method, Windows};
use super::rays;
use crate::gpu::sizes::CastingRanks;
use crate::gpu::step::Steps;
use crate::gpu::uniforms::casting::CastSamples;
use crate::gpu::uniforms::frame::FrameUniform;
use crate::host::needs::RayInputs;
use crate::host::plan::PlanWord;
use crate::host::statistics::Counters;
use crate::passes::{first, resolve};
use crate::settings::Settings;

pub(super) struct Single;

impl Method for Single {
    fn uniform(&self, _: &Settings, _: u32, _: Option<Effort>, _: &mut FrameUniform) {}

    fn steps(&self, settings: &Settings, inputs: RayInputs) -> Steps {
        let shown = Shown { image: &resolve::FIRST, planned: false, surfaces: false, classified: inputs.any(), inputs };
        Steps::default()
            .then_all(rays::classified(inputs))
            .then_all(rays::cast(inputs, CastSamples::First))
            .then(&first::FIRST)
            .then(image_or_view(settings, &shown))
    }

    fn shaded(&self, _: &Settings, _: u32, _: PlanWord) -> Option<Vec<usize>> {
        Some(vec![0])
    }

    fn casting(&self, _: &Settings, _: u32) -> CastingRanks {
        CastingRanks::First(1)
    }

    fn count(&self, _: &Counters, of: Windows) -> Counted {
        Counted::uniform(1, of)
    }
}
