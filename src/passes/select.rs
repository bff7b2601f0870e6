//! select: chooses the quadrants of each pixel of which more samples are shaded.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "select",
    base: Base::Found,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_BY_RANK,
        chunk::TILE_SUM,
        chunk::DISPLAY,
        chunk::HISTOGRAM,
        include_str!("../../shaders/passes/select.wgsl"),
    ],
};

pub(crate) static SELECT: PassData = PassData {
    names: &["select"],
    kind: PassKind::Select,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::write(1, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(2, "daa_statistics", Slot::Part(Part::Counters)),
        Binding::read(3, "daa_marks", Slot::Marks),
    ],
    stages: &[Stage::new("daa_select_main", Grid::Tiles)],
    rounds: Rounds::Once,
};
