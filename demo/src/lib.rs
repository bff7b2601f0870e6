//! A host for deferred-aa: glTF and built-in scenes, a G-buffer, a shading model, and the commands that measure.
//!
//! It uses the library as any host would. Tests and benches use the same host.

#![deny(missing_docs)]

pub mod commands;
pub mod goal;
pub mod gpu;
pub mod host;
#[cfg(test)]
mod layouts;
pub mod mips;
pub mod names;
pub mod oracle;
pub mod peers;
pub mod picture;
pub mod quality;
pub mod raster;
pub mod rays;
pub mod report;
pub mod scene;
pub mod settings_file;
pub mod shaders;
pub mod stats;
pub mod temporal;
pub mod tune;
pub mod upload;
pub mod view;
