//! The types that a host passes in and gets back: everything public except the node, the settings and the ray scene.

pub(crate) mod band;
pub(crate) mod check;
pub(crate) mod descriptor;
pub(crate) mod error;
pub(crate) mod frame;
pub mod gbuffer;
pub(crate) mod graph;
pub(crate) mod intermediates;
pub(crate) mod needs;
pub(crate) mod plan;
pub(crate) mod requirements;
pub(crate) mod shader;
pub(crate) mod statistics;
pub(crate) mod table;
pub(crate) mod traced;
