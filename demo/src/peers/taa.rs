//! TAA as published: Karis, "High Quality Temporal Supersampling", SIGGRAPH 2014, with variance clipping (Salvi, "An
//! Excursion in Temporal Supersampling", GDC 2016) and a history that is read by Catmull-Rom. Scenes stand still, so
//! motion vectors come from depth and the two cameras. The samples of a pixel lie in it and count alike, as those of
//! the truth do; Karis takes a wider filter, which blurs.

use super::display::Display;
use super::output::{self, Output};
use super::pass::{self, Fullscreen, PeerShot, Timer};
use crate::host::gpu::Gpu;
use crate::host::raster::crop;
use crate::host::{HostError, TARGET_FORMAT};
use crate::picture::Picture;
use deferred_aa::{Camera, Settings, Technique};
use glam::{Mat4, Vec2};

/// Places of the sample in a pixel, one a frame.
pub const PHASES: u32 = 16;

/// Frames of a still camera until a history has settled: what is left of the first then is 3 %.
pub const STILL_FRAMES: u32 = 2 * PHASES;

/// As on the command line.
pub const NAME: &str = "taa";

/// The passes and the history, for images of one size.
#[derive(Debug)]
pub struct Taa {
    gpu: Gpu,
    pass: Fullscreen,
    display: Display,
    uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    /// The last frame's, and the one before that, which the next frame replaces.
    history: [wgpu::TextureView; 2],
    /// Samples along one side of a pixel in the depth, and the one of them that is shaded.
    m: u32,
    place: [u32; 2],
    /// Frames since the first one or a cut.
    frames: u32,
    /// The last frame's, without jitter.
    before: Option<Camera>,
    output: Output,
    timer: Option<Timer>,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniform {
    before_from_now: [[f32; 4]; 4],
    jitter: [f32; 2],
    place: [u32; 2],
    m: u32,
    has_history: u32,
    padding: [u32; 2],
}

impl Taa {
    /// For images of `width` × `height` pixels, on the device that has them, with m × m samples of depth a pixel, of
    /// which the image shows the one that the node shades first.
    pub fn new(gpu: &Gpu, width: u32, height: u32, m: u32) -> Result<Self, HostError> {
        let device = &gpu.device;
        let single = Settings { technique: Technique::Single, ..Settings::default() };
        let place = deferred_aa::sample_order(&single, m).first().map_or([0; 2], |&(x, y)| [x.into(), y.into()]);
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let depth = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let entries = [
            entry(0, uniform),
            pass::texture_entry(1, false),
            entry(2, depth),
            pass::texture_entry(3, true),
            entry(4, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
        ];
        let history = || {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("taa history"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: TARGET_FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let taa = Self {
            gpu: gpu.clone(),
            pass: Fullscreen::new(device, NAME, include_str!("taa.wgsl"), &entries, TARGET_FORMAT),
            display: Display::new(device),
            uniform: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(NAME),
                size: size_of::<Uniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(NAME),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            history: [history(), history()],
            m,
            place,
            frames: 0,
            before: None,
            output: Output::new(device, width, height),
            timer: Timer::new(device),
        };
        taa.complaints()?;
        Ok(taa)
    }

    /// The camera that the next frame is to be rendered with, where `camera` is that of the picture.
    pub fn jittered(&self, camera: Camera) -> Camera {
        let (width, height) = self.output.size();
        let full = Vec2::new(width as f32, height as f32);
        // The sample that is shaded may lie beside the pixel's centre.
        let beside = self.place.map(|place| (place as f32 + 0.5) / self.m as f32 - 0.5);
        crop(camera, full, jitter(self.frames % PHASES) - Vec2::from_array(beside), full)
    }

    /// Takes in a frame by the [`jittered`](Self::jittered) `camera`, linear HDR and its depth, and waits. The result is
    /// in [`picture`](Self::picture).
    pub fn run(
        &mut self,
        image: &wgpu::TextureView,
        depth: &wgpu::TextureView,
        camera: Camera,
    ) -> Result<PeerShot, HostError> {
        let size = self.output.size();
        let found =
            [(image, 1), (depth, self.m)].map(|(view, m)| (output::size(view.texture()), (size.0 * m, size.1 * m)));
        if let Some((image, size)) = found.into_iter().find(|(found, wanted)| found != wanted) {
            return Err(HostError::PeerSize { peer: NAME, image, size });
        }
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let uniform = Uniform {
            before_from_now: before_from_now(&self.before.unwrap_or(camera), &camera).to_cols_array_2d(),
            jitter: (jitter(self.frames % PHASES) / Vec2::new(size.0 as f32, size.1 as f32)).to_array(),
            place: self.place,
            m: self.m,
            has_history: u32::from(self.before.is_some()),
            padding: [0; 2],
        };
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let [last, next] = &self.history;
        let views = [(1, image), (2, depth), (3, last)];
        let [image, depth, last] = views.map(|(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        });
        let uniform = wgpu::BindGroupEntry { binding: 0, resource: self.uniform.as_entire_binding() };
        let sampler = wgpu::BindGroupEntry { binding: 4, resource: wgpu::BindingResource::Sampler(&self.sampler) };
        let bind_group = self.pass.bind(device, &[uniform, image, depth, last, sampler]);
        let mut encoder = device.create_command_encoder(&Default::default());
        let timer = self.timer.as_ref();
        self.pass.record(&mut encoder, &bind_group, next, timer.map(Timer::begin));
        self.display.record(device, &mut encoder, next, &self.output.view, timer.map(Timer::end));
        if let Some(timer) = timer {
            timer.resolve(&mut encoder);
        }
        queue.submit([encoder.finish()]);
        self.history.swap(0, 1);
        self.frames += 1;
        self.before = Some(camera);
        self.gpu.wait();
        self.complaints()?;
        Ok(PeerShot { milliseconds: self.timer.as_ref().and_then(|t| t.milliseconds(&self.gpu)) })
    }

    /// Nothing of what was is used any more: an engine tells its TAA where the camera cuts.
    pub fn cut(&mut self) {
        (self.frames, self.before) = (0, None);
    }

    /// What the last [`run`](Self::run) made, black before the first; as of the other peers, what would be displayed so.
    /// Waits.
    pub fn picture(&self) -> Picture {
        self.output.picture(&self.gpu)
    }

    fn complaints(&self) -> Result<(), HostError> {
        self.gpu.complaint().map_or(Ok(()), |complaint| Err(HostError::Device(complaint)))
    }
}

/// Halton's points of bases 2 and 3 from the first on, in pixels from the centre.
fn jitter(phase: u32) -> Vec2 {
    let radical_inverse = |base: u32| {
        let (mut rest, mut digit, mut sum) = (phase + 1, 1.0, 0.0);
        while rest > 0 {
            digit /= base as f32;
            sum += (rest % base) as f32 * digit;
            rest /= base;
        }
        sum
    };
    Vec2::new(radical_inverse(2), radical_inverse(3)) - 0.5
}

/// In f64, so that a still camera is none that moves a little.
fn before_from_now(before: &Camera, now: &Camera) -> Mat4 {
    let view = before.world_from_view.as_dmat4().inverse() * now.world_from_view.as_dmat4();
    (before.clip_from_view.as_dmat4() * view * now.clip_from_view.as_dmat4().inverse()).as_mat4()
}

#[cfg(test)]
mod tests;
