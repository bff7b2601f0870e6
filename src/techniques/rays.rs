//! The steps that cast rays, in frames that need rays.

use crate::gpu::step::Step;
use crate::gpu::uniforms::casting::CastSamples;
use crate::host::needs::RayInputs;
use crate::passes::rays::{bounce, classify, trace};

/// The step that lists the tiles in which rays are needed.
pub(super) fn classified(inputs: RayInputs) -> Option<Step> {
    inputs.any().then(|| (&classify::CLASSIFY).into())
}

/// The steps that cast rays from these samples.
pub(super) fn cast(inputs: RayInputs, samples: CastSamples) -> impl Iterator<Item = Step> {
    let [trace, bounce] = match samples {
        CastSamples::First => [&trace::FIRST, &bounce::FIRST],
        CastSamples::Full => [&trace::FULL, &bounce::FULL],
        CastSamples::Planned => [&trace::PLANNED, &bounce::PLANNED],
        CastSamples::Audited => [&trace::AUDITED, &bounce::AUDITED],
        CastSamples::Geometric => [&trace::GEOMETRIC, &bounce::GEOMETRIC],
        CastSamples::Points(_) => [&trace::POINTS, &bounce::POINTS],
    };
    let wanted = [(inputs.shadows, trace), (inputs.secondary, bounce)];
    wanted.into_iter().filter(|(is, _)| *is).map(move |(_, pass)| Step::cast(pass, samples))
}
