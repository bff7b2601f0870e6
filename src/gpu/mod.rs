//! The GPU side of frames, independent of what the passes are: pipelines, memory and uniforms.

pub(crate) mod bands;
pub(crate) mod binding;
pub(crate) mod buffers;
#[cfg(test)]
mod layouts;
pub(crate) mod loans;
pub(crate) mod modules;
pub(crate) mod pipelines;
pub(crate) mod readback;
pub(crate) mod recording;
pub(crate) mod resources;
pub(crate) mod shape;
pub(crate) mod sizes;
pub(crate) mod step;
pub(crate) mod uniforms;
