//! view: writes a debug view in place of resolve.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "view",
    base: Base::GBuffer,
    chunks: &[
        chunk::RANKS,
        chunk::RESULTS_PLANNED,
        chunk::MASKS,
        chunk::MEAN,
        chunk::DISPLAY,
        chunk::FULLSCREEN,
        include_str!("../../shaders/passes/view.wgsl"),
    ],
};

const VIEW: PassData = PassData {
    names: &["view"],
    kind: PassKind::View,
    module: &MODULE,
    gbuffer: false,
    bindings: &[],
    stages: &[],
    rounds: Rounds::Once,
};

/// A channel of the G-buffer.
pub(crate) static GBUFFER: PassData =
    PassData { gbuffer: true, stages: &[Stage::new("daa_view_gbuffer", Grid::Target)], ..VIEW };

/// The number of surfaces in each window.
pub(crate) static SURFACES: PassData =
    PassData { gbuffer: true, stages: &[Stage::new("daa_view_surfaces", Grid::Target)], ..VIEW };

/// S.
pub(crate) static FIRST: PassData = PassData {
    bindings: &[Binding::read(0, "daa_first", Slot::Part(Part::First))],
    stages: &[Stage::new("daa_view_first", Grid::Target)],
    ..VIEW
};

/// The plan.
pub(crate) static PLAN: PassData = PassData {
    bindings: &[Binding::read(1, "daa_plan", Slot::Part(Part::Plan))],
    stages: &[Stage::new("daa_view_plan", Grid::Target)],
    ..VIEW
};

/// The same for techniques without a plan.
pub(crate) static UNPLANNED: PassData = PassData { stages: &[Stage::new("daa_view_unplanned", Grid::Target)], ..VIEW };

/// The lights of each window of `Surfaces`.
pub(crate) static LIT: PassData = PassData {
    bindings: &[Binding::read(5, "daa_surface_masks", Slot::Part(Part::SurfaceMasks))],
    stages: &[Stage::new("daa_view_lit", Grid::Target)],
    ..VIEW
};

/// The taps of each window of `Surfaces`.
pub(crate) static TAPS: PassData = PassData { stages: &[Stage::new("daa_view_taps", Grid::Target)], ..LIT };

/// The tiles for which rays were dispatched.
pub(crate) static TILES: PassData = PassData {
    bindings: &[Binding::read(2, "daa_tile_lists", Slot::Part(Part::Tiles))],
    stages: &[Stage::new("daa_view_tiles", Grid::Target)],
    ..VIEW
};

/// The lights that reach the first samples.
pub(crate) static SHADOWS: PassData = PassData {
    gbuffer: true,
    bindings: &[Binding::read(3, "daa_shadows", Slot::Part(Part::Shadows))],
    stages: &[Stage::new("daa_view_shadows", Grid::Target)],
    ..VIEW
};

/// The number of rays that the samples sent.
pub(crate) static RAYS: PassData = PassData {
    bindings: &[
        Binding::read(1, "daa_plan", Slot::Part(Part::Plan)),
        Binding::read(3, "daa_shadows", Slot::Part(Part::Shadows)),
        Binding::read(4, "daa_reflections", Slot::Part(Part::Reflections)),
    ],
    stages: &[Stage::new("daa_view_rays", Grid::Target)],
    ..VIEW
};

/// Views of rays in frames that trace none.
pub(crate) static NOTHING: PassData = PassData { stages: &[Stage::new("daa_view_nothing", Grid::Target)], ..VIEW };
