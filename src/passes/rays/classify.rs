//! classify: lists the tiles in which rays are needed, by kind.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};

static MODULE: Module =
    Module { name: "classify", base: Base::GBuffer, chunks: &[include_str!("../../../shaders/rays/classify.wgsl")] };

pub(crate) static CLASSIFY: PassData = PassData {
    names: &["classify"],
    kind: PassKind::Classify,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::write(0, "daa_tile_lists", Slot::Part(Part::Tiles)),
        Binding::read(1, "daa_reflective", Slot::Reflective),
        Binding::write(2, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_classify_main", Grid::Tiles), Stage::new("daa_classify_finish", Grid::One)],
    rounds: Rounds::Once,
};
