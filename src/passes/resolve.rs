//! resolve: writes the image into the host's target.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "resolve",
    base: Base::GBuffer,
    chunks: &[chunk::FULLSCREEN, include_str!("../../shaders/passes/resolve.wgsl")],
};

const RESOLVE: PassData = PassData {
    names: &["resolve"],
    kind: PassKind::Resolve,
    module: &MODULE,
    gbuffer: false,
    bindings: &[],
    stages: &[],
    rounds: Rounds::Once,
};

/// For frames whose image is S.
pub(crate) static FIRST: PassData = PassData {
    bindings: &[Binding::read(0, "daa_first", Slot::Part(Part::First))],
    stages: &[Stage::new("daa_resolve_first", Grid::Target)],
    ..RESOLVE
};

/// For frames in which every pixel has a mean.
pub(crate) static COLOR: PassData = PassData {
    bindings: &[Binding::read(1, "daa_color", Slot::Part(Part::Color))],
    stages: &[Stage::new("daa_resolve_color", Grid::Target)],
    ..RESOLVE
};

/// For frames with a plan: windows with k > 1 have a mean, the others their first sample.
pub(crate) static BY_PLAN: PassData = PassData {
    bindings: &[
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::read(1, "daa_color", Slot::Part(Part::Color)),
        Binding::read(2, "daa_plan", Slot::Part(Part::Plan)),
    ],
    stages: &[Stage::new("daa_resolve_by_plan", Grid::Target)],
    ..RESOLVE
};

/// For frames whose image is the lattice of pixels.
pub(crate) static LATTICE: PassData = PassData {
    bindings: &[Binding::read(3, "daa_lattice_colors", Slot::Part(Part::LatticeColors))],
    stages: &[Stage::new("daa_resolve_lattice", Grid::Target)],
    ..RESOLVE
};
