//! Twin of the passes of `Surfaces`.

pub mod blocks;
pub mod cover;
pub mod light;
