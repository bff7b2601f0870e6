//! Adaptive supersampling for deferred shading.
//!
//! A host renders its scene into a G-buffer enlarged m × m. Of the n = m² samples behind each pixel this crate shades
//! those that are worth it with the host's own WGSL, and writes an image as good as full supersampling into the host's
//! target. One frame in, one frame out: no history, no motion vectors.
//!
//! ```text
//!                host                                   deferred-aa
//! scene ──raster──► G-buffer (m·w × m·h) ─┬─► first     shade the rank-0 sample of every window → S
//! `material`, `light` or `shade` (WGSL) ──┤   metrics   what differs inside the window, and between neighbours in S
//! Settings ───────────────────────────────┤   plan      how many samples of each window, and where
//! Needs: scene for rays, lights, mirrors ─┤   trace     shadow rays, and bounce: mirrored and refracted ones (before first, too)
//!                                         │   shade     the host's WGSL on those samples, and their mean
//!                                         └─► resolve   → target view
//! ```
//!
//! # Words
//! *Window*: the m × m samples behind one pixel. *Rank*: a sample's place in the window's order; rank 0 is shaded first.
//! *k*: how many samples of a window are shaded, 1 to n, the first included. *S*: the image of first samples.
//! *Sample ratio*: shaded samples over n · w · h.
//!
//! # Integration
//! 1. [`DeferredAa::requirements`] says what the device must have; create it so.
//! 2. [`DeferredAa::new`] takes the host's WGSL ([`Shading`]) and checks it; [`DeferredAa::resize`] makes the
//!    [`GBuffer`].
//! 3. Each frame the host renders into the G-buffer, its fragment shaders packing with [`gbuffer::PACK_WGSL`], and calls
//!    [`DeferredAa::record`].
//!
//! While a host is written, [`DeferredAa::check_input`] says what of its input is probably a mistake. A frame graph records
//! [`DeferredAa::passes`] itself, and may [lend](DeferredAa::lend) its memory for what they pass on.
//!
//! `examples/host.rs` in the repository is a whole host in under 120 lines.
//!
//! # Source
//! The techniques come from M. Holländer, T. Boubekeur, E. Eisemann, "Adaptive Supersampling for Deferred Anti-Aliasing",
//! Journal of Computer Graphics Techniques 2013; sections are cited where they are used.

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
pub use host::check::{InputCounts, InputMistake, InputReport, Normal, NormalCounts};
pub use host::descriptor::{Descriptor, Shading};
pub use host::error::{
    BuildError, LendError, PipelineError, RecordError, ShadingError, ShadingErrorKind, SizeError, TableError,
};
pub use host::frame::{Camera, Frame};
pub use host::gbuffer::{self, GBuffer};
pub use host::graph::{
    Grid, LatticeShape, Lifetime, Part, PartInfo, PartKind, PassInfo, PassKind, Resource, ResourceSet, Rounds, Stage,
};
pub use host::intermediates::Intermediates;
pub use host::needs::{CastingLight, MAX_CASTING_LIGHTS, Needs, ObjectImportance};
pub use host::plan::{Attribute, DecidedBy, PlanWord, Slots};
pub use host::requirements::{Memory, Requirements};
pub use host::shader::Shader;
pub use host::statistics::{DecidedCounts, PassTime, PointCounts, QuadrantCounts, Statistics, TileCounts};
pub use host::table::{
    BINDING_FEATURES, MAX_CLASSES, MAX_SAMPLERS, TableSampler, TableTexture, TextureTable, TextureTier, classes,
};
pub use node::DeferredAa;
pub use passes::shader_texts;
pub use settings::{
    ColorReference, DebugView, DepthMeasure, Effect, Enabled, Execution, Goal, Lattice, LuminanceCurve,
    MultiResolution, Pattern, Preset, Reconstructed, Selective, SettingRange, SettingScale, Settings, SettingsError,
    Technique, Weight, Windowed,
};
pub use {glam, wgpu};

/// `@group` of the host's bindings.
pub const HOST_GROUP: u32 = 2;

/// All WGSL that a host's shading may use but for the texture table's ([`DeferredAa::texture_wgsl`]): joined behind it where it runs. For
/// tools that parse it by itself.
pub const CONTRACT_WGSL: &str = wgsl::chunk::CONTRACT;

/// Pixels along one side of a tile.
pub const TILE: u32 = 8;

/// The blocks of the guide are compiled by the tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/integration.md")]
struct Integration;
