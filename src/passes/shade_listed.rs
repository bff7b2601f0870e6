//! shade_listed: `shade` for the executions that run a list.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::gpu::sizes::{WORK_BYTES, WORK_GROUPS_AT};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "shade_listed",
    base: Base::Shading,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_PLANNED,
        chunk::WORK,
        include_str!("../../shaders/passes/shade.wgsl"),
        include_str!("../../shaders/passes/shade_listed.wgsl"),
    ],
};

const PIXELS: [Binding; 6] = [
    Binding::read(0, "daa_first", Slot::Part(Part::First)),
    Binding::read(1, "daa_plan", Slot::Part(Part::Plan)),
    Binding::write(2, "daa_color", Slot::Part(Part::Color)),
    Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
    Binding::read(4, "daa_list", Slot::Part(Part::PixelListEntries)),
    Binding::read(5, "daa_work", Slot::Part(Part::PixelListWork)),
];

const SHADE: PassData = PassData {
    names: &["shade"],
    kind: PassKind::Shade,
    module: &MODULE,
    gbuffer: true,
    bindings: &PIXELS,
    stages: &[],
    rounds: Rounds::Once,
};

/// Runs work 0, the whole list.
pub(crate) static SORTED: PassData = PassData {
    stages: &[Stage::new("daa_shade_pixels", Grid::Indirect { part: Part::PixelListWork, offset: WORK_GROUPS_AT })],
    ..SHADE
};

/// Runs work r + 1 in round r: row r, the pixels of one k.
pub(crate) static BUCKETED: PassData = PassData {
    stages: &[Stage::new(
        "daa_shade_pixels",
        Grid::Indirect { part: Part::PixelListWork, offset: WORK_BYTES + WORK_GROUPS_AT },
    )],
    rounds: Rounds::Counts,
    ..SHADE
};

/// Runs work b + 1 in round b: batch b, whose colours are added up before the next batch replaces them.
pub(crate) static PACKED: PassData = PassData {
    bindings: &[
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::read(1, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(2, "daa_color", Slot::Part(Part::Color)),
        Binding::write(3, "daa_statistics", Slot::Part(Part::Counters)),
        Binding::read(4, "daa_list", Slot::Part(Part::SampleListEntries)),
        Binding::read(5, "daa_work", Slot::Part(Part::SampleListWork)),
        Binding::update(6, "daa_colors", Slot::Part(Part::SampleListColors)),
        Binding::read(7, "daa_rows", Slot::Part(Part::SampleListRows)),
    ],
    stages: &[
        Stage {
            entry: "daa_shade_packed",
            grid: Grid::Indirect { part: Part::SampleListWork, offset: WORK_BYTES + WORK_GROUPS_AT },
            without: &["daa_first", "daa_color", "daa_rows"],
        },
        Stage { entry: "daa_shade_gather", grid: Grid::Tiles, without: &["daa_statistics", "daa_list"] },
    ],
    rounds: Rounds::Batches,
    ..SHADE
};
