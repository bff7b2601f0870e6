//! The buffers of a node that do not depend on its size: the uniforms, the marks of materials and objects, and audits.
//! Each is created when a frame first needs it.

use crate::gpu::binding::{Access, Slot};
use crate::gpu::sizes::{NAMES, REFLECTIVE_BYTES};
use crate::gpu::uniforms::audited;
use crate::gpu::uniforms::casting::{CastSamples, CastingUniform};
use crate::gpu::uniforms::frame::FrameUniform;
use crate::gpu::uniforms::lattice::{LatticeStep, StepUniform};
use crate::gpu::uniforms::ring::{BANDS, FRAMES, Ring};
use crate::host::error::RecordError;
use crate::host::needs::{Needs, ObjectImportance};
use crate::host::statistics::COUNTER_BYTES;
use std::sync::OnceLock;

/// The bytes of `daa_marks` of select.wgsl: a bit for each material and a byte for each object.
pub(crate) const MARKS_BYTES: u64 = NAMES as u64 / 8 + NAMES as u64;

/// The bytes of a placeholder.
const NOTHING_BYTES: u64 = 256;

/// The buffers of a node.
#[derive(Debug)]
pub(crate) struct NodeBuffers {
    device: wgpu::Device,
    /// The number of slots that frames and bands use in turn. The input check has one more.
    slots: u64,
    pub frames: Ring<FrameUniform>,
    steps: OnceLock<Ring<StepUniform>>,
    casting: OnceLock<Ring<CastingUniform>>,
    marks: OnceLock<wgpu::Buffer>,
    reflective: OnceLock<wgpu::Buffer>,
    audits: OnceLock<wgpu::Buffer>,
    audited_counters: OnceLock<wgpu::Buffer>,
    /// Placeholders for bindings that a pass does not use: one for reading, and one for writing.
    nothing: OnceLock<[wgpu::Buffer; 2]>,
    marked: (Vec<u32>, Vec<ObjectImportance>),
    sending: Vec<u32>,
}

impl NodeBuffers {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            device: device.clone(),
            slots: FRAMES,
            frames: Ring::new(device, "daa frame", 1, FRAMES + 1),
            steps: OnceLock::new(),
            casting: OnceLock::new(),
            marks: OnceLock::new(),
            reflective: OnceLock::new(),
            audits: OnceLock::new(),
            audited_counters: OnceLock::new(),
            nothing: OnceLock::new(),
            marked: Default::default(),
            sending: Vec::new(),
        }
    }

    /// The number of slots that frames and bands use in turn. The slot after them belongs to the input check.
    pub fn slots(&self) -> u64 {
        self.slots
    }

    /// Gives the rings room for bands. Groups that bind them may be of no more use.
    pub fn hold_bands(&mut self) {
        if self.slots < BANDS {
            self.slots = BANDS;
            self.frames = Ring::new(&self.device, "daa frame", 1, self.slots + 1);
            (self.steps, self.casting) = Default::default();
        }
    }

    /// The most bytes of all these buffers, for frames in bands.
    pub fn most_bytes() -> u64 {
        let steps = Ring::<StepUniform>::bytes(LatticeStep::COUNT, BANDS);
        let casting = Ring::<CastingUniform>::bytes(CastSamples::COUNT, BANDS);
        let rings = Ring::<FrameUniform>::bytes(1, BANDS + 1) + steps + casting;
        rings + MARKS_BYTES + REFLECTIVE_BYTES + audited::BYTES + COUNTER_BYTES + 2 * NOTHING_BYTES
    }

    /// The values of `DaaStep`, one for each frame and each [`LatticeStep`](crate::gpu::lattice::LatticeStep).
    pub fn steps(&self) -> &Ring<StepUniform> {
        self.steps.get_or_init(|| Ring::new(&self.device, "daa steps", LatticeStep::COUNT, self.slots))
    }

    /// The values of `DaaCasting`, one for each frame and each [`CastSamples`].
    pub fn casting(&self) -> &Ring<CastingUniform> {
        self.casting.get_or_init(|| Ring::new(&self.device, "daa casting", CastSamples::COUNT, self.slots))
    }

    /// The squared errors of each audited tile: at the frame's effort, and a step below it.
    pub fn audits(&self) -> &wgpu::Buffer {
        self.audits.get_or_init(|| self.storage("daa audits", audited::BYTES, wgpu::BufferUsages::COPY_SRC))
    }

    fn marks(&self) -> &wgpu::Buffer {
        self.marks.get_or_init(|| self.storage("daa marks", MARKS_BYTES, wgpu::BufferUsages::COPY_DST))
    }

    fn reflective(&self) -> &wgpu::Buffer {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        self.reflective.get_or_init(|| self.buffer("daa reflective", REFLECTIVE_BYTES, usage))
    }

    fn storage(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.buffer(label, size, wgpu::BufferUsages::STORAGE | usage)
    }

    fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let label = Some(label);
        self.device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
    }

    /// A placeholder for a binding that a pass does not use.
    pub fn nothing(&self, access: Access) -> &wgpu::Buffer {
        let made = || {
            ["daa nothing", "daa nothing written"]
                .map(|label| self.storage(label, NOTHING_BYTES, wgpu::BufferUsages::empty()))
        };
        &self.nothing.get_or_init(made)[usize::from(access != Access::Read)]
    }

    /// The buffer of a slot, `None` if it is not one of these.
    pub fn of(&self, slot: Slot) -> Option<&wgpu::Buffer> {
        Some(match slot {
            Slot::Step => &self.steps().buffer,
            Slot::Casting => &self.casting().buffer,
            Slot::Marks => self.marks(),
            Slot::Reflective => self.reflective(),
            Slot::Audits => self.audits(),
            Slot::AuditedCounters => self
                .audited_counters
                .get_or_init(|| self.storage("daa audited statistics", COUNTER_BYTES, wgpu::BufferUsages::empty())),
            Slot::Part(_) | Slot::InputCounts | Slot::RayTree | Slot::RayMeshes | Slot::RayTop => return None,
        })
    }

    /// The bytes of the marks.
    pub fn marks_held(&self) -> u64 {
        self.marks.get().map_or(0, wgpu::Buffer::size)
    }

    /// The bytes of buffers for rays that a node without bands has once it has traced.
    pub fn rays_bytes() -> u64 {
        Ring::<CastingUniform>::bytes(CastSamples::COUNT, FRAMES) + REFLECTIVE_BYTES
    }

    /// The bytes of buffers for rays.
    pub fn rays_held(&self) -> u64 {
        let casting = self.casting.get().map(|ring| &ring.buffer);
        casting.into_iter().chain(self.reflective.get()).map(wgpu::Buffer::size).sum()
    }

    /// Writes the marks of materials and objects, checked, if they differ from the last frame's.
    pub fn write_marks(&mut self, queue: &wgpu::Queue, needs: &Needs<'_>) {
        let (textured, importance) = &mut self.marked;
        if textured == needs.textured && importance == needs.importance {
            // New buffers are 0.
            return;
        }
        *textured = needs.textured.to_vec();
        *importance = needs.importance.to_vec();
        let mut bytes = vec![0; MARKS_BYTES as usize];
        for &material in needs.textured {
            bytes[material as usize / 8] |= 1 << (material % 8);
        }
        for mark in needs.importance {
            bytes[NAMES / 8 + mark.object as usize] = (mark.importance * 255.0).round() as u8;
        }
        queue.write_buffer(self.marks(), 0, &bytes);
    }

    /// Writes the materials that send rays if they differ from the last frame's.
    pub fn write_reflective(&mut self, queue: &wgpu::Queue, materials: &[u32]) {
        let mut bits = [0; NAMES / 32];
        for &material in materials {
            bits[(material & 0xffff) as usize / 32] |= 1 << (material % 32);
        }
        if self.sending[..] != bits {
            self.sending.clear();
            self.sending.extend(bits);
            queue.write_buffer(self.reflective(), 0, bytemuck::cast_slice(&self.sending));
        }
    }
}

/// Refuses the first material or object that is out of range.
pub(crate) fn check_marks(needs: &Needs<'_>) -> Result<(), RecordError> {
    if let Some(index) = needs.textured.iter().position(|&material| material as usize >= NAMES) {
        return Err(RecordError::TexturedMaterial { index, material: needs.textured[index] });
    }
    for (index, mark) in needs.importance.iter().enumerate() {
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
