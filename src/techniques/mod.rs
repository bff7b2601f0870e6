//! The techniques, a file each: their check of a frame, their part of the constants, their passes in order, and the
//! meaning of their counters.

mod full;
mod image;
mod method;
mod multi_resolution;
mod planned;
mod rays;
mod reconstructed;
mod selective;
mod single;
mod surfaces;
mod windowed;

use crate::gpu::step::Step;
use crate::host::needs::RayInputs;
use crate::host::plan::PlanWord;
use crate::settings::{Settings, Technique};
use method::Method;

pub(crate) use method::{Effort, Windows};

/// The implementation of a technique.
pub(crate) fn of(technique: Technique) -> &'static dyn Method {
    match technique {
        Technique::Full => &full::Full,
        Technique::Single => &single::Single,
        Technique::Windowed => &windowed::Windowed,
        Technique::Reconstructed => &reconstructed::Reconstructed,
        Technique::Selective => &selective::Selective,
        Technique::MultiResolution => &multi_resolution::MultiResolution,
        Technique::Surfaces => &surfaces::Surfaces,
    }
}

/// The passes of a frame, in order.
pub(crate) fn steps(settings: &Settings, inputs: RayInputs) -> Vec<Step> {
    of(settings.technique).steps(settings, inputs).0
}

/// The places of a window's shaded samples, in the order in which they are shaded, from the window's word of the plan.
/// `None` if the plan has only their number, [`PlanWord::k`]: with [`Technique::Reconstructed`], which shades what its
/// neighbours don't speak for.
pub fn shaded_places(settings: &Settings, m: u32, word: PlanWord) -> Option<Vec<(u8, u8)>> {
    let technique = of(settings.technique);
    let order = technique.order(settings, m);
    let ranks = technique.shaded(settings, m, word)?;
    Some(ranks.into_iter().filter_map(|rank| order.get(rank).copied()).collect())
}

/// The places of a window's samples in the order of their ranks, as the settings' technique has it:
/// `sample_order(..)[rank] = (x, y)`.
///
/// # Panics
/// If m is not in 1..=8.
pub fn sample_order(settings: &Settings, m: u32) -> Vec<(u8, u8)> {
    of(settings.technique).order(settings, m)
}
