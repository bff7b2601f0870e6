//! The plan, measured.

use super::plan::{Cell, Plan};
use super::schema::{Bench, LeftOut, Measured, OVER, Row};
use crate::host::gpu::{Gpu, GpuError};
use crate::host::{self, Host, HostError, Options, Shot};
use crate::measure::quality::{self, QualityError};
use crate::measure::stats::{Adapter, Spread, Stats};
use crate::picture::Picture;
use crate::scene::Camera;
use crate::scene::builtin::builtin;
use deferred_aa::{GBufferTier, Ids, PassKind, Settings, TextureTier};
use std::time::{Duration, Instant};

/// Why a cell could not be measured.
#[derive(Debug, thiserror::Error)]
enum CellError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Host(#[from] HostError),
    #[error(transparent)]
    Quality(#[from] QualityError),
    #[error("no built-in scene of this name")]
    Scene,
}

/// Measures cell after cell until the plan or the time ends. `begin` is told of each with its number, `done` of what
/// there is after each that could be measured.
pub fn run(
    adapter: &wgpu::Adapter,
    plan: &Plan,
    minutes: f64,
    mut begin: impl FnMut(usize, &Cell),
    mut done: impl FnMut(&Bench),
) -> Bench {
    let start = Instant::now();
    let end = start + Duration::from_secs_f64(minutes * 60.0);
    let mut bench = Bench {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        adapter: Adapter::of_adapter(adapter),
        software: adapter.get_info().device_type == wgpu::DeviceType::Cpu,
        size: plan.size,
        seconds: 0.0,
        measured: Vec::new(),
        left_out: Vec::new(),
    };
    let mut last: Option<(Cell, Host)> = None;
    let mut longest = Duration::ZERO;
    for (i, cell) in plan.cells.iter().enumerate() {
        let left_out = |why: String| LeftOut { cell: cell.clone(), why };
        let left = end.saturating_duration_since(Instant::now());
        // What takes half as long as the longest so far would end late.
        if left <= longest / 2 {
            bench.left_out.push(left_out(OVER.to_owned()));
            continue;
        }
        begin(i, cell);
        // Twice an even share, since small scenes leave some of theirs.
        let share = 2.0 / (plan.cells.len() - i) as f64;
        let began = Instant::now();
        // Another light loop needs no new node, whose pipelines take seconds to compile.
        let reused = last.take().filter(|(other, _)| Cell { stall: cell.stall, ..other.clone() } == *cell);
        let host = reused.map_or_else(|| host(adapter, plan.size, cell), |(_, host)| Ok(host));
        match host.and_then(|host| measure(host, plan, cell, left.mul_f64(share.min(1.0)))) {
            Ok((measured, host)) => {
                last = Some((cell.clone(), host));
                longest = longest.max(began.elapsed());
                bench.measured.push(measured);
                bench.seconds = start.elapsed().as_secs_f64();
                done(&bench);
            }
            Err(e) => bench.left_out.push(left_out(e.to_string())),
        }
    }
    bench.seconds = start.elapsed().as_secs_f64();
    bench
}

/// An entry that is being measured.
struct Entry {
    label: String,
    settings: Settings,
    picture: Picture,
    shots: Vec<Shot>,
    wall_ms: Vec<f64>,
}

/// Measures the entries of a cell in turn, for as long as it may take, but once in any case.
fn measure(mut host: Host, plan: &Plan, cell: &Cell, time: Duration) -> Result<(Measured, Host), CellError> {
    let start = Instant::now();
    let camera = host.scene.default_camera();
    host.set_stall(cell.stall);
    let mut entries = Vec::new();
    for (label, settings) in cell.entries() {
        // The frame that warms up is the picture too: the same frame twice is the same bits.
        host.frame(&camera, settings)?;
        let picture = host.picture();
        entries.push(Entry { label, settings, picture, shots: Vec::new(), wall_ms: Vec::new() });
    }
    for round in 0..plan.frames {
        // No round begins that would not end in time.
        let rounds = round + 1;
        if round > 0 && start.elapsed() * (rounds + 1) / rounds > time {
            break;
        }
        entries.iter_mut().try_for_each(|entry| entry.shoot(&mut host, &camera))?;
    }
    let reference = entries.last().map(|entry| entry.picture.clone()).filter(|_| entries.len() > 1);
    let rows = entries.iter().map(|entry| entry.row(&host, reference.as_ref())).collect::<Result<_, _>>()?;
    let gbuffer = match host.options.gbuffer {
        GBufferTier::Visibility(_) => "visibility",
        GBufferTier::Stored(_) => "stored",
    };
    Ok((Measured { cell: cell.clone(), gbuffer: gbuffer.to_owned(), rows }, host))
}

/// A host of its own, with what the cell needs and no more.
fn host(adapter: &wgpu::Adapter, (width, height): (u32, u32), cell: &Cell) -> Result<Host, CellError> {
    let scene = builtin(&cell.scene).ok_or(CellError::Scene)?;
    let settings = Settings::default();
    let traces = host::traces(&scene, &settings);
    let (textures, rays) = (TextureTier::Arrays, cell.rays());
    let gbuffer = if cell.visibility {
        let wanted = GBufferTier::Visibility(Ids::Wide);
        host::gbuffer_for(wanted, &scene, adapter, textures, traces.then_some(rays))
    } else {
        host::stored(&scene)
    };
    let options = Options { stall: cell.stall, rays, traces, gbuffer, ..Options::new(width, height, cell.m) };
    let gpu = Gpu::new(adapter.clone(), &options.descriptor())?;
    Ok(Host::new(gpu, scene, options)?)
}

impl Entry {
    fn shoot(&mut self, host: &mut Host, camera: &Camera) -> Result<(), HostError> {
        let start = Instant::now();
        self.shots.push(host.frame(camera, self.settings)?);
        self.wall_ms.push(start.elapsed().as_secs_f64() * 1e3);
        Ok(())
    }

    fn row(&self, host: &Host, reference: Option<&Picture>) -> Result<Row, CellError> {
        let pixels = f64::from(host.options.width) * f64::from(host.options.height);
        let stats = Stats::new(host, self.settings, &self.shots, None);
        let (stats, last) = stats.zip(self.shots.last()).ok_or(HostError::NoStatistics)?;
        let speeds = self.shots.iter().filter_map(rays_per_second).collect();
        let rays = &stats.rays;
        Ok(Row {
            label: self.label.clone(),
            frames: self.shots.len() as u32,
            k: stats.samples.mean_k,
            ratio: stats.samples.ratio,
            taps: stats.samples.taps as f64 / pixels,
            psnr_db: reference.map(|reference| quality::psnr(&self.picture, reference)).transpose()?,
            rays: rays.shadow + rays.reflection + rays.refraction,
            rays_per_second: Spread::of(speeds).map(|s| s.median),
            wall_ms: Spread::of(self.wall_ms.clone()),
            gbuffer_bytes: stats.memory_bytes.gbuffer(),
            other_bytes: stats.memory_bytes.others(),
            not_finite: u64::from(last.statistics.not_finite),
            without_rays: u64::from(last.statistics.without_rays),
            time_ms: stats.time_ms,
        })
    }
}

/// All rays of a frame over the time of the passes that trace them.
fn rays_per_second(shot: &Shot) -> Option<f64> {
    let statistics = &shot.statistics;
    let traces = statistics.passes.iter().filter(|p| matches!(p.kind, PassKind::Trace | PassKind::Reflect));
    let ms = traces.map(|pass| pass.milliseconds).sum::<Option<f64>>().filter(|&ms| ms > 0.0)?;
    let rays = [statistics.shadow_rays, statistics.reflection_rays, statistics.refraction_rays];
    Some(rays.into_iter().map(f64::from).sum::<f64>() / (ms * 1e-3)).filter(|&speed| speed > 0.0)
}
