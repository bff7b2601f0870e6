//! reflect: traces mirrored and refracted rays from samples whose material sends rays.

use super::{Cast, over_audited, over_points, over_tiles};
use crate::gpu::binding::{Binding, PassData, Slot, by_level};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Part, PassKind, Rounds};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "reflect",
    base: Base::Casting { shades: true },
    chunks: &[chunk::RANKS, chunk::RESULTS_PLANNED, include_str!("../../../shaders/rays/reflect.wgsl")],
};

/// The bindings of a pass that casts rays, and the materials that send rays.
const fn bindings(cast: Cast) -> [Binding; 10] {
    let [a, b, c, d, e, f, g, h, i] = cast.bindings(FOUND);
    [a, b, c, d, e, f, g, h, i, Binding::read(9, "daa_reflective", Slot::Reflective)]
}

const FOUND: (&str, Part) = ("daa_reflections", Part::Reflections);

const ENTRY: &str = "daa_reflect_main";

/// Every sample, for `Full`.
pub(crate) static FULL: PassData = PassData {
    names: &["reflect"],
    kind: PassKind::Reflect,
    module: &MODULE,
    gbuffer: true,
    bindings: &bindings(Cast::TILES),
    stages: &[over_tiles(ENTRY, 1)],
    rounds: Rounds::Once,
};

/// The first samples.
pub(crate) static FIRST: PassData = PassData { names: &["reflect first"], ..FULL };

/// The samples that the plan has beyond the first.
pub(crate) static PLANNED: PassData = PassData { bindings: &bindings(Cast::PLANNED), ..FULL };

/// The samples of audited tiles that were not planned.
pub(crate) static AUDITED: PassData = PassData {
    names: &["reflect audited"],
    bindings: &bindings(Cast::AUDITED),
    stages: &[over_audited(ENTRY)],
    ..FULL
};

/// The geometric samples beyond the first, for `Reconstructed`.
pub(crate) static GEOMETRIC: PassData = PassData { bindings: &bindings(Cast::GEOMETRIC), ..FULL };

/// The chosen points of a lattice.
pub(crate) static POINTS: PassData =
    PassData { names: by_level!("reflect"), bindings: &bindings(Cast::POINTS), stages: &[over_points(ENTRY)], ..FULL };
