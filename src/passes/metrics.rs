//! metrics: computes how many samples of each window are shaded.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "metrics",
    base: Base::Found,
    chunks: &[chunk::RESULTS_BY_RANK, chunk::DISPLAY, include_str!("../../shaders/passes/metrics.wgsl")],
};

/// The bindings, after `probe` or without it.
const fn bindings(probed: bool) -> [Binding; 3] {
    [
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::write(1, "daa_counts", Slot::Part(Part::WindowCounts)),
        Binding::read(2, "daa_probed", Slot::Part(Part::Plan)).if_used(probed),
    ]
}

pub(crate) static METRICS: PassData = PassData {
    names: &["metrics"],
    kind: PassKind::Metrics,
    module: &MODULE,
    gbuffer: true,
    bindings: &bindings(false),
    stages: &[Stage::new("daa_metrics_main", Grid::Tiles)],
    rounds: Rounds::Once,
};

/// The same after `probe`.
pub(crate) static PROBED: PassData = PassData { bindings: &bindings(true), ..METRICS };
