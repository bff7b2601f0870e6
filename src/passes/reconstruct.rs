//! reconstruct: gives geometric samples the colours of shaded ones around them.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "reconstruct",
    base: Base::Shading,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_BY_RANK,
        chunk::BILATERAL,
        chunk::DISPLAY,
        chunk::HISTOGRAM,
        include_str!("../../shaders/passes/reconstruct.wgsl"),
    ],
};

pub(crate) static RECONSTRUCT: PassData = PassData {
    names: &["reconstruct"],
    kind: PassKind::Reconstruct,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::write(1, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(2, "daa_color", Slot::Part(Part::Color)),
        Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_reconstruct_main", Grid::Tiles)],
    rounds: Rounds::Once,
};
