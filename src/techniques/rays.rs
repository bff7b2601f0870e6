//! The steps that cast rays, in frames that need rays.

use crate::gpu::step::Step;
use crate::gpu::uniforms::casting::CastSamples;
use crate::host::needs::RayInputs;
use crate::passes::rays::{classify, places, probe, reflect, trace};

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

/// The step that looks for shadows that first samples miss, so far from those that they hit.
pub(super) fn probed(inputs: RayInputs, reach: u32) -> Option<Step> {
    // It chooses samples itself, so the constants of first ones do.
    (inputs.shadows && reach > 0).then(|| Step::cast(&probe::PROBE, CastSamples::First))
}

/// The steps that cast rays from the samples that a plan has beyond the first, and first find the places of their
/// results.
pub(super) fn cast_planned(inputs: RayInputs) -> impl Iterator<Item = Step> {
    let places = inputs.any().then(|| (&places::PLACES).into());
    places.into_iter().chain(cast(inputs, CastSamples::Planned))
}
