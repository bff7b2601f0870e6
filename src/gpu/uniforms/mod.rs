//! What shaders are told of a frame: its constants, the lattices, who casts rays, and which tiles are audited.

pub(crate) mod audited;
pub(crate) mod casting;
pub(crate) mod frame;
pub(crate) mod lattice;
pub(crate) mod ring;
