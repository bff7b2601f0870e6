//! `demo`: what each kind of anti-aliasing makes of one view, and what it costs.

use super::args::{ViewArgs, frames, parse_preset};
use super::error::CommandError;
use super::output::{say, write_json};
use super::set;
use crate::host::raster::node_camera;
use crate::host::{Host, HostError, Options, Shot};
use crate::measure::quality::{self, Quality};
use crate::measure::reference;
use crate::measure::stats::Stats;
use crate::peers::{Peer, Peers};
use crate::picture::{self, Panel, Picture};
use crate::report::ReportError;
use crate::report::parts::truth;
use crate::scene::Camera;
use deferred_aa::{Preset, Settings, Surfaces, Technique};
use indicatif::{ProgressBar, ProgressStyle};

/// See `deferred-aa-demo demo --help`.
#[derive(Debug, clap::Args)]
pub struct Demo {
    #[command(flatten)]
    view: ViewArgs,
    /// The settings of Windowed and Surfaces: fast, balanced or quality.
    #[arg(long, default_value = "balanced", value_parser = parse_preset)]
    preset: Preset,
    /// On top of the preset, any field of the settings by its path; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Measured frames of each technique, interleaved, after one that warms up.
    #[arg(long, default_value_t = 3, value_parser = frames())]
    frames: u32,
}

/// What is measured, and the name of its files.
const ENTRIES: [(&str, &str, Technique, Option<Peer>); 7] = [
    ("No AA", "none", Technique::Single, None),
    ("FXAA", "fxaa", Technique::Single, Some(Peer::Fxaa)),
    ("SMAA 1x", "smaa", Technique::Single, Some(Peer::Smaa)),
    ("Windowed", "windowed", Technique::Windowed, None),
    ("Surfaces, once", ONCE, Technique::Surfaces, None),
    ("Surfaces", "surfaces", Technique::Surfaces, None),
    ("Full", "full", Technique::Full, None),
];
/// Of [`ENTRIES`]. The first ones, which light one sample a pixel, need no more than that of the G-buffer.
const PLAIN: usize = 3;
const WINDOWED: usize = 3;
const FULL: usize = 6;
/// The columns of strip.png and those of crops.png.
const IN_STRIP: [usize; 4] = [0, 3, 5, 6];
const IN_CROPS: [usize; 6] = [0, 2, 3, 4, 5, 6];

/// The name of the files of [`Surfaces::ONCE`].
const ONCE: &str = "surfaces-once";

/// Everything about one technique.
struct Entry {
    title: &'static str,
    file: &'static str,
    settings: Settings,
    peer: Option<Peer>,
    shots: Vec<Shot>,
    picture: Picture,
    counts: Vec<u32>,
}

/// A measured one.
struct Row<'a> {
    entry: &'a Entry,
    stats: Stats,
    quality: Quality,
}

impl Demo {
    pub fn run(self) -> Result<(), CommandError> {
        let base = set::apply(self.preset.settings(), &self.settings)?;
        let (mut host, camera) = self.view.open(&base)?;
        // One sample a pixel, as rendered by those who do not supersample.
        let options = Options { m: 1, ..host.options };
        let mut plain = Host::new(host.gpu.clone(), host.scene.clone(), options)?;
        let mut peers = Peers::new(&host.gpu, options.width, options.height)?;
        let truth = truth(&mut host, &camera, base)?;
        let mut entries = Vec::new();
        for (i, (title, file, technique, peer)) in ENTRIES.into_iter().enumerate() {
            let surfaces = if file == ONCE { Surfaces::ONCE } else { base.surfaces };
            let settings = Settings { technique, surfaces, ..base };
            let mut entry =
                Entry { title, file, settings, peer, shots: Vec::new(), picture: truth.clone(), counts: Vec::new() };
            let host = if i < PLAIN { &mut plain } else { &mut host };
            // The frame that warms up is the picture too: the same frame twice is the same bits.
            entry.shoot(host, &mut peers, &camera)?;
            entry.picture = if peer.is_some() { peers.picture() } else { host.picture() };
            entry.counts = host.counts(technique);
            entries.push(entry);
        }
        let mask = host.edge_mask();
        for _ in 0..self.frames {
            for (i, entry) in entries.iter_mut().enumerate() {
                let host = if i < PLAIN { &mut plain } else { &mut host };
                let shot = entry.shoot(host, &mut peers, &camera)?;
                entry.shots.push(shot);
            }
        }
        let mut rows = Vec::new();
        for (i, entry) in entries.iter().enumerate() {
            let host = if i < PLAIN { &plain } else { &host };
            let quality = quality::compare(&entry.picture, &truth, Some(&mask))?;
            rows.extend(Stats::new(host, entry.settings, &entry.shots, None).map(|stats| {
                let mut stats = entry.peer.map_or(stats.clone(), |peer| stats.of_peer(peer.name()));
                stats.quality.truth = Some(quality);
                Row { entry, stats, quality }
            }));
        }
        let heading = format!(
            "{}  {}×{}, m = {}, {}",
            host.scene.name,
            options.width,
            options.height,
            host.options.m,
            host.gpu.adapter.get_info().name
        );
        self.write(&heading, &host, &rows, &truth)?;
        let strip = self.view.scene.out.join("strip.png");
        say(&format!("{heading}\n{}{}", table(&rows), strip.display()));
        Ok(())
    }

    /// Writes the pictures.
    fn write(&self, heading: &str, host: &Host, rows: &[Row<'_>], truth: &Picture) -> Result<(), CommandError> {
        let out = &self.view.scene.out;
        let (width, height, n) = (host.options.width, host.options.height, host.options.m * host.options.m);
        for Row { entry, stats, .. } in rows {
            entry.picture.write_png(&out.join(format!("{}.png", entry.file)))?;
            entry.picture.write_exr(&out.join(format!("{}.exr", entry.file)))?;
            write_json(&out.join(format!("{}.json", entry.file)), stats)?;
        }
        truth.write_png(&out.join("truth.png"))?;
        let Some(windowed) = rows.get(WINDOWED) else { return Ok(()) };
        let map = picture::heat_map(&windowed.entry.counts, width, height, n)?;
        picture::write_png(&map, &out.join("samples.png"))?;

        let images: Vec<_> = rows.iter().map(|row| row.entry.picture.to_image()).collect::<Result<_, _>>()?;
        let captions: Vec<_> = rows.iter().map(|row| caption(row, &rows[0])).collect();
        let panel =
            |&i: &usize| Panel { title: rows[i].entry.title, caption: &captions[i], image: &images[i], legend: None };
        let mut panels: Vec<_> = IN_STRIP.iter().map(panel).collect();
        let map_caption = format!("samples a pixel, 1 to {n}");
        panels.push(Panel { title: "k of Windowed", caption: &map_caption, image: &map, legend: Some(n) });
        let crops = picture::pick_crops(&rows[0].entry.picture, truth, 4, 48)?;
        picture::write_png(&picture::strip(heading, &panels, &crops)?, &out.join("strip.png"))?;

        let panels: Vec<_> = IN_CROPS.iter().map(panel).collect();
        let crops = &crops[..crops.len().min(3)];
        picture::write_png(&picture::sheet(heading, &panels, crops, 4)?, &out.join("crops.png"))?;
        Ok(())
    }
}

impl Entry {
    /// A frame of it; a peer's pass comes last.
    fn shoot(&self, host: &mut Host, peers: &mut Peers, camera: &Camera) -> Result<Shot, HostError> {
        let mut shot = host.frame(camera, self.settings)?;
        if let Some(peer) = self.peer {
            shot.statistics.passes.push(peers.run(peer, host.target())?.pass(peer.name()));
        }
        Ok(shot)
    }
}

/// The mean of 16 times as many samples as `Full` has.
fn truth(host: &mut Host, camera: &Camera, base: Settings) -> Result<Picture, ReportError> {
    let (width, height, m) = (host.options.width, host.options.height, host.options.m);
    // Hidden where stderr is no terminal.
    let bar = ProgressBar::new(16);
    if let Ok(style) =
        ProgressStyle::with_template(&format!("truth of {} samples a pixel: {{pos}} of {{len}}", 16 * m * m))
    {
        bar.set_style(style);
    }
    let tick = || {
        bar.inc(1);
        Ok(())
    };
    let camera = node_camera(camera, width, height);
    let picture = truth::render(host, camera, 4 * m, reference::truth(base), tick)?;
    bar.finish_and_clear();
    Ok(picture)
}

/// Of a row beside the first one, which is not anti-aliased.
fn caption(row: &Row<'_>, first: &Row<'_>) -> String {
    let lit = row.stats.samples.mean_k;
    let mut figures = vec![format!("{lit:.1} lit a pixel"), format!("{} dB", decibels(row.quality.psnr_db))];
    let times = first.stats.node_ms().zip(row.stats.node_ms());
    figures.extend(times.map(|(first, own)| format!("shading ×{:.1}", own / first)));
    figures.join("  ")
}

fn decibels(psnr_db: Option<f64>) -> String {
    psnr_db.filter(|&db| db < quality::IDENTICAL_DB).map_or("-".to_owned(), |db| format!("{db:.1}"))
}

/// Median milliseconds; on a software driver only their ratios count.
fn table(rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "{:<16}{:>7}{:>7}{:>8}{:>8}{:>9}{:>11}{:>10}{:>10}{:>9}{:>8}\n",
        "", "lit", "taps", "PSNR", "edges", "FLIP", "G-buffer", "shading", "frame", "of Full", "MB"
    );
    let full = rows.get(FULL).and_then(|row| row.stats.time_ms.get("total")).map(|spread| spread.median);
    for Row { entry, stats, quality } in rows {
        let samples = &stats.samples;
        let ms = |name: &str| stats.time_ms.get(name).map(|spread| spread.median);
        let number = |ms: Option<f64>| ms.map_or("-".to_owned(), |ms| format!("{ms:.1}"));
        let of_full = ms("total").zip(full).map_or("-".to_owned(), |(ms, full)| format!("{:.0} %", ms / full * 100.0));
        let taps = samples.taps as f64 / samples.shaded.max(1) as f64 * samples.mean_k;
        text += &format!(
            "{:<16}{:>7.2}{taps:>7.1}{:>8}{:>8}{:>9}{:>11}{:>10}{:>10}{of_full:>9}{:>8.0}\n",
            entry.title,
            samples.mean_k,
            decibels(quality.psnr_db),
            decibels(quality.edge_psnr_db),
            quality.flip_mean.map_or("-".to_owned(), |flip| format!("{flip:.4}")),
            number(ms("gbuffer")),
            number(ms("node")),
            number(ms("total")),
            (stats.memory_bytes.gbuffer() + stats.memory_bytes.others()) as f64 * 1e-6,
        );
    }
    text + "lit: lit samples a pixel; taps: material evaluations a pixel; PSNR, edges, FLIP: against the truth, edges \
            where a window holds one;\ntimes: median milliseconds; shading: all passes after the G-buffer, rays and \
            peers' among them; MB: what the node holds\n"
}
