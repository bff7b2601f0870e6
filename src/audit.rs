//! audit: the error of the finished image, measured on some of its tiles.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::{self, Scratch};
use crate::statistics::COUNTER_BYTES;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "audit",
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::Color],
    writes: &[Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo = PassInfo {
    reads: &[Resource::GBuffer, Resource::Host, Resource::First, Resource::Plan, Resource::Color, Resource::Traced],
    ..INFO
};

/// Most tiles of one frame.
pub(crate) const MAX_TILES: u32 = 4096;
/// Tiles of one frame that an error can be judged by, where the image has so many: fewer may all miss where it errs most.
const ENOUGH: u32 = 64;
pub(crate) const BYTES: u64 = MAX_TILES as u64 * 8;

/// Which tiles a frame audits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Audited {
    /// One in so many.
    pub period: u32,
    /// Below the period.
    pub phase: u32,
    /// How far below the frame's effort it looks ahead.
    pub step: f32,
    /// The least k of windows there.
    pub least_below: f32,
}

impl Audited {
    /// The tiles of a frame: after `period` frames each tile has had its turn.
    pub fn of(frame: u64, size: [u32; 2]) -> Self {
        let tiles = scratch::tiles(size).iter().product::<u32>();
        let mut period = (tiles / ENOUGH).clamp(1, 32);
        while Self::groups(period, size).iter().product::<u32>() > MAX_TILES {
            period *= 2;
        }
        Self { period, phase: (frame % u64::from(period)) as u32, step: 0.0, least_below: 1.0 }
    }

    fn groups(period: u32, size: [u32; 2]) -> [u32; 2] {
        let [x, y] = scratch::tiles(size);
        [x.div_ceil(period), y]
    }

    /// Index of the audited tile, row by row, of each place of the audit's result.
    pub fn tiles(self, size: [u32; 2]) -> impl Iterator<Item = Option<usize>> {
        let [tiles_x, _] = scratch::tiles(size);
        let [groups_x, rows] = Self::groups(self.period, size);
        (0..rows).flat_map(move |row| {
            let phase = (self.phase + 11 * (self.period - row % self.period)) % self.period;
            let columns = (0..groups_x).map(move |group| group * self.period + phase);
            columns.map(move |x| (x < tiles_x).then_some((row * tiles_x + x) as usize))
        })
    }
}

#[derive(Debug)]
pub(crate) struct Audit {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
    /// Takes the counts of audited samples, which are nobody's.
    ignored: wgpu::Buffer,
    /// Squared errors by audited tile, as they are and with a step less of effort.
    pub errors: wgpu::Buffer,
}

impl Audit {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa audit"),
            entries: &[
                entry::texture(0, compute),
                entry::texture(1, compute),
                entry::buffer(2, compute, true),
                entry::buffer(3, compute, false),
                entry::buffer(4, compute, false),
                entry::buffer(5, compute, true),
            ],
        });
        let buffer = |label, size| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        Self {
            layout,
            pipelines: Default::default(),
            ignored: buffer("daa audited statistics", COUNTER_BYTES),
            errors: buffer("daa audits", BYTES),
        }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa audit"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&scratch.color) },
                wgpu::BindGroupEntry { binding: 2, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: self.ignored.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 4, resource: self.errors.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 5, resource: scratch.counts.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let source = build.host.join(include_str!("../shaders/audit.wgsl"), traced);
            build.compute(INFO.name, source, "daa_audit_main", &self.layout, Some(traced))
        })
    }

    /// Workgroups of a dispatch.
    pub fn groups(audited: Audited, size: [u32; 2]) -> [u32; 2] {
        Audited::groups(audited.period, size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_has_its_turn_once() {
        for size in [[1, 1], [96, 54], [960, 540], [1027, 771], [7680, 4320]] {
            let period = u64::from(Audited::of(0, size).period);
            let mut turns = vec![0; scratch::tiles(size).iter().product::<u32>() as usize];
            for frame in 7..7 + period {
                let audited = Audited::of(frame, size);
                let tiles = audited.tiles(size).flatten().count();
                assert!(tiles >= turns.len().min(ENOUGH as usize / 2), "{size:?}: {tiles}");
                assert!(audited.tiles(size).count() <= MAX_TILES as usize);
                audited.tiles(size).flatten().for_each(|tile| turns[tile] += 1);
            }
            assert!(turns.iter().all(|&t| t == 1), "{size:?}");
        }
    }
}
