//! The shape of the resources of frames, from their settings.

use crate::gpu::bands::Layout;
use crate::gpu::sizes::{Results, Shape};
use crate::host::gbuffer::GBufferTier;
use crate::host::needs::RayInputs;
use crate::settings::{DebugView, Goal, Settings};
use crate::techniques;

/// What the descriptor says of a node's resources.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kind {
    pub m: u32,
    pub target_format: wgpu::TextureFormat,
    pub gbuffer: GBufferTier,
}

/// The shape of frames with these settings, which trace for these inputs.
pub(crate) fn shape(kind: Kind, layout: Layout, settings: &Settings, inputs: RayInputs) -> Shape {
    let Kind { m, target_format, gbuffer } = kind;
    let Layout { image, size } = layout;
    let technique = techniques::of(settings.technique);
    let audits = settings.technique.follows_goals() && matches!(settings.goal, Some(Goal::Error(_)));
    let casting = technique.casting(settings, m);
    // A goal may raise every k to n.
    let room =
        if settings.technique.follows_goals() && settings.goal.is_some() { f32::MAX } else { settings.ray_samples };
    Shape {
        size,
        image,
        m,
        target_format,
        gbuffer,
        inputs,
        results: Results::new(layout, m, casting, room, audits),
        hits: technique.reads_hits(),
        rays: settings.view == DebugView::Rays,
        lattices: technique.lattices(settings, size, image, inputs),
    }
}
