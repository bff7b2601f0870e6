//! `view`: the window.

use super::args::{CameraArg, GBufferArg, RayArg, TextureArg, check_m, parse_camera, parse_size};
use super::error::{CommandError, wrong};
use crate::host::Options;
use crate::host::gpu;
use crate::host::raster::look_at;
use crate::scene::builtin;
use crate::scene::open::open;
use crate::settings_file;
use crate::view::{self, Kept, Source, Start};
use deferred_aa::{GBufferTier, Ids};
use std::path::{Path, PathBuf};

/// See `deferred-aa-demo view --help`.
#[derive(Debug, clap::Args)]
pub struct View {
    /// A built-in scene or a .gltf or .glb file; atrium if not given.
    scene: Option<String>,
    /// The same, as other commands have it.
    #[arg(long = "scene", value_name = "SCENE", conflicts_with = "scene")]
    named: Option<String>,
    /// Which scene of a glTF file that has several, from 0; its default scene if not given.
    #[arg(long)]
    scene_index: Option<usize>,
    /// Pixels of the picture, WIDTHxHEIGHT; as last time, or to match the window, if not given.
    #[arg(long, value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Samples along one side of a pixel's window, 1 to 8; as last time if not given.
    #[arg(long, short)]
    m: Option<u32>,
    /// x,y,z,tx,ty,tz[,fov]: from where, to where, vertical field of view in degrees; else the scene's own camera.
    #[arg(long, allow_hyphen_values = true, value_parser = parse_camera)]
    camera: Option<CameraArg>,
    /// The left side's settings, saved by the viewer; as last time if not given.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// How textures are reached: arrays (plain WebGPU limits) or bindings (binding arrays).
    #[arg(long, default_value = "arrays")]
    textures: TextureArg,
    /// Who traces rays: software (WGSL, on any adapter) or query (the adapter's ray query).
    #[arg(long, default_value = "software")]
    rays: RayArg,
    /// What the G-buffer keeps of a sample: stored (its attributes) or visibility (its triangle); visibility where the
    /// adapter can, if not given.
    #[arg(long)]
    gbuffer: Option<GBufferArg>,
    /// Part of the adapter's name; `adapters` lists them.
    #[arg(long)]
    adapter: Option<String>,
    /// Starts afresh, and remembers nothing.
    #[arg(long)]
    fresh: bool,
    /// Moves every control through its range on every technique, then closes: exit code 2 if anything went wrong.
    #[arg(long)]
    tour: bool,
}

/// The most pixels of a picture at start, where pixels are shaded by a CPU.
const ON_A_CPU: u32 = 130_000;

impl View {
    pub fn run(self) -> Result<(), CommandError> {
        let afresh = self.fresh || self.tour;
        let kept_at = view::kept_path().filter(|_| !afresh);
        let (mut kept, trouble) = kept_at.as_deref().map_or((Kept::default(), None), Kept::load);
        if let Some(why) = trouble {
            eprintln!("note: {why}");
        }
        if let Some(path) = &self.settings {
            kept.settings[0] = settings_file::load(path)?;
            kept.makers[0] = Default::default();
        }
        if let Some(m) = self.m {
            kept.m = check_m(m)?;
        }
        let scene = self.scene.or(self.named).unwrap_or_else(|| "atrium".to_owned());
        // The window would open without a scene.
        if builtin::builtin(&scene).is_none() && !Path::new(&scene).is_file() {
            open(&scene, self.scene_index)?;
        }
        // A mistake in the adapter's name is one of the command line.
        let adapter = gpu::choose(self.adapter.as_deref())?;
        let on_a_cpu = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        drop(adapter);
        let size = self.size.map(|(w, h)| [w, h]).or(kept.size);
        let [width, height] = size.unwrap_or([960, 540]);
        if width.max(height) > 16_384 {
            return Err(wrong("--size", format!("{width}x{height}: a side has at most 16384 pixels")));
        }
        let options = Options {
            width,
            height,
            m: kept.m,
            textures: self.textures.tier(),
            stall: kept.stall,
            anisotropy: 16,
            rays: self.rays.tier(),
            traces: true,
            gbuffer: match self.gbuffer {
                Some(GBufferArg::Stored) => GBufferTier::default(),
                _ => GBufferTier::Visibility(Ids::Wide),
            },
        };
        let kept_fill = kept.fill;
        let start = Start {
            source: Source { name: scene, index: self.scene_index },
            camera: self.camera.map(|c| look_at(c.eye, c.target, c.fov_y, 0.05)),
            options,
            adapter: self.adapter,
            kept,
            kept_at,
            fill: size.is_none().then(|| kept_fill.unwrap_or(1)),
            most_pixels: (size.is_none() && kept_fill.is_none() && on_a_cpu).then_some(ON_A_CPU),
        };
        Ok(view::run(start, self.tour)?)
    }
}
