//! SMAA 1x at quality High, by the crate `smaa`: the shaders of Jimenez et al. 2012, "SMAA: Enhanced Subpixel
//! Morphological Antialiasing".

use super::display;
use super::pass::Timer;

pub struct Smaa(::smaa::SmaaTarget);

impl std::fmt::Debug for Smaa {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Smaa")
    }
}

impl Smaa {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, width: u32, height: u32) -> Self {
        let mode = ::smaa::SmaaMode::Smaa1X;
        Self(::smaa::SmaaTarget::new(device, queue, width, height, display::FORMAT, mode))
    }

    /// `draw` fills the target that it is given with displayed values. Submits three times: the crate submits its own
    /// passes and takes no timestamps, so an empty pass on `to`, which has to wait for them, takes the last one.
    pub fn run(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        draw: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView),
        to: &wgpu::TextureView,
        timer: Option<&Timer>,
    ) {
        let frame = self.0.start_frame(device, queue, to);
        let mut encoder = device.create_command_encoder(&Default::default());
        draw(&mut encoder, &frame);
        queue.submit([encoder.finish()]);
        frame.resolve();
        if let Some(timer) = timer {
            let mut encoder = device.create_command_encoder(&Default::default());
            drop(super::pass::begin(&mut encoder, "smaa end", to, wgpu::LoadOp::Load, Some(timer.end())));
            timer.resolve(&mut encoder);
            queue.submit([encoder.finish()]);
        }
    }
}
