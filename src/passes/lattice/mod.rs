//! The passes over lattices of points.

pub(crate) mod lattice_to_pixels;
pub(crate) mod points;
pub(crate) mod refine;
