//! The GPU side of frames, independent of what the passes are: pipelines, memory and uniforms.

pub(crate) mod audited;
pub(crate) mod binding;
pub(crate) mod buffers;
pub(crate) mod casting;
pub(crate) mod collector;
pub(crate) mod frame_uniform;
pub(crate) mod input_check;
pub(crate) mod lattice;
#[cfg(test)]
mod layouts;
pub(crate) mod loans;
pub(crate) mod modules;
pub(crate) mod pipelines;
pub(crate) mod readback;
pub(crate) mod recording;
pub(crate) mod resources;
pub(crate) mod sizes;
pub(crate) mod step;
pub(crate) mod uniforms;
