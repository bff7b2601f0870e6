//! audit of `Surfaces`: measures the error of the finished image in some of its tiles.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "audit surfaces",
    base: Base::Shading,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_PLANNED,
        chunk::AUDITS,
        include_str!("../../../shaders/surfaces/audit.wgsl"),
    ],
};

/// `traced`: in frames with rays, which have a plan of the samples that cast them.
const fn bindings(traced: bool) -> [Binding; 4] {
    [
        Binding::read(0, "daa_color", Slot::Part(Part::Color)),
        Binding::write(1, "daa_statistics", Slot::AuditedCounters),
        Binding::write(2, "daa_audits", Slot::Audits),
        Binding::read(3, "daa_plan", Slot::Part(Part::Plan)).if_used(traced),
    ]
}

/// Frames that trace nothing.
pub(crate) static AUDIT: PassData = PassData {
    names: &["audit"],
    kind: PassKind::Audit,
    module: &MODULE,
    gbuffer: true,
    bindings: &bindings(false),
    stages: &[Stage::new("daa_audit_surfaces", Grid::AuditedTiles)],
    rounds: Rounds::Once,
};

/// Frames with rays.
pub(crate) static TRACED: PassData = PassData { bindings: &bindings(true), ..AUDIT };
