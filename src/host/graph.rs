//! A frame as a host's frame graph sees it: its resources, the textures and buffers behind them, and its passes.

use crate::settings::Pattern;
use std::fmt;

/// A resource of the frame, as [`PassInfo`] lists it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Resource {
    /// The attachments of [`GBuffer`](crate::GBuffer), rendered by the host.
    GBuffer,
    /// The host's bind group and the texture table.
    Host,
    /// S, the image of shaded first samples, w×h.
    First,
    /// The scene that rays are traced in.
    Rays,
    /// The tiles in which rays are needed.
    Tiles,
    /// The ray results: the shadow bits of samples, and the radiance that they reflect and refract.
    Traced,
    /// The k of each window, as the metrics computed it.
    WindowCounts,
    /// The k of each window and its position in the tile's list.
    Plan,
    /// The frame's pixels, sorted by k, or its samples, as one list.
    List,
    /// The points of the lattices and their shaded colours.
    Lattice,
    /// The surfaces of each window, and the list of windows that are lit apart.
    Surfaces,
    /// The means of windows with k > 1, w×h.
    Color,
    /// The statistics counters.
    Statistics,
    /// The target of the frame.
    Target,
    /// The depth texture of the frame.
    Depth,
}

impl Resource {
    const ALL: [Self; 15] = [
        Self::GBuffer,
        Self::Host,
        Self::First,
        Self::Rays,
        Self::Tiles,
        Self::Traced,
        Self::WindowCounts,
        Self::Plan,
        Self::List,
        Self::Lattice,
        Self::Surfaces,
        Self::Color,
        Self::Statistics,
        Self::Target,
        Self::Depth,
    ];

    /// Whether passes only add to it, so that the sums do not depend on their order. Two passes that write it may be
    /// swapped or overlap.
    pub fn is_unordered(self) -> bool {
        self == Self::Statistics
    }
}

/// A set of [`Resource`]s.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct ResourceSet(u16);

impl ResourceSet {
    /// Whether the set contains the resource.
    pub fn contains(self, resource: Resource) -> bool {
        self.0 & 1 << resource as u16 != 0
    }

    /// The resources of the set, in the order of [`Resource`].
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

/// A texture or a buffer of the node. A [`Resource`] consists of one or several of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// The depth of the G-buffer.
    GBufferDepth,
    /// The first colour target of the G-buffer.
    GBufferSurface,
    /// The second colour target of the G-buffer.
    GBufferFrame,
    /// The third colour target of the G-buffer.
    GBufferUv,
    /// The texture of [`Resource::First`].
    First,
    /// The texture of [`Resource::Color`].
    Color,
    /// The buffer of [`Resource::WindowCounts`].
    WindowCounts,
    /// The buffer of [`Resource::Plan`].
    Plan,
    /// The offsets of each tile's entries in the list of pixels ([`Resource::List`]).
    PixelListRows,
    /// The entries of the list of pixels.
    PixelListEntries,
    /// The indirect dispatches of the list of pixels.
    PixelListWork,
    /// The offsets of each tile's entries in the list of samples ([`Resource::List`]).
    SampleListRows,
    /// The entries of the list of samples.
    SampleListEntries,
    /// The indirect dispatches of the list of samples.
    SampleListWork,
    /// The shaded colours of the list of samples.
    SampleListColors,
    /// The points of [`Resource::Lattice`]: why each was chosen, and its ray results.
    LatticePoints,
    /// The shaded colours of the points.
    LatticeColors,
    /// The surfaces of each window ([`Resource::Surfaces`]).
    SurfaceMasks,
    /// The windows that are lit apart, and their indirect dispatch ([`Resource::Surfaces`]).
    SurfaceList,
    /// The windows with a surface that is cut into groups, and their indirect dispatch ([`Resource::Surfaces`]).
    SurfaceCutList,
    /// The buffer of [`Resource::Tiles`].
    Tiles,
    /// The shadow bits of [`Resource::Traced`].
    Shadows,
    /// The reflected and refracted radiance of [`Resource::Traced`].
    Reflections,
    /// The buffer of [`Resource::Statistics`].
    Counters,
    /// The texture of [`Resource::Target`].
    Target,
    /// The texture of [`Resource::Depth`].
    Depth,
}

/// How long the content of a resource is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lifetime {
    /// The host writes it before the frame or reads it after the frame.
    Imported,
    /// From its first write to its last read in the same frame: it is never read before it is written within the frame.
    /// Outside that time its memory may hold something else.
    Transient {
        /// Whether [`begin`](crate::DeferredAa::begin) clears it, so that its life starts there.
        from_begin: bool,
    },
    /// The content is kept from frame to frame.
    Kept,
}

/// The memory that a part needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// A plain 2D texture with one layer, one mip level and one sample per texel.
    Texture {
        /// The format of the texture.
        format: wgpu::TextureFormat,
        /// The width in texels.
        width: u32,
        /// The height in texels.
        height: u32,
        /// The usages that the texture must have; it may have more.
        usage: wgpu::TextureUsages,
    },
    /// A buffer.
    Buffer {
        /// The least size in bytes.
        bytes: u64,
        /// The usages that the buffer must have; it may have more.
        usage: wgpu::BufferUsages,
    },
}

impl PartKind {
    /// The size in bytes, without what the driver adds.
    pub fn bytes(&self) -> u64 {
        match *self {
            Self::Texture { format, width, height, .. } => {
                u64::from(format.block_copy_size(None).unwrap_or(0)) * u64::from(width) * u64::from(height)
            }
            Self::Buffer { bytes, .. } => bytes,
        }
    }
}

/// A part of a frame's resources, the memory that it needs and its lifetime.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartInfo {
    /// The texture or buffer.
    pub part: Part,
    /// The resource that it belongs to in [`PassInfo::reads`] and [`PassInfo::writes`].
    pub resource: Resource,
    /// The memory that it needs.
    pub kind: PartKind,
    /// How long its content is needed.
    pub lifetime: Lifetime,
}

impl Part {
    pub(crate) const ALL: [Self; 26] = [
        Self::GBufferDepth,
        Self::GBufferSurface,
        Self::GBufferFrame,
        Self::GBufferUv,
        Self::First,
        Self::Color,
        Self::WindowCounts,
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
        Self::SurfaceMasks,
        Self::SurfaceList,
        Self::SurfaceCutList,
        Self::Tiles,
        Self::Shadows,
        Self::Reflections,
        Self::Counters,
        Self::Target,
        Self::Depth,
    ];

    /// The parts of the G-buffer, in the order of [`GBuffer::color`](crate::GBuffer::color), then depth.
    pub(crate) const GBUFFER: [Self; 4] =
        [Self::GBufferSurface, Self::GBufferFrame, Self::GBufferUv, Self::GBufferDepth];

    /// The resource that the part belongs to.
    pub const fn resource(self) -> Resource {
        match self {
            Self::GBufferDepth | Self::GBufferSurface | Self::GBufferFrame | Self::GBufferUv => Resource::GBuffer,
            Self::First => Resource::First,
            Self::Color => Resource::Color,
            Self::WindowCounts => Resource::WindowCounts,
            Self::Plan => Resource::Plan,
            Self::PixelListRows
            | Self::PixelListEntries
            | Self::PixelListWork
            | Self::SampleListRows
            | Self::SampleListEntries
            | Self::SampleListWork
            | Self::SampleListColors => Resource::List,
            Self::LatticePoints | Self::LatticeColors => Resource::Lattice,
            Self::SurfaceMasks | Self::SurfaceList | Self::SurfaceCutList => Resource::Surfaces,
            Self::Tiles => Resource::Tiles,
            Self::Shadows | Self::Reflections => Resource::Traced,
            Self::Counters => Resource::Statistics,
            Self::Target => Resource::Target,
            Self::Depth => Resource::Depth,
        }
    }

    pub(crate) fn lifetime(self) -> Lifetime {
        match self {
            Self::GBufferDepth | Self::GBufferSurface | Self::GBufferFrame | Self::GBufferUv => Lifetime::Imported,
            Self::Target | Self::Depth => Lifetime::Imported,
            Self::Counters => Lifetime::Kept,
            Self::SurfaceList | Self::SurfaceCutList | Self::Tiles | Self::Shadows | Self::Reflections => {
                Lifetime::Transient { from_begin: true }
            }
            _ => Lifetime::Transient { from_begin: false },
        }
    }

    /// Whether a host may lend memory for the part.
    pub(crate) fn is_lendable(self) -> bool {
        !matches!(self, Self::Counters | Self::Target | Self::Depth)
    }
}

/// The kind of a pass. Several passes of a frame may have the same kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum PassKind {
    /// Lists the tiles in which rays are needed.
    Classify,
    /// Finds the places of the results of planned samples.
    Places,
    /// Traces shadow rays.
    Trace,
    /// Traces mirrored and refracted rays.
    Reflect,
    /// Shades the first sample of every window.
    First,
    /// Computes how many samples of each window are shaded.
    Metrics,
    /// Gives every pixel the greatest k of its block.
    MaxFilter,
    /// Lays out the samples of each tile.
    Plan,
    /// Chooses the quadrants of pixels that are shaded.
    Select,
    /// Builds the list of the frame's pixels or samples.
    List,
    /// Shades the samples beyond the first.
    Shade,
    /// Shades the samples of active quadrants.
    Quadrants,
    /// Gives geometric samples colours from shaded ones.
    Reconstruct,
    /// Chooses the points of a lattice that are shaded.
    Refine,
    /// Shades the chosen points of a lattice.
    Points,
    /// Computes S from the finest lattice.
    LatticeToPixels,
    /// Gathers the samples of each window into surfaces.
    Cover,
    /// Lights the surfaces of each window.
    Light,
    /// Writes the image into the target.
    Resolve,
    /// Writes a debug view into the target.
    View,
    /// Writes depth at the output's size.
    Depth,
    /// Measures the error of the finished image in some tiles.
    Audit,
    /// Is a pass of the host's own. No node has one; it is for hosts that list their times beside the node's.
    Host,
    /// Counts probable mistakes in the G-buffer. Only [`check_input`](crate::DeferredAa::check_input) records it.
    Check,
}

/// The number of workgroups of an entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Grid {
    /// A single workgroup.
    One,
    /// One workgroup for each tile of 8 × 8 pixels, along x and y.
    Tiles,
    /// One workgroup for each 64 tiles, counted row by row, along x.
    TileRuns,
    /// One workgroup for each square of pixels with this side, along x and y.
    Pixels(u32),
    /// One workgroup for each 8 × 8 samples of the G-buffer, along x and y.
    Samples,
    /// One workgroup for each k from 2 to n, along x.
    Counts,
    /// One workgroup for each audited tile, along x and y: one in a period of tiles in each row, where the period is in
    /// the frame's constants.
    AuditedTiles,
    /// One workgroup for each square of points with this side, along x and y, on the pass's lattice.
    Points(u32),
    /// One workgroup for each 8 × 8 points of the next coarser lattice, along x and y.
    Parents,
    /// One workgroup for each 8 × 8 cells of the pass's lattice, along x and y. If the coarser lattice is nested in it,
    /// a cell is a block of 2 × 2 points, and each row and column has two more cells; otherwise a cell is a point.
    Cells,
    /// An indirect dispatch: a buffer holds the numbers.
    Indirect {
        /// The buffer.
        part: Part,
        /// The position of the three numbers in the buffer in the pass's first round, in bytes. Each later round reads
        /// 256 bytes further on.
        offset: u64,
    },
    /// No workgroups: a triangle that covers the target is drawn.
    Target,
    /// No workgroups: a triangle that covers the host's depth texture is drawn, which writes depth and no colour.
    Depth,
}

impl Grid {
    /// The resource that a triangle is drawn over, `None` if workgroups are dispatched.
    pub(crate) fn drawn(self) -> Option<Resource> {
        match self {
            Self::Target => Some(Resource::Target),
            Self::Depth => Some(Resource::Depth),
            _ => None,
        }
    }
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
            Self::Depth => f.write_str("a triangle over the depth texture"),
        }
    }
}

/// How often a pass runs its stages one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rounds {
    /// Once.
    Once,
    /// Once for each k from 2 to n. Each round adds 256 bytes to its dynamic offset.
    Counts,
    /// Once for each batch of 2²² samples that the frame may have. Each round adds 256 bytes to its dynamic offset.
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

/// An entry point of a pass and its number of workgroups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stage {
    /// The entry point in the pass's module; for a triangle, the fragment entry point.
    pub entry: &'static str,
    /// The number of workgroups.
    pub grid: Grid,
    /// The names of those bindings of the pass that this entry point does not use, so that they don't count against the
    /// device's limits.
    pub(crate) without: &'static [&'static str],
}

impl Stage {
    pub(crate) const fn new(entry: &'static str, grid: Grid) -> Self {
        Self { entry, grid, without: &[] }
    }
}

/// The shape of a lattice that a pass works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LatticeShape {
    /// The arrangement of its points.
    pub pattern: Pattern,
    /// The base-2 logarithm of the distance between its points in pixels.
    pub level: u32,
}

/// The name of a pass, its entry points, and the resources that it reads and writes.
///
/// A graph may record passes in another order than that of [`passes`](crate::DeferredAa::passes) if, for each resource
/// that is not [unordered](Resource::is_unordered), each write stays after the reads and writes before it, and each
/// read after the writes before it. It may drop a pass if nothing reads what that pass writes. With
/// [`Frame::statistics`] or [`Settings::goal`](crate::Settings::goal), [`Resource::Statistics`] is read after the
/// frame.
///
/// [`Frame::statistics`]: crate::Frame::statistics
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PassInfo {
    /// The name in `stats.json` and in timings, such as `trace 1/4`.
    pub name: &'static str,
    /// The kind of the pass.
    pub kind: PassKind,
    /// The resources that it reads. Their writes must be finished before.
    pub reads: ResourceSet,
    /// The resources that it changes. The rest of a resource keeps what earlier passes have written.
    pub writes: ResourceSet,
    /// Its entry points, in the order in which they run.
    pub stages: &'static [Stage],
    /// How often the stages run.
    pub rounds: Rounds,
    /// The lattice that it works on and the next coarser one, for passes of
    /// [`MultiResolution`](crate::Technique::MultiResolution) that work on a lattice.
    pub lattice: Option<[LatticeShape; 2]>,
}
