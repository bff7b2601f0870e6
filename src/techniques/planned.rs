//! The steps from counts of samples to shaded windows, which `Windowed` and `MultiResolution` share.

use super::rays;
use crate::gpu::binding::PassData;
use crate::gpu::step::{Step, Steps};
use crate::host::needs::RayInputs;
use crate::passes::{list, max_filter, plan, shade, shade_listed};
use crate::settings::Execution;

/// How far a pixel's block of [`Execution::MaxFiltered`] reaches, in pixels.
pub(super) fn blocks(execution: Execution) -> u32 {
    if execution == Execution::MaxFiltered { max_filter::BLOCK - 1 } else { 0 }
}

/// Plans the samples beyond the first, casts their rays, and shades them.
pub(super) fn planned(execution: Execution, inputs: RayInputs) -> Vec<Step> {
    let (listed, shade): (Option<&'static PassData>, &'static PassData) = match execution {
        Execution::Loop | Execution::MaxFiltered => (None, &shade::LOOP),
        Execution::Tiled => (None, &shade::TILED),
        Execution::Bucketed => (Some(&list::PIXELS), &shade_listed::BUCKETED),
        Execution::Sorted => (Some(&list::PIXELS), &shade_listed::SORTED),
        Execution::Packed => (Some(&list::SAMPLES), &shade_listed::PACKED),
    };
    Steps::default()
        .then_if(execution == Execution::MaxFiltered, &max_filter::MAX_FILTER)
        .then(&plan::PLAN)
        .then_all(rays::cast_planned(inputs))
        .then_all(listed.map(Step::from))
        .then(shade)
        .0
}
