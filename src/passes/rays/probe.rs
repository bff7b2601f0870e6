//! probe: looks for shadows that first samples miss, near those that they hit.

use super::{Cast, over_tiles};
use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Part, PassKind, Rounds};
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
        let [tree, meshes, top, casting, _, shadows, statistics, tiles, _] =
            Cast::GEOMETRIC.bindings(("daa_shadows", Part::Shadows));
        let probed = Binding::write(9, "daa_probed", Slot::Part(Part::Plan));
        [tree, meshes, top, casting, shadows, statistics, tiles, probed]
    },
    stages: &[over_tiles("daa_probe_main", 0)],
    rounds: Rounds::Once,
};
