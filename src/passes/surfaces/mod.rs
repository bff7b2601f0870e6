//! The passes of `Surfaces`.

pub(crate) mod cover;
pub(crate) mod light;
