//! trace: traces shadow rays from the samples that will be shaded.

use super::{Cast, over_audited, over_points, over_tiles};
use crate::gpu::binding::{PassData, by_level};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Part, PassKind, Rounds};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "trace",
    base: Base::Casting { shades: false },
    chunks: &[chunk::RANKS, chunk::RESULTS_PLANNED, include_str!("../../../shaders/rays/trace.wgsl")],
};

const FOUND: (&str, Part) = ("daa_shadows", Part::Shadows);

const ENTRY: &str = "daa_trace_main";

/// Every sample, for `Full`.
pub(crate) static FULL: PassData = PassData {
    names: &["trace"],
    kind: PassKind::Trace,
    module: &MODULE,
    gbuffer: true,
    bindings: &Cast::TILES.bindings(FOUND),
    stages: &[over_tiles(ENTRY, 0)],
    rounds: Rounds::Once,
};

/// The first samples.
pub(crate) static FIRST: PassData = PassData { names: &["trace first"], ..FULL };

/// The samples that the plan has beyond the first.
pub(crate) static PLANNED: PassData = PassData { bindings: &Cast::PLANNED.bindings(FOUND), ..FULL };

/// The samples of audited tiles that were not planned.
pub(crate) static AUDITED: PassData = PassData {
    names: &["trace audited"],
    bindings: &Cast::AUDITED.bindings(FOUND),
    stages: &[over_audited(ENTRY)],
    ..FULL
};

/// The geometric samples beyond the first, for `Reconstructed`.
pub(crate) static GEOMETRIC: PassData = PassData { bindings: &Cast::GEOMETRIC.bindings(FOUND), ..FULL };

/// The chosen points of a lattice.
pub(crate) static POINTS: PassData = PassData {
    names: by_level!("trace"),
    bindings: &Cast::POINTS.bindings(FOUND),
    stages: &[over_points(ENTRY)],
    ..FULL
};
