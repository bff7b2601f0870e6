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
mod windowed;

use crate::gpu::step::Step;
use crate::host::needs::RayInputs;
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
    }
}

/// The passes of a frame, in order.
pub(crate) fn steps(settings: &Settings, inputs: RayInputs) -> Vec<Step> {
    of(settings.technique).steps(settings, inputs).0
}
