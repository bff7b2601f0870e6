//! The passes that cast rays.

pub(crate) mod classify;
pub(crate) mod places;
pub(crate) mod probe;
pub(crate) mod reflect;
pub(crate) mod trace;

use crate::gpu::binding::{Binding, Slot};
use crate::gpu::sizes::{POINTS_BLOCK, TILE_CLASSES_BYTES};
use crate::host::graph::{Grid, Part, Stage};

/// Which samples cast rays. `plan`, `tiles` and `points` say whether they follow from these. `earlier` says whether the
/// results of earlier rays are read.
#[derive(Clone, Copy)]
pub(crate) struct Cast {
    plan: bool,
    tiles: bool,
    points: bool,
    earlier: bool,
}

impl Cast {
    /// The first samples of the listed tiles, or all of them.
    pub const TILES: Self = Self { plan: false, tiles: true, points: false, earlier: false };
    /// The samples that the plan has beyond the first.
    pub const PLANNED: Self = Self { plan: true, ..Self::TILES };
    /// The samples of audited tiles that were not planned.
    pub const AUDITED: Self = Self { tiles: false, ..Self::PLANNED };
    /// The geometric samples beyond the first.
    pub const GEOMETRIC: Self = Self { earlier: true, ..Self::TILES };
    /// The chosen points of a lattice.
    pub const POINTS: Self = Self { tiles: false, points: true, ..Self::TILES };

    /// The bindings that `trace` and `reflect` share, in the order of casting.wgsl. `found` is the part for their
    /// results, with its name.
    pub const fn bindings(self, found: (&'static str, Part)) -> [Binding; 9] {
        let (name, found) = (found.0, Slot::Part(found.1));
        [
            Binding::read(0, "daa_ray_tlas", Slot::RayTree),
            Binding::read(1, "daa_ray_meshes", Slot::RayMeshes),
            Binding::read(2, "daa_ray_top", Slot::RayTop),
            Binding::read(3, "daa_casting", Slot::Casting),
            Binding::read(4, "daa_plan", Slot::Part(Part::Plan)).if_used(self.plan),
            if self.earlier { Binding::update(5, name, found) } else { Binding::write(5, name, found) },
            Binding::write(6, "daa_statistics", Slot::Part(Part::Counters)),
            Binding::read(7, "daa_tile_lists", Slot::Part(Part::Tiles)).if_used(self.tiles),
            Binding::update(8, "daa_points", Slot::Part(Part::LatticePoints)).if_used(self.points),
        ]
    }
}

/// A stage over the tiles of a class that `classify` lists: 0 with a surface, 1 with one that sends rays.
pub(crate) const fn over_tiles(entry: &'static str, class: u64) -> Stage {
    // In a `DaaTileClass` the workgroups follow the count.
    Stage::new(entry, Grid::Indirect { part: Part::Tiles, offset: class * (TILE_CLASSES_BYTES / 2) + 4 })
}

/// A stage over the audited tiles.
pub(crate) const fn over_audited(entry: &'static str) -> Stage {
    Stage::new(entry, Grid::AuditedTiles)
}

/// A stage over the chosen points of a lattice.
pub(crate) const fn over_points(entry: &'static str) -> Stage {
    Stage::new(entry, Grid::Points(POINTS_BLOCK))
}
