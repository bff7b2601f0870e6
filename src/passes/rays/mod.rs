//! The passes that cast rays.

pub(crate) mod classify;
pub(crate) mod reflect;
pub(crate) mod trace;

use crate::gpu::binding::{Binding, Slot};
use crate::gpu::sizes::TILE_CLASSES_BYTES;
use crate::host::graph::{Grid, Part, Stage};
use crate::passes::lattice::points::BLOCK;

/// The bindings that `trace` and `reflect` share. `found` is the part for their results with its name. `plan`, `tiles`
/// and `points` say whether the samples follow from these. `earlier` says whether the pass reads the results of earlier
/// rays.
pub(crate) struct Cast {
    pub found: (&'static str, Part),
    pub plan: bool,
    pub tiles: bool,
    pub points: bool,
    pub earlier: bool,
}

impl Cast {
    /// The bindings in the order of casting.wgsl.
    pub const fn bindings(self) -> [Binding; 9] {
        let (name, found) = self.found;
        let found = Slot::Part(found);
        [
            Binding::read(0, "daa_ray_nodes", Slot::RayNodes),
            Binding::read(1, "daa_ray_geometry", Slot::RayGeometry),
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
    Stage::new(entry, Grid::Points(BLOCK))
}
