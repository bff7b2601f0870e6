//! The command line.

mod adapters;
mod demo;
mod render;
mod report;
mod set;
mod shaders;
mod tune;
mod view;

use crate::host::gpu::{self, Gpu, GpuError};
use crate::host::raster::look_at;
use crate::host::{self, Host, HostError, Options};
use crate::measure::quality::QualityError;
use crate::names::did_you_mean;
use crate::picture::PictureError;
use crate::report::ReportError;
use crate::scene::load::LoadError;
use crate::scene::{Camera, Scene, builtin, load};
use crate::settings_file::SettingsFileError;
use crate::shaders::ShadersError;
use crate::view::ViewError;
use deferred_aa::rays::RayTier;
use deferred_aa::{Preset, Technique, TextureTier};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Adaptive supersampling of deferred scenes: renders, measures, compares.
#[derive(Debug, clap::Parser)]
#[command(name = "deferred-aa-demo", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Renders a scene by one technique: image.png, image.exr, samples.png and stats.json.
    Render(render::Render),
    /// Renders a scene by Single, Windowed and Full, draws a comparison strip and prints a table.
    Demo(demo::Demo),
    /// Measures techniques over their settings against the truth: report.html, report.json, and pictures of every entry.
    Report(report::Report),
    /// Searches the settings of a technique for presets that reach given errors with the fewest samples on several scenes.
    Tune(tune::Tune),
    /// Opens a window: every setting on a control, two of them side by side, what each costs and how near it comes, live.
    View(view::View),
    /// Writes the shaders of a technique in another language, with a table of what they bind: for engines that aren't on wgpu.
    Shaders(shaders::Shaders),
    /// Lists the graphics adapters and what each can run.
    Adapters,
}

/// A command failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// No device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The scene.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The frame.
    #[error(transparent)]
    Host(#[from] HostError),
    /// A picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A measure.
    #[error(transparent)]
    Quality(#[from] QualityError),
    /// The report.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The window.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The shaders.
    #[error(transparent)]
    Shaders(#[from] ShadersError),
    /// A settings file.
    #[error(transparent)]
    Settings(#[from] SettingsFileError),
    /// Something on the command line.
    #[error("{argument}: {problem}")]
    Argument {
        /// Which.
        argument: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A file or folder.
    #[error("{path}: {source}", path = .path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl Cli {
    /// Runs the command.
    pub fn run(self) -> Result<(), CommandError> {
        match self.command {
            Command::Render(render) => render.run(),
            Command::Demo(demo) => demo.run(),
            Command::Report(report) => report.run(),
            Command::Tune(tune) => tune.run(),
            Command::View(view) => view.run(),
            Command::Shaders(shaders) => shaders.run(),
            Command::Adapters => {
                adapters::run();
                Ok(())
            }
        }
    }
}

/// What to look at, at which size and m: shared by all commands that render one m.
#[derive(Debug, Clone, clap::Args)]
struct ViewArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Samples along one side of a pixel's window, 1 to 8.
    #[arg(long, short, default_value_t = 4)]
    m: u32,
}

/// What to look at, and at which size: shared by all commands that render.
#[derive(Debug, Clone, clap::Args)]
struct SceneArgs {
    /// A built-in scene (atrium, fence, checker, spheres, cornell, shadows, mirrors, flat, empty) or a .gltf or .glb file.
    #[arg(long, default_value = "atrium")]
    scene: String,
    /// Which scene of a glTF file that has several, from 0; its default scene if not given.
    #[arg(long)]
    scene_index: Option<usize>,
    /// Pixels, WIDTHxHEIGHT.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    size: (u32, u32),
    /// x,y,z,tx,ty,tz[,fov]: from where, to where, vertical field of view in degrees; else the scene's own camera, or one
    /// that frames it.
    #[arg(long, allow_hyphen_values = true, value_parser = parse_camera)]
    camera: Option<CameraArg>,
    /// Runs the light loop this often, to stand for costly shading.
    #[arg(long, default_value_t = 1)]
    stall: u32,
    /// How textures are reached: arrays (plain WebGPU limits) or bindings (binding arrays).
    #[arg(long, default_value = "arrays")]
    textures: TextureArg,
    /// Who traces rays: software (WGSL, on any adapter) or query (the adapter's ray query).
    #[arg(long, default_value = "software")]
    rays: RayArg,
    /// Of texture reads, 1 to 16.
    #[arg(long, default_value_t = 16)]
    anisotropy: u16,
    /// Part of the adapter's name; `adapters` lists them.
    #[arg(long)]
    adapter: Option<String>,
    /// Where results go; made if it is not there. The last one given counts.
    #[arg(long, overrides_with = "out")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum TextureArg {
    Arrays,
    Bindings,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum RayArg {
    Software,
    Query,
}

impl RayArg {
    fn tier(self) -> RayTier {
        match self {
            Self::Software => RayTier::Software,
            Self::Query => RayTier::Query,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct CameraArg {
    eye: Vec3,
    target: Vec3,
    fov_y: f32,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let cure = || format!("'{text}' is no size: write WIDTHxHEIGHT in pixels, such as 1024x768");
    let (w, h) = text.split_once(['x', '×']).ok_or_else(cure)?;
    match (w.parse(), h.parse()) {
        (Ok(w), Ok(h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err(cure()),
    }
}

fn parse_camera(text: &str) -> Result<CameraArg, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse::<f32>()).collect();
    let numbers = numbers
        .ok()
        .filter(|n| (n.len() == 6 || n.len() == 7) && n.iter().all(|v| v.is_finite()))
        .ok_or_else(|| format!("'{text}' is no camera: write x,y,z,tx,ty,tz or x,y,z,tx,ty,tz,fov"))?;
    let fov = numbers.get(6).copied().unwrap_or(60.0);
    let (eye, target) = (Vec3::from_slice(&numbers), Vec3::from_slice(&numbers[3..]));
    if !(1.0..=170.0).contains(&fov) {
        return Err(format!("field of view {fov} must lie in 1 to 170 degrees"));
    }
    if eye == target {
        return Err("the camera looks at its own place: move the target".to_owned());
    }
    Ok(CameraArg { eye, target, fov_y: fov.to_radians() })
}

/// A line to stdout. A reader that has gone away (`| head`) is not an error.
fn say(line: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Loads by name or path.
pub fn open_scene(name: &str, index: Option<usize>) -> Result<Scene, CommandError> {
    if let Some(scene) = builtin::builtin(name) {
        if let Some(index) = index {
            let problem = format!("{index}: the built-in scene '{name}' is a single one; leave it out");
            return Err(CommandError::Argument { argument: "--scene-index".to_owned(), problem });
        }
        return Ok(scene);
    }
    let path = Path::new(name);
    if path.extension().is_none() && !path.exists() {
        let meant = did_you_mean(name, &builtin::NAMES);
        let all = builtin::NAMES.join(", ");
        let problem = format!("no built-in scene '{name}':{meant} choose {all} or a .gltf or .glb file");
        return Err(CommandError::Argument { argument: "--scene".to_owned(), problem });
    }
    Ok(load::load(path, index)?)
}

/// A mistake on the command line.
fn wrong(argument: &str, problem: String) -> CommandError {
    CommandError::Argument { argument: argument.to_owned(), problem }
}

fn check_m(m: u32) -> Result<u32, CommandError> {
    if (1..=deferred_aa::window::MAX_M).contains(&m) {
        Ok(m)
    } else {
        Err(wrong("--m", format!("{m} is not in 1 to 8")))
    }
}

impl ViewArgs {
    /// The host with its scene loaded, and the camera. Notices go to stderr.
    fn open(&self) -> Result<(Host, Camera), CommandError> {
        let m = check_m(self.m)?;
        let args = &self.scene;
        let Opened { scene, gpu, camera } = args.open(m)?;
        let (width, height) = args.size;
        let textures = args.textures.tier();
        let options = Options {
            width,
            height,
            m,
            textures,
            stall: args.stall,
            anisotropy: args.anisotropy,
            rays: args.rays.tier(),
        };
        let host = Host::new(gpu, scene, options)?;
        note(&host);
        Ok((host, camera))
    }
}

/// What a view needs, before anything of its size is made.
struct Opened {
    scene: Scene,
    gpu: Gpu,
    camera: Camera,
}

impl SceneArgs {
    /// The scene, a device for nodes of this m, and the camera. The folder for results is there.
    fn open(&self, m: u32) -> Result<Opened, CommandError> {
        if !(1..=16).contains(&self.anisotropy) {
            return Err(wrong("--anisotropy", format!("{} is not in 1 to 16", self.anisotropy)));
        }
        if self.stall == 0 {
            return Err(wrong("--stall", "0 would not light anything: 1 or more".to_owned()));
        }
        let scene = open_scene(&self.scene, self.scene_index)?;
        std::fs::create_dir_all(&self.out)
            .map_err(|e| wrong("--out", format!("{}: {e}; name a folder that can be made", self.out.display())))?;
        let adapter = gpu::choose(self.adapter.as_deref())?;
        let gpu = Gpu::new(adapter, &host::descriptor(m, self.textures.tier(), self.rays.tier()))?;
        let own = scene.default_camera();
        let camera = self.camera.map_or(own, |c| look_at(c.eye, c.target, c.fov_y, own.near));
        Ok(Opened { scene, gpu, camera })
    }
}

/// Notices go to stderr.
fn note(host: &Host) {
    for notice in host.scene.notices.iter().chain(&host.uploaded.notices) {
        eprintln!("note: {notice}");
    }
}

impl TextureArg {
    fn tier(self) -> TextureTier {
        match self {
            Self::Arrays => TextureTier::Arrays,
            Self::Bindings => TextureTier::Bindings,
        }
    }
}

fn parse_preset(text: &str) -> Result<Preset, String> {
    match text {
        "fast" => Ok(Preset::Fast),
        "balanced" => Ok(Preset::Balanced),
        "quality" => Ok(Preset::Quality),
        _ => {
            let meant = did_you_mean(text, &["fast", "balanced", "quality"]);
            Err(format!("no preset '{text}':{meant} choose fast, balanced or quality"))
        }
    }
}

fn parse_technique(text: &str) -> Result<Technique, String> {
    match text {
        "full" => Ok(Technique::Full),
        "single" => Ok(Technique::Single),
        "windowed" => Ok(Technique::Windowed),
        "reconstructed" => Ok(Technique::Reconstructed),
        "selective" => Ok(Technique::Selective),
        "multiresolution" => Ok(Technique::MultiResolution),
        _ => {
            let meant =
                did_you_mean(text, &["full", "single", "windowed", "reconstructed", "selective", "multiresolution"]);
            Err(format!(
                "no technique '{text}':{meant} choose full, single, windowed, reconstructed, selective or multiresolution"
            ))
        }
    }
}
