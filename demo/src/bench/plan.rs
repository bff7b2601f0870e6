//! What is measured, in the order of what it tells.

use deferred_aa::rays::RayTier;
use deferred_aa::{Preset, Settings, Surfaces, Technique};
use serde::{Deserialize, Serialize};

/// Frames that share a scene, a node and a light loop. Its entries are interleaved.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cell {
    /// A built-in scene.
    pub scene: String,
    /// Samples along one side of a pixel's window.
    pub m: u32,
    /// How often the light loop runs.
    pub stall: u32,
    /// Whether the G-buffer keeps triangles, where the adapter can, and not attributes.
    pub visibility: bool,
    /// Whether the adapter's ray query traces, and not WGSL.
    pub query: bool,
}

/// All cells, and the size of their pictures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The most measured frames of an entry.
    pub frames: u32,
    /// In the order in which they are measured.
    pub cells: Vec<Cell>,
}

/// Scenes that trace rays, and the others, by how much they tell.
const TRACED: [&str; 2] = ["mirrors", "shadows"];
const OTHERS: [&str; 4] = ["fence", "checker", "spheres", "cornell"];

impl Plan {
    /// The standing figures: what decides comes first, since time may end before the plan does.
    pub fn standing(size: (u32, u32), frames: u32) -> Self {
        let cell = |scene: &str, m, stall| Cell { scene: scene.to_owned(), m, stall, visibility: true, query: false };
        // m = 1 is what a frame costs without this crate.
        let all = |scene, ms: &[u32]| -> Vec<Cell> {
            ms.iter().flat_map(|&m| [1, 8].map(|stall| cell(scene, m, stall))).collect()
        };
        let mut cells = all("atrium", &[1, 4, 2]);
        cells.push(Cell { visibility: false, ..cell("atrium", 4, 1) });
        for scene in TRACED {
            cells.extend(all(scene, &[1, 4]));
            cells.push(Cell { query: true, ..cell(scene, 4, 1) });
        }
        cells.extend(OTHERS.iter().flat_map(|scene| all(scene, &[1, 4])));
        cells.push(cell("empty", 4, 1));
        cells.extend(TRACED.iter().chain(&OTHERS).flat_map(|scene| all(scene, &[2])));
        cells.push(Cell { visibility: false, ..cell("atrium", 2, 1) });
        Self { size, frames, cells }
    }
}

impl Cell {
    /// Its name in tables.
    pub fn name(&self) -> String {
        let gbuffer = if self.visibility { "" } else { ", stored G-buffer" };
        let rays = if self.query { ", ray query" } else { "" };
        format!("{}, m = {}, stall {}{gbuffer}{rays}", self.scene, self.m, self.stall)
    }

    /// Who traces its rays.
    pub fn rays(&self) -> RayTier {
        if self.query { RayTier::Query } else { RayTier::Software }
    }

    /// The labels and settings of its entries; the last one is the reference of the others.
    pub fn entries(&self) -> Vec<(String, Settings)> {
        let of = |technique: Technique, name: &str| (name.to_owned(), Settings { technique, ..Settings::default() });
        let single = of(Technique::Single, "Single");
        if self.m == 1 {
            return vec![single];
        }
        let presets = [(Preset::Fast, "fast"), (Preset::Balanced, "balanced"), (Preset::Quality, "quality")];
        let preset = |technique: Technique, (preset, name): (Preset, &str)| {
            (format!("{technique:?}, {name}"), Settings { technique, ..preset.settings() })
        };
        let mut entries = vec![single];
        entries.extend(presets.map(|p| preset(Technique::Windowed, p)));
        entries.push((
            "Surfaces, once".to_owned(),
            Settings { technique: Technique::Surfaces, surfaces: Surfaces::ONCE, ..Settings::default() },
        ));
        entries.extend(presets.map(|p| preset(Technique::Surfaces, p)));
        entries.push(of(Technique::Reconstructed, "Reconstructed"));
        entries.push(of(Technique::Selective, "Selective"));
        entries.push(of(Technique::MultiResolution, "MultiResolution"));
        entries.push(of(Technique::Full, "Full"));
        entries
    }
}
