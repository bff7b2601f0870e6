//! Readback of bytes from the GPU without waiting.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

const FREE: u8 = 0;
const UNDER_WAY: u8 = 1;
const READY: u8 = 2;

/// A buffer that is copied to, mapped when its encoder is submitted, read, and then free again.
#[derive(Debug)]
pub(crate) struct ReadBack {
    pub buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

/// Frees the buffer if the encoder, and with it the callback, is dropped without a submit.
struct Landing {
    state: Arc<AtomicU8>,
    to: u8,
}

impl Drop for Landing {
    fn drop(&mut self) {
        self.state.store(self.to, Ordering::Release);
    }
}

impl ReadBack {
    pub fn new(device: &wgpu::Device, label: &str, size: u64) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, state: Arc::new(AtomicU8::new(FREE)) }
    }

    /// Whether the last readback has been read, or was never submitted.
    pub fn is_free(&self) -> bool {
        self.state.load(Ordering::Acquire) == FREE
    }

    pub fn is_ready(&self) -> bool {
        self.state.load(Ordering::Acquire) == READY
    }

    /// Starts the readback of what the encoder has copied to the buffer.
    pub fn send(&self, encoder: &wgpu::CommandEncoder) {
        self.state.store(UNDER_WAY, Ordering::Release);
        let mut landing = Landing { state: self.state.clone(), to: FREE };
        encoder.map_buffer_on_submit(&self.buffer, wgpu::MapMode::Read, .., move |outcome| {
            landing.to = if outcome.is_ok() { READY } else { FREE };
            drop(landing);
        });
    }

    /// Reads the bytes once they have arrived, and frees the buffer. `None` if nothing has arrived.
    pub fn take<T>(&self, read: impl FnOnce(&[u8]) -> T) -> Option<T> {
        if !self.is_ready() {
            return None;
        }
        let taken = self.buffer.get_mapped_range(..).ok().map(|bytes| read(&bytes));
        self.buffer.unmap();
        self.state.store(FREE, Ordering::Release);
        taken
    }
}
