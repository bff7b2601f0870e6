//! The steps that cast rays, in frames that need rays.

use crate::gpu::step::Step;
use crate::gpu::uniforms::casting::CastSamples;
use crate::host::needs::RayInputs;
use crate::passes::rays::{classify, places, reflect, trace};

/// The step that lists the tiles in which rays are needed.
pub(super) fn classified(inputs: RayInputs) -> Option<Step> {
    inputs.any().then(|| (&classify::CLASSIFY).into())
}

/// The steps that cast rays from these samples.
pub(super) fn cast(inputs: RayInputs, samples: CastSamples) -> impl Iterator<Item = Step> {
    let [trace, reflect] = match samples {
        CastSamples::First => [&trace::FIRST, &reflect::FIRST],
        CastSamples::Full => [&trace::FULL, &reflect::FULL],
        CastSamples::Planned => [&trace::PLANNED, &reflect::PLANNED],
        CastSamples::Audited => [&trace::AUDITED, &reflect::AUDITED],
        CastSamples::Geometric => [&trace::GEOMETRIC, &reflect::GEOMETRIC],
        CastSamples::Points(_) => [&trace::POINTS, &reflect::POINTS],
    };
    let wanted = [(inputs.shadows, trace), (inputs.reflections, reflect)];
    wanted.into_iter().filter(|(is, _)| *is).map(move |(_, pass)| Step::cast(pass, samples))
}

/// The steps that cast rays from the samples that a plan has beyond the first, and first find the places of their
/// results.
pub(super) fn cast_planned(inputs: RayInputs) -> impl Iterator<Item = Step> {
    let places = inputs.any().then(|| (&places::PLACES).into());
    places.into_iter().chain(cast(inputs, CastSamples::Planned))
}
