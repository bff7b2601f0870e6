//! stats.json.

use crate::host::gpu::Gpu;
use crate::host::{Host, Shot};
use crate::measure::quality::{IDENTICAL_DB, Quality};
use deferred_aa::{Settings, Technique, TileCounts};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The key of the time in which the samples of the plan are shaded.
pub const SHADE: &str = "shade";

/// One measured entry: a technique with its settings on a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stats {
    scene: String,
    width: u32,
    height: u32,
    /// Samples along one side of a window.
    pub m: u32,
    /// The technique as it is named on the command line, or the peer.
    pub technique: String,
    /// The settings that were recorded.
    pub settings: Settings,
    stall: u32,
    adapter: Adapter,
    /// The samples that were shaded.
    pub samples: Samples,
    /// The rays that were traced.
    pub rays: Rays,
    /// The tiles by class.
    #[serde(default)]
    pub tiles: TileCounts,
    /// Times by pass, with `gbuffer` and `total`.
    pub time_ms: BTreeMap<String, Spread>,
    /// The memory that is held.
    pub memory_bytes: Memory,
    /// How near the image comes to its references.
    pub quality: Against,
    /// Names of the passes, in order.
    pub passes: Vec<String>,
}

/// The adapter that it ran on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Adapter {
    /// The device's name.
    pub name: String,
    /// Name and version of the driver.
    pub driver: String,
    /// The backend: Vulkan, Metal or DX12.
    pub backend: String,
}

/// The samples that were shaded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// Shaded samples, the first ones included.
    pub shaded: u64,
    /// Shaded samples over all n · w · h samples.
    pub ratio: f64,
    /// Shaded samples over w · h pixels.
    pub mean_k: f64,
    histogram_k: Vec<u32>,
    /// Calls of the host's material: as many as shaded samples, except with `surfaces`, where a light may have several.
    #[serde(default)]
    pub taps: u64,
}

/// The rays that were traced, by kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rays {
    /// Rays towards lights.
    pub shadow: u64,
    /// Reflected rays.
    pub reflection: u64,
    /// Refracted rays.
    pub refraction: u64,
    /// Planned samples for whose results there was no room: `Statistics::without_rays`.
    pub without_room: u64,
    primary: u64,
}

/// The bytes that are held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    gbuffer: u64,
    scratch: u64,
    /// Bytes held for rays, including the scene for rays.
    pub rays: u64,
    /// The most bytes that all textures and buffers of the device took after a frame, as wgpu counts them.
    peak: Option<u64>,
}

impl Memory {
    /// Bytes of the G-buffer, and of the meshes that a visibility buffer is read with.
    pub fn gbuffer(&self) -> u64 {
        self.gbuffer
    }

    /// Bytes of everything else.
    pub fn others(&self) -> u64 {
        self.scratch + self.rays
    }
}

/// How near an image comes to what it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Against {
    /// The quality against all samples of the same grid.
    pub grid: Option<Quality>,
    /// The quality against the truth, which has many more samples.
    pub truth: Option<Quality>,
}

/// The spread of values over the measured frames, mostly milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The least value.
    pub min: f64,
    /// The middle value.
    pub median: f64,
    /// The value that 19 of 20 do not exceed.
    pub p95: f64,
}

impl Spread {
    /// The spread of at least one value.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let at = |q: f64| values.get(((values.len() as f64 * q).ceil() as usize).saturating_sub(1)).copied();
        Some(Self { min: *values.first()?, median: at(0.5)?, p95: at(0.95)? })
    }
}

impl Adapter {
    /// The adapter of a device.
    pub fn of(gpu: &Gpu) -> Self {
        Self::of_adapter(&gpu.adapter)
    }

    /// An adapter that may have no device yet.
    pub fn of_adapter(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            backend: format!("{:?}", info.backend),
            name: info.name,
        }
    }
}

impl Stats {
    /// The statistics of frames of the same settings, measured one after another. `None` without a frame.
    pub fn new(host: &Host, settings: Settings, shots: &[Shot], grid: Option<Quality>) -> Option<Self> {
        let last = shots.last()?;
        let memory = host.aa.memory();
        let s = &last.statistics;
        let taps = if settings.technique == Technique::Surfaces { s.surfaces.taps.into() } else { s.shaded };
        // A scene that traces nothing is what a visibility buffer is read with.
        let scenes = host.rays.iter().map(|rays| &rays.scene);
        let bytes =
            |traces: bool| scenes.clone().filter(|s| s.tier().is_some() == traces).map(|s| s.bytes()).sum::<u64>();
        Some(Self {
            scene: host.scene.name.clone(),
            width: host.options.width,
            height: host.options.height,
            m: host.options.m,
            technique: format!("{:?}", settings.technique).to_lowercase(),
            settings,
            stall: host.options.stall,
            adapter: Adapter::of(&host.gpu),
            samples: Samples {
                shaded: s.shaded,
                ratio: s.ratio,
                mean_k: s.mean_k,
                histogram_k: s.histogram_k.clone(),
                taps,
            },
            rays: Rays {
                shadow: u64::from(s.shadow_rays),
                reflection: u64::from(s.reflection_rays),
                refraction: u64::from(s.refraction_rays),
                without_room: u64::from(s.without_rays),
                primary: 0,
            },
            tiles: s.tiles,
            time_ms: times(shots),
            memory_bytes: Memory {
                gbuffer: memory.gbuffer + bytes(false),
                scratch: memory.scratch,
                rays: memory.rays + bytes(true),
                peak: Some(host.peak()).filter(|&bytes| bytes > 0),
            },
            quality: Against { grid, truth: None },
            passes: s.passes.iter().map(|p| p.name.to_owned()).collect(),
        })
    }

    /// Time of a sample beyond the first over the time of a sample of `full`, both by the pass `shade`. `None` where
    /// there are no such samples or no times.
    pub fn beta(&self, full: &Self, pixels: u64) -> Option<f64> {
        let extra = self.samples.shaded.checked_sub(pixels).filter(|&e| e > 0)?;
        let of = |stats: &Self| Some(stats.time_ms.get(SHADE)?.median);
        (self.technique != full.technique)
            .then_some((of(self)? / extra as f64) / (of(full)? / full.samples.shaded as f64))
    }

    /// The same for a peer that ran on this image in a pass of its own, which the shots hold.
    pub fn of_peer(mut self, name: &str) -> Self {
        name.clone_into(&mut self.technique);
        self
    }

    /// The same for a peer that has these bytes of targets, and none of the node's.
    pub fn holding(mut self, bytes: u64) -> Self {
        self.memory_bytes = Memory { gbuffer: bytes, scratch: 0, rays: 0, peak: None };
        self
    }

    /// What it came to, in a line: lit samples a pixel, how near to all of them, and the time.
    pub fn summary(&self) -> String {
        let mut parts = vec![
            format!("k {:.2} of {}", self.samples.mean_k, self.m * self.m),
            format!("{:.1} % of the samples", self.samples.ratio * 100.0),
        ];
        match self.quality.grid.and_then(|quality| quality.psnr_db) {
            Some(db) if db >= IDENTICAL_DB => parts.push("the same image as Full".to_owned()),
            Some(db) => parts.push(format!("{db:.1} dB to Full")),
            None => {}
        }
        let ms = |name: &str| self.time_ms.get(name).map(|spread| spread.median);
        if let (Some(node), Some(total)) = (ms("node"), ms("total")) {
            parts.push(format!("node {node:.2} ms, with the G-buffer {total:.2} ms"));
        }
        format!("{}: {}", self.technique, parts.join(", "))
    }

    /// Median milliseconds of the node's passes together, G-buffer left out.
    pub fn node_ms(&self) -> Option<f64> {
        self.time_ms.get("node").map(|s| s.median)
    }
}

/// Each pass, `gbuffer`, `node` (all passes of the node) and `total` (both). Empty without timestamps.
pub fn times(shots: &[Shot]) -> BTreeMap<String, Spread> {
    let mut all: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    for shot in shots {
        let passes: Option<Vec<_>> =
            shot.statistics.passes.iter().map(|p| p.milliseconds.map(|ms| (p.name, ms))).collect();
        let (Some(passes), Some(gbuffer)) = (passes, shot.gbuffer_ms) else { continue };
        let node: f64 = passes.iter().map(|(_, ms)| ms).sum();
        // Some passes run more than once in a frame.
        let mut frame = BTreeMap::new();
        for (name, ms) in passes.into_iter().chain([("gbuffer", gbuffer), ("node", node), ("total", node + gbuffer)]) {
            *frame.entry(name).or_default() += ms;
        }
        for (name, ms) in frame {
            all.entry(name).or_default().push(ms);
        }
    }
    all.into_iter().filter_map(|(name, values)| Some((name.to_owned(), Spread::of(values)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::Spread;

    #[test]
    fn the_spread_of_twenty() {
        let values = (1..=20).rev().map(f64::from).collect();
        assert_eq!(Spread::of(values), Some(Spread { min: 1.0, median: 10.0, p95: 19.0 }));
        assert_eq!(Spread::of(vec![3.0]), Some(Spread { min: 3.0, median: 3.0, p95: 3.0 }));
        assert_eq!(Spread::of(Vec::new()), None);
    }
}
