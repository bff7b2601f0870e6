//! max_filter: gives every pixel the greatest k of its block of 6 × 6 pixels.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};

static MODULE: Module =
    Module { name: "max_filter", base: Base::GBuffer, chunks: &[include_str!("../../shaders/passes/max_filter.wgsl")] };

/// `DAA_BLOCK` of max_filter.wgsl: the number of pixels along one side of a block.
pub(crate) const BLOCK: u32 = 6;

pub(crate) static MAX_FILTER: PassData = PassData {
    names: &["max_filter"],
    kind: PassKind::MaxFilter,
    module: &MODULE,
    gbuffer: false,
    bindings: &[Binding::update(0, "daa_counts", Slot::Part(Part::WindowCounts))],
    stages: &[
        // 8 blocks along either side.
        Stage::new("daa_max_filter_main", Grid::Pixels(8 * BLOCK)),
    ],
    rounds: Rounds::Once,
};
