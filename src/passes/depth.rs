//! depth: writes depth at the output's size into the host's texture.

use crate::gpu::binding::PassData;
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, PassKind, Rounds, Stage};
use crate::host::needs::Depth;
use crate::wgsl::chunk;

static MODULE: Module = Module {
    name: "depth",
    base: Base::GBuffer,
    chunks: &[chunk::FULLSCREEN, include_str!("../../shaders/passes/depth.wgsl")],
};

const DEPTH: PassData = PassData {
    names: &["depth"],
    kind: PassKind::Depth,
    module: &MODULE,
    gbuffer: true,
    bindings: &[],
    stages: &[],
    rounds: Rounds::Once,
};

/// The depth of each window's nearest sample.
pub(crate) static NEAREST: PassData = PassData { stages: &[Stage::new("daa_depth_nearest", Grid::Depth)], ..DEPTH };

/// The depth of each window's farthest sample.
pub(crate) static FARTHEST: PassData = PassData { stages: &[Stage::new("daa_depth_farthest", Grid::Depth)], ..DEPTH };

/// The depth of each window's first sample.
pub(crate) static FIRST: PassData = PassData { stages: &[Stage::new("daa_depth_first", Grid::Depth)], ..DEPTH };

/// The pass for a choice of samples.
pub(crate) fn of(depth: Depth) -> &'static PassData {
    match depth {
        Depth::Nearest => &NEAREST,
        Depth::Farthest => &FARTHEST,
        Depth::First => &FIRST,
    }
}
