//! The peers: anti-aliasing of a finished image, to measure against. They look at what a screen shows, as both were
//! made to do: radiance goes through `display` (c/(1+c), then sRGB) into 8 bits first, and that counts as their time.

mod display;
mod fxaa;
mod pass;
mod smaa;
#[cfg(test)]
mod tests;

use crate::host::HostError;
use crate::host::gpu::Gpu;
use crate::picture::Picture;
use display::Display;
use fxaa::Fxaa;
use pass::Timer;
use smaa::Smaa;

/// An anti-aliasing of finished images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Peer {
    /// FXAA 3.11, quality preset 29, with its default thresholds: a pass of our own after the published description.
    Fxaa,
    /// SMAA 1x at quality High, by the crate `smaa`. It finds edges in displayed values, as published, and blends them
    /// there too, where its authors would blend linear ones: the crate has one target for both.
    Smaa,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Fxaa, Self::Smaa];

    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fxaa => "fxaa",
            Self::Smaa => "smaa",
        }
    }
}

/// Both peers for images of one size.
#[derive(Debug)]
pub struct Peers {
    gpu: Gpu,
    display: Display,
    fxaa: Fxaa,
    smaa: Smaa,
    output: wgpu::Texture,
    output_view: wgpu::TextureView,
    timer: Option<Timer>,
}

/// What a peer took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeerShot {
    /// On top of what made the image, `display` included: by GPU timestamps, from the begin of the peer's first pass to
    /// the end of its last. SMAA's holds the time between its three submits too. `None` on a device without timestamps.
    pub milliseconds: Option<f64>,
}

impl Peers {
    /// For images of `width` × `height` pixels, on the device that has them.
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, HostError> {
        let device = &gpu.device;
        let output = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("peers output"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: display::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let peers = Self {
            gpu: gpu.clone(),
            display: Display::new(device),
            fxaa: Fxaa::new(device, width, height),
            smaa: Smaa::new(device, &gpu.queue, width, height),
            output_view: output.create_view(&wgpu::TextureViewDescriptor::default()),
            output,
            timer: Timer::new(device),
        };
        peers.complaints()?;
        Ok(peers)
    }

    /// Anti-aliases `image`, linear HDR, and waits. The result is in [`picture`](Self::picture).
    pub fn run(&mut self, peer: Peer, image: &wgpu::TextureView) -> Result<PeerShot, HostError> {
        let (found, size) = (size_of_texture(image.texture()), size_of_texture(&self.output));
        if found != size {
            return Err(HostError::PeerSize { peer: peer.name(), image: found, size });
        }
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let (timer, to) = (self.timer.as_ref(), &self.output_view);
        let (begin, end) = (timer.map(Timer::begin), timer.map(Timer::end));
        let display = &self.display;
        match peer {
            Peer::Fxaa => {
                let mut encoder = device.create_command_encoder(&Default::default());
                display.record(device, &mut encoder, image, &self.fxaa.input, begin);
                self.fxaa.record(&mut encoder, to, end);
                if let Some(timer) = timer {
                    timer.resolve(&mut encoder);
                }
                queue.submit([encoder.finish()]);
            }
            Peer::Smaa => {
                let draw = |encoder: &mut _, input: &_| display.record(device, encoder, image, input, begin);
                self.smaa.run((device, queue), draw, to, timer);
            }
        }
        self.gpu.wait();
        self.complaints()?;
        Ok(PeerShot { milliseconds: self.timer.as_ref().and_then(|t| t.milliseconds(&self.gpu)) })
    }

    /// What the last [`run`](Self::run) made, black before the first. Its `to_srgb8` gives the peer's own bytes; the
    /// radiance is what would be displayed so. Waits.
    pub fn picture(&self) -> Picture {
        let (width, height) = size_of_texture(&self.output);
        let radiance: [f32; 256] = std::array::from_fn(|shown| display::radiance(shown as u8));
        let bytes = self.gpu.read_texture(&self.output, 4);
        let linear = |&[r, g, b, _]: &[u8; 4]| {
            let [r, g, b] = [r, g, b].map(|c| radiance[usize::from(c)]);
            [r, g, b, 1.0]
        };
        Picture { width, height, rgba: bytes.as_chunks::<4>().0.iter().map(linear).collect() }
    }

    fn complaints(&self) -> Result<(), HostError> {
        self.gpu.complaint().map_or(Ok(()), |complaint| Err(HostError::Device(complaint)))
    }
}

fn size_of_texture(texture: &wgpu::Texture) -> (u32, u32) {
    (texture.width(), texture.height())
}
