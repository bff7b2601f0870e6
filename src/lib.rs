//! Adaptive supersampling for deferred shading.
//!
//! A host renders its scene into a G-buffer with m × m samples per pixel. Of these n = m² samples this crate shades
//! only those that the image needs, with the host's own WGSL, and writes an image close to full supersampling into the
//! host's target. Each frame stands alone: no history, no motion vectors.
//!
//! ```text
//!                host                                   deferred-aa
//! scene ──raster──► G-buffer (m·w × m·h) ─┬─► first     shade the rank-0 sample of every window → S
//! `material`, `light` or `shade` (WGSL) ──┤   metrics   what differs inside the window, and between neighbours in S
//! Settings ───────────────────────────────┤   plan      how many samples of each window, and where
//! Needs: scene for rays, lights, mirrors ─┤   trace     shadow, mirrored and refracted rays (also before first)
//!                                         │   shade     the host's WGSL on those samples, and their mean
//!                                         └─► resolve   → target view
//! ```
//!
//! # Terms
//! - *Window*: the m × m samples of one pixel.
//! - *Rank*: the position of a sample in the order of its window; rank 0 is shaded first.
//! - *k*: the number of samples of a window that are shaded, 1 to n, the first included.
//! - *S*: the image of the first samples.
//! - *Sample ratio*: the number of shaded samples over n · w · h.
//!
//! # Integration
//! 1. [`DeferredAa::requirements`] says which features and limits to request of the device.
//! 2. [`DeferredAa::new`] takes the host's WGSL ([`Shading`]) and checks it; [`DeferredAa::resize`] creates the
//!    [`GBuffer`].
//! 3. Each frame the host renders into the G-buffer, with fragment shaders that pack their output with
//!    [`GBufferTier::pack_wgsl`], and calls [`DeferredAa::record`].
//!
//! Skies, transparent surfaces and gizmos are drawn over the image, with the depth that the node writes at the output's
//! size ([`Needs::depth`]).
//!
//! An image too large for the memory or the device is rendered in bands ([`DeferredAa::resize_banded`]).
//!
//! While a host is being written, [`DeferredAa::check_input`] finds probable mistakes in its input. A frame graph
//! records the [`DeferredAa::passes`] itself, and may [lend](DeferredAa::lend) its memory for the resources between
//! them.
//!
//! `examples/host.rs` in the repository is a complete host in under 120 lines.
//!
//! # Source
//! The techniques come from four papers; the code cites their sections.
//! - [`Technique::Windowed`]: M. Holländer, T. Boubekeur, E. Eisemann, "Adaptive Supersampling for Deferred
//!   Anti-Aliasing", Journal of Computer Graphics Techniques 2013.
//! - [`Technique::Selective`]: B. Jin, I. Ihm, B. Chang, C. Park, W. Lee, S. Jung, "Selective and Adaptive
//!   Supersampling for Real-Time Ray Tracing", High-Performance Graphics 2009.
//! - [`Technique::Reconstructed`]: M. Chajdas, M. McGuire, D. Luebke, "Subpixel Reconstruction Antialiasing for
//!   Deferred Shading", I3D 2011, as extended to ray tracing at WSCG 2012.
//! - [`Technique::MultiResolution`]: the University of Alaska Fairbanks thesis on tri-adaptive sampling.
//!
//! [`Technique::Surfaces`] is the crate's own.

#![deny(missing_docs)]

mod goal;
mod gpu;
mod host;
mod node;
mod octahedral;
mod passes;
pub mod rays;
#[cfg(feature = "reference")]
pub mod reference;
mod settings;
mod techniques;
mod wgsl;
pub mod window;

pub use goal::{GoalProgress, GoalState};
pub use gpu::loans::{Lent, Physical};
pub use gpu::recording::Recording;
pub use gpu::step::Pass;
pub use host::band::{Band, Rect};
pub use host::check::{InputCounts, InputMistake, InputReport, Normal, NormalCounts};
pub use host::descriptor::{Descriptor, Shading};
pub use host::error::{
    BuildError, LendError, PipelineError, RecordError, ShadingError, ShadingErrorKind, SizeError, TableError,
};
pub use host::frame::{Camera, Frame};
pub use host::gbuffer::{self, Channels, GBuffer, GBufferTier, Ids};
pub use host::graph::{
    Grid, LatticeShape, Lifetime, Part, PartInfo, PartKind, PassInfo, PassKind, Resource, ResourceSet, Rounds, Stage,
};
pub use host::intermediates::Intermediates;
pub use host::needs::{CastingLight, Depth, MAX_CASTING_LIGHTS, Needs, ObjectImportance};
pub use host::plan::{Attribute, DecidedBy, PlanWord, Slots, SurfaceWord};
pub use host::requirements::{Memory, Requirements};
pub use host::shader::Shader;
pub use host::statistics::{
    DecidedCounts, PassTime, PointCounts, QuadrantCounts, Statistics, SurfaceCounts, TileCounts,
};
pub use host::table::{
    BINDING_FEATURES, MAX_CLASSES, MAX_SAMPLERS, TableSampler, TableTexture, TextureTable, TextureTier, classes,
};
pub use host::traced::Traced;
pub use node::DeferredAa;
pub use passes::shader_texts;
pub use settings::*;
pub use techniques::{sample_order, shaded_places};
pub use {glam, wgpu};

/// The index of the host's bind group: its WGSL binds at `@group(2)`.
pub const HOST_GROUP: u32 = 2;

/// The index of a second bind group of the host's, where no texture table takes it ([`TextureTier::None`]):
/// [`DeferredAa::with_groups`].
pub const SECOND_HOST_GROUP: u32 = 1;

/// All the WGSL that a host's shading may use, except for the texture table ([`DeferredAa::texture_wgsl`]). The node
/// appends it to the host's source; it is public for tools that parse that source by themselves.
pub const CONTRACT_WGSL: &str = wgsl::chunk::CONTRACT;

/// The number of pixels along one side of a tile.
pub const TILE: u32 = 8;

// Compiles the code blocks of the guide and the README as documentation tests.

#[cfg(doctest)]
#[doc = include_str!("../docs/integration.md")]
struct Integration;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
