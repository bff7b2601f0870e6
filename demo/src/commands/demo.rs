//! `demo`: Single, Windowed and Full side by side, with what each costs.

use super::args::{ViewArgs, frames, parse_preset};
use super::error::CommandError;
use super::output::{say, write_json};
use super::set;
use crate::host::Shot;
use crate::measure::quality::{self, Quality};
use crate::measure::stats::Stats;
use crate::picture::{self, Panel, Picture};
use deferred_aa::{Execution, Preset, Settings, Technique};

/// See `deferred-aa-demo demo --help`.
#[derive(Debug, clap::Args)]
pub struct Demo {
    #[command(flatten)]
    view: ViewArgs,
    /// The settings of Windowed: fast, balanced or quality.
    #[arg(long, default_value = "balanced", value_parser = parse_preset)]
    preset: Preset,
    /// On top of the preset, any field of the settings by its path; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Measured frames of each technique, interleaved, after one that warms up.
    #[arg(long, default_value_t = 3, value_parser = frames())]
    frames: u32,
}

/// What is measured. The second execution of Windowed has a row of the table, not a picture of its own.
const ENTRIES: [(Technique, Execution, &str); 4] = [
    (Technique::Single, Execution::Sorted, "Single"),
    (Technique::Windowed, Execution::Sorted, "Windowed"),
    (Technique::Windowed, Execution::Loop, "  as Loop"),
    (Technique::Full, Execution::Sorted, "Full"),
];
const SHOWN: [usize; 3] = [0, 1, 3];
const WINDOWED: usize = 1;
const FULL: usize = 3;

/// Everything about one technique.
struct Entry {
    title: &'static str,
    settings: Settings,
    shots: Vec<Shot>,
    picture: Picture,
    counts: Vec<u32>,
}

impl Demo {
    pub fn run(self) -> Result<(), CommandError> {
        let base = set::apply(self.preset.settings(), &self.settings)?;
        let (mut host, camera) = self.view.open(&base)?;
        let out = &self.view.scene.out;
        let mut entries = Vec::new();
        for (technique, execution, title) in ENTRIES {
            let settings = Settings { technique, execution, ..base };
            // The frame that warms up is the picture too: the same frame twice is the same bits.
            host.frame(&camera, settings)?;
            let (picture, counts) = (host.picture(), host.counts(technique));
            entries.push(Entry { title, settings, shots: Vec::new(), picture, counts });
        }
        for _ in 0..self.frames {
            for entry in &mut entries {
                let shot = host.frame(&camera, entry.settings)?;
                entry.shots.push(shot);
            }
        }
        let mask = host.edge_mask();
        let reference = &entries[FULL].picture;
        let mut rows = Vec::new();
        for entry in &entries {
            let quality = quality::compare(&entry.picture, reference, Some(&mask))?;
            rows.extend(Stats::new(&host, entry.settings, &entry.shots, Some(quality)).map(|s| (entry, s, quality)));
        }
        let (width, height, n) = (host.options.width, host.options.height, host.options.m * host.options.m);
        let map = picture::heat_map(&entries[WINDOWED].counts, width, height, n)?;
        picture::write_png(&map, &out.join("samples.png"))?;

        let mut columns = Vec::new();
        for (entry, stats, quality) in SHOWN.into_iter().filter_map(|i| rows.get(i)) {
            let name = entry.title.to_lowercase();
            entry.picture.write_png(&out.join(format!("{name}.png")))?;
            entry.picture.write_exr(&out.join(format!("{name}.exr")))?;
            write_json(&out.join(format!("{name}.json")), stats)?;
            columns.push((entry.title, caption(stats, quality), entry.picture.to_image()?));
        }
        let mut panels: Vec<_> =
            columns.iter().map(|(title, caption, image)| Panel { title, caption, image, legend: None }).collect();
        let map_caption = format!("samples a pixel, 1 to {n}");
        panels.push(Panel { title: "k of Windowed", caption: &map_caption, image: &map, legend: Some(n) });
        let crops = picture::pick_crops(&entries[0].picture, reference, 4, 48)?;
        let adapter = host.gpu.adapter.get_info().name;
        let heading = format!("{}  {width}×{height}, m = {}, {adapter}", host.scene.name, host.options.m);
        let strip = out.join("strip.png");
        picture::write_png(&picture::strip(&heading, &panels, &crops)?, &strip)?;

        let rows: Vec<_> = rows.iter().map(|(e, s, q)| (e.title, s, q)).collect();
        let table = table(&rows, u64::from(width) * u64::from(height));
        say(&format!("{heading}\n{table}{}", strip.display()));
        Ok(())
    }
}

fn caption(stats: &Stats, quality: &Quality) -> String {
    let mut figures = vec![format!("k {:.2}", stats.samples.mean_k), format!("{:.1} %", stats.samples.ratio * 100.0)];
    figures.push(decibels(quality));
    if let Some(ms) = stats.node_ms() {
        figures.push(format!("{ms:.0} ms"));
    }
    figures.join("  ")
}

fn decibels(quality: &Quality) -> String {
    match quality.psnr_db {
        Some(db) if db >= quality::IDENTICAL_DB => "reference".to_owned(),
        Some(db) => format!("{db:.1} dB"),
        None => "-".to_owned(),
    }
}

/// Median milliseconds by pass; on a software driver only their ratios count.
fn table(rows: &[(&str, &Stats, &Quality)], pixels: u64) -> String {
    const PASSES: [&str; 8] = ["gbuffer", "first", "metrics", "plan", "shade", "resolve", "node", "total"];
    let mut text = format!("{:<10}{:>12}{:>8}{:>8}{:>11}", "", "samples", "k", "ratio", "PSNR");
    PASSES.iter().for_each(|p| text += &format!("{p:>9}"));
    text += &format!("{:>7}\n", "β");
    for (title, stats, quality) in rows {
        let s = &stats.samples;
        text +=
            &format!("{title:<10}{:>12}{:>8.2}{:>7.1}%{:>11}", s.shaded, s.mean_k, s.ratio * 100.0, decibels(quality));
        for pass in PASSES {
            let ms = stats.time_ms.get(pass).map_or("-".to_owned(), |spread| format!("{:.1}", spread.median));
            text += &format!("{ms:>9}");
        }
        let beta = rows.last().and_then(|(_, full, _)| stats.beta(full, pixels));
        text += &format!("{:>7}\n", beta.map_or("-".to_owned(), |b| format!("{b:.2}")));
    }
    text + "times: median milliseconds; node: the passes first to resolve; total: with the G-buffer\n\
            β: time of a sample beyond the first over that of a sample of Full\n"
}
