//! cover: gathers the samples of each window into surfaces.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "cover",
    base: Base::Found,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_BY_RANK,
        chunk::DISPLAY,
        chunk::MASKS,
        include_str!("../../../shaders/surfaces/cover.wgsl"),
    ],
};

/// The bindings, after `probe` or without it.
const fn bindings(probed: bool) -> [Binding; 3] {
    [
        Binding::write(0, "daa_surfaces", Slot::Part(Part::SurfaceMasks)),
        Binding::write(1, "daa_counts", Slot::Part(Part::WindowCounts)),
        Binding::read(2, "daa_probed", Slot::Part(Part::Plan)).if_used(probed),
    ]
}

pub(crate) static COVER: PassData = PassData {
    names: &["cover"],
    kind: PassKind::Cover,
    module: &MODULE,
    gbuffer: true,
    bindings: &bindings(false),
    stages: &[Stage::new("daa_cover_main", Grid::Tiles)],
    rounds: Rounds::Once,
};

/// The same after `probe`.
pub(crate) static PROBED: PassData = PassData { bindings: &bindings(true), ..COVER };
