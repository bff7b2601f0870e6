//! `render`: one technique on one view, with everything that it wrote.

use super::{CommandError, ViewArgs, parse_preset, parse_technique, set};
use crate::picture;
use crate::quality;
use crate::stats::Stats;
use deferred_aa::{DebugView, Preset, Settings, Technique};
use std::path::Path;

/// See `deferred-aa-demo render --help`.
#[derive(Debug, clap::Args)]
pub struct Render {
    #[command(flatten)]
    view: ViewArgs,
    /// full, single or windowed.
    #[arg(long, default_value = "windowed", value_parser = parse_technique)]
    technique: Technique,
    /// The settings of windowed: fast, balanced or quality.
    #[arg(long, default_value = "balanced", value_parser = parse_preset)]
    preset: Preset,
    /// On top of the preset, any field of the settings by its path, such as windowed.luminance_scale=40 or execution=loop; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Measured frames, after one that warms up.
    #[arg(long, default_value_t = 1)]
    frames: u32,
    /// Leaves the grid reference out: no quality in stats.json, but no frame of full supersampling either.
    #[arg(long)]
    no_reference: bool,
}

impl Render {
    pub fn run(self) -> Result<(), CommandError> {
        let settings = set::apply(Settings { technique: self.technique, ..self.preset.settings() }, &self.settings)?;
        let (mut host, camera) = self.view.open()?;
        let out = &self.view.out;

        let mut shots = Vec::new();
        for frame in 0..=self.frames.max(1) {
            let shot = host.frame(&camera, settings)?;
            if frame > 0 {
                shots.push(shot);
            }
        }
        let image = host.picture();
        let counts = host.counts(settings.technique);
        let (width, height) = (host.options.width, host.options.height);
        let n = host.options.m * host.options.m;

        let quality = if self.no_reference || settings.view != DebugView::Image {
            None
        } else {
            let grid = Settings { technique: Technique::Full, ..settings };
            let grid = Settings { weight: deferred_aa::Weight::Linear, ..grid };
            let reference = if settings == grid {
                image.clone()
            } else {
                host.frame(&camera, grid)?;
                host.picture()
            };
            Some(quality::compare(&image, &reference, Some(&host.edge_mask()))?)
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
        if let Some(stats) = Stats::new(&host, settings, &shots, quality) {
            write_json(&out.join("stats.json"), &stats)?;
        }
        eprintln!("wrote {}", out.display());
        Ok(())
    }
}

/// Written whole or not at all.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), CommandError> {
    let file = |source| CommandError::File { path: path.to_owned(), source };
    let text = serde_json::to_string_pretty(value).map_err(|e| file(e.into()))?;
    let part = path.with_extension("json.part");
    std::fs::write(&part, text + "\n").map_err(file)?;
    std::fs::rename(&part, path).map_err(file)
}
