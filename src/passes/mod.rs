//! The passes, each declared once: its shader, its bindings and its stages. They do not depend on each other or on the
//! frame's order.

pub(crate) mod audit;
pub(crate) mod check;
pub(crate) mod depth;
pub(crate) mod first;
pub(crate) mod lattice;
pub(crate) mod list;
pub(crate) mod max_filter;
pub(crate) mod metrics;
pub(crate) mod plan;
pub(crate) mod quadrants;
pub(crate) mod rays;
pub(crate) mod reconstruct;
pub(crate) mod resolve;
pub(crate) mod select;
pub(crate) mod shade;
pub(crate) mod shade_listed;
pub(crate) mod surfaces;
pub(crate) mod view;

use crate::gpu::binding::PassData;
use crate::host::gbuffer;
use crate::wgsl::chunk;

/// All passes.
pub(crate) static ALL: &[&PassData] = &[
    &audit::AUDIT,
    &check::CHECK,
    &depth::NEAREST,
    &depth::FARTHEST,
    &depth::FIRST,
    &first::FIRST,
    &lattice::lattice_to_pixels::FINAL,
    &lattice::lattice_to_pixels::COUNTED,
    &lattice::points::POINTS,
    &lattice::refine::COLORS,
    &lattice::refine::RAYS,
    &list::PIXELS,
    &list::SAMPLES,
    &max_filter::MAX_FILTER,
    &metrics::METRICS,
    &metrics::PROBED,
    &plan::PLAN,
    &quadrants::ACTIVE,
    &quadrants::BETWEEN,
    &rays::reflect::FIRST,
    &rays::reflect::FULL,
    &rays::reflect::PLANNED,
    &rays::reflect::AUDITED,
    &rays::reflect::GEOMETRIC,
    &rays::reflect::POINTS,
    &rays::classify::CLASSIFY,
    &rays::places::PLACES,
    &rays::probe::PROBE,
    &rays::trace::FIRST,
    &rays::trace::FULL,
    &rays::trace::PLANNED,
    &rays::trace::AUDITED,
    &rays::trace::GEOMETRIC,
    &rays::trace::POINTS,
    &reconstruct::RECONSTRUCT,
    &resolve::FIRST,
    &resolve::COLOR,
    &resolve::BY_PLAN,
    &resolve::LATTICE,
    &select::SELECT,
    &shade::FULL,
    &shade::LOOP,
    &shade::TILED,
    &shade_listed::SORTED,
    &shade_listed::BUCKETED,
    &shade_listed::PACKED,
    &surfaces::cover::COVER,
    &surfaces::cover::PROBED,
    &surfaces::light::LIGHT,
    &surfaces::light::TRACED,
    &surfaces::audit::AUDIT,
    &surfaces::audit::TRACED,
    &view::GBUFFER,
    &view::SURFACES,
    &view::FIRST,
    &view::PLAN,
    &view::UNPLANNED,
    &view::LIT,
    &view::TAPS,
    &view::TILES,
    &view::SHADOWS,
    &view::RAYS,
    &view::NOTHING,
];

/// All texts of the crate's WGSL, each once. A host that caches results can tell by them whether the shaders have
/// changed.
pub fn shader_texts() -> Vec<&'static str> {
    let own = ALL.iter().flat_map(|pass| pass.module.chunks.iter().copied());
    let mut all: Vec<_> = chunk::ALL.iter().copied().chain([gbuffer::PACK]).chain(own).collect();
    all.sort_unstable();
    all.dedup();
    all
}
