//! What adaptive supersampling costs beside full supersampling: GPU time of the presets over that of `Full`, frame by
//! frame in turn, on the built-in atrium. Ratios hold where milliseconds drift. `cargo bench --bench supersampling`

use deferred_aa::{Preset, Settings, Technique, TextureTier};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options, Shot};
use deferred_aa_demo::scene::builtin::builtin;
use deferred_aa_demo::stats::Spread;
use std::error::Error;
use std::time::{Duration, Instant};

const SCENE: &str = "atrium";
const SIZE: (u32, u32) = (480, 270);

/// Samples along one side of a window, and how often the light loop runs.
const CASES: [(u32, u32); 4] = [(2, 1), (2, 8), (4, 1), (4, 8)];

const MOST_ROUNDS: usize = 20;
const LEAST_ROUNDS: usize = 3;
/// For each case, when it has its least rounds.
const TIME: Duration = Duration::from_secs(12);

fn main() -> Result<(), Box<dyn Error>> {
    let adapter = match gpu::choose(None) {
        Ok(adapter) => adapter,
        Err(e) => {
            println!("nothing measured: {e}");
            return Ok(());
        }
    };
    if !adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        println!("nothing measured: {} has no timestamps", adapter.get_info().name);
        return Ok(());
    }
    let (width, height) = SIZE;
    println!("{SCENE} {width}×{height}, {}", adapter.get_info().name);
    println!("samples and GPU time over those of Full; times: min, median, 95th percentile over rounds");
    println!(
        "{:>3}{:>7}{:>8}  {:<20}{:>9}{:>27}{:>27}",
        "m", "stall", "rounds", "", "samples", "node", "with G-buffer"
    );
    for (m, stall) in CASES {
        case(adapter.clone(), m, stall)?;
    }
    Ok(())
}

/// Of one preset over Full, one entry a round.
#[derive(Default)]
struct Ratios {
    samples: f64,
    node: Vec<f64>,
    total: Vec<f64>,
}

fn case(adapter: wgpu::Adapter, m: u32, stall: u32) -> Result<(), Box<dyn Error>> {
    let textures = TextureTier::Arrays;
    let options = Options { textures, stall, ..Options::new(SIZE.0, SIZE.1, m) };
    let gpu = Gpu::new(adapter, &options.descriptor())?;
    let scene = builtin(SCENE).ok_or("no such scene")?;
    let camera = scene.default_camera();
    let mut host = Host::new(gpu, scene, options)?;
    let full = Settings { technique: Technique::Full, ..Default::default() };
    let with = |technique| Preset::ALL.map(|preset| Settings { technique, ..preset.settings() });
    let tried = [with(Technique::Windowed), with(Technique::Surfaces)].concat();
    let mut all: Vec<Ratios> = tried.iter().map(|_| Ratios::default()).collect();
    // Warms up: pipelines are compiled at their first use.
    for settings in [full].iter().chain(&tried) {
        host.frame(&camera, *settings)?;
    }
    let begin = Instant::now();
    let mut rounds = 0;
    while rounds < MOST_ROUNDS && (rounds < LEAST_ROUNDS || begin.elapsed() < TIME) {
        let reference = times(&host.frame(&camera, full)?);
        for (settings, ratios) in tried.iter().zip(&mut all) {
            let shot = host.frame(&camera, *settings)?;
            ratios.samples = shot.statistics.ratio;
            if let (Some(own), Some(reference)) = (times(&shot), reference) {
                ratios.node.push(own.0 / reference.0);
                ratios.total.push(own.1 / reference.1);
            }
        }
        rounds += 1;
    }
    for ((settings, preset), ratios) in tried.iter().zip(Preset::ALL.into_iter().cycle()).zip(all) {
        let (samples, node, total) = (ratios.samples * 100.0, spread(ratios.node), spread(ratios.total));
        println!(
            "{m:>3}{stall:>7}{rounds:>8}  {:<20}{samples:>8.1}%{node:>27}{total:>27}",
            format!("{:?} {preset:?}", settings.technique)
        );
    }
    Ok(())
}

/// Milliseconds of the node's passes together, and with the G-buffer.
fn times(shot: &Shot) -> Option<(f64, f64)> {
    let node: f64 = shot.statistics.passes.iter().map(|p| p.milliseconds).sum::<Option<f64>>()?;
    Some((node, node + shot.gbuffer_ms?))
}

fn spread(ratios: Vec<f64>) -> String {
    let percent = |s: Spread| format!("{:.1} {:.1} {:.1} %", s.min * 100.0, s.median * 100.0, s.p95 * 100.0);
    Spread::of(ratios).map_or("no times".to_owned(), percent)
}
