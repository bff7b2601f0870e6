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

pub(crate) static COVER: PassData = PassData {
    names: &["cover"],
    kind: PassKind::Cover,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::write(0, "daa_surfaces", Slot::Part(Part::SurfaceMasks)),
        Binding::write(1, "daa_counts", Slot::Part(Part::WindowCounts)),
    ],
    stages: &[Stage::new("daa_cover_main", Grid::Tiles)],
    rounds: Rounds::Once,
};
