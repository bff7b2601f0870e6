//! first: shades the rank-0 sample of every window into S.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "first",
    base: Base::Shading,
    chunks: &[chunk::RESULTS_BY_RANK, include_str!("../../shaders/passes/first.wgsl")],
};

pub(crate) static FIRST: PassData = PassData {
    names: &["first"],
    kind: PassKind::First,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::write(0, "daa_first", Slot::Part(Part::First)),
        Binding::write(1, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_first_main", Grid::Tiles)],
    rounds: Rounds::Once,
};
