//! Twin of `shaders/octahedral.wgsl`.

pub use crate::octahedral::{decode, encode};
