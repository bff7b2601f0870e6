//! Arguments that several commands take, and what they open.

use super::error::{CommandError, wrong};
use crate::host::gpu::{self, Gpu};
use crate::host::raster::look_at;
use crate::host::{self, Host, Options};
use crate::names::did_you_mean;
use crate::scene::open::open;
use crate::scene::{Camera, Scene};
use deferred_aa::rays::RayTier;
use deferred_aa::{GBufferTier, Preset, Settings, Technique, TextureTier};
use glam::Vec3;
use std::path::PathBuf;

/// What to look at, at which size and m: shared by all commands that render one m.
#[derive(Debug, Clone, clap::Args)]
pub struct ViewArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Samples along one side of a pixel's window, 1 to 8.
    #[arg(long, short, default_value_t = 4)]
    pub m: u32,
}

/// What to look at, and at which size: shared by all commands that render.
#[derive(Debug, Clone, clap::Args)]
pub struct SceneArgs {
    /// A built-in scene (atrium, fence, checker, spheres, cornell, shadows, mirrors, flat, empty) or a .gltf or .glb
    /// file.
    #[arg(long, default_value = "atrium")]
    pub scene: String,
    /// Which scene of a glTF file that has several, from 0; its default scene if not given.
    #[arg(long)]
    pub scene_index: Option<usize>,
    /// Pixels, WIDTHxHEIGHT.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    pub size: (u32, u32),
    /// x,y,z,tx,ty,tz[,fov]: from where, to where, vertical field of view in degrees; else the scene's own camera, or
    /// one that frames it.
    #[arg(long, allow_hyphen_values = true, value_parser = parse_camera)]
    pub camera: Option<CameraArg>,
    /// Runs the light loop this often, to stand for costly shading.
    #[arg(long, default_value_t = 1)]
    pub stall: u32,
    /// How textures are reached: arrays (plain WebGPU limits) or bindings (binding arrays).
    #[arg(long, default_value = "arrays")]
    pub textures: TextureArg,
    /// Who traces rays: software (WGSL, on any adapter) or query (the adapter's ray query).
    #[arg(long, default_value = "software")]
    pub rays: RayArg,
    /// What the G-buffer keeps of a sample: stored (its attributes) or visibility (its triangle); visibility where the
    /// adapter can, if not given.
    #[arg(long)]
    pub gbuffer: Option<GBufferArg>,
    /// Of texture reads, 1 to 16.
    #[arg(long, default_value_t = 16)]
    pub anisotropy: u16,
    /// Part of the adapter's name; `adapters` lists them.
    #[arg(long)]
    pub adapter: Option<String>,
    /// Where results go; made if it is not there. If repeated, the last wins.
    #[arg(long, overrides_with = "out")]
    pub out: PathBuf,
}

/// A number of measured frames.
pub fn frames() -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(1..=10_000)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum TextureArg {
    Arrays,
    Bindings,
}

impl TextureArg {
    pub fn tier(self) -> TextureTier {
        match self {
            Self::Arrays => TextureTier::Arrays,
            Self::Bindings => TextureTier::Bindings,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum RayArg {
    Software,
    Query,
}

impl RayArg {
    pub fn tier(self) -> RayTier {
        match self {
            Self::Software => RayTier::Software,
            Self::Query => RayTier::Query,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum GBufferArg {
    Stored,
    Visibility,
}

impl GBufferArg {
    /// The tier for a scene on an adapter, in nodes of these tiers.
    pub fn tier(
        asked: Option<Self>,
        scene: &Scene,
        adapter: &wgpu::Adapter,
        textures: TextureTier,
        rays: Option<RayTier>,
    ) -> Result<GBufferTier, CommandError> {
        let best = host::gbuffer_tier(scene, adapter);
        match asked {
            None => Ok(host::gbuffer_for(best, scene, adapter, textures, rays)),
            Some(Self::Stored) => Ok(host::stored(scene)),
            Some(Self::Visibility) if matches!(best, GBufferTier::Visibility(_)) => Ok(best),
            Some(Self::Visibility) if adapter.features().contains(wgpu::Features::PRIMITIVE_INDEX) => {
                let problem = "the scene is too small or too large for the areas of its triangles: use stored";
                Err(wrong("--gbuffer", problem.to_owned()))
            }
            Some(Self::Visibility) => {
                let name = adapter.get_info().name;
                Err(wrong("--gbuffer", format!("'{name}' can't tell triangles apart (no PRIMITIVE_INDEX): use stored")))
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraArg {
    pub eye: Vec3,
    pub target: Vec3,
    pub fov_y: f32,
}

/// The scene, device and camera of a view, before anything of its size is made.
pub struct Opened {
    pub scene: Scene,
    pub gpu: Gpu,
    pub camera: Camera,
    pub gbuffer: GBufferTier,
    /// Whether the device can trace rays.
    pub traces: bool,
}

impl ViewArgs {
    /// Opens the scene in a host for frames with settings that trace rays as these do, with the camera. Notices go to
    /// stderr.
    pub fn open(&self, settings: &Settings) -> Result<(Host, Camera), CommandError> {
        self.open_within(None, settings)
    }

    /// [`open`](Self::open) for frames in bands, so that the node holds at most so many bytes.
    pub fn open_within(&self, memory: Option<u64>, settings: &Settings) -> Result<(Host, Camera), CommandError> {
        let m = check_m(self.m)?;
        let args = &self.scene;
        let Opened { scene, gpu, camera, gbuffer, traces } = args.open(m, Some(settings))?;
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
            traces,
            gbuffer,
        };
        let host = Host::within(gpu, scene, options, memory)?;
        note(&host);
        Ok((host, camera))
    }
}

impl SceneArgs {
    /// Opens the scene, a device for nodes of this m, and the camera, and makes the folder for results. The device can
    /// trace rays if settings need them, or in any case without settings.
    pub fn open(&self, m: u32, settings: Option<&Settings>) -> Result<Opened, CommandError> {
        if !(1..=16).contains(&self.anisotropy) {
            return Err(wrong("--anisotropy", format!("{} is not in 1 to 16", self.anisotropy)));
        }
        if self.stall == 0 {
            return Err(wrong("--stall", "0 would not light anything: 1 or more".to_owned()));
        }
        let scene = open(&self.scene, self.scene_index)?;
        std::fs::create_dir_all(&self.out)
            .map_err(|e| wrong("--out", format!("{}: {e}; name a folder that can be made", self.out.display())))?;
        let adapter = gpu::choose(self.adapter.as_deref())?;
        let traces = settings.is_none_or(|settings| host::traces(&scene, settings));
        let (textures, rays) = (self.textures.tier(), traces.then(|| self.rays.tier()));
        let gbuffer = GBufferArg::tier(self.gbuffer, &scene, &adapter, textures, rays)?;
        let gpu = Gpu::for_peers(adapter, &host::descriptor(m, textures, rays, gbuffer))?;
        let own = scene.default_camera();
        let camera = self.camera.map_or(own, |c| look_at(c.eye, c.target, c.fov_y, own.near));
        Ok(Opened { scene, gpu, camera, gbuffer, traces })
    }
}

/// Prints the notices about the scene to stderr.
fn note(host: &Host) {
    for notice in host.scene.notices.iter().chain(&host.uploaded.notices) {
        eprintln!("note: {notice}");
    }
}

pub fn check_m(m: u32) -> Result<u32, CommandError> {
    if (1..=deferred_aa::window::MAX_M).contains(&m) {
        Ok(m)
    } else {
        Err(wrong("--m", format!("{m} is not in 1 to 8")))
    }
}

pub fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let cure = || format!("'{text}' is not a size: write WIDTHxHEIGHT in pixels, such as 1024x768");
    let (w, h) = text.split_once(['x', '×']).ok_or_else(cure)?;
    match (w.parse(), h.parse()) {
        (Ok(w), Ok(h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err(cure()),
    }
}

/// Bytes as a whole number with a unit: of 1000 (KB, MB, GB) or of 1024 (KiB, MiB, GiB).
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let cure = || format!("'{text}' is not a number of bytes: write one with a unit, such as 512MB or 2GiB");
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let unit: u64 = match text[end..].trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "kb" => 1000,
        "mb" => 1_000_000,
        "gb" => 1_000_000_000,
        "kib" => 1 << 10,
        "mib" => 1 << 20,
        "gib" => 1 << 30,
        _ => return Err(cure()),
    };
    let number: u64 = text[..end].parse().map_err(|_| cure())?;
    number.checked_mul(unit).filter(|&bytes| bytes > 0).ok_or_else(cure)
}

pub fn parse_camera(text: &str) -> Result<CameraArg, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse::<f32>()).collect();
    let numbers = numbers
        .ok()
        .filter(|n| (n.len() == 6 || n.len() == 7) && n.iter().all(|v| v.is_finite()))
        .ok_or_else(|| format!("'{text}' is not a camera: write x,y,z,tx,ty,tz or x,y,z,tx,ty,tz,fov"))?;
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

pub fn parse_preset(text: &str) -> Result<Preset, String> {
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

pub fn parse_technique(text: &str) -> Result<Technique, String> {
    let names = Technique::ALL.map(|technique| format!("{technique:?}").to_lowercase());
    if let Some(at) = names.iter().position(|name| name == text) {
        return Ok(Technique::ALL[at]);
    }
    let names = names.each_ref().map(String::as_str);
    let meant = did_you_mean(text, &names);
    let [all_but_last @ .., last] = &names;
    Err(format!("no technique '{text}':{meant} choose {} or {last}", all_but_last.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::parse_bytes;

    #[test]
    fn bytes_have_units() {
        let all = [("512MB", 512_000_000), ("1 gb", 1_000_000_000), ("2GiB", 2 << 30), ("3kib", 3072), ("4KB", 4000)];
        for (text, bytes) in all.into_iter().chain([("17", 17), ("17B", 17), ("5MiB", 5 << 20)]) {
            assert_eq!(parse_bytes(text), Ok(bytes));
        }
        for text in ["", "MB", "0", "-1MB", "1.5GB", "1TB", "512 MB and more", "99999999999999999999", "20000000000GB"]
        {
            let told = format!("'{text}' is not a number of bytes: write one with a unit, such as 512MB or 2GiB");
            assert_eq!(parse_bytes(text), Err(told));
        }
    }
}
