//! `demo`: Single, Windowed and Full side by side, with what each costs.

use super::render::write_json;
use super::{CommandError, ViewArgs, set};
use crate::host::Shot;
use crate::picture::{self, Panel, Picture};
use crate::quality::{self, Quality};
use crate::stats::Stats;
use deferred_aa::{Settings, Technique};

/// See `deferred-aa-demo demo --help`.
#[derive(Debug, clap::Args)]
pub struct Demo {
    #[command(flatten)]
    view: ViewArgs,
    /// Any field of the settings by its path; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Measured frames of each technique, interleaved, after one that warms up.
    #[arg(long, default_value_t = 3)]
    frames: u32,
}

const TECHNIQUES: [(Technique, &str); 3] =
    [(Technique::Single, "Single"), (Technique::Windowed, "Windowed"), (Technique::Full, "Full")];

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
        let base = set::apply(Settings::default(), &self.settings)?;
        let (mut host, camera) = self.view.open()?;
        let out = &self.view.out;
        let mut entries = Vec::new();
        for (technique, title) in TECHNIQUES {
            let settings = Settings { technique, ..base };
            // The frame that warms up is the picture too: the same frame twice is the same bits.
            host.frame(&camera, settings)?;
            let (picture, counts) = (host.picture(), host.counts(technique));
            entries.push(Entry { title, settings, shots: Vec::new(), picture, counts });
        }
        for _ in 0..self.frames.max(1) {
            for entry in &mut entries {
                let shot = host.frame(&camera, entry.settings)?;
                entry.shots.push(shot);
            }
        }
        let mask = host.edge_mask();
        let reference = entries[2].picture.clone();
        let mut rows = Vec::new();
        for entry in &entries {
            let quality = quality::compare(&entry.picture, &reference, Some(&mask))?;
            if let Some(stats) = Stats::new(&host, entry.settings, &entry.shots, Some(quality.clone())) {
                let name = entry.title.to_lowercase();
                entry.picture.write_png(&out.join(format!("{name}.png")))?;
                write_json(&out.join(format!("{name}.json")), &stats)?;
                rows.push((entry, stats, quality));
            }
        }
        let (width, height, n) = (host.options.width, host.options.height, host.options.m * host.options.m);
        let map = picture::heat_map(&rows[1].0.counts, width, height, n)?;
        picture::write_png(&map, &out.join("samples.png"))?;

        let images: Vec<_> = rows.iter().map(|(e, ..)| e.picture.to_image()).collect::<Result<_, _>>()?;
        let captions: Vec<_> = rows.iter().map(|(_, stats, quality)| caption(stats, quality)).collect();
        let mut panels: Vec<_> = rows
            .iter()
            .zip(&images)
            .zip(&captions)
            .map(|(((entry, ..), image), caption)| Panel { title: entry.title, caption, image, legend: None })
            .collect();
        let map_caption = format!("samples a pixel, 1 to {n}");
        panels.push(Panel { title: "k of Windowed", caption: &map_caption, image: &map, legend: Some(n) });
        let crops = picture::pick_crops(&rows[0].0.picture, &rows[2].0.picture, 4, 48)?;
        let heading = format!(
            "{}  {width}×{height}, m = {}, {}",
            host.scene.name,
            host.options.m,
            host.gpu.adapter.get_info().name
        );
        let strip = out.join("strip.png");
        picture::write_png(&picture::strip(&heading, &panels, &crops)?, &strip)?;

        println!("{heading}");
        print_table(&rows.iter().map(|(e, s, q)| (e.title, s, q)).collect::<Vec<_>>());
        println!("{}", strip.display());
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
fn print_table(rows: &[(&str, &Stats, &Quality)]) {
    const PASSES: [&str; 8] = ["gbuffer", "first", "metrics", "plan", "shade", "resolve", "node", "total"];
    print!("{:<10}{:>12}{:>8}{:>8}{:>11}", "", "samples", "k", "ratio", "PSNR");
    PASSES.iter().for_each(|p| print!("{p:>9}"));
    println!();
    for (title, stats, quality) in rows {
        let s = &stats.samples;
        print!("{title:<10}{:>12}{:>8.2}{:>7.1}%{:>11}", s.shaded, s.mean_k, s.ratio * 100.0, decibels(quality));
        for pass in PASSES {
            match stats.time_ms.get(pass) {
                Some(spread) => print!("{:>9.1}", spread.median),
                None => print!("{:>9}", "-"),
            }
        }
        println!();
    }
    println!("times: median milliseconds; node: the passes first to resolve; total: with the G-buffer");
}
