//! The check of a host's input, on request. One check runs at a time, and is read back without waiting.

use crate::gpu::binding::OWN_GROUP;
use crate::gpu::pipelines::{PipelineKind, Pipelines};
use crate::gpu::readback::read_back::ReadBack;
use crate::gpu::sizes::workgroups;
use crate::host::check::{InputCounts, InputMistake, InputReport, NormalCounts};
use crate::host::error::RecordError;
use crate::host::gbuffer::GBufferTier;
use crate::host::needs::RayInputs;
use crate::passes::check::CHECK;

const BYTES: u64 = size_of::<InputCounts>() as u64;

/// The resources of the check, created by the first one.
#[derive(Debug)]
pub(crate) struct InputCheck {
    counts: wgpu::Buffer,
    read_back: ReadBack,
    /// For the check in flight: the mistakes that do not depend on the G-buffer, and the number of samples.
    begun: (Vec<InputMistake>, u64),
    /// Whether the G-buffer has the geometric normal.
    has_geometric_normal: bool,
    report: Option<InputReport>,
}

impl InputCheck {
    pub fn new(device: &wgpu::Device) -> Self {
        let counts = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("daa input counts"),
            size: BYTES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let read_back = ReadBack::new(device, "daa input read-back", BYTES);
        Self { counts, read_back, begun: Default::default(), has_geometric_normal: true, report: None }
    }

    /// Whether the previous check has arrived, or was never submitted.
    pub fn is_free(&self) -> bool {
        self.read_back.is_free()
    }

    /// Records the check of a frame of `size` pixels, whose constants lie at `offset`.
    pub fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &Pipelines,
        (frame, offset): (&wgpu::BindGroup, u32),
        size: [u32; 2],
        mistakes: Vec<InputMistake>,
    ) -> Result<(), RecordError> {
        let build = &pipelines.build;
        encoder.clear_buffer(&self.counts, 0, None);
        for stage in CHECK.stages {
            let pipeline = pipelines.get(&CHECK, stage, RayInputs::default())?;
            let group = build.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(stage.entry),
                layout: &pipeline.layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: self.counts.as_entire_binding() }],
            });
            let descriptor = wgpu::ComputePassDescriptor { label: Some(stage.entry), timestamp_writes: None };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            if let (PipelineKind::Compute(pipeline), Some([x, y, z])) =
                (&pipeline.kind, workgroups(stage.grid, (size, size), build.m, None, None))
            {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, frame, &[offset]);
                pass.set_bind_group(OWN_GROUP, &group, &[]);
                pass.dispatch_workgroups(x, y, z);
            }
        }
        encoder.copy_buffer_to_buffer(&self.counts, 0, &self.read_back.buffer, 0, BYTES);
        let samples = size.map(|side| u64::from(side * build.m));
        self.has_geometric_normal = match build.gbuffer {
            GBufferTier::Stored(channels) => channels.frame()[0],
            GBufferTier::Visibility(_) => true,
        };
        self.begun = (mistakes, samples[0] * samples[1]);
        self.read_back.send(encoder);
        Ok(())
    }

    /// Reads what has arrived.
    pub fn poll(&mut self, m: u32) {
        let arrived: Option<InputCounts> = self.read_back.take(bytemuck::pod_read_unaligned);
        if let Some(counts) = arrived {
            let (mut mistakes, samples) = std::mem::take(&mut self.begun);
            let mut judged = counts;
            if !self.has_geometric_normal {
                judged.geometric_normal = NormalCounts { fits: counts.planes, ..Default::default() };
            }
            mistakes.extend(judged.mistakes(samples, m));
            self.report = Some(InputReport { mistakes, counts });
        }
    }

    pub fn report(&self) -> Option<&InputReport> {
        self.report.as_ref()
    }
}
