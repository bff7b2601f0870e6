//! trace: traces shadow rays from the samples that will be shaded.

use super::{Cast, over_audited, over_points, over_tiles};
use crate::gpu::binding::{PassData, by_level};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Part, PassKind, Rounds};

static MODULE: Module = Module {
    name: "trace",
    base: Base::Casting { shades: false },
    chunks: &[include_str!("../../../shaders/rays/trace.wgsl")],
};

const FOUND: (&str, Part) = ("daa_shadows", Part::Shadows);

/// The first samples.
pub(crate) static FIRST: PassData = PassData {
    names: &["trace first"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast { found: FOUND, plan: false, tiles: true, points: false, earlier: false }.bindings(),
    stages: &[over_tiles("daa_trace_main", 0)],
    rounds: Rounds::Once,
};

/// Every sample, for `Full`.
pub(crate) static FULL: PassData = PassData {
    names: &["trace"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast { found: FOUND, plan: false, tiles: true, points: false, earlier: false }.bindings(),
    stages: &[over_tiles("daa_trace_main", 0)],
    rounds: Rounds::Once,
};

/// The samples that the plan has beyond the first.
pub(crate) static PLANNED: PassData = PassData {
    names: &["trace"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast { found: FOUND, plan: true, tiles: true, points: false, earlier: false }.bindings(),
    stages: &[over_tiles("daa_trace_main", 0)],
    rounds: Rounds::Once,
};

/// The samples of audited tiles that were not planned.
pub(crate) static AUDITED: PassData = PassData {
    names: &["trace audited"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast { found: FOUND, plan: true, tiles: false, points: false, earlier: false }.bindings(),
    stages: &[over_audited("daa_trace_main")],
    rounds: Rounds::Once,
};

/// The geometric samples beyond the first, for `Reconstructed`.
pub(crate) static GEOMETRIC: PassData = PassData {
    names: &["trace"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast { found: FOUND, plan: false, tiles: true, points: false, earlier: true }.bindings(),
    stages: &[over_tiles("daa_trace_main", 0)],
    rounds: Rounds::Once,
};

/// The chosen points of a lattice.
pub(crate) static POINTS: PassData = PassData {
    names: by_level!("trace"),
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast { found: FOUND, plan: false, tiles: false, points: true, earlier: false }.bindings(),
    stages: &[over_points("daa_trace_main")],
    rounds: Rounds::Once,
};
