//! points: shades the chosen points of a lattice.

use crate::gpu::binding::{Binding, PassData, Slot, by_level};
use crate::gpu::modules::{Base, Module};
use crate::gpu::sizes::POINTS_BLOCK;
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "points",
    base: Base::Shading,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_BY_RANK,
        chunk::LATTICE,
        chunk::LATTICE_COLORS,
        chunk::LISTING,
        include_str!("../../../shaders/lattice/points.wgsl"),
    ],
};

pub(crate) static POINTS: PassData = PassData {
    names: by_level!("points"),
    kind: PassKind::Points,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::read(0, "daa_step", Slot::Step),
        Binding::update(1, "daa_points", Slot::Part(Part::LatticePoints)),
        Binding::update(2, "daa_lattice_colors", Slot::Part(Part::LatticeColors)),
        Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_points_main", Grid::Points(POINTS_BLOCK))],
    rounds: Rounds::Once,
};
