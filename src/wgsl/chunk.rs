//! The crate's chunks of WGSL that several modules share.

macro_rules! chunks {
    ($($name:ident: $file:literal,)*) => {
        $(pub(crate) const $name: &str = include_str!(concat!("../../shaders/", $file));)*

        /// All chunks.
        pub(crate) const ALL: &[&str] = &[$($name),*];
    };
}

chunks! {
    CONTRACT: "contract.wgsl",
    OCTAHEDRAL: "shared/octahedral.wgsl",
    FRAME: "shared/frame.wgsl",
    PLAN_WORD: "shared/plan_word.wgsl",
    SAMPLE: "shared/sample.wgsl",
    STORED: "gbuffer/stored.wgsl",
    STORED_FRAME: "gbuffer/stored_frame.wgsl",
    STORED_FRAME_NORMALS: "gbuffer/stored_frame_normals.wgsl",
    STORED_FRAME_USER: "gbuffer/stored_frame_user.wgsl",
    STORED_FRAME_NONE: "gbuffer/stored_frame_none.wgsl",
    STORED_UV: "gbuffer/stored_uv.wgsl",
    STORED_UV_NONE: "gbuffer/stored_uv_none.wgsl",
    IDS_WIDE: "gbuffer/ids_wide.wgsl",
    IDS_NARROW: "gbuffer/ids_narrow.wgsl",
    VISIBILITY: "gbuffer/visibility.wgsl",
    USER: "shared/user.wgsl",
    TRIANGLE: "shared/triangle.wgsl",
    MEAN: "shared/mean.wgsl",
    STATISTICS: "shared/statistics.wgsl",
    EVALUATE: "shared/evaluate.wgsl",
    SHARED_EXPONENT: "shared/shared_exponent.wgsl",
    RANKS: "shared/ranks.wgsl",
    WORK: "shared/work.wgsl",
    BILATERAL: "shared/bilateral.wgsl",
    DISPLAY: "shared/display.wgsl",
    HISTOGRAM: "shared/histogram.wgsl",
    FULLSCREEN: "shared/fullscreen.wgsl",
    SHADOWS: "swap/shadows.wgsl",
    SHADOWS_NONE: "swap/shadows_none.wgsl",
    REFLECTIONS: "swap/reflections.wgsl",
    REFLECTIONS_NONE: "swap/reflections_none.wgsl",
    TABLE_NONE: "swap/table_none.wgsl",
    TABLE_ARRAYS: "swap/table_arrays.wgsl",
    TABLE_BINDINGS: "swap/table_bindings.wgsl",
    RAYS_SOFTWARE: "swap/rays_software.wgsl",
    RAYS_QUERY: "swap/rays_query.wgsl",
    LATTICE_COLORS: "swap/lattice_colors.wgsl",
    LATTICE_RAYS: "swap/lattice_rays.wgsl",
    RESULTS_BY_RANK: "swap/results_by_rank.wgsl",
    RESULTS_PLANNED: "swap/results_planned.wgsl",
    MASKS: "surfaces/masks.wgsl",
    TAPS: "surfaces/taps.wgsl",
    GROUPS: "surfaces/groups.wgsl",
    BLOCKS: "surfaces/blocks.wgsl",
    AUDITS: "shared/audits.wgsl",
    TILE_SUM: "shared/tile_sum.wgsl",
    SCAN: "shared/scan.wgsl",
    RAYS: "rays/rays.wgsl",
    CASTING: "rays/casting.wgsl",
    LATTICE: "lattice/lattice.wgsl",
    LISTING: "lattice/listing.wgsl",
    RESIDUAL: "lattice/residual.wgsl",
}
