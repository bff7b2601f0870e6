//! plan: lays out the samples of each tile, and counts what the frame shades.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "plan",
    base: Base::GBuffer,
    chunks: &[chunk::TILE_SUM, chunk::HISTOGRAM, include_str!("../../shaders/passes/plan.wgsl")],
};

pub(crate) static PLAN: PassData = PassData {
    names: &["plan"],
    kind: PassKind::Plan,
    module: &MODULE,
    gbuffer: false,
    bindings: &[
        Binding::read(0, "daa_counts", Slot::Part(Part::WindowCounts)),
        Binding::write(1, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(2, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_plan_main", Grid::Tiles)],
    rounds: Rounds::Once,
};
