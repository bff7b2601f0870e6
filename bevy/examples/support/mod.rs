//! A headless app that renders into an image, and a scene with what deferred cameras can draw: for the example and the
//! tests.

#![allow(dead_code)]

pub mod picture;
pub mod scene;

use bevy_app::prelude::*;
use bevy_asset::prelude::*;
use bevy_camera::RenderTarget;
use bevy_core_pipeline::tonemapping::Tonemapping;
use bevy_deferred_aa::deferred_aa::wgpu;
use bevy_deferred_aa::{DeferredAaPlugin, DeferredAaState, DeferredAaStatus};
use bevy_ecs::prelude::*;
use bevy_image::prelude::*;
use bevy_render::RenderApp;
use bevy_render::error_handler::{RenderErrorHandler, RenderErrorPolicy};
use bevy_render::render_asset::RenderAssets;
use bevy_render::render_resource::{TextureFormat, TextureUsages};
use bevy_render::renderer::{RenderDevice, RenderQueue};
use bevy_render::texture::GpuImage;
use bevy_time::TimeUpdateStrategy;
use picture::Picture;
use std::time::{Duration, Instant};

/// What wgpu complained of.
#[derive(Resource, Default)]
pub struct Complaints(pub Vec<String>);

/// An app without a window.
pub struct Stage {
    pub app: App,
}

impl Stage {
    pub fn new() -> Self {
        let mut app = App::new();
        app.add_plugins((
            bevy_app::TaskPoolPlugin::default(),
            bevy_log::LogPlugin { level: bevy_log::Level::WARN, ..Default::default() },
            bevy_diagnostic::FrameCountPlugin,
            bevy_time::TimePlugin,
            bevy_transform::TransformPlugin,
            bevy_diagnostic::DiagnosticsPlugin,
            bevy_window::WindowPlugin { primary_window: None, ..Default::default() },
            AssetPlugin { file_path: assets(), unapproved_path_mode: bevy_asset::UnapprovedPathMode::Allow, ..Default::default() },
            bevy_world_serialization::WorldSerializationPlugin,
        ));
        app.add_plugins((
            bevy_render::RenderPlugin { synchronous_pipeline_compilation: true, ..Default::default() },
            ImagePlugin::default(),
            bevy_mesh::MeshPlugin,
            bevy_camera::CameraPlugin,
            bevy_light::LightPlugin,
            bevy_core_pipeline::CorePipelinePlugin,
            bevy_post_process::PostProcessPlugin,
            bevy_anti_alias::AntiAliasPlugin,
            bevy_gltf::GltfPlugin::default(),
            bevy_pbr::PbrPlugin::default(),
            bevy_animation::AnimationPlugin,
            bevy_render::diagnostic::RenderDiagnosticsPlugin,
        ));
        app.add_plugins(DeferredAaPlugin);
        // The same moment in every frame and every run.
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(1.0 / 60.0)))
            .init_resource::<Complaints>()
            .insert_resource(RenderErrorHandler(|error, world, _| {
                world.resource_mut::<Complaints>().0.push(format!("{:?}: {}", error.ty, error.description));
                RenderErrorPolicy::Ignore
            }));
        while app.plugins_state() == bevy_app::PluginsState::Adding {
            std::thread::yield_now();
        }
        app.finish();
        app.cleanup();
        Self { app }
    }

    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// An image to render into, in linear half floats.
    pub fn target(&mut self, [width, height]: [u32; 2]) -> Handle<Image> {
        let mut image = Image::new_target_texture(width, height, TextureFormat::Rgba16Float, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        self.world().resource_mut::<Assets<Image>>().add(image)
    }

    /// A camera without tone mapping, so that the picture is radiance.
    pub fn camera(&mut self, target: &Handle<Image>, bundle: impl Bundle) -> Entity {
        let target = RenderTarget::Image(target.clone().into());
        self.world().spawn((bevy_camera::Camera3d::default(), target, bevy_camera::Hdr, Tonemapping::None, bundle)).id()
    }

    pub fn run(&mut self, frames: usize) {
        for _ in 0..frames {
            self.app.update();
        }
    }

    /// Runs until the camera is anti-aliased, and a few frames more, in which shadow maps and statistics settle.
    pub fn run_until_active(&mut self, camera: Entity) {
        let start = Instant::now();
        loop {
            self.run(1);
            match self.state(camera) {
                DeferredAaState::Active => break,
                DeferredAaState::Refused(e) => panic!("{e}"),
                DeferredAaState::Waiting => std::thread::sleep(Duration::from_millis(10)),
            }
            assert!(start.elapsed() < Duration::from_secs(600), "no program after ten minutes");
        }
        self.run(4);
    }

    pub fn state(&mut self, camera: Entity) -> DeferredAaState {
        self.status(camera).state.clone()
    }

    pub fn status(&mut self, camera: Entity) -> &DeferredAaStatus {
        self.app.world().get::<DeferredAaStatus>(camera).expect("a status")
    }

    /// What the image holds now.
    pub fn picture(&mut self, target: &Handle<Image>) -> Picture {
        let world = self.app.sub_app(RenderApp).world();
        let device = world.resource::<RenderDevice>().wgpu_device();
        let image = world.resource::<RenderAssets<GpuImage>>().get(target).expect("the target on the GPU");
        let (width, height) = (image.texture.width(), image.texture.height());
        let row = (width * 8).next_multiple_of(256);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            image.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        world.resource::<RenderQueue>().submit([encoder.finish()]);
        buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("mapped"));
        device.poll(wgpu::PollType::wait_indefinitely()).expect("the device");
        let bytes = buffer.slice(..).get_mapped_range().expect("mapped").to_vec();
        let texel = |x: usize, y: usize, channel: usize| {
            let at = y * row as usize + x * 8 + channel * 2;
            half(u16::from_le_bytes([bytes[at], bytes[at + 1]]))
        };
        let size = [width as usize, height as usize];
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        Picture { size, pixels: places.map(|(x, y)| [0, 1, 2].map(|c| texel(x, y, c))).collect() }
    }

    pub fn complaints(&mut self) -> Vec<String> {
        self.run(1);
        std::mem::take(&mut self.world().resource_mut::<Complaints>().0)
    }
}

/// Where glTF files are looked for.
fn assets() -> String {
    std::env::var("DEFERRED_AA_SCENES").unwrap_or_else(|_| ".".to_owned())
}

fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let mantissa = f32::from(bits & 0x3ff);
    sign * match bits >> 10 & 0x1f {
        0 => mantissa * 2f32.powi(-24),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        e => (1024.0 + mantissa) * 2f32.powi(i32::from(e) - 25),
    }
}
