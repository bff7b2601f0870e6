//! `shaders`: the node's shaders in other languages.

use super::args::{GBufferArg, RayArg, check_m};
use super::error::{CommandError, wrong};
use super::output::{say, write_json};
use super::set::SettingsArgs;
use crate::host;
use crate::shaders::{self, Lang, Request};
use deferred_aa::{Depth, GBufferTier, Ids, Shading, TextureTier};
use std::path::{Path, PathBuf};

/// See `deferred-aa-demo shaders --help`.
#[derive(Debug, clap::Args)]
pub struct Shaders {
    /// What to write them in.
    #[arg(long)]
    lang: Lang,
    /// Where they go, one file an entry point, and bindings.md and bindings.json beside them; made if it is not there.
    #[arg(long)]
    out: PathBuf,
    /// Samples along one side of a pixel's window, 1 to 8: a constant in the shaders.
    #[arg(long, short, default_value_t = 4)]
    m: u32,
    #[command(flatten)]
    settings: SettingsArgs,
    /// The WGSL that shades, with all that it needs: shade, or material and light; the demo's own if not given.
    #[arg(long, value_name = "FILE")]
    shading: Option<PathBuf>,
    /// How daa_texture reaches textures: none, arrays or bindings; of the demo's own shading, arrays if not given.
    #[arg(long)]
    textures: Option<TierArg>,
    /// Who traces rays, where effects are set on (--set shadows=on, reflections=on, refraction=on): software (a
    /// structure in buffers) or query (ray query).
    #[arg(long, default_value = "software")]
    rays: RayArg,
    /// What the G-buffer keeps of a sample: stored (its attributes) or visibility (its triangle).
    #[arg(long, default_value = "stored")]
    gbuffer: GBufferArg,
    /// Which sample of a pixel's window gives the depth that the frames also write at the output's size, for what is
    /// drawn over the image: nearest, farthest or first; no such pass if not given.
    #[arg(long)]
    depth: Option<DepthArg>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum TierArg {
    None,
    Arrays,
    Bindings,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum DepthArg {
    Nearest,
    Farthest,
    First,
}

impl Shaders {
    pub fn run(self) -> Result<(), CommandError> {
        let settings = self.settings.settings()?;
        let text = self.shading.as_deref().map(read).transpose()?;
        let name = self.shading.as_deref().map_or_else(String::new, |path| path.display().to_string());
        let own = host::descriptor(1, TextureTier::Arrays, self.rays.tier(), GBufferTier::default()).shading;
        let shading = text.as_deref().map_or(own, |source| Shading { source, file: &name });
        let textures = match (self.textures, &text) {
            (Some(TierArg::Arrays), _) | (None, None) => TextureTier::Arrays,
            (Some(TierArg::Bindings), _) => TextureTier::Bindings,
            (Some(TierArg::None), _) | (None, Some(_)) => TextureTier::None,
        };
        let request = Request {
            lang: self.lang,
            m: check_m(self.m)?,
            settings: &settings,
            textures,
            rays: self.rays.tier(),
            gbuffer: match self.gbuffer {
                GBufferArg::Stored => GBufferTier::default(),
                GBufferArg::Visibility => GBufferTier::Visibility(Ids::Wide),
            },
            depth: self.depth.map(|depth| match depth {
                DepthArg::Nearest => Depth::Nearest,
                DepthArg::Farthest => Depth::Farthest,
                DepthArg::First => Depth::First,
            }),
            shading,
        };
        let export = shaders::export(&request)?;

        let file = |path: PathBuf| move |source| CommandError::File { path, source };
        std::fs::create_dir_all(&self.out)
            .map_err(|e| wrong("--out", format!("{}: {e}; name a folder that can be made", self.out.display())))?;
        for (name, bytes) in &export.files {
            let path = self.out.join(name);
            std::fs::write(&path, bytes).map_err(file(path))?;
        }
        let path = self.out.join("bindings.md");
        std::fs::write(&path, export.table.markdown()).map_err(file(path))?;
        write_json(&self.out.join("bindings.json"), &export.table)?;
        say(&format!("{} shaders, bindings.md and bindings.json in {}", export.files.len(), self.out.display()));
        Ok(())
    }
}

fn read(path: &Path) -> Result<String, CommandError> {
    std::fs::read_to_string(path).map_err(|e| wrong("--shading", format!("{}: {e}", path.display())))
}
