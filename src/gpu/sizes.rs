//! How large things are: the parts of a frame's resources, and the grids of its passes.

use crate::TILE;
use crate::gpu::uniforms::audited::Audited;
use crate::gpu::uniforms::lattice::{self, LatticeSteps};
use crate::host::gbuffer::{BYTES_PER_SAMPLE, COLOR_FORMATS, DEPTH_FORMAT};
use crate::host::graph::{Grid, LatticeShape, Part, PartKind, PassInfo, Rounds};
use crate::host::needs::RayInputs;
use crate::host::statistics::COUNTER_BYTES;

/// Format of S and of the shaded image: f32, so that the linear mean is exact to f32 and 65520 is a number.
pub(crate) const IMAGE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Bytes of a `DaaWork` of work.wgsl: one dispatch's part of a list.
pub(crate) const WORK_BYTES: u64 = 256;

/// Where the workgroups of an indirect dispatch stand in a `DaaWork`.
pub(crate) const WORK_GROUPS_AT: u64 = 16;

/// `DAA_BATCH` of list.wgsl.
pub(crate) const BATCH: u64 = 1 << 22;

/// Bytes before the lists of tiles: two `DaaTileClass` of classify.wgsl.
pub(crate) const TILE_CLASSES_BYTES: u64 = 32;

/// Words of what the rays of a first sample met: three each of a mirrored and a refracted one.
const HIT_WORDS: u64 = 6;

/// What the sizes of a frame depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shape {
    pub size: [u32; 2],
    pub m: u32,
    pub target_format: wgpu::TextureFormat,
    pub inputs: RayInputs,
    /// What the rays of first samples met is kept.
    pub hits: bool,
    /// How many rays each sample sent is kept.
    pub rays: bool,
    /// The lattices, if it has any.
    pub lattices: Option<LatticeSteps>,
}

/// Tiles along x and y.
pub(crate) fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(TILE))
}

/// Bytes of a buffer with a word for each pixel of each tile.
pub(crate) fn plan_bytes(size: [u32; 2]) -> u64 {
    let [x, y] = tiles(size).map(u64::from);
    x * y * u64::from(TILE * TILE) * 4
}

/// Bytes of the G-buffer.
pub(crate) fn gbuffer_bytes(size: [u32; 2], m: u32) -> u64 {
    let [w, h] = size.map(u64::from);
    w * h * u64::from(m * m) * BYTES_PER_SAMPLE
}

/// Bytes of all else that [`resize`](crate::DeferredAa::resize) makes.
pub(crate) fn scratch_bytes(size: [u32; 2]) -> u64 {
    let image = u64::from(size[0]) * u64::from(size[1]) * 16;
    2 * image + 2 * plan_bytes(size) + COUNTER_BYTES
}

/// Bytes of a word for each sample.
pub(crate) fn sample_bytes(size: [u32; 2], m: u32) -> u64 {
    plan_bytes(size) * u64::from(m * m)
}

/// Rows of a list of pixels: one for each k from 2, or one that stays empty.
pub(crate) fn pixel_rows(m: u32) -> u32 {
    (m * m - 1).max(1)
}

/// Most entries of a list of samples, which has no first ones.
fn sample_entries(size: [u32; 2], m: u32) -> u64 {
    let [w, h] = size.map(u64::from);
    (w * h * u64::from(m * m - 1)).max(1)
}

/// Batches that the samples of any frame of a size fit in.
pub(crate) fn batches(size: [u32; 2], m: u32) -> u32 {
    sample_entries(size, m).div_ceil(BATCH) as u32
}

impl Shape {
    /// The memory that a part needs; `None` if frames of this shape have no such part.
    pub fn kind(&self, part: Part) -> Option<PartKind> {
        let &Self { size, m, inputs, .. } = self;
        let [w, h] = size.map(u64::from);
        let tiles = plan_bytes(size) / (u64::from(TILE * TILE) * 4);
        let rows = u64::from(pixel_rows(m));
        let lattices = |part: usize| buffer(self.lattices?.bytes()[part], wgpu::BufferUsages::empty());
        let none = wgpu::BufferUsages::empty();
        let cleared = wgpu::BufferUsages::COPY_DST;
        let indirect = wgpu::BufferUsages::INDIRECT;
        let gbuffer =
            |format| texture(format, size.map(|side| side * m), wgpu::TextureUsages::RENDER_ATTACHMENT | SAMPLED);
        match part {
            Part::GBufferDepth => gbuffer(DEPTH_FORMAT),
            Part::GBufferSurface => gbuffer(COLOR_FORMATS[0]),
            Part::GBufferFrame => gbuffer(COLOR_FORMATS[1]),
            Part::GBufferUv => gbuffer(COLOR_FORMATS[2]),
            Part::First | Part::Color => texture(IMAGE_FORMAT, size, wgpu::TextureUsages::STORAGE_BINDING | SAMPLED),
            Part::Counts | Part::Plan => buffer(plan_bytes(size), none),
            Part::PixelListRows => buffer(tiles * rows * 4, none),
            // Each row is padded to whole workgroups.
            Part::PixelListEntries => buffer((w * h + 63 * rows) * 4, none),
            Part::PixelListWork => buffer((rows + 1) * WORK_BYTES, indirect),
            Part::SampleListRows => buffer(tiles * 4, none),
            Part::SampleListEntries => buffer(sample_entries(size, m) * 4, none),
            Part::SampleListWork => buffer(u64::from(batches(size, m) + 1) * WORK_BYTES, indirect),
            // The last tile of a batch may reach beyond it.
            Part::SampleListColors => {
                buffer(sample_entries(size, m).min(BATCH + u64::from(TILE * TILE * 63)) * 16, none)
            }
            Part::LatticePoints => lattices(0),
            Part::LatticeColors => lattices(1),
            // For each tile a word for each class, and one for its own classes.
            Part::Tiles if inputs.any() => buffer(TILE_CLASSES_BYTES + 3 * tiles * 4, indirect | cleared),
            Part::Shadows if inputs.shadows => buffer(self.shadow_bytes(), cleared),
            Part::Secondary if inputs.secondary => buffer(self.secondary_bytes(), cleared),
            Part::Tiles | Part::Shadows | Part::Secondary => None,
            Part::Counters => buffer(COUNTER_BYTES, wgpu::BufferUsages::COPY_SRC | cleared),
            Part::Target => texture(self.target_format, size, wgpu::TextureUsages::RENDER_ATTACHMENT),
        }
    }

    /// Bytes of a part, 0 if there is none.
    pub fn bytes(&self, part: Part) -> u64 {
        self.kind(part).map_or(0, |kind| kind.bytes())
    }

    /// The most that a part made for other frames may have and still be kept: what hits make larger stays, as frames of several
    /// techniques may take turns; the room for counts of rays is given back.
    pub fn most(&self, part: Part) -> u64 {
        match part {
            Part::Shadows | Part::Secondary if !self.rays => Self { hits: true, ..*self }.bytes(part),
            _ => u64::MAX,
        }
    }

    /// Shadow bits, and behind them the rays that found them.
    fn shadow_bytes(&self) -> u64 {
        sample_bytes(self.size, self.m) * if self.rays { 2 } else { 1 }
    }

    /// What is reflected and refracted, what the rays of first samples met, and the rays that found it. Rays lie behind the room for
    /// hits, whether these are kept or not.
    fn secondary_bytes(&self) -> u64 {
        let hits = if self.hits || self.rays { plan_bytes(self.size) * HIT_WORDS } else { 0 };
        self.shadow_bytes() + hits
    }
}

const SAMPLED: wgpu::TextureUsages = wgpu::TextureUsages::TEXTURE_BINDING;

fn texture(format: wgpu::TextureFormat, size: [u32; 2], usage: wgpu::TextureUsages) -> Option<PartKind> {
    Some(PartKind::Texture { format, width: size[0], height: size[1], usage })
}

fn buffer(bytes: u64, usage: wgpu::BufferUsages) -> Option<PartKind> {
    Some(PartKind::Buffer { bytes, usage: wgpu::BufferUsages::STORAGE | usage })
}

impl Rounds {
    /// How many there are at an output size, m × m samples to a window.
    pub fn count(self, size: [u32; 2], m: u32) -> u32 {
        match self {
            Self::Once => 1,
            Self::Counts => pixel_rows(m),
            Self::Batches => batches(size, m),
        }
    }
}

impl PassInfo {
    /// The workgroups that an entry point of this pass gets at an output size, m × m samples to a window. `None` where only the GPU
    /// knows ([`Grid::Indirect`]), where the frame's constants say ([`Grid::AuditedTiles`]), and where a triangle is drawn.
    pub fn workgroups(&self, grid: Grid, size: [u32; 2], m: u32) -> Option<[u32; 3]> {
        workgroups(grid, size, m, self.lattice, None)
    }
}

/// [`PassInfo::workgroups`] of a frame that audits these tiles.
pub(crate) fn workgroups(
    grid: Grid,
    size: [u32; 2],
    m: u32,
    lattice: Option<[LatticeShape; 2]>,
    audited: Option<Audited>,
) -> Option<[u32; 3]> {
    let [tiles_x, tiles_y] = tiles(size);
    let [x, y] = match grid {
        Grid::One => [1, 1],
        Grid::Tiles => [tiles_x, tiles_y],
        Grid::TileRuns => [(tiles_x * tiles_y).div_ceil(TILE * TILE), 1],
        Grid::Pixels(side) => size.map(|pixels| pixels.div_ceil(side)),
        Grid::Samples => size.map(|pixels| (pixels * m).div_ceil(TILE)),
        Grid::Counts => [pixel_rows(m), 1],
        Grid::AuditedTiles => audited?.groups(size),
        Grid::Points(side) => lattice::points(size, lattice?[0]).map(|points| points.div_ceil(side)),
        Grid::Parents => lattice::points(size, lattice?[1]).map(|points| points.div_ceil(TILE)),
        Grid::Cells => {
            let [own, parents] = lattice?;
            let nested = own.pattern == parents.pattern && own.level + 1 == parents.level;
            // Of triangles there is one more in a row.
            let cells = |points: u32| if nested { points / 2 + 2 } else { points };
            lattice::points(size, own).map(|points| cells(points).div_ceil(TILE))
        }
        Grid::Indirect { .. } | Grid::Target => return None,
    };
    Some([x, y, 1])
}
