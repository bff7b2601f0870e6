//! list: builds a list of the frame's pixels, sorted by k, or of its samples.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "list",
    base: Base::GBuffer,
    chunks: &[chunk::WORK, chunk::SCAN, include_str!("../../shaders/passes/list.wgsl")],
};

const LIST: PassData = PassData {
    names: &["list"],
    kind: PassKind::List,
    module: &MODULE,
    gbuffer: false,
    bindings: &[],
    stages: &[],
    rounds: Rounds::Once,
};

/// The list of pixels, with a row for each k.
pub(crate) static PIXELS: PassData = PassData {
    bindings: &[
        Binding::read(0, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(1, "daa_rows", Slot::Part(Part::PixelListRows)),
        Binding::write(2, "daa_list", Slot::Part(Part::PixelListEntries)),
        Binding::write(3, "daa_work", Slot::Part(Part::PixelListWork)),
    ],
    stages: &[
        Stage::new("daa_list_count_pixels", Grid::TileRuns),
        Stage::new("daa_list_scan", Grid::Counts),
        Stage::new("daa_list_pixels", Grid::TileRuns),
    ],
    ..LIST
};

/// The list of samples, in one row.
pub(crate) static SAMPLES: PassData = PassData {
    bindings: &[
        Binding::read(0, "daa_plan", Slot::Part(Part::Plan)),
        Binding::write(1, "daa_rows", Slot::Part(Part::SampleListRows)),
        Binding::write(2, "daa_list", Slot::Part(Part::SampleListEntries)),
        Binding::write(3, "daa_work", Slot::Part(Part::SampleListWork)),
    ],
    stages: &[
        Stage::new("daa_list_count_samples", Grid::TileRuns),
        Stage::new("daa_list_scan", Grid::One),
        Stage::new("daa_list_samples", Grid::Tiles),
    ],
    ..LIST
};
