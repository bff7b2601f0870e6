//! check: counts probable mistakes in a host's input, on request.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, PassKind, Rounds, Stage};

static MODULE: Module =
    Module { name: "check", base: Base::GBuffer, chunks: &[include_str!("../../shaders/passes/check.wgsl")] };

pub(crate) static CHECK: PassData = PassData {
    names: &["check"],
    kind: PassKind::Check,
    module: &MODULE,
    gbuffer: true,
    bindings: &[Binding::write(0, "daa_input", Slot::InputCounts)],
    stages: &[Stage::new("daa_check_main", Grid::Samples)],
    rounds: Rounds::Once,
};
