//! The passes of `Surfaces`.

pub(crate) mod audit;
pub(crate) mod cover;
pub(crate) mod light;
