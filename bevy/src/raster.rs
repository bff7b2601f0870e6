//! Draws the camera's deferred meshes into the enlarged G-buffer, with Bevy's own pipelines.

use crate::diagnostics::Reports;
use crate::extract::ExtractedDeferredAa;
use crate::view::ViewNode;
use bevy_core_pipeline::core_3d::Opaque3d;
use bevy_core_pipeline::deferred::{AlphaMask3dDeferred, Opaque3dDeferred};
use bevy_ecs::prelude::*;
use bevy_log::error;
use bevy_render::camera::ExtractedCamera;
use bevy_render::diagnostic::RecordDiagnostics;
use bevy_render::render_phase::ViewBinnedRenderPhases;
use bevy_render::render_resource::{
    LoadOp, Operations, RenderPassColorAttachment, RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp,
};
use bevy_render::renderer::{RenderContext, ViewQuery};
use bevy_render::view::ExtractedView;
use deferred_aa::wgpu;

pub fn raster(
    world: &World,
    view: ViewQuery<(&ExtractedDeferredAa, &ExtractedCamera, &ExtractedView, &ViewNode)>,
    opaque: Res<ViewBinnedRenderPhases<Opaque3dDeferred>>,
    masked: Res<ViewBinnedRenderPhases<AlphaMask3dDeferred>>,
    forward: Res<ViewBinnedRenderPhases<Opaque3d>>,
    reports: Res<Reports>,
    mut ctx: RenderContext,
) {
    let entity = view.entity();
    let (aa, camera, extracted, node) = view.into_inner();
    let Some(targets) = node.targets() else { return };
    let (Some(opaque), Some(masked)) =
        (opaque.get(&extracted.retained_view_entity), masked.get(&extracted.retained_view_entity))
    else {
        return;
    };
    let is_forward = || forward.get(&extracted.retained_view_entity).is_some_and(|forward| !forward.is_empty());
    if opaque.is_empty() && masked.is_empty() && is_forward() {
        reports.forward(aa.camera);
    }
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();

    let attachment = |view, store| {
        let ops = Operations { load: LoadOp::Clear(wgpu::Color::TRANSPARENT), store };
        Some(RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
    };
    let [normals, motion] = targets.unread.each_ref().map(|unread| attachment(unread.as_ref()?, StoreOp::Discard));
    // The places of Bevy's deferred prepass.
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("deferred_aa_raster"),
        color_attachments: &[
            normals,
            motion,
            attachment(&targets.texels, StoreOp::Store),
            attachment(&targets.lighting_passes, StoreOp::Store),
        ],
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: &targets.depth,
            depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: StoreOp::Store }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "deferred_aa_raster");
    if let Some(viewport) = &camera.viewport {
        let [width, height] = targets.samples.map(|side| side as f32);
        pass.set_viewport(0.0, 0.0, width, height, viewport.depth.start, viewport.depth.end);
    }
    if !opaque.is_empty()
        && let Err(e) = opaque.render(&mut pass, world, entity)
    {
        error!("DeferredAa: the deferred meshes can't be drawn: {e:?}");
    }
    if !masked.is_empty()
        && let Err(e) = masked.render(&mut pass, world, entity)
    {
        error!("DeferredAa: the masked deferred meshes can't be drawn: {e:?}");
    }
    span.end(&mut pass);
}
