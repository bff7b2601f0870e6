//! The crate's chunks of WGSL that several modules share.

pub(crate) const CONTRACT: &str = include_str!("../../shaders/contract.wgsl");
pub(crate) const OCTAHEDRAL: &str = include_str!("../../shaders/shared/octahedral.wgsl");
pub(crate) const FRAME: &str = include_str!("../../shaders/shared/frame.wgsl");
pub(crate) const PLAN_WORD: &str = include_str!("../../shaders/shared/plan_word.wgsl");
pub(crate) const SAMPLE: &str = include_str!("../../shaders/shared/sample.wgsl");
pub(crate) const MEAN: &str = include_str!("../../shaders/shared/mean.wgsl");
pub(crate) const STATISTICS: &str = include_str!("../../shaders/shared/statistics.wgsl");
pub(crate) const EVALUATE: &str = include_str!("../../shaders/shared/evaluate.wgsl");
pub(crate) const SHARED_EXPONENT: &str = include_str!("../../shaders/shared/shared_exponent.wgsl");
pub(crate) const SHADOWS: &str = include_str!("../../shaders/swap/shadows.wgsl");
pub(crate) const SHADOWS_NONE: &str = include_str!("../../shaders/swap/shadows_none.wgsl");
pub(crate) const REFLECTIONS: &str = include_str!("../../shaders/swap/reflections.wgsl");
pub(crate) const REFLECTIONS_NONE: &str = include_str!("../../shaders/swap/reflections_none.wgsl");
pub(crate) const TABLE_NONE: &str = include_str!("../../shaders/swap/table_none.wgsl");
pub(crate) const TABLE_ARRAYS: &str = include_str!("../../shaders/swap/table_arrays.wgsl");
pub(crate) const TABLE_BINDINGS: &str = include_str!("../../shaders/swap/table_bindings.wgsl");
pub(crate) const RAYS_SOFTWARE: &str = include_str!("../../shaders/swap/rays_software.wgsl");
pub(crate) const RAYS_QUERY: &str = include_str!("../../shaders/swap/rays_query.wgsl");
pub(crate) const RAYS: &str = include_str!("../../shaders/rays/rays.wgsl");
pub(crate) const CASTING: &str = include_str!("../../shaders/rays/casting.wgsl");
pub(crate) const LATTICE: &str = include_str!("../../shaders/lattice/lattice.wgsl");
pub(crate) const LISTING: &str = include_str!("../../shaders/lattice/listing.wgsl");

/// All chunks.
pub(crate) const ALL: [&str; 22] = [
    CONTRACT,
    OCTAHEDRAL,
    FRAME,
    PLAN_WORD,
    SAMPLE,
    MEAN,
    STATISTICS,
    EVALUATE,
    SHARED_EXPONENT,
    SHADOWS,
    SHADOWS_NONE,
    REFLECTIONS,
    REFLECTIONS_NONE,
    TABLE_NONE,
    TABLE_ARRAYS,
    TABLE_BINDINGS,
    RAYS_SOFTWARE,
    RAYS_QUERY,
    RAYS,
    CASTING,
    LATTICE,
    LISTING,
];
