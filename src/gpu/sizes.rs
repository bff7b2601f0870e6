//! The sizes of the parts of a frame's resources, and the grids of its passes.

use crate::TILE;
use crate::gpu::bands::Layout;
use crate::gpu::uniforms::audited::Audited;
use crate::gpu::uniforms::lattice::{self, LatticeSteps};
use crate::host::gbuffer::{DEPTH_FORMAT, GBufferTier};
use crate::host::graph::{Grid, LatticeShape, Part, PartKind, PassInfo, Rounds};
use crate::host::needs::RayInputs;
use crate::host::statistics::COUNTER_BYTES;

/// The format of S and of the shaded image: f32, so that linear means have the precision of f32 and 65520 stays finite.
pub(crate) const IMAGE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// The number of materials, and of objects, that a G-buffer can tell apart.
pub(crate) const NAMES: usize = 1 << 16;
/// The bytes of `daa_reflective` of reflect.wgsl: a bit for each material.
pub(crate) const REFLECTIVE_BYTES: u64 = NAMES as u64 / 8;

/// The bytes of a `DaaWork` of work.wgsl: the part of a list that one dispatch runs.
pub(crate) const WORK_BYTES: u64 = 256;

/// The offset of the workgroups of an indirect dispatch in a `DaaWork`.
pub(crate) const WORK_GROUPS_AT: u64 = 16;

/// `DAA_BATCH` of list.wgsl.
pub(crate) const BATCH: u64 = 1 << 22;

/// The bytes before the lists of tiles: two `DaaTileClass` of classify.wgsl.
pub(crate) const TILE_CLASSES_BYTES: u64 = 32;

/// The number of points along one side of the block of a workgroup that lists points: `DAA_LANE_SIDE` of listing.wgsl
/// for each of 8 lanes.
pub(crate) const POINTS_BLOCK: u32 = 32;

/// The number of words for the hits of a first sample's rays: three for the mirrored and three for the refracted one.
const HIT_WORDS: u64 = 6;

/// The values that the sizes of a frame's resources depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shape {
    /// The size of the image, or of its bands with their aprons.
    pub size: [u32; 2],
    pub image: [u32; 2],
    pub m: u32,
    pub target_format: wgpu::TextureFormat,
    pub gbuffer: GBufferTier,
    pub inputs: RayInputs,
    /// Where the results of rays lie.
    pub results: Results,
    /// Whether the hits of the rays of first samples are kept.
    pub hits: bool,
    /// Whether the number of rays of each sample is kept.
    pub rays: bool,
    /// The lattices, if it has any.
    pub lattices: Option<LatticeSteps>,
}

/// Where the results of rays lie, in words: `DaaResults` of frame.wgsl.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Results {
    /// The number of ranks that have a word for each slot.
    pub ranks: u32,
    /// The number of words for other planned samples.
    pub planned: u64,
    /// The number of audited tiles in a row of tiles, 0 if no tile is audited.
    pub audited: u32,
    /// The number of all words.
    pub words: u64,
}

impl Results {
    /// For these samples of an image, or of a band of `size`. `room` is the setting `ray_samples`; `audits` says
    /// whether the frame audits tiles.
    pub fn new(layout: Layout, m: u32, ranks: CastingRanks, room: f32, audits: bool) -> Self {
        let Layout { image, size } = layout;
        let n = m * m;
        let slots = plan_bytes(size) / 4;
        let (ranks, planned) = match ranks {
            CastingRanks::First(ranks) => (ranks, 0),
            CastingRanks::Planned => (1, (slots as f64 * f64::from(room.clamp(0.0, (n - 1) as f32))).ceil() as u64),
        };
        let audited = if audits { Audited::of(0, image).groups(image)[0] } else { 0 };
        let of_audit = u64::from(audited * tiles(size)[1] * TILE * TILE) * u64::from(n);
        Self { ranks, planned, audited, words: slots * u64::from(ranks) + planned + of_audit }
    }

    /// The bytes of a word for each.
    pub fn bytes(self) -> u64 {
        self.words * 4
    }
}

/// The bytes of `DaaWindowList` of light.wgsl before its slots.
pub(crate) const SURFACE_LIST_HEAD_BYTES: u64 = 32;

/// `DAA_CORNER_WORDS` of light.wgsl: the number of words for a corner of a block.
pub(crate) const CORNER_WORDS: u64 = 14;

/// The bytes of what the corners of a tile's four blocks know.
const CORNERS_BYTES: u64 = 16 * CORNER_WORDS * 4;

/// The number of words for the surfaces of a window: masks.wgsl. A set of ranks has a word, or two.
fn surface_words(m: u32) -> u64 {
    1 + 3 * if m > 5 { 2 } else { 1 }
}

/// The number of tiles along x and y.
pub(crate) fn tiles(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(TILE))
}

/// The bytes of a buffer with a word for each pixel of each tile.
pub(crate) fn plan_bytes(size: [u32; 2]) -> u64 {
    let [x, y] = tiles(size).map(u64::from);
    x * y * u64::from(TILE * TILE) * 4
}

/// The bytes of the plan: its words, and the number of planned samples before each tile.
fn plan_part_bytes(size: [u32; 2]) -> u64 {
    let [x, y] = tiles(size).map(u64::from);
    plan_bytes(size) + x * y * 4
}

/// The bytes of the G-buffer.
pub(crate) fn gbuffer_bytes(size: [u32; 2], m: u32, tier: GBufferTier) -> u64 {
    let [w, h] = size.map(u64::from);
    w * h * u64::from(m * m) * tier.bytes_per_sample()
}

/// The bytes of everything else that [`resize`](crate::DeferredAa::resize) creates.
pub(crate) fn scratch_bytes(size: [u32; 2]) -> u64 {
    let image = u64::from(size[0]) * u64::from(size[1]) * 16;
    2 * image + plan_bytes(size) + plan_part_bytes(size) + COUNTER_BYTES
}

/// The number of rows of a list of pixels: one for each k from 2, or at n = 1 one that stays empty.
pub(crate) fn pixel_rows(m: u32) -> u32 {
    (m * m - 1).max(1)
}

/// The most entries of a list of samples, which does not contain first samples.
fn sample_entries(size: [u32; 2], m: u32) -> u64 {
    let [w, h] = size.map(u64::from);
    (w * h * u64::from(m * m - 1)).max(1)
}

/// The number of batches into which the samples of any frame of this size fit.
pub(crate) fn batches(size: [u32; 2], m: u32) -> u32 {
    sample_entries(size, m).div_ceil(BATCH) as u32
}

/// The parts, besides the G-buffer, that are created with the size. The others are created when a frame first needs
/// them.
pub(crate) const FIXED: [Part; 5] = [Part::First, Part::Color, Part::WindowCounts, Part::Plan, Part::Counters];

/// The samples of windows that may cast rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CastingRanks {
    /// The first so many of every window.
    First(u32),
    /// The first one of every window, and those that a plan has beyond it.
    Planned,
}

impl Shape {
    /// The bytes of the parts that frames of this shape hold if their passes use `used`.
    pub fn bytes_held(&self, used: &[Part]) -> u64 {
        self.held(used).map(|(_, bytes)| bytes).sum()
    }

    /// These parts, with the bytes of each.
    pub fn held(&self, used: &[Part]) -> impl Iterator<Item = (Part, u64)> {
        let is_held = |part: &Part| Part::GBUFFER.contains(part) || FIXED.contains(part) || used.contains(part);
        Part::ALL.into_iter().filter(is_held).map(|part| (part, self.bytes(part)))
    }

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
            Part::GBufferSurface => gbuffer(self.gbuffer.first_format()),
            Part::GBufferFrame => self.gbuffer.frame_format().and_then(gbuffer),
            Part::GBufferUv => self.gbuffer.uv_format().and_then(gbuffer),
            Part::First | Part::Color => texture(IMAGE_FORMAT, size, wgpu::TextureUsages::STORAGE_BINDING | SAMPLED),
            Part::WindowCounts => buffer(plan_bytes(size), none),
            Part::Plan => buffer(plan_part_bytes(size), none),
            Part::PixelListRows => buffer(tiles * rows * 4, none),
            // Each row is padded to whole workgroups.
            Part::PixelListEntries => buffer((w * h + 63 * rows) * 4, none),
            Part::PixelListWork => buffer((rows + 1) * WORK_BYTES, indirect),
            Part::SampleListRows => buffer(tiles * 4, none),
            Part::SampleListEntries => buffer(sample_entries(size, m) * 4, none),
            Part::SampleListWork => buffer(u64::from(batches(size, m) + 1) * WORK_BYTES, indirect),
            // The last tile of a batch may exceed it.
            Part::SampleListColors => {
                buffer(sample_entries(size, m).min(BATCH + u64::from(TILE * TILE * 63)) * 16, none)
            }
            Part::LatticePoints => lattices(0),
            Part::LatticeColors => lattices(1),
            Part::SurfaceMasks => buffer(plan_bytes(size) * surface_words(m) + tiles * CORNERS_BYTES, none),
            Part::SurfaceList | Part::SurfaceCutList => {
                buffer(SURFACE_LIST_HEAD_BYTES + plan_bytes(size), indirect | cleared)
            }
            // A word for each tile in each class, and a word for the classes of each tile.
            Part::Tiles if inputs.any() => buffer(TILE_CLASSES_BYTES + 3 * tiles * 4, indirect | cleared),
            Part::Shadows if inputs.shadows => buffer(self.shadow_bytes(), cleared),
            Part::Reflections if inputs.reflections => buffer(self.reflection_bytes(), cleared),
            Part::Tiles | Part::Shadows | Part::Reflections => None,
            Part::Counters => buffer(COUNTER_BYTES, wgpu::BufferUsages::COPY_SRC | cleared),
            Part::Target => texture(self.target_format, self.image, wgpu::TextureUsages::RENDER_ATTACHMENT),
            Part::Depth => texture(DEPTH_FORMAT, self.image, wgpu::TextureUsages::RENDER_ATTACHMENT),
        }
    }

    /// The bytes of a part, 0 if frames of this shape have no such part.
    pub fn bytes(&self, part: Part) -> u64 {
        self.kind(part).map_or(0, |kind| kind.bytes())
    }

    /// The bytes of a part that is bound as a buffer, 0 for textures.
    pub fn buffer_bytes(&self, part: Part) -> u64 {
        match self.kind(part) {
            Some(PartKind::Buffer { bytes, .. }) => bytes,
            _ => 0,
        }
    }

    /// The greatest size at which an existing part is kept. Room for hits and for all samples stays, since frames of
    /// several techniques may alternate; room for counts of rays is freed.
    pub fn most(&self, part: Part) -> u64 {
        let &Self { size, image, m, .. } = self;
        let audits = self.results.audited > 0;
        let results = Results::new(Layout { image, size }, m, CastingRanks::First(m * m), 0.0, audits);
        let most = Self { hits: true, results, ..*self };
        match part {
            Part::Shadows | Part::Reflections if !self.rays => most.bytes(part),
            _ => u64::MAX,
        }
    }

    /// The bytes of the shadow bits, and of the counts of rays, which lie behind them.
    fn shadow_bytes(&self) -> u64 {
        self.results.bytes() * if self.rays { 2 } else { 1 }
    }

    /// The bytes of the reflected and refracted radiance, of the hits of first samples, and of the counts of rays.
    /// Counts lie after the room for hits, whether or not hits are kept.
    fn reflection_bytes(&self) -> u64 {
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
    /// The number of rounds at an output size, with m × m samples to a window.
    pub fn count(self, size: [u32; 2], m: u32) -> u32 {
        match self {
            Self::Once => 1,
            Self::Counts => pixel_rows(m),
            Self::Batches => batches(size, m),
        }
    }
}

impl PassInfo {
    /// The number of workgroups, along x, y and z, of an entry point of this pass at an output size, with m × m samples
    /// to a window. `None` for numbers that are computed on the GPU ([`Grid::Indirect`]) or follow from the frame's
    /// constants ([`Grid::AuditedTiles`]), and if a triangle is drawn.
    pub fn workgroups(&self, grid: Grid, size: [u32; 2], m: u32) -> Option<[u32; 3]> {
        workgroups(grid, (size, size), m, self.lattice, None)
    }
}

/// [`PassInfo::workgroups`] for a frame of a size, over an image or a band of it, that audits these tiles.
pub(crate) fn workgroups(
    grid: Grid,
    (size, image): ([u32; 2], [u32; 2]),
    m: u32,
    lattice: Option<[LatticeShape; 2]>,
    audited: Option<Audited>,
) -> Option<[u32; 3]> {
    let [tiles_x, tiles_y] = tiles(size);
    let [x, y] = match grid {
        Grid::One => [1, 1],
        Grid::Tiles => [tiles_x, tiles_y],
        Grid::TileRuns => [(tiles_x * tiles_y).div_ceil(TILE * TILE), 1],
        // The first block may begin before a band.
        Grid::Pixels(side) => size.map(|pixels| (pixels + if size == image { 0 } else { TILE }).div_ceil(side)),
        Grid::Samples => size.map(|pixels| (pixels * m).div_ceil(TILE)),
        Grid::Counts => [pixel_rows(m), 1],
        Grid::AuditedTiles => [audited?.groups(image)[0], tiles_y],
        Grid::Points(side) => lattice::points(size, image, lattice?[0]).map(|points| points.div_ceil(side)),
        Grid::Parents => lattice::points(size, image, lattice?[1]).map(|points| points.div_ceil(TILE)),
        Grid::Cells => {
            let [own, parents] = lattice?;
            let nested = own.pattern == parents.pattern && own.level + 1 == parents.level;
            // A row of triangles has one more cell.
            let cells = |points: u32| if nested { points / 2 + 2 } else { points };
            lattice::points(size, image, own).map(|points| cells(points).div_ceil(TILE))
        }
        Grid::Indirect { .. } | Grid::Target | Grid::Depth => return None,
    };
    Some([x, y, 1])
}
