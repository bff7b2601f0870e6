//! places: counts the planned samples before each tile, which says where the results of their rays lie.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "places",
    base: Base::GBuffer,
    chunks: &[chunk::SCAN, include_str!("../../../shaders/rays/places.wgsl")],
};

pub(crate) static PLACES: PassData = PassData {
    names: &["places"],
    kind: PassKind::Places,
    module: &MODULE,
    gbuffer: false,
    bindings: &[
        Binding::update(0, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(1, "daa_statistics", Slot::Part(Part::Counters)),
    ],
    stages: &[Stage::new("daa_places_main", Grid::One)],
    rounds: Rounds::Once,
};
