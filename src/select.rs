//! select: which quadrants of each pixel are worth more samples.

use crate::effects::{ObjectImportance, Traced};
use crate::error::{PipelineError, RecordError};
use crate::pipeline::{Build, Lazy, PassInfo, Resource, entry};
use crate::scratch::Scratch;
use crate::wgsl;

pub(crate) const INFO: PassInfo = PassInfo {
    name: "select",
    reads: &[Resource::GBuffer, Resource::First],
    writes: &[Resource::Plan, Resource::Statistics],
};

/// Where something was traced.
pub(crate) const INFO_TRACED: PassInfo =
    PassInfo { reads: &[Resource::GBuffer, Resource::First, Resource::Traced], ..INFO };

/// Materials and objects that a G-buffer tells apart.
const NAMES: usize = 1 << 16;

/// What the host says of its materials and objects, `daa_marks` of select.wgsl. Made in the first frame that selects.
#[derive(Debug)]
pub(crate) struct Marks {
    buffer: wgpu::Buffer,
    textured: Vec<u32>,
    importance: Vec<ObjectImportance>,
}

impl Marks {
    /// A bit for each material, a byte for each object.
    pub const BYTES: u64 = NAMES as u64 / 8 + NAMES as u64;

    pub fn new(device: &wgpu::Device) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("daa marks"),
            size: Self::BYTES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, textured: Vec::new(), importance: Vec::new() }
    }

    /// Names the first mark that is none.
    pub fn check(textured: &[u32], importance: &[ObjectImportance]) -> Result<(), RecordError> {
        if let Some(index) = textured.iter().position(|&material| material as usize >= NAMES) {
            return Err(RecordError::TexturedMaterial { index, material: textured[index] });
        }
        for (index, mark) in importance.iter().enumerate() {
            if mark.object as usize >= NAMES {
                return Err(RecordError::ImportantObject { index, object: mark.object });
            }
            // Written so that NaN fails.
            if !(0.0..=1.0).contains(&mark.importance) {
                return Err(RecordError::Importance { index, importance: mark.importance });
            }
        }
        Ok(())
    }

    /// Writes them, checked, if they differ from the last frame's.
    pub fn write(&mut self, queue: &wgpu::Queue, textured: &[u32], importance: &[ObjectImportance]) {
        if self.textured == textured && self.importance == importance {
            return;
        }
        self.textured = textured.to_vec();
        self.importance = importance.to_vec();
        let mut bytes = vec![0; Self::BYTES as usize];
        for &material in textured {
            bytes[material as usize / 8] |= 1 << (material % 8);
        }
        for mark in importance {
            bytes[NAMES / 8 + mark.object as usize] = (mark.importance * 255.0).round() as u8;
        }
        queue.write_buffer(&self.buffer, 0, &bytes);
    }
}

#[derive(Debug)]
pub(crate) struct Select {
    layout: wgpu::BindGroupLayout,
    pipelines: [Lazy<wgpu::ComputePipeline>; Traced::COUNT],
}

impl Select {
    pub fn new(device: &wgpu::Device) -> Self {
        let compute = wgpu::ShaderStages::COMPUTE;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("daa select"),
            entries: &[
                entry::texture(0, compute),
                entry::buffer(1, compute, false),
                entry::buffer(2, compute, false),
                entry::buffer(3, compute, true),
            ],
        });
        Self { layout, pipelines: Default::default() }
    }

    pub fn bind(&self, device: &wgpu::Device, scratch: &Scratch, marks: &Marks) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("daa select"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&scratch.first) },
                wgpu::BindGroupEntry { binding: 1, resource: scratch.plan.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: scratch.statistics.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 3, resource: marks.buffer.as_entire_binding() },
            ],
        })
    }

    pub fn pipeline(&self, build: &Build, traced: Traced) -> Result<&wgpu::ComputePipeline, PipelineError> {
        self.pipelines[traced.index()].get(|| {
            let source = wgsl::join_reading(include_str!("../shaders/select.wgsl"), traced);
            build.compute_plain(INFO.name, source, "daa_select_main", &self.layout, traced)
        })
    }
}
