//! A host for deferred-aa: glTF and built-in scenes, a G-buffer, a shading model, and the commands that measure.
//!
//! It uses the library as any host would. Tests and benches use the same host.

#![deny(missing_docs)]

pub mod bench;
pub mod commands;
mod files;
pub mod host;
pub mod measure;
pub mod names;
pub mod pass_kind;
pub mod peers;
pub mod picture;
pub mod report;
pub mod scene;
pub mod settings_file;
pub mod shaders;
pub mod tune;
pub mod view;

// The short paths by which the library's tests and benches know them.
pub use host::{gpu, raster, rays, upload};
pub use measure::{oracle, quality, stats};
