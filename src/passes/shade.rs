//! shade: shades the samples beyond the first, and stores their mean with the first.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "shade",
    base: Base::Shading,
    chunks: &[chunk::RANKS, chunk::RESULTS_PLANNED, include_str!("../../shaders/passes/shade.wgsl")],
};

const PLANNED: [Binding; 4] = [
    Binding::read(0, "daa_first", Slot::Part(Part::First)),
    Binding::read(1, "daa_plan", Slot::Part(Part::Plan)),
    Binding::write(2, "daa_color", Slot::Part(Part::Color)),
    Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
];

const SHADE: PassData = PassData {
    names: &["shade"],
    kind: PassKind::Shade,
    module: &MODULE,
    gbuffer: true,
    bindings: &PLANNED,
    stages: &[],
    rounds: Rounds::Once,
};

/// Shades every sample for `Full`, which has neither first samples nor a plan.
pub(crate) static FULL: PassData = PassData {
    bindings: &[
        Binding::read(1, "daa_plan", Slot::Part(Part::Plan)).if_used(false),
        Binding::write(2, "daa_color", Slot::Part(Part::Color)),
        Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_shade_full", Grid::Tiles)],
    ..SHADE
};

/// Each pixel shades its own samples.
pub(crate) static LOOP: PassData = PassData { stages: &[Stage::new("daa_shade_loop", Grid::Tiles)], ..SHADE };

/// A tile's samples are shaded end to end.
pub(crate) static TILED: PassData = PassData { stages: &[Stage::new("daa_shade_tiled", Grid::Tiles)], ..SHADE };
