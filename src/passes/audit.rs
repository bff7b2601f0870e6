//! audit: measures the error of the finished image in some of its tiles.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "audit",
    base: Base::Shading,
    chunks: &[chunk::RANKS, chunk::RESULTS_PLANNED, chunk::AUDITS, include_str!("../../shaders/passes/audit.wgsl")],
};

pub(crate) static AUDIT: PassData = PassData {
    names: &["audit"],
    kind: PassKind::Audit,
    module: &MODULE,
    gbuffer: true,
    bindings: &[
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::read(1, "daa_color", Slot::Part(Part::Color)),
        Binding::read(2, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(3, "daa_statistics", Slot::AuditedCounters),
        Binding::write(4, "daa_audits", Slot::Audits),
        Binding::read(5, "daa_counts", Slot::Part(Part::WindowCounts)),
    ],
    stages: &[Stage::new("daa_audit_main", Grid::AuditedTiles)],
    rounds: Rounds::Once,
};
