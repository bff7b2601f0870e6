//! What a frame did: counted on the GPU, read back without waiting.

use crate::audit::{self, Audited};
use crate::goal::{Controller, GoalProgress, Measured};
use crate::scratch;
use crate::settings::Technique;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// `DaaStatistics` of statistics.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Counters {
    pub histogram: [u32; 64],
    pub not_finite: u32,
    pub negative: u32,
    pub overflowed_tiles: u32,
    pub decided: [u32; 7],
    pub shadow_rays: u32,
    pub reflection_rays: u32,
    pub refraction_rays: u32,
    pub tiles: [u32; 2],
    pub quadrants: [u32; 9],
    pub points: [u32; 5],
}

pub(crate) const COUNTER_BYTES: u64 = size_of::<Counters>() as u64;

/// Most passes of a frame.
pub(crate) const MAX_PASSES: usize = 32;
const TIMESTAMP_BYTES: u64 = (MAX_PASSES * 2 * 8) as u64;
/// Where the timestamps lie in a read-back buffer, aligned as `resolve_query_set` copies want it.
const TIMESTAMPS_AT: u64 = COUNTER_BYTES.next_multiple_of(8);
/// Where the audited errors do.
const AUDITS_AT: u64 = TIMESTAMPS_AT + TIMESTAMP_BYTES;
/// Frames whose statistics may be under way at once.
const IN_FLIGHT: usize = 4;

/// What one frame did.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Statistics {
    /// Counted from 1 by [`record`](crate::DeferredAa::record).
    pub frame: u64,
    /// That was recorded.
    pub technique: Technique,
    /// Samples that the host's code shaded, first samples included.
    pub shaded: u64,
    /// `shaded` over n · w · h.
    pub ratio: f64,
    /// `shaded` over w · h.
    pub mean_k: f64,
    /// Windows by k: `histogram_k[0]` had k = 1. As long as n. Those of [`Technique::MultiResolution`] that were interpolated are in
    /// none.
    pub histogram_k: Vec<u32>,
    /// Windows whose k was decided by nothing (k = 1), depth, normal, luminance, identity, the least allowed, shadow.
    pub decided: [u32; 7],
    /// Active quadrants of [`Technique::Selective`] by what their threshold is for: colour, then object, normal, shadow and texture
    /// of what pixels show, then of what they reflect and refract.
    pub quadrants: [u32; 9],
    /// Points of [`Technique::MultiResolution`] that were shaded, those beyond the image's border included: on the lattice of the
    /// pixels, the shifted one, and those of every second, fourth and eighth pixel. Samples of refined windows come on top.
    pub points: [u32; 5],
    /// Samples that came back from the host's code with NaN or infinity, and were shaded black.
    pub not_finite: u32,
    /// Samples that came back with a negative component, and were clamped to 0.
    pub negative: u32,
    /// Tiles that wanted more than [`tile_limit`](crate::Windowed::tile_limit) samples and fell back to k = 1.
    pub overflowed_tiles: u32,
    /// Rays towards lights. Modulo 2³².
    pub shadow_rays: u32,
    /// Mirrored rays.
    pub reflection_rays: u32,
    /// Refracted rays.
    pub refraction_rays: u32,
    /// Tiles of 8 × 8 pixels by what rays were dispatched for.
    pub tiles: TileCounts,
    /// How far the search for [`Settings::goal`](crate::Settings::goal) had come when this frame's counters arrived.
    pub goal: Option<GoalProgress>,
    /// The passes in order, with their GPU time in milliseconds where the device has timestamps.
    pub passes: Vec<PassTime>,
}

/// Tiles of a frame, by class. One may be of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TileCounts {
    /// Of the frame.
    pub all: u32,
    /// Where a sample has a surface: shadow rays are dispatched there. 0 if the frame traces nothing.
    pub surface: u32,
    /// Where a sample's material sends rays: mirrored and refracted ones are dispatched there.
    pub bounce: u32,
}

/// A pass and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PassTime {
    /// As in [`PassInfo::name`](crate::PassInfo::name).
    pub name: &'static str,
    /// `None` without [`wgpu::Features::TIMESTAMP_QUERY`].
    pub milliseconds: Option<f64>,
}

/// What the CPU knows of a recorded frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recorded {
    pub frame: u64,
    pub technique: Technique,
    pub size: [u32; 2],
    pub m: u32,
    /// With a goal.
    pub effort: Option<f32>,
    /// With an audit.
    pub audited: Option<Audited>,
    pub names: [&'static str; MAX_PASSES],
    pub passes: usize,
}

impl Recorded {
    pub fn new(frame: u64, technique: Technique, size: [u32; 2], m: u32) -> Self {
        Self { frame, technique, size, m, effort: None, audited: None, names: [""; MAX_PASSES], passes: 0 }
    }

    pub fn push(&mut self, name: &'static str) {
        self.names[self.passes] = name;
        self.passes += 1;
    }
}

/// States of a buffer on its way back.
pub(crate) const FREE: u8 = 0;
pub(crate) const UNDER_WAY: u8 = 1;
pub(crate) const READY: u8 = 2;

#[derive(Debug)]
struct Slot {
    buffer: wgpu::Buffer,
    state: Arc<AtomicU8>,
    recorded: Option<Recorded>,
}

/// Frees its slot when the encoder is dropped without a submit, and the callback with it.
pub(crate) struct Landing {
    state: Arc<AtomicU8>,
    to: u8,
}

impl Landing {
    pub fn new(state: &Arc<AtomicU8>) -> Self {
        Self { state: state.clone(), to: FREE }
    }

    pub fn land(mut self, to: u8) {
        self.to = to;
    }
}

impl Drop for Landing {
    fn drop(&mut self) {
        self.state.store(self.to, Ordering::Release);
    }
}

/// Counters on their way from the GPU: a ring of buffers, none of which is ever waited for.
#[derive(Debug)]
pub(crate) struct Collector {
    slots: Vec<Slot>,
    queries: Option<wgpu::QuerySet>,
    resolved: Option<wgpu::Buffer>,
    nanoseconds_per_tick: f64,
    latest: Option<Statistics>,
}

impl Collector {
    pub fn new(device: &wgpu::Device) -> Self {
        let timed = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let slots = (0..IN_FLIGHT).map(|_| Slot {
            buffer: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("daa statistics read-back"),
                size: AUDITS_AT + audit::BYTES,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            state: Arc::new(AtomicU8::new(FREE)),
            recorded: None,
        });
        Self {
            slots: slots.collect(),
            queries: timed.then(|| {
                device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("daa"),
                    ty: wgpu::QueryType::Timestamp,
                    count: (MAX_PASSES * 2) as u32,
                })
            }),
            resolved: timed.then(|| {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("daa timestamps"),
                    size: TIMESTAMP_BYTES,
                    usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                })
            }),
            nanoseconds_per_tick: 1.0,
            latest: None,
        }
    }

    /// The query set and the indices at which pass number `pass` of the frame writes its begin and end.
    pub fn timestamps(&self, pass: usize) -> Option<(&wgpu::QuerySet, u32, u32)> {
        self.queries.as_ref().filter(|_| pass < MAX_PASSES).map(|q| (q, pass as u32 * 2, pass as u32 * 2 + 1))
    }

    /// Records the copies of a frame's counters. Without a free slot the frame goes uncounted: the host reads too rarely.
    pub fn collect(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        counters: &wgpu::Buffer,
        audits: &wgpu::Buffer,
        recorded: Recorded,
    ) {
        self.nanoseconds_per_tick = f64::from(queue.get_timestamp_period());
        let Some(slot) = self.slots.iter_mut().find(|s| s.state.load(Ordering::Acquire) == FREE) else { return };
        encoder.copy_buffer_to_buffer(counters, 0, &slot.buffer, 0, COUNTER_BYTES);
        if let (Some(queries), Some(resolved)) = (&self.queries, &self.resolved) {
            let count = recorded.passes.min(MAX_PASSES) as u32 * 2;
            encoder.resolve_query_set(queries, 0..count, resolved, 0);
            encoder.copy_buffer_to_buffer(resolved, 0, &slot.buffer, TIMESTAMPS_AT, TIMESTAMP_BYTES);
        }
        if recorded.audited.is_some() {
            encoder.copy_buffer_to_buffer(audits, 0, &slot.buffer, AUDITS_AT, audit::BYTES);
        }
        slot.state.store(UNDER_WAY, Ordering::Release);
        slot.recorded = Some(recorded);
        let landing = Landing::new(&slot.state);
        encoder.map_buffer_on_submit(&slot.buffer, wgpu::MapMode::Read, .., move |outcome| {
            landing.land(if outcome.is_ok() { READY } else { FREE });
        });
    }

    /// Takes in what has arrived, oldest first.
    pub fn poll(&mut self, controller: &mut Controller) {
        let ready = |slot: &Slot| slot.state.load(Ordering::Acquire) == READY;
        let age = |slot: &Slot| slot.recorded.map_or(0, |r| r.frame);
        while let Some(slot) = self.slots.iter_mut().filter(|s| ready(s)).min_by_key(|s| age(s)) {
            if let (Some(recorded), Ok(bytes)) = (slot.recorded.take(), slot.buffer.get_mapped_range(..)) {
                let timed = self.queries.is_some().then_some(self.nanoseconds_per_tick);
                let mut read = read(&bytes, &recorded, timed);
                if let Some(effort) = recorded.effort {
                    let errors: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&bytes[AUDITS_AT as usize..]);
                    let milliseconds = read.passes.iter().map(|p| p.milliseconds).sum();
                    let audits = recorded.audited.map(|audited| (audited, &errors[..]));
                    controller.learn(&Measured { effort, milliseconds, audits });
                    read.goal = controller.progress(effort);
                }
                if self.latest.as_ref().is_none_or(|latest| latest.frame < read.frame) {
                    self.latest = Some(read);
                }
            }
            slot.buffer.unmap();
            slot.state.store(FREE, Ordering::Release);
        }
    }

    /// The newest frame whose counters have arrived.
    pub fn latest(&self) -> Option<&Statistics> {
        self.latest.as_ref()
    }
}

fn read(bytes: &[u8], recorded: &Recorded, nanoseconds_per_tick: Option<f64>) -> Statistics {
    let c: Counters = bytemuck::pod_read_unaligned(&bytes[..COUNTER_BYTES as usize]);
    let n = (recorded.m * recorded.m) as usize;
    let windows = u64::from(recorded.size[0]) * u64::from(recorded.size[1]);
    let mut histogram_k = c.histogram[..n].to_vec();
    let mut decided = c.decided;
    // Only a plan, or a reconstruction, counts windows; without one all have the same k.
    if matches!(recorded.technique, Technique::Full | Technique::Single) {
        let k = if recorded.technique == Technique::Full { n } else { 1 };
        histogram_k = vec![0; n];
        histogram_k[k - 1] = windows as u32;
        decided = [windows as u32, 0, 0, 0, 0, 0, 0];
    }
    if matches!(recorded.technique, Technique::Reconstructed | Technique::Selective) {
        decided = [windows as u32, 0, 0, 0, 0, 0, 0];
    }
    let points: u64 = c.points.iter().map(|&points| u64::from(points)).sum();
    if recorded.technique == Technique::MultiResolution && histogram_k.iter().all(|&windows| windows == 0) {
        // No plan has counted.
        histogram_k[0] = points.min(windows) as u32;
        decided = [windows as u32, 0, 0, 0, 0, 0, 0];
    }
    let shaded = if recorded.technique == Technique::MultiResolution {
        let beyond = histogram_k.iter().zip(0u64..).map(|(&windows, more)| u64::from(windows) * more).sum::<u64>();
        beyond + points
    } else {
        histogram_k.iter().zip(1u64..).map(|(&windows, k)| u64::from(windows) * k).sum()
    };
    let ticks: Vec<u64> =
        bytes[TIMESTAMPS_AT as usize..].as_chunks::<8>().0.iter().map(|&b| u64::from_le_bytes(b)).collect();
    let passes = (0..recorded.passes).map(|i| PassTime {
        name: recorded.names[i],
        milliseconds: nanoseconds_per_tick
            .map(|period| ticks[2 * i + 1].saturating_sub(ticks[2 * i]) as f64 * period * 1e-6),
    });
    let [x, y] = scratch::tiles(recorded.size);
    Statistics {
        frame: recorded.frame,
        technique: recorded.technique,
        shaded,
        ratio: shaded as f64 / (windows * n as u64) as f64,
        mean_k: shaded as f64 / windows as f64,
        histogram_k,
        decided,
        quadrants: c.quadrants,
        points: c.points,
        not_finite: c.not_finite,
        negative: c.negative,
        overflowed_tiles: c.overflowed_tiles,
        shadow_rays: c.shadow_rays,
        reflection_rays: c.reflection_rays,
        refraction_rays: c.refraction_rays,
        tiles: TileCounts { all: x * y, surface: c.tiles[0], bounce: c.tiles[1] },
        goal: None,
        passes: passes.collect(),
    }
}
