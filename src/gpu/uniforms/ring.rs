//! Rings of uniforms. As many frames, or bands of frames, may be recorded between two submits as a ring has slots.

use bytemuck::Pod;
use std::marker::PhantomData;

/// The number of slots of a ring.
pub(crate) const FRAMES: u64 = 16;
/// The number of slots once frames have bands.
pub(crate) const BANDS: u64 = 64;

/// Values of one type, several for each frame, which dynamic offsets select.
#[derive(Debug)]
pub(crate) struct Ring<T> {
    pub buffer: wgpu::Buffer,
    each_frame: u64,
    of: PhantomData<fn(T)>,
}

impl<T: Pod> Ring<T> {
    /// A multiple of WebGPU's default alignment of dynamic offsets.
    const STRIDE: u64 = (size_of::<T>() as u64).next_multiple_of(256);

    /// Creates a ring.
    pub fn new(device: &wgpu::Device, label: &str, each_frame: u64, slots: u64) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: Self::bytes(each_frame, slots),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, each_frame, of: PhantomData }
    }

    /// The size of a ring.
    pub fn bytes(each_frame: u64, slots: u64) -> u64 {
        Self::STRIDE * each_frame * slots
    }

    /// The dynamic offset of a value in a slot.
    pub fn offset(&self, slot: u64, index: u64) -> u32 {
        ((slot * self.each_frame + index) * Self::STRIDE) as u32
    }

    pub fn write(&self, queue: &wgpu::Queue, slot: u64, index: u64, value: &T) {
        queue.write_buffer(&self.buffer, self.offset(slot, index).into(), bytemuck::bytes_of(value));
    }
}
