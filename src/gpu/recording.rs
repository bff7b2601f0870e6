//! A frame that is being recorded, pass by pass.

use crate::gpu::binding::{OWN_GROUP, Slot, TABLE_GROUP};
use crate::gpu::buffers::NodeBuffers;
use crate::gpu::readback::collector::{Collector, Recorded};
use crate::gpu::resources::SizedResources;
use crate::gpu::sizes::WORK_BYTES;
use crate::gpu::step::Pass;
use crate::host::band::Rect;
use crate::host::error::RecordError;
use crate::host::frame::Frame;
use crate::host::graph::{Part, Resource, Rounds, Stage};
use crate::{HOST_GROUP, SECOND_HOST_GROUP};

/// A frame that is being recorded. If it is dropped without [`finish`](Self::finish), it has no statistics.
#[derive(Debug)]
pub struct Recording<'a> {
    pub(crate) frame: &'a Frame<'a>,
    /// The pixels of the target, and of the depth texture, that are drawn, `None` for all of it.
    pub(crate) drawn: Option<Rect>,
    pub(crate) resources: &'a SizedResources,
    pub(crate) buffers: &'a NodeBuffers,
    pub(crate) collector: &'a mut Collector,
    /// The slot of its constants.
    pub(crate) slot: u64,
    pub(crate) passes: &'a [ReadyPass],
    /// Set if the frame's statistics are requested or the goal needs them.
    pub(crate) recorded: Option<Recorded>,
}

/// A pass with everything that is needed to record it.
#[derive(Debug)]
pub(crate) struct ReadyPass {
    pub pass: Pass,
    /// Group 0.
    pub frame: wgpu::BindGroup,
    pub binds: Binds,
    pub stages: Vec<ReadyStage>,
}

/// Which groups are bound that are neither the frame's nor the pass's own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Binds {
    pub table: bool,
    pub host: bool,
    /// In the table's place.
    pub second: bool,
}

#[derive(Debug)]
pub(crate) struct ReadyStage {
    pub stage: &'static Stage,
    /// The pass's own bind group.
    pub group: wgpu::BindGroup,
    pub run: Run,
}

/// How a stage runs.
#[derive(Debug)]
pub(crate) enum Run {
    /// With so many workgroups.
    Direct(wgpu::ComputePipeline, [u32; 3]),
    /// With as many as stand in the buffer, at this offset in the first round.
    Indirect(wgpu::ComputePipeline, wgpu::Buffer, u64),
    /// As a triangle that covers the target, or the depth texture.
    Draw(wgpu::RenderPipeline),
}

impl Recording<'_> {
    /// Records one pass of [`DeferredAa::passes`](crate::DeferredAa::passes) for the frame's own settings and needs;
    /// other passes are refused.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, pass: Pass) -> Result<(), RecordError> {
        let own = self.passes.get(pass.index).filter(|own| own.pass == pass);
        self.record_ready(encoder, own.ok_or(RecordError::ForeignPass(pass.info.name))?);
        Ok(())
    }

    /// Records all passes in their order.
    pub(crate) fn record_all(&self, encoder: &mut wgpu::CommandEncoder) {
        self.passes.iter().for_each(|own| self.record_ready(encoder, own));
    }

    fn record_ready(&self, encoder: &mut wgpu::CommandEncoder, own: &ReadyPass) {
        if own.pass.step.pass.draws() {
            self.draw(encoder, own);
        } else {
            self.compute(encoder, own);
        }
    }

    fn timestamps(&self, pass: Pass) -> Option<(&wgpu::QuerySet, u32, u32)> {
        self.collector.timestamps(pass.index).filter(|_| self.recorded.is_some())
    }

    fn compute(&self, encoder: &mut wgpu::CommandEncoder, own: &ReadyPass) {
        let pass = own.pass;
        let timestamps = self.timestamps(pass);
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.info.name),
            timestamp_writes: timestamps.map(|(query_set, begin, end)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }),
        });
        let constants = self.buffers.frames.offset(self.slot, 0);
        compute.set_bind_group(0, &own.frame, &[constants]);
        let [offsets, second_offsets] = self.frame.host_offsets;
        if let (true, Some(table)) = (own.binds.table, self.frame.textures) {
            compute.set_bind_group(TABLE_GROUP, &table.bind_group, &[]);
        }
        if let (true, Some(second)) = (own.binds.second, self.frame.second_bind_group) {
            compute.set_bind_group(SECOND_HOST_GROUP, second, second_offsets);
        }
        if let (true, Some(host)) = (own.binds.host, self.frame.host_bind_group) {
            compute.set_bind_group(HOST_GROUP, host, offsets);
        }
        let SizedResources { size, m, .. } = *self.resources;
        let mut bound = None;
        for round in 0..pass.info.rounds.count(size, m) {
            let further = u64::from(round) * WORK_BYTES;
            for ready in &own.stages {
                let (offsets, count) = self.offsets(pass, ready.stage, further);
                if bound != Some((&ready.group, offsets)) {
                    compute.set_bind_group(OWN_GROUP, &ready.group, &offsets[..count]);
                    bound = Some((&ready.group, offsets));
                }
                match &ready.run {
                    Run::Direct(pipeline, [x, y, z]) => {
                        compute.set_pipeline(pipeline);
                        compute.dispatch_workgroups(*x, *y, *z);
                    }
                    Run::Indirect(pipeline, groups, offset) => {
                        compute.set_pipeline(pipeline);
                        compute.dispatch_workgroups_indirect(groups, offset + further);
                    }
                    // A pass draws or computes, not both.
                    Run::Draw(_) => {}
                }
            }
        }
    }

    /// The dynamic offsets of a stage's own group, in the order of its bindings. `further` is the offset of the round
    /// into the work of a list.
    fn offsets(&self, pass: Pass, stage: &Stage, further: u64) -> ([u32; 2], usize) {
        let mut offsets = [0; 2];
        let mut count = 0;
        for binding in pass.step.pass.bound(stage).filter(|binding| binding.dynamic().is_some()) {
            offsets[count] = match binding.slot {
                Slot::Step => {
                    let index = pass.step.lattice.map_or(0, |lattice| lattice.index());
                    self.buffers.steps().offset(self.slot, index)
                }
                Slot::Casting => {
                    let index = pass.step.samples.map_or(0, |samples| samples.index());
                    self.buffers.casting().offset(self.slot, index)
                }
                // Work 0 describes the whole list; each later one describes a round.
                _ => further as u32 + if pass.info.rounds == Rounds::Once { 0 } else { WORK_BYTES as u32 },
            };
            count += 1;
        }
        (offsets, count)
    }

    fn draw(&self, encoder: &mut wgpu::CommandEncoder, own: &ReadyPass) {
        let timestamps = self.timestamps(own.pass);
        let depth = self.frame.depth.filter(|_| own.pass.info.writes.contains(Resource::Depth));
        let color = Some(wgpu::RenderPassColorAttachment {
            view: self.frame.target,
            depth_slice: None,
            resolve_target: None,
            ops: self.ops(wgpu::Color::TRANSPARENT),
        });
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(own.pass.info.name),
            color_attachments: if depth.is_some() { &[] } else { std::slice::from_ref(&color) },
            depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(self.ops(0.0)),
                stencil_ops: None,
            }),
            timestamp_writes: timestamps.map(|(query_set, begin, end)| wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        if let Some(Rect { x, y, width, height }) = self.drawn {
            render.set_scissor_rect(x, y, width, height);
        }
        for ready in &own.stages {
            if let Run::Draw(pipeline) = &ready.run {
                render.set_pipeline(pipeline);
                render.set_bind_group(0, &own.frame, &[self.buffers.frames.offset(self.slot, 0)]);
                render.set_bind_group(OWN_GROUP, &ready.group, &[]);
                render.draw(0..3, 0..1);
            }
        }
    }

    /// How a pass writes an attachment. What lies around the image, or belongs to other bands, is kept.
    fn ops<V>(&self, clear: V) -> wgpu::Operations<V> {
        let load = if self.drawn.is_some() { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(clear) };
        wgpu::Operations { load, store: wgpu::StoreOp::Store }
    }

    /// Ends the frame, or the band. If [`Frame::statistics`] is set, `encoder` receives the copies of its counters.
    pub fn finish(self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder) {
        if let (Some(recorded), Some(counters)) = (self.recorded, self.resources.buffer(Part::Counters)) {
            let audits = recorded.audited.is_some().then(|| self.buffers.audits());
            self.collector.collect(queue, encoder, counters, audits, recorded);
        }
    }
}
