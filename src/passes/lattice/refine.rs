//! refine: chooses the points of a lattice that get their own sample, and interpolates the others.

use crate::gpu::binding::{Binding, PassData, Slot, by_level};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

const REFINE: &str = include_str!("../../../shaders/lattice/refine.wgsl");

static OF_COLORS: Module = Module {
    name: "refine",
    base: Base::Found,
    chunks: &[
        chunk::RESULTS_BY_RANK,
        chunk::LATTICE,
        chunk::LATTICE_COLORS,
        chunk::BILATERAL,
        chunk::DISPLAY,
        chunk::RESIDUAL,
        REFINE,
    ],
};

static OF_RAYS: Module = Module {
    name: "refine rays",
    base: Base::GBuffer,
    chunks: &[chunk::LATTICE, chunk::LATTICE_RAYS, chunk::BILATERAL, chunk::DISPLAY, chunk::RESIDUAL, REFINE],
};

/// Refines a lattice by the colours of its points.
pub(crate) static COLORS: PassData = PassData {
    names: by_level!("refine"),
    kind: PassKind::Refine,
    module: &OF_COLORS,
    gbuffer: true,
    bindings: &[
        Binding::read(0, "daa_step", Slot::Step),
        Binding::update(1, "daa_points", Slot::Part(Part::LatticePoints)),
        Binding::update(2, "daa_lattice_colors", Slot::Part(Part::LatticeColors)),
    ],
    stages: &[Stage::new("daa_refine_judge", Grid::Parents), Stage::new("daa_refine_main", Grid::Cells)],
    rounds: Rounds::Once,
};

/// Refines a lattice by the ray results of its points.
pub(crate) static RAYS: PassData = PassData {
    names: by_level!("refine rays"),
    kind: PassKind::Refine,
    module: &OF_RAYS,
    gbuffer: true,
    bindings: &[
        Binding::read(0, "daa_step", Slot::Step),
        Binding::update(1, "daa_points", Slot::Part(Part::LatticePoints)),
        Binding::update(2, "daa_shadows", Slot::Part(Part::Shadows)),
        Binding::update(3, "daa_reflections", Slot::Part(Part::Reflections)),
    ],
    stages: &[Stage::new("daa_refine_judge", Grid::Parents), Stage::new("daa_refine_main", Grid::Cells)],
    rounds: Rounds::Once,
};
