//! lattice_to_pixels: computes S from the finest lattice, and chooses the windows that are refined beyond it.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "lattice_to_pixels",
    base: Base::GBuffer,
    chunks: &[
        chunk::LATTICE,
        chunk::LATTICE_COLORS,
        chunk::BILATERAL,
        chunk::DISPLAY,
        chunk::RESIDUAL,
        include_str!("../../../shaders/lattice/lattice_to_pixels.wgsl"),
    ],
};

const fn bindings(counted: bool) -> [Binding; 6] {
    [
        Binding::read(0, "daa_step", Slot::Step),
        Binding::update(1, "daa_points", Slot::Part(Part::LatticePoints)).only_read(),
        Binding::update(2, "daa_lattice_colors", Slot::Part(Part::LatticeColors)).only_read(),
        Binding::write(3, "daa_first", Slot::Part(Part::First)),
        Binding::write(4, "daa_counts", Slot::Part(Part::WindowCounts)).if_used(counted),
        Binding::write(5, "daa_plan", Slot::Part(Part::Plan)).if_used(!counted),
    ]
}

/// For frames without further refinement: it writes the plan itself.
pub(crate) static FINAL: PassData = PassData {
    names: &["lattice_to_pixels"],
    kind: PassKind::LatticeToPixels,
    module: &MODULE,
    gbuffer: true,
    bindings: &bindings(false),
    stages: &[Stage::new("daa_lattice_to_pixels_main", Grid::Tiles)],
    rounds: Rounds::Once,
};

/// For frames with further refinement: it writes the counts, and `plan` follows.
pub(crate) static COUNTED: PassData = PassData { bindings: &bindings(true), ..FINAL };
