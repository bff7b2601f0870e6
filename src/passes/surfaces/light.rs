//! light: lights the surfaces of each window, once for each group of taps that are alike.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "light",
    base: Base::Lighting,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_PLANNED,
        chunk::DISPLAY,
        chunk::MASKS,
        chunk::TAPS,
        chunk::GROUPS,
        chunk::BLOCKS,
        chunk::HISTOGRAM,
        include_str!("../../../shaders/surfaces/light.wgsl"),
    ],
};

/// `traced`: in frames with rays, which have a plan of the samples that cast them.
const fn bindings(traced: bool) -> [Binding; 8] {
    [
        Binding::update(0, "daa_surfaces", Slot::Part(Part::SurfaceMasks)),
        Binding::read(1, "daa_plan", Slot::Part(Part::Plan)).if_used(traced),
        Binding::write(2, "daa_color", Slot::Part(Part::Color)),
        Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
        Binding::write(4, "daa_list_out", Slot::Part(Part::SurfaceList)),
        Binding::read(5, "daa_list", Slot::Part(Part::SurfaceList)),
        Binding::write(6, "daa_cut_list_out", Slot::Part(Part::SurfaceCutList)),
        Binding::read(7, "daa_cut_list", Slot::Part(Part::SurfaceCutList)),
    ]
}

/// The offset of `DaaWindowList::several`.
pub(crate) const SEVERAL_AT: u64 = 16;

const STAGES: &[Stage] = &[
    Stage {
        entry: "daa_light_corners",
        grid: Grid::Pixels(16),
        without: &["daa_list_out", "daa_list", "daa_cut_list_out", "daa_cut_list"],
    },
    Stage {
        entry: "daa_light_between",
        grid: Grid::Pixels(16),
        without: &["daa_list_out", "daa_list", "daa_cut_list_out", "daa_cut_list"],
    },
    Stage {
        entry: "daa_light_list",
        grid: Grid::TileRuns,
        without: &["daa_plan", "daa_color", "daa_statistics", "daa_list", "daa_cut_list"],
    },
    Stage {
        entry: "daa_light_one",
        grid: Grid::Indirect { part: Part::SurfaceList, offset: 0 },
        without: &["daa_list_out", "daa_cut_list"],
    },
    Stage {
        entry: "daa_light_group",
        grid: Grid::Indirect { part: Part::SurfaceCutList, offset: 0 },
        without: &["daa_color", "daa_list_out", "daa_list", "daa_cut_list_out"],
    },
    Stage {
        entry: "daa_light_cut",
        grid: Grid::Indirect { part: Part::SurfaceCutList, offset: 0 },
        without: &["daa_list_out", "daa_list", "daa_cut_list_out"],
    },
    Stage {
        entry: "daa_light_several",
        grid: Grid::Indirect { part: Part::SurfaceList, offset: SEVERAL_AT },
        without: &["daa_list_out", "daa_cut_list_out", "daa_cut_list"],
    },
    Stage {
        entry: "daa_light_count",
        grid: Grid::TileRuns,
        without: &["daa_plan", "daa_color", "daa_list_out", "daa_list", "daa_cut_list_out", "daa_cut_list"],
    },
];

/// Frames that trace nothing.
pub(crate) static LIGHT: PassData = PassData {
    names: &["light"],
    kind: PassKind::Light,
    module: &MODULE,
    gbuffer: true,
    bindings: &bindings(false),
    stages: STAGES,
    rounds: Rounds::Once,
};

/// Frames with rays.
pub(crate) static TRACED: PassData = PassData { bindings: &bindings(true), ..LIGHT };
