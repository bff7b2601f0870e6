//! A frame as a host's graph sees it: its resources, the memory that these are made of, and its passes.

use crate::settings::Pattern;
use std::fmt;

/// A resource of the frame, by the name that [`PassInfo`] lists it under.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Resource {
    /// The attachments of [`GBuffer`](crate::GBuffer), rendered by the host.
    GBuffer,
    /// The host's bind group and the texture table.
    Host,
    /// S: the shaded first samples, w×h.
    First,
    /// The scene for rays.
    Rays,
    /// The tiles in which rays are wanted.
    Tiles,
    /// The shadow bits of samples, and what they reflect and refract.
    Traced,
    /// k of each window, as the metrics have it.
    Counts,
    /// k of each window, and its place in the tile's list.
    Plan,
    /// The frame's pixels ordered by k, or its samples, as one list.
    List,
    /// The points of lattices, and their shaded colours.
    Lattice,
    /// The means of windows with k > 1, w×h.
    Color,
    /// The counters.
    Statistics,
    /// The host's target.
    Target,
}

impl Resource {
    const ALL: [Self; 13] = [
        Self::GBuffer,
        Self::Host,
        Self::First,
        Self::Rays,
        Self::Tiles,
        Self::Traced,
        Self::Counts,
        Self::Plan,
        Self::List,
        Self::Lattice,
        Self::Color,
        Self::Statistics,
        Self::Target,
    ];

    /// Whether passes only add to it, in any order to the same sums. Two passes that write it may be swapped, or overlap.
    pub fn is_unordered(self) -> bool {
        self == Self::Statistics
    }
}

/// Some of the [`Resource`]s.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct ResourceSet(u16);

impl ResourceSet {
    /// Whether the resource is among them.
    pub fn contains(self, resource: Resource) -> bool {
        self.0 & 1 << resource as u16 != 0
    }

    /// The resources, in the order of [`Resource`].
    pub fn iter(self) -> impl Iterator<Item = Resource> {
        Resource::ALL.into_iter().filter(move |&resource| self.contains(resource))
    }
}

impl FromIterator<Resource> for ResourceSet {
    fn from_iter<T: IntoIterator<Item = Resource>>(resources: T) -> Self {
        Self(resources.into_iter().fold(0, |all, resource| all | 1 << resource as u16))
    }
}

impl fmt::Debug for ResourceSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

/// A texture or a buffer of the node: a [`Resource`] is one or several of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// Depth of the G-buffer.
    GBufferDepth,
    /// Its first colour target.
    GBufferSurface,
    /// Its second.
    GBufferFrame,
    /// Its third.
    GBufferUv,
    /// Of [`Resource::First`].
    First,
    /// Of [`Resource::Color`].
    Color,
    /// Of [`Resource::Counts`].
    Counts,
    /// Of [`Resource::Plan`].
    Plan,
    /// [`Resource::List`] of pixels: where each tile's entries lie.
    PixelListRows,
    /// Of pixels: the entries.
    PixelListEntries,
    /// Of pixels: its dispatches.
    PixelListWork,
    /// [`Resource::List`] of samples: where each tile's entries lie.
    SampleListRows,
    /// Of samples: the entries.
    SampleListEntries,
    /// Of samples: its dispatches.
    SampleListWork,
    /// Of samples: what they were shaded.
    SampleListColors,
    /// [`Resource::Lattice`]: why each point was chosen, and what its rays found.
    LatticePoints,
    /// What each point was shaded.
    LatticeColors,
    /// Of [`Resource::Tiles`].
    Tiles,
    /// [`Resource::Traced`]: shadow bits.
    Shadows,
    /// What is reflected and refracted.
    Secondary,
    /// Of [`Resource::Statistics`].
    Counters,
    /// Of [`Resource::Target`].
    Target,
}

/// How long the content of a resource lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lifetime {
    /// The host writes it before the frame, or has it after.
    Imported,
    /// From its first write of a frame to its last read of the same frame: no pass reads what no pass of the frame has written.
    /// Outside of that its memory may serve for something else.
    Transient {
        /// [`begin`](crate::DeferredAa::begin) clears it, so that it lives from there.
        from_begin: bool,
    },
    /// Across frames.
    Kept,
}

/// What memory a part needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// A plain 2D texture: one layer, one mip level, one sample a texel.
    Texture {
        /// Of its texels.
        format: wgpu::TextureFormat,
        /// Texels.
        width: u32,
        /// Texels.
        height: u32,
        /// At least these.
        usage: wgpu::TextureUsages,
    },
    /// A buffer.
    Buffer {
        /// At least so many.
        bytes: u64,
        /// At least these.
        usage: wgpu::BufferUsages,
    },
}

impl PartKind {
    /// Bytes, without what the driver adds.
    pub fn bytes(&self) -> u64 {
        match *self {
            Self::Texture { format, width, height, .. } => {
                u64::from(format.block_copy_size(None).unwrap_or(0)) * u64::from(width) * u64::from(height)
            }
            Self::Buffer { bytes, .. } => bytes,
        }
    }
}

/// A part of a frame's resources.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartInfo {
    /// Which.
    pub part: Part,
    /// What passes call it.
    pub resource: Resource,
    /// The memory that it needs.
    pub kind: PartKind,
    /// How long its content lives.
    pub lifetime: Lifetime,
}

impl Part {
    pub(crate) const ALL: [Self; 22] = [
        Self::GBufferDepth,
        Self::GBufferSurface,
        Self::GBufferFrame,
        Self::GBufferUv,
        Self::First,
        Self::Color,
        Self::Counts,
        Self::Plan,
        Self::PixelListRows,
        Self::PixelListEntries,
        Self::PixelListWork,
        Self::SampleListRows,
        Self::SampleListEntries,
        Self::SampleListWork,
        Self::SampleListColors,
        Self::LatticePoints,
        Self::LatticeColors,
        Self::Tiles,
        Self::Shadows,
        Self::Secondary,
        Self::Counters,
        Self::Target,
    ];

    /// In the order of [`GBuffer::color`](crate::GBuffer::color), then depth.
    pub(crate) const GBUFFER: [Self; 4] =
        [Self::GBufferSurface, Self::GBufferFrame, Self::GBufferUv, Self::GBufferDepth];

    /// The resource that passes list it under.
    pub const fn resource(self) -> Resource {
        match self {
            Self::GBufferDepth | Self::GBufferSurface | Self::GBufferFrame | Self::GBufferUv => Resource::GBuffer,
            Self::First => Resource::First,
            Self::Color => Resource::Color,
            Self::Counts => Resource::Counts,
            Self::Plan => Resource::Plan,
            Self::PixelListRows
            | Self::PixelListEntries
            | Self::PixelListWork
            | Self::SampleListRows
            | Self::SampleListEntries
            | Self::SampleListWork
            | Self::SampleListColors => Resource::List,
            Self::LatticePoints | Self::LatticeColors => Resource::Lattice,
            Self::Tiles => Resource::Tiles,
            Self::Shadows | Self::Secondary => Resource::Traced,
            Self::Counters => Resource::Statistics,
            Self::Target => Resource::Target,
        }
    }

    pub(crate) fn lifetime(self) -> Lifetime {
        match self {
            Self::GBufferDepth | Self::GBufferSurface | Self::GBufferFrame | Self::GBufferUv | Self::Target => {
                Lifetime::Imported
            }
            Self::Counters => Lifetime::Kept,
            Self::Tiles | Self::Shadows | Self::Secondary => Lifetime::Transient { from_begin: true },
            _ => Lifetime::Transient { from_begin: false },
        }
    }

    /// Whether a host may lend memory for it.
    pub(crate) fn is_lendable(self) -> bool {
        !matches!(self, Self::Counters | Self::Target)
    }
}

/// What a pass does. Several passes of a frame may be of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum PassKind {
    /// Lists the tiles in which rays are wanted.
    Classify,
    /// Traces shadow rays.
    Trace,
    /// Traces mirrored and refracted rays.
    Bounce,
    /// Shades the first sample of every window.
    First,
    /// Asks how many samples each window is worth.
    Metrics,
    /// Gives every pixel the greatest k of its block.
    MaxFilter,
    /// Lays out each tile's samples.
    Plan,
    /// Chooses quadrants of pixels.
    Select,
    /// Lists the frame's pixels or samples.
    List,
    /// Shades the samples beyond the first.
    Shade,
    /// Shades the samples of active quadrants.
    Quadrants,
    /// Fills geometric samples from shaded ones.
    Reconstruct,
    /// Chooses the points of a lattice that are worth a sample.
    Refine,
    /// Shades the chosen points of a lattice.
    Points,
    /// Takes S from the finest lattice.
    LatticeToPixels,
    /// Writes the image into the target.
    Resolve,
    /// Writes a debug view into the target.
    View,
    /// Measures the error of the finished image on some tiles.
    Audit,
    /// A pass of the host's own. No node has one; it is for hosts that list their times beside the node's.
    Host,
    /// Counts what is probably wrong in the G-buffer. Only [`check_input`](crate::DeferredAa::check_input) records it.
    Check,
}

/// How many workgroups an entry point gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Grid {
    /// One, alone.
    One,
    /// One for each tile of 8 × 8 pixels, along x and y.
    Tiles,
    /// One for each 64 tiles, counted row by row, along x.
    TileRuns,
    /// One for each square of so many pixels along a side, along x and y.
    Pixels(u32),
    /// One for each 8 × 8 samples of the G-buffer, along x and y.
    Samples,
    /// One for each k from 2 to n, along x.
    Counts,
    /// One for each audited tile, along x and y: one in so many of each row of tiles, as the frame's constants say.
    AuditedTiles,
    /// One for each square of so many points along a side of the pass's lattice, along x and y.
    Points(u32),
    /// One for each 8 × 8 points of the next coarser lattice, along x and y.
    Parents,
    /// One for each 8 × 8 cells of the pass's lattice, along x and y. A cell is a 2 × 2 of points where the coarser lattice is nested in
    /// it, with two cells more in each row and column, else a point.
    Cells,
    /// As many as stand in a buffer: an indirect dispatch.
    Indirect {
        /// The buffer.
        part: Part,
        /// Where in it the three numbers stand in the pass's first round, in bytes. In each later round 256 bytes further on.
        offset: u64,
    },
    /// None: a triangle that covers the target is drawn.
    Target,
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One => f.write_str("1"),
            Self::Tiles => f.write_str("⌈w/8⌉ × ⌈h/8⌉"),
            Self::TileRuns => f.write_str("⌈⌈w/8⌉ ⌈h/8⌉ / 64⌉"),
            Self::Pixels(side) => write!(f, "⌈w/{side}⌉ × ⌈h/{side}⌉"),
            Self::Samples => f.write_str("⌈m w/8⌉ × ⌈m h/8⌉"),
            Self::Counts => f.write_str("max(m² − 1, 1)"),
            Self::AuditedTiles => f.write_str("⌈⌈w/8⌉ / period⌉ × ⌈h/8⌉"),
            Self::Points(side) => write!(f, "⌈columns/{side}⌉ × ⌈rows/{side}⌉ of the lattice"),
            Self::Parents => f.write_str("⌈columns/8⌉ × ⌈rows/8⌉ of the coarser lattice"),
            Self::Cells => f.write_str("⌈cells/8⌉ along either side of the lattice"),
            Self::Indirect { part, offset } => write!(f, "indirect, from {part:?} at byte {offset}"),
            Self::Target => f.write_str("a triangle over the target"),
        }
    }
}

/// How often a pass runs its stages, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rounds {
    /// Once.
    Once,
    /// Once for each k from 2 to n; its dynamic offset goes 256 bytes further each time.
    Counts,
    /// Once for each batch of 2²² samples that the frame may have; its dynamic offset goes 256 bytes further each time.
    Batches,
}

impl fmt::Display for Rounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Once => "once",
            Self::Counts => "once for each k from 2 to n",
            Self::Batches => "once for each batch of 2²² samples",
        })
    }
}

/// An entry point of a pass, and its workgroups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stage {
    /// The entry point in the pass's module; of a triangle that of its fragments.
    pub entry: &'static str,
    /// How many workgroups it gets.
    pub grid: Grid,
    /// Names of the pass's bindings that this entry point does not use, so that they don't count against the device's limits.
    pub(crate) without: &'static [&'static str],
}

impl Stage {
    pub(crate) const fn new(entry: &'static str, grid: Grid) -> Self {
        Self { entry, grid, without: &[] }
    }
}

/// The lattice that a pass works on, by its shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LatticeShape {
    /// How its points lie.
    pub pattern: Pattern,
    /// log2 of its pitch in pixels.
    pub level: u32,
}

/// What a pass is called, what it runs, and what it reads and writes.
///
/// A graph may record passes in another order than [`passes`](crate::DeferredAa::passes) has, as long as for each resource that
/// is not [unordered](Resource::is_unordered) each write stays behind the reads and writes before it, and each read behind the
/// writes before it. It may leave out a pass if nobody reads what that writes: behind [`Frame::statistics`] and
/// [`Settings::goal`](crate::Settings::goal) somebody reads [`Resource::Statistics`].
///
/// [`Frame::statistics`]: crate::Frame::statistics
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PassInfo {
    /// The name in `stats.json` and in timings, such as `trace 1/4`.
    pub name: &'static str,
    /// What it does.
    pub kind: PassKind,
    /// What must be finished before.
    pub reads: ResourceSet,
    /// What it changes. The rest of a resource stays as earlier passes have written it.
    pub writes: ResourceSet,
    /// Its entry points, in the order in which they run.
    pub stages: &'static [Stage],
    /// How often these run.
    pub rounds: Rounds,
    /// The lattice that it works on, and the next coarser one, for passes of [`MultiResolution`](crate::Technique::MultiResolution) that
    /// have one.
    pub lattice: Option<[LatticeShape; 2]>,
}
