//! The readback of frames: counters, times and audits. Nothing ever waits for it.

use crate::goal::{Controller, Measured};
use crate::gpu::readback::read_back::ReadBack;
use crate::gpu::sizes::tiles;
use crate::gpu::uniforms::audited::{self, Audited};
use crate::gpu::uniforms::ring::BANDS;
use crate::host::band::Band;
use crate::host::graph::PassKind;
use crate::host::statistics::{COUNTER_BYTES, Counters, PassTime, Statistics, TileCounts};
use crate::settings::Technique;
use crate::techniques::{self, Windows};

/// The number of frames whose statistics may be in flight at once.
const IN_FLIGHT: usize = 4;
/// The number of passes that can be timed at first. It grows with the first frame that has more.
const TIMED: usize = 32;
/// The offset of the timestamps in a readback buffer, aligned for the copy of query results.
const TIMESTAMPS_AT: u64 = COUNTER_BYTES.next_multiple_of(8);

/// The CPU's record of a frame.
#[derive(Debug, Clone)]
pub(crate) struct Recorded {
    pub frame: u64,
    pub technique: Technique,
    /// The band that was recorded; a frame is read back after its last one.
    pub band: Band,
    pub m: u32,
    /// The effort, if the frame has a goal.
    pub effort: Option<f32>,
    /// The audited tiles, if the frame has an audit.
    pub audited: Option<Audited>,
    /// The names and kinds of its passes.
    pub passes: Vec<(&'static str, PassKind)>,
}

#[derive(Debug)]
struct Slot {
    read_back: ReadBack,
    recorded: Option<Recorded>,
}

/// The queries for the times of a number of passes, in each of a number of bands.
#[derive(Debug)]
struct Timing {
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
    passes: usize,
    bands: u32,
    slots: Vec<Slot>,
}

impl Timing {
    fn new(device: &wgpu::Device, passes: usize, bands: u32) -> Self {
        let bytes = Self::bytes(passes, bands);
        let timed = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let queries = timed.then(|| {
            let set = device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("daa"),
                ty: wgpu::QueryType::Timestamp,
                count: (passes * 2) as u32,
            });
            let resolved = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("daa timestamps"),
                size: bytes,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            (set, resolved)
        });
        let read_back = || ReadBack::new(device, "daa statistics read-back", TIMESTAMPS_AT + bytes + audited::BYTES);
        let slots = (0..IN_FLIGHT).map(|_| Slot { read_back: read_back(), recorded: None }).collect();
        Self { queries, passes, bands, slots }
    }

    /// The bytes of the timestamps, band by band. Those of a band are a multiple of the alignment of query results.
    fn bytes(passes: usize, bands: u32) -> u64 {
        passes as u64 * 16 * u64::from(bands)
    }

    /// The offset of the audited errors in a readback buffer.
    fn audits_at(&self) -> u64 {
        TIMESTAMPS_AT + Self::bytes(self.passes, self.bands)
    }
}

/// A ring of readback buffers.
#[derive(Debug)]
pub(crate) struct Collector {
    timing: Timing,
    nanoseconds_per_tick: f64,
    latest: Option<Statistics>,
}

impl Collector {
    pub fn new(device: &wgpu::Device) -> Self {
        Self { timing: Timing::new(device, TIMED, 1), nanoseconds_per_tick: 1.0, latest: None }
    }

    /// Makes room for the times of a number of passes in each band. If it has to grow, statistics in flight are lost.
    pub fn reserve(&mut self, device: &wgpu::Device, passes: usize, bands: u32) {
        let bands = if bands > 1 { BANDS as u32 } else { 1 };
        if passes > self.timing.passes || bands > self.timing.bands {
            let passes = passes.next_multiple_of(TIMED).max(self.timing.passes);
            self.timing = Timing::new(device, passes, bands.max(self.timing.bands));
        }
    }

    /// The bytes of the buffers for frames with so many passes, in bands.
    pub fn most_bytes(passes: usize) -> u64 {
        let timestamps = Timing::bytes(passes.next_multiple_of(TIMED), BANDS as u32);
        timestamps + IN_FLIGHT as u64 * (TIMESTAMPS_AT + timestamps + audited::BYTES)
    }

    /// The query set and the indices at which pass number `pass` of the frame writes its begin and end.
    pub fn timestamps(&self, pass: usize) -> Option<(&wgpu::QuerySet, u32, u32)> {
        let (set, _) = self.timing.queries.as_ref().filter(|_| pass < self.timing.passes)?;
        Some((set, pass as u32 * 2, pass as u32 * 2 + 1))
    }

    /// Records the copies of a frame's counters, after its last band. If no slot is free because the host polls too
    /// rarely, the frame has no statistics.
    pub fn collect(
        &mut self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        counters: &wgpu::Buffer,
        audits: Option<&wgpu::Buffer>,
        recorded: Recorded,
    ) {
        self.nanoseconds_per_tick = f64::from(queue.get_timestamp_period());
        let audits_at = self.timing.audits_at();
        let has_room = recorded.band.index < self.timing.bands;
        if let Some((set, resolved)) = self.timing.queries.as_ref().filter(|_| has_room) {
            let at = Timing::bytes(self.timing.passes, recorded.band.index);
            encoder.resolve_query_set(set, 0..recorded.passes.len() as u32 * 2, resolved, at);
        }
        if recorded.band.index + 1 < recorded.band.count {
            return;
        }
        let Some(slot) = self.timing.slots.iter_mut().find(|slot| slot.read_back.is_free()) else { return };
        let to = &slot.read_back.buffer;
        encoder.copy_buffer_to_buffer(counters, 0, to, 0, COUNTER_BYTES);
        if let Some((_, resolved)) = &self.timing.queries {
            encoder.copy_buffer_to_buffer(resolved, 0, to, TIMESTAMPS_AT, resolved.size());
        }
        if let Some(audits) = audits.filter(|_| recorded.audited.is_some()) {
            encoder.copy_buffer_to_buffer(audits, 0, to, audits_at, audited::BYTES);
        }
        slot.recorded = Some(recorded);
        slot.read_back.send(encoder);
    }

    /// Reads what has arrived, oldest first.
    pub fn poll(&mut self, controller: &mut Controller) {
        let timed = self.timing.queries.is_some().then_some(self.nanoseconds_per_tick);
        let (timed_passes, timed_bands) = (self.timing.passes, self.timing.bands);
        let audits_at = self.timing.audits_at() as usize;
        let age = |slot: &Slot| slot.recorded.as_ref().map_or(0, |recorded| recorded.frame);
        while let Some(slot) = self.timing.slots.iter_mut().filter(|s| s.read_back.is_ready()).min_by_key(|s| age(s)) {
            let Some(recorded) = slot.recorded.take() else {
                slot.read_back.take(|_| ());
                continue;
            };
            let taken = slot.read_back.take(|bytes| {
                let timed = timed.filter(|_| recorded.band.count <= timed_bands);
                let mut read = read(bytes, &recorded, timed_passes, timed);
                if let Some(effort) = recorded.effort {
                    let errors: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&bytes[audits_at..]);
                    let milliseconds = read.passes.iter().map(|pass| pass.milliseconds).sum();
                    let audits = recorded.audited.map(|audited| (audited, &errors[..]));
                    controller.learn(&Measured { effort, milliseconds, audits });
                    read.goal = controller.progress(effort);
                }
                read
            });
            if let Some(read) = taken
                && self.latest.as_ref().is_none_or(|latest| latest.frame < read.frame)
            {
                self.latest = Some(read);
            }
        }
    }

    /// The newest frame whose counters have arrived.
    pub fn latest(&self) -> Option<&Statistics> {
        self.latest.as_ref()
    }
}

fn read(bytes: &[u8], recorded: &Recorded, timed_passes: usize, nanoseconds_per_tick: Option<f64>) -> Statistics {
    let counters: Counters = bytemuck::pod_read_unaligned(&bytes[..COUNTER_BYTES as usize]);
    let n = (recorded.m * recorded.m) as usize;
    let Band { count: bands, image, raster, .. } = recorded.band;
    let windows = u64::from(image[0]) * u64::from(image[1]);
    let rastered = u64::from(bands) * u64::from(raster.width) * u64::from(raster.height);
    // Where S is shaded, it is for neighbours, too.
    let shades_first = recorded.passes.iter().any(|pass| pass.1 == PassKind::First);
    let apron = if shades_first { rastered - windows } else { 0 };
    let counted = techniques::of(recorded.technique).count(&counters, Windows { n, windows });
    let ticks: Vec<u64> =
        bytes[TIMESTAMPS_AT as usize..].as_chunks::<8>().0.iter().map(|&b| u64::from_le_bytes(b)).collect();
    let milliseconds = |i: usize| {
        let of_band = |band: usize| {
            let begin = 2 * (band * timed_passes + i);
            ticks[begin + 1].saturating_sub(ticks[begin])
        };
        nanoseconds_per_tick.map(|period| (0..bands as usize).map(of_band).sum::<u64>() as f64 * period * 1e-6)
    };
    let passes = recorded.passes.iter().enumerate();
    let [x, y] = tiles([raster.width, raster.height]);
    let shaded = counted.shaded + apron;
    Statistics {
        frame: recorded.frame,
        technique: recorded.technique,
        bands,
        shaded,
        apron,
        ratio: shaded as f64 / (windows * n as u64) as f64,
        mean_k: shaded as f64 / windows as f64,
        histogram_k: counted.histogram_k,
        decided: counted.decided,
        quadrants: counters.quadrants,
        points: counters.points,
        not_finite: counters.not_finite,
        negative: counters.negative,
        overflowed_tiles: counters.overflowed_tiles,
        without_rays: counters.without_rays,
        surfaces: counters.surfaces,
        shadow_rays: counters.shadow_rays,
        reflection_rays: counters.reflection_rays,
        refraction_rays: counters.refraction_rays,
        tiles: TileCounts { all: bands * x * y, surface: counters.tiles[0], reflect: counters.tiles[1] },
        goal: None,
        passes: passes.map(|(i, &(name, kind))| PassTime { name, kind, milliseconds: milliseconds(i) }).collect(),
    }
}
