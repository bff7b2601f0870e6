//! Twin of the passes of `Surfaces`.

pub mod cover;
pub mod light;
