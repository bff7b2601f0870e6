//! resolve: writes the image into the host's target.

use crate::gpu::binding::{Binding, PassData, Slot};
use crate::gpu::modules::{Base, Module};
use crate::host::graph::{Grid, Part, PassKind, Rounds, Stage};

static MODULE: Module = Module {
    name: "resolve",
    base: Base::GBuffer,
    chunks: &[include_str!("../../shaders/shared/fullscreen.wgsl"), include_str!("../../shaders/passes/resolve.wgsl")],
};

/// For frames whose image is S.
pub(crate) static FIRST: PassData = PassData {
    names: &["resolve"],
    kind: PassKind::Resolve,
    module: &MODULE,
    gbuffer: false,
    bindings: &[Binding::read(0, "daa_first", Slot::Part(Part::First))],
    stages: &[Stage::new("daa_resolve_first", Grid::Target)],
    rounds: Rounds::Once,
};

/// For frames in which every pixel has a mean.
pub(crate) static COLOR: PassData = PassData {
    names: &["resolve"],
    kind: PassKind::Resolve,
    module: &MODULE,
    gbuffer: false,
    bindings: &[Binding::read(1, "daa_color", Slot::Part(Part::Color))],
    stages: &[Stage::new("daa_resolve_color", Grid::Target)],
    rounds: Rounds::Once,
};

/// For frames with a plan: windows with k > 1 have a mean, the others their first sample.
pub(crate) static BY_PLAN: PassData = PassData {
    names: &["resolve"],
    kind: PassKind::Resolve,
    module: &MODULE,
    gbuffer: false,
    bindings: &[
        Binding::read(0, "daa_first", Slot::Part(Part::First)),
        Binding::read(1, "daa_color", Slot::Part(Part::Color)),
        Binding::read(2, "daa_plan", Slot::Part(Part::Plan)),
    ],
    stages: &[Stage::new("daa_resolve_by_plan", Grid::Target)],
    rounds: Rounds::Once,
};

/// For frames whose image is the lattice of pixels.
pub(crate) static LATTICE: PassData = PassData {
    names: &["resolve"],
    kind: PassKind::Resolve,
    module: &MODULE,
    gbuffer: false,
    bindings: &[Binding::read(3, "daa_lattice_colors", Slot::Part(Part::LatticeColors))],
    stages: &[Stage::new("daa_resolve_lattice", Grid::Target)],
    rounds: Rounds::Once,
};

/// The greatest finite value of a colour format.
pub(crate) fn target_max(format: wgpu::TextureFormat) -> f32 {
    match format {
        wgpu::TextureFormat::Rgba16Float | wgpu::TextureFormat::Rg16Float | wgpu::TextureFormat::R16Float => 65504.0,
        wgpu::TextureFormat::Rg11b10Ufloat => 64512.0,
        wgpu::TextureFormat::Rgba32Float | wgpu::TextureFormat::Rg32Float | wgpu::TextureFormat::R32Float => 1e30,
        _ => 1.0,
    }
}
