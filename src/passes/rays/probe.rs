//! probe: looks for shadows that first samples miss, near those that they hit.

use super::{Cast, over_tiles};
use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "probe",
    base: Base::Casting { shades: false },
    chunks: &[chunk::RANKS, chunk::RESULTS_PLANNED, include_str!("../../../shaders/rays/probe.wgsl")],
};

pub(crate) static PROBE: PassData = PassData {
    names: &["probe"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &{
        let [a, b, c, d, e, f, g, h, i] = Cast::GEOMETRIC.bindings(("daa_shadows", Part::Shadows));
        [a, b, c, d, e, f, g, h, i, Binding::write(9, "daa_probed", Slot::Part(Part::Plan))]
    },
    stages: &[Stage { without: &["daa_plan", "daa_points"], ..over_tiles("daa_probe_main", 0) }],
    rounds: Rounds::Once,
};
