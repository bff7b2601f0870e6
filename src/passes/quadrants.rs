//! quadrants: shades the samples of active quadrants, and stores their mean with the first samples.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::gpu::sizes::WORK_GROUPS_AT;
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "quadrants",
    base: Base::Shading,
    chunks: &[chunk::RANKS, chunk::RESULTS_PLANNED, chunk::WORK, include_str!("../../shaders/passes/quadrants.wgsl")],
};

const BINDINGS: [Binding; 6] = [
    Binding::read(0, "daa_first", Slot::Part(Part::First)),
    Binding::read(1, "daa_plan", Slot::Part(Part::Plan)),
    Binding::write(2, "daa_color", Slot::Part(Part::Color)),
    Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
    Binding::read(4, "daa_list", Slot::Part(Part::PixelListEntries)),
    Binding::read(5, "daa_work", Slot::Part(Part::PixelListWork)),
];

const LISTED: Stage =
    Stage::new("daa_quadrants_active", Grid::Indirect { part: Part::PixelListWork, offset: WORK_GROUPS_AT });

/// Processes only pixels with an active quadrant.
pub(crate) static ACTIVE: PassData = PassData {
    names: &["quadrants"],
    kind: PassKind::Quadrants,
    module: &MODULE,
    gbuffer: true,
    bindings: &BINDINGS,
    stages: &[LISTED],
    rounds: Rounds::Once,
};

/// Processes all pixels, since inactive quadrants are interpolated.
pub(crate) static BETWEEN: PassData =
    PassData { stages: &[LISTED, Stage::new("daa_quadrants_between", Grid::Tiles)], ..ACTIVE };
