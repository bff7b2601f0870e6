//! The peers: other anti-aliasing, to measure against. Those of a finished image look at what a screen shows, as both
//! were made to do: radiance goes through `display` (c/(1+c), then sRGB) into 8 bits first, and that counts as their
//! time. TAA looks at linear HDR and is displayed at the end, as is what hardware MSAA of
//! forward shading has resolved.

mod display;
mod fxaa;
pub mod msaa;
mod output;
mod pass;
mod smaa;
pub mod taa;
#[cfg(test)]
mod tests;

use crate::host::HostError;
use crate::host::gpu::Gpu;
use crate::picture::Picture;
use display::Display;
use fxaa::Fxaa;
use msaa::Samples;
use output::Output;
pub use pass::PeerShot;
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

/// What is measured beside the techniques.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AnyPeer {
    /// It looks at one finished image.
    Image(Peer),
    /// It looks at the frames before, too: [`taa::Taa`].
    Taa,
    /// It renders frames of its own: [`msaa::Msaa`].
    Msaa(Samples),
}

impl AnyPeer {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Image(peer) => peer.name(),
            Self::Taa => taa::NAME,
            Self::Msaa(samples) => samples.name(),
        }
    }
}

/// Both peers of finished images, for images of one size.
#[derive(Debug)]
pub struct Peers {
    gpu: Gpu,
    display: Display,
    fxaa: Fxaa,
    smaa: Smaa,
    output: Output,
    timer: Option<Timer>,
}

impl Peers {
    /// For images of `width` × `height` pixels, on the device that has them.
    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Result<Self, HostError> {
        let device = &gpu.device;
        let peers = Self {
            gpu: gpu.clone(),
            display: Display::new(device),
            fxaa: Fxaa::new(device, width, height),
            smaa: Smaa::new(device, &gpu.queue, width, height),
            output: Output::new(device, width, height),
            timer: Timer::new(device),
        };
        peers.complaints()?;
        Ok(peers)
    }

    /// Anti-aliases `image`, linear HDR, and waits. The result is in [`picture`](Self::picture).
    pub fn run(&mut self, peer: Peer, image: &wgpu::TextureView) -> Result<PeerShot, HostError> {
        let (found, size) = (output::size(image.texture()), self.output.size());
        if found != size {
            return Err(HostError::PeerSize { peer: peer.name(), image: found, size });
        }
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let (timer, to) = (self.timer.as_ref(), &self.output.view);
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
        self.output.picture(&self.gpu)
    }

    fn complaints(&self) -> Result<(), HostError> {
        self.gpu.complaint().map_or(Ok(()), |complaint| Err(HostError::Device(complaint)))
    }
}
