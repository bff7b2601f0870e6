//! A headless app that renders into an image, and a scene with what deferred cameras can draw: for the example and the
//! tests.

#![allow(dead_code)]

pub mod picture;
pub mod plugins;
pub mod scene;

use bevy_app::prelude::*;
use bevy_asset::RecursiveDependencyLoadState;
use bevy_asset::prelude::*;
use bevy_camera::RenderTarget;
use bevy_camera::primitives::Aabb;
use bevy_core_pipeline::tonemapping::Tonemapping;
use bevy_deferred_aa::deferred_aa::wgpu;
use bevy_deferred_aa::{DeferredAaPlugin, DeferredAaState, DeferredAaStatus};
use bevy_ecs::prelude::*;
use bevy_image::prelude::*;
use bevy_math::Vec3;
use bevy_render::RenderApp;
use bevy_render::error_handler::{RenderErrorHandler, RenderErrorPolicy};
use bevy_render::render_asset::RenderAssets;
use bevy_render::render_resource::{TextureFormat, TextureUsages};
use bevy_render::renderer::{RenderDevice, RenderQueue};
use bevy_render::settings::WgpuSettings;
use bevy_render::texture::GpuImage;
use bevy_time::TimeUpdateStrategy;
use bevy_transform::prelude::*;
use bevy_world_serialization::{WorldAsset, WorldAssetRoot};
use half::f16;
use picture::Picture;
use std::time::{Duration, Instant};

/// Says in one line why a file can't be a glTF scene, where its first bytes show it.
pub fn check_scene(file: &str) -> Result<(), String> {
    let path = std::path::Path::new(file);
    let bytes = match std::fs::metadata(path) {
        Ok(found) if found.is_file() => std::fs::read(path).map_err(|e| format!("{file}: {e}"))?,
        Ok(_) => return Err(format!("{file} is no file")),
        Err(_) => return Err(format!("there is no file {file}")),
    };
    let is_named = path.extension().is_some_and(|name| name == "gltf" || name == "glb");
    match (bytes.strip_prefix(b"glTF"), bytes.iter().find(|byte| !byte.is_ascii_whitespace())) {
        // The version and the length of the file follow.
        (Some([_, _, _, _, a, b, c, d, ..]), _) if is_named => {
            let whole = u32::from_le_bytes([*a, *b, *c, *d]) as usize;
            let held = bytes.len();
            if held < whole { Err(format!("{file} is cut off: it holds {held} of {whole} bytes")) } else { Ok(()) }
        }
        (None, Some(b'{')) if is_named => Ok(()),
        _ => Err(format!("{file} is no glTF file (.gltf or .glb)")),
    }
}

/// An error without the backtrace that Bevy's may carry.
pub fn first_line(e: &impl ToString) -> String {
    e.to_string().lines().next().unwrap_or_default().to_owned()
}

/// Makes an app. Where Bevy panics, as it does without a GPU or a display, the process ends with one line and code 2.
pub fn make<T>(program: &'static str, app: impl FnOnce() -> T) -> T {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let message = panic.payload_as_str().and_then(|message| message.lines().next());
        eprintln!("{program}: {}", message.unwrap_or("Bevy can't start here"));
        std::process::exit(2);
    }));
    let made = app();
    std::panic::set_hook(before);
    made
}

/// What wgpu complained of.
#[derive(Resource, Default)]
pub struct Complaints(pub Vec<String>);

/// An app without a window.
pub struct Stage {
    pub app: App,
}

impl Stage {
    pub fn new() -> Self {
        Self::with(WgpuSettings::default(), |_| {})
    }

    /// With other settings of the GPU, and more plugins.
    pub fn with(settings: WgpuSettings, more: impl FnOnce(&mut App)) -> Self {
        let mut app = App::new();
        plugins::add_to(&mut app, None, settings);
        app.add_plugins(DeferredAaPlugin);
        more(&mut app);
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
    pub fn run_until_active(&mut self, camera: Entity) -> Result<(), String> {
        let start = Instant::now();
        loop {
            self.run(1);
            match self.state(camera) {
                DeferredAaState::Active => break,
                DeferredAaState::Refused(e) => return Err(e.to_string()),
                DeferredAaState::Waiting => std::thread::sleep(Duration::from_millis(10)),
            }
            if start.elapsed() > Duration::from_secs(600) {
                return Err("nothing compiled in ten minutes".to_owned());
            }
        }
        self.run(4);
        Ok(())
    }

    pub fn state(&mut self, camera: Entity) -> DeferredAaState {
        self.status(camera).map(|status| status.state.clone()).unwrap_or_default()
    }

    /// `None` if the camera never had the component.
    pub fn status(&mut self, camera: Entity) -> Option<&DeferredAaStatus> {
        self.app.world().get::<DeferredAaStatus>(camera)
    }

    /// Loads a glTF file, spawns its first scene, and returns where a camera sees all of it.
    pub fn load(&mut self, file: &str) -> Result<Transform, String> {
        check_scene(file)?;
        let path = std::fs::canonicalize(file).map_err(|e| format!("{file}: {e}"))?;
        let server = self.world().resource::<AssetServer>().clone();
        let path = bevy_gltf::GltfAssetLabel::Scene(0).from_asset(path);
        let scene: Handle<WorldAsset> = server.load(path);
        self.world().spawn(WorldAssetRoot(scene.clone()));
        let start = Instant::now();
        loop {
            self.run(1);
            match server.recursive_dependency_load_state(&scene) {
                RecursiveDependencyLoadState::Loaded => break,
                RecursiveDependencyLoadState::Failed(e) => return Err(format!("{file}: {}", first_line(&*e))),
                _ if start.elapsed() > Duration::from_secs(120) => {
                    return Err(format!("{file} did not load in two minutes"));
                }
                _ => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        // Its entities come some frames after the asset.
        for _ in 0..100 {
            self.run(1);
            if self.app.world_mut().query::<&Aabb>().iter(self.app.world()).next().is_some() {
                self.run(2);
                scene::spawn_sun(self.world());
                return Ok(self.facing());
            }
        }
        Err(format!("{file} has no meshes"))
    }

    /// Where a camera sees all meshes, from the front and a little above.
    fn facing(&mut self) -> Transform {
        let (mut least, mut most) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        let world = self.app.world_mut();
        let mut meshes = world.query::<(&Aabb, &GlobalTransform)>();
        for (bounds, place) in meshes.iter(world) {
            for corner in 0..8 {
                let sign = Vec3::new([-1.0, 1.0][corner & 1], [-1.0, 1.0][corner >> 1 & 1], [-1.0, 1.0][corner >> 2]);
                let at = place.transform_point(Vec3::from(bounds.center) + sign * Vec3::from(bounds.half_extents));
                (least, most) = (least.min(at), most.max(at));
            }
        }
        let (centre, radius) = ((least + most) * 0.5, (most - least).length().max(1e-3) * 0.5);
        Transform::from_translation(centre + Vec3::new(0.3, 0.35, 1.0).normalize() * radius * 2.2)
            .looking_at(centre, Vec3::Y)
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
            f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f32()
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
