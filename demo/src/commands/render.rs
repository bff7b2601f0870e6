//! `render`: one technique on one view, with everything that it wrote.

use super::args::{ViewArgs, frames, parse_bytes};
use super::error::CommandError;
use super::output::{say, write_json};
use super::set::SettingsArgs;
use crate::host::raster::node_camera;
use crate::measure::goal;
use crate::measure::quality;
use crate::measure::stats::Stats;
use crate::picture;
use deferred_aa::{DebugView, Goal, Settings, Technique};

/// See `deferred-aa-demo render --help`.
#[derive(Debug, clap::Args)]
pub struct Render {
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    settings: SettingsArgs,
    /// An error or a time to keep to, such as error=0.01 (40 dB) or time=8 (milliseconds of the node): renders until
    /// the search rests, and says how it ended.
    #[arg(long, value_name = "error=E|time=MS", value_parser = goal::parse)]
    goal: Option<Goal>,
    /// Measured frames, after one that warms up.
    #[arg(long, default_value_t = 1, value_parser = frames())]
    frames: u32,
    /// The most that the node may hold, such as 512MB or 2GiB: renders in bands that fit it, and leaves the quality at
    /// edges out. Textures larger than the device allows are divided, too.
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    memory: Option<u64>,
    /// Leaves the grid reference out: no quality in stats.json, but no frame of full supersampling either.
    #[arg(long)]
    no_reference: bool,
}

impl Render {
    pub fn run(self) -> Result<(), CommandError> {
        let settings = self.settings.settings()?;
        let settings = Settings { goal: self.goal.or(settings.goal), ..settings };
        settings
            .validate()
            .map_err(|e| CommandError::Argument { argument: "--goal".to_owned(), problem: e.to_string() })?;
        if settings.goal.is_some() && !settings.technique.follows_goals() {
            let problem =
                format!("'{:?}' has nothing to scale: use windowed or surfaces", settings.technique).to_lowercase();
            return Err(CommandError::Argument { argument: "--goal".to_owned(), problem });
        }
        let (mut host, camera) = self.view.open_within(self.memory, &settings)?;
        let out = &self.view.scene.out;
        if let Some(wanted) = settings.goal {
            let (frames, progress) = goal::seek(|| host.frame(&camera, settings))?;
            say(&goal::ended(wanted, frames, progress));
        }

        let mut shots = Vec::new();
        for frame in 0..=self.frames {
            let shot = host.frame(&camera, settings)?;
            if frame > 0 {
                shots.push(shot);
            }
        }
        // Before other frames change what is held.
        let stats = Stats::new(&host, settings, &shots, None);
        let image = host.picture();
        let (width, height) = (host.options.width, host.options.height);
        let counts = host.sample_map(node_camera(&camera, width, height), settings)?;
        let n = host.options.m * host.options.m;

        let quality = if self.no_reference || settings.view != DebugView::Image {
            None
        } else {
            let grid = Settings { technique: Technique::Full, goal: None, ..settings };
            let grid = Settings { weight: deferred_aa::Weight::Linear, ..grid };
            let reference = if settings == grid {
                image.clone()
            } else {
                host.frame(&camera, grid)?;
                host.picture()
            };
            // Of an image in bands, the G-buffer holds the last one alone.
            let edges = self.memory.is_none().then(|| host.edge_mask());
            Some(quality::compare(&image, &reference, edges.as_deref())?)
        };
        if settings.view == DebugView::Image {
            image.write_png(&out.join("image.png"))?;
        } else {
            // A debug view is made of displayable values, not of radiance.
            let bytes =
                image.rgba.iter().flat_map(|c| [c[0], c[1], c[2]].map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8));
            let shown = image::RgbImage::from_raw(width, height, bytes.collect()).unwrap_or_default();
            picture::write_png(&shown, &out.join("image.png"))?;
        }
        image.write_exr(&out.join("image.exr"))?;
        picture::write_png(&picture::heat_map(&counts, width, height, n)?, &out.join("samples.png"))?;
        let mut summary = None;
        if let Some(mut stats) = stats {
            stats.quality.grid = quality;
            summary = Some(stats.summary());
            write_json(&out.join("stats.json"), &stats)?;
        }
        if let Some(rays) = &host.rays {
            eprintln!("{}", rays.summary());
            rays.notices.iter().for_each(|notice| eprintln!("{notice}"));
        }
        let bands = shots.last().map_or(1, |shot| shot.statistics.bands);
        if bands > 1 {
            eprintln!("rendered in {bands} bands");
        }
        let sharing = shots.last().map_or(0, |shot| shot.statistics.without_rays);
        if sharing > 0 {
            eprintln!(
                "{sharing} samples took the ray results of their pixel's first one, as there was no room for their own: \
                 --set ray_samples={} keeps all",
                n - 1
            );
        }
        summary.iter().for_each(|summary| say(summary));
        say(&out.display().to_string());
        Ok(())
    }
}
