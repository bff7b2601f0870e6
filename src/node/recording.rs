//! A frame under way, pass by pass.

use super::order::{Pass, Step};
use super::sized::{Sized, SizedTraces};
use super::{DeferredAa, LIGHTS_STRIDE, STEP_STRIDE, step_slot};
use crate::audit::{Audit, Audited};
use crate::effects::Traced;
use crate::frame::Frame;
use crate::lattice::{Place, Steps, Use};
use crate::max_filter;
use crate::points;
use crate::resolve::Source;
use crate::scratch::{self, ListKind};
use crate::statistics::Recorded;
use crate::traces::{Samples, TileClass, Traces};

/// A frame under way. Dropped without [`finish`](Self::finish), it has no statistics.
#[derive(Debug)]
pub struct Recording<'a> {
    pub(super) aa: &'a mut DeferredAa,
    pub(super) frame: &'a Frame<'a>,
    /// Into the frame's constants and lights.
    pub(super) offsets: [u32; 2],
    pub(super) traced: Traced,
    /// Whose pipelines it takes.
    pub(super) set: Traced,
    /// Of lattices, and where they lie.
    pub(super) steps: Steps,
    pub(super) steps_offset: u32,
    pub(super) recorded: Recorded,
    pub(super) audited: Audited,
    /// Statistics are asked for, or the goal needs them.
    pub(super) collects: bool,
}

impl Recording<'_> {
    /// Records one pass.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, pass: Pass) {
        let aa = &*self.aa;
        let Some(sized) = &aa.sized else { return };
        let Some(frame) = &sized.frames[0] else { return };
        let timestamps = aa.collector.timestamps(pass.index).filter(|_| self.collects);
        let own = &*aa.pipelines;
        // `begin` has compiled them all.
        match pass.step {
            Step::Resolve(source) => {
                let pipeline = own.resolve.pipeline(&own.build, source).ok();
                let lattice = sized.lattices.as_ref().filter(|_| source == Source::Lattice);
                let group = lattice.map_or(&sized.resolve, |made| &made.resolve);
                self.fullscreen(encoder, pass, pipeline, (frame, group), timestamps);
            }
            Step::View { seen, .. } => {
                let pipeline = own.view.pipeline(&own.build).ok();
                let bound = sized.traced.as_ref().and_then(|t| t.bound.as_ref()).filter(|_| seen.is_some());
                let group = bound.map_or(&sized.view, |bound| &bound.view);
                self.fullscreen(encoder, pass, pipeline, (frame, group), timestamps);
            }
            _ => self.compute(encoder, pass, sized, timestamps),
        }
    }

    fn step_offset(&self, of: Use, place: Place) -> u32 {
        self.steps_offset + step_slot(of, place) as u32 * STEP_STRIDE as u32
    }

    fn compute(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        sized: &Sized,
        timestamps: Option<(&wgpu::QuerySet, u32, u32)>,
    ) {
        let aa = &*self.aa;
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.info.name),
            timestamp_writes: timestamps.map(|(query_set, begin, end)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }),
        });
        let own = &*aa.pipelines;
        let build = &own.build;
        let (frame, set) = if pass.step.reads_traced() {
            (sized.frame(self.traced, self.set), self.set)
        } else {
            (sized.frames[0].as_ref(), Traced::default())
        };
        compute.set_bind_group(0, frame, &[self.offsets[0]]);
        if pass.step.shades() || (matches!(pass.step, Step::Trace(_)) && build.host.solid) {
            if let Some(table) = self.frame.textures.filter(|_| aa.tables.is_some()) {
                compute.set_bind_group(1, &table.bind_group, &[]);
            }
            if build.host_layout.is_some() {
                compute.set_bind_group(crate::HOST_GROUP, self.frame.host_bind_group, &[]);
            }
        }
        let size = sized.scratch.size;
        let tiles = scratch::tiles(size);
        let (pipeline, group, [x, y]) = match pass.step {
            Step::Classify { bounces } => {
                let Some(tracing) = &own.tracing else { return };
                let Some(bound) = sized.traced.as_ref().and_then(|t| t.bound.as_ref()) else { return };
                compute.set_bind_group(3, &bound.classify, &[]);
                return tracing.classify.dispatch(&mut compute, build, bounces, size);
            }
            Step::Trace(samples) | Step::Bounce(samples) => {
                let Some(tracing) = &own.tracing else { return };
                let Some(SizedTraces { traces, bound: Some(bound) }) = &sized.traced else { return };
                let (pipeline, group, class) = match pass.step {
                    Step::Bounce(_) => (tracing.bounce.pipeline(build, tracing.tier), &bound.bounce, TileClass::Bounce),
                    _ => (tracing.trace.pipeline(build, tracing.tier), &bound.trace, TileClass::Surface),
                };
                let (Ok(pipeline), Some(group)) = (pipeline, group) else { return };
                compute.set_pipeline(pipeline);
                compute.set_bind_group(3, group, &[self.offsets[1] + samples.index() as u32 * LIGHTS_STRIDE as u32]);
                if let Samples::Points(place) = samples {
                    let [x, y] = self.steps.step(Use::Rays, place).groups(points::BLOCK);
                    return compute.dispatch_workgroups(x, y, 1);
                }
                if samples == Samples::Audited {
                    let [x, y] = Audit::groups(self.audited, size);
                    return compute.dispatch_workgroups(x, y, 1);
                }
                return compute.dispatch_workgroups_indirect(&traces.tiles, Traces::groups_at(class));
            }
            Step::Refine(of, place) => {
                let Some(made) = &sized.lattices else { return };
                let group = if of == Use::Rays { made.refine_rays.as_ref() } else { Some(&made.refine) };
                let Some(group) = group else { return };
                compute.set_bind_group(3, group, &[self.step_offset(of, place)]);
                return own.refine.dispatch(&mut compute, build, of, set, self.steps.step(of, place));
            }
            Step::Points(place) => {
                let (Some(made), Ok(pipeline)) = (&sized.lattices, own.points.pipeline(build, set)) else { return };
                compute.set_pipeline(pipeline);
                compute.set_bind_group(3, &made.points, &[self.step_offset(Use::Shading, place)]);
                let [x, y] = self.steps.step(Use::Shading, place).groups(points::BLOCK);
                return compute.dispatch_workgroups(x, y, 1);
            }
            Step::Map { .. } => {
                let (Some(made), Ok(pipeline)) = (&sized.lattices, own.map.pipeline(build)) else { return };
                compute.set_pipeline(pipeline);
                compute.set_bind_group(3, &made.map, &[self.step_offset(Use::Shading, Place::Pixels)]);
                return compute.dispatch_workgroups(tiles[0], tiles[1], 1);
            }
            Step::First => (own.first.pipeline(build, set), &sized.first, tiles),
            Step::Metrics => (own.metrics.pipeline(build, set), &sized.metrics, tiles),
            Step::MaxFilter => {
                let groups = size.map(|side| side.div_ceil(max_filter::REACH));
                (own.max_filter.pipeline(build), &sized.max_filter, groups)
            }
            // A workgroup plans 64 tiles.
            Step::Plan => (own.plan.pipeline(build), &sized.plan, [(tiles[0] * tiles[1]).div_ceil(64), 1]),
            Step::Shade(variant) => (own.shade.pipeline(build, variant, set), &sized.shade, tiles),
            Step::Reconstruct => (own.reconstruct.pipeline(build, set), &sized.reconstruct, tiles),
            Step::Select => {
                let Some(group) = &sized.select else { return };
                (own.select.pipeline(build, set), group, tiles)
            }
            Step::Audit => {
                let groups = Audit::groups(self.audited, size);
                (own.audit.pipeline(build, set), &sized.audit, groups)
            }
            Step::List(kind) => {
                let Some(made) = &sized.lists[kind as usize] else { return };
                compute.set_bind_group(3, &made.fill, &[]);
                return own.lists.dispatch(&mut compute, build, kind, size);
            }
            Step::Listed(listing) => {
                let Some(made) = &sized.lists[listing.kind() as usize] else { return };
                return own.listed.dispatch(&mut compute, build, (listing, set), &made.list, &made.shade, size);
            }
            Step::Extra { between } => {
                let Some(made) = &sized.lists[ListKind::Pixels as usize] else { return };
                let Some(group) = &made.extra else { return };
                return own.extra.dispatch(&mut compute, build, (between, set), &made.list, group, size);
            }
            Step::Resolve(_) | Step::View { .. } => return,
        };
        let Ok(pipeline) = pipeline else { return };
        compute.set_pipeline(pipeline);
        compute.set_bind_group(3, group, &[]);
        compute.dispatch_workgroups(x, y, 1);
    }

    fn fullscreen(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: Pass,
        pipeline: Option<&wgpu::RenderPipeline>,
        (frame, own): (&wgpu::BindGroup, &wgpu::BindGroup),
        timestamps: Option<(&wgpu::QuerySet, u32, u32)>,
    ) {
        let Some(pipeline) = pipeline else { return };
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass.info.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.frame.target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: timestamps.map(|(query_set, begin, end)| wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        render.set_pipeline(pipeline);
        render.set_bind_group(0, frame, &[self.offsets[0]]);
        render.set_bind_group(3, own, &[]);
        render.draw(0..3, 0..1);
    }

    /// Ends the frame: its statistics are on their way if [`Frame::statistics`] asks for them.
    pub fn finish(self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder) {
        if let (true, Some(sized)) = (self.collects, &self.aa.sized) {
            let (counters, audits) = (&sized.scratch.statistics, &self.aa.pipelines.audit.errors);
            self.aa.collector.collect(queue, encoder, counters, audits, self.recorded);
        }
    }
}
