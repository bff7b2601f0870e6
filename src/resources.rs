//! What the resources of a frame are made of: for a host whose graph allocates, aliases and frees them.

use crate::effects::Traced;
use crate::gbuffer::{COLOR_FORMATS, DEPTH_FORMAT};
use crate::lattice::Steps;
use crate::pipeline::Resource;
use crate::scratch::{self, IMAGE_FORMAT, List, ListKind};
use crate::settings::{Settings, Technique};
use crate::statistics::COUNTER_BYTES;
use crate::traces::{Kept, Traces};

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

/// What sizes depend on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape<'a> {
    pub size: [u32; 2],
    pub m: u32,
    pub target_format: wgpu::TextureFormat,
    pub settings: &'a Settings,
    pub traced: Traced,
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

    /// In the order of [`List::bytes`]; a list of pixels has no colours.
    pub(crate) fn of_list(kind: ListKind) -> &'static [Self] {
        match kind {
            ListKind::Pixels => &[Self::PixelListRows, Self::PixelListEntries, Self::PixelListWork],
            ListKind::Samples => {
                &[Self::SampleListRows, Self::SampleListEntries, Self::SampleListWork, Self::SampleListColors]
            }
        }
    }

    /// What passes call it.
    pub fn resource(self) -> Resource {
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

    /// A host may lend memory for it.
    pub(crate) fn is_lendable(self) -> bool {
        !matches!(self, Self::Counters | Self::Target)
    }

    /// What frames of this shape need; `None` if they have no rays or lattices. Of lists both kinds.
    pub(crate) fn kind(self, shape: &Shape<'_>) -> Option<PartKind> {
        let Shape { size, m, settings, traced, .. } = *shape;
        let samples = size.map(|side| side * m);
        let of_list = |kind: ListKind, part: usize| {
            // The dispatches are indirect.
            let usage = if part == 2 { wgpu::BufferUsages::INDIRECT } else { wgpu::BufferUsages::empty() };
            buffer(List::bytes(kind, size, m)[part], usage)
        };
        let of_lattices = |part: usize| {
            let steps = Steps::new(&settings.multi_resolution, size, traced.rays());
            let refined = settings.technique == Technique::MultiResolution;
            if refined { buffer(steps.bytes()[part], wgpu::BufferUsages::empty()) } else { None }
        };
        let cleared = wgpu::BufferUsages::COPY_DST;
        let gbuffer = |format| texture(format, samples, wgpu::TextureUsages::RENDER_ATTACHMENT | SAMPLED);
        let image = || texture(IMAGE_FORMAT, size, wgpu::TextureUsages::STORAGE_BINDING | SAMPLED);
        match self {
            Self::GBufferDepth => gbuffer(DEPTH_FORMAT),
            Self::GBufferSurface => gbuffer(COLOR_FORMATS[0]),
            Self::GBufferFrame => gbuffer(COLOR_FORMATS[1]),
            Self::GBufferUv => gbuffer(COLOR_FORMATS[2]),
            Self::First | Self::Color => image(),
            Self::Counts | Self::Plan => buffer(scratch::plan_bytes(size), wgpu::BufferUsages::empty()),
            Self::PixelListRows => of_list(ListKind::Pixels, 0),
            Self::PixelListEntries => of_list(ListKind::Pixels, 1),
            Self::PixelListWork => of_list(ListKind::Pixels, 2),
            Self::SampleListRows => of_list(ListKind::Samples, 0),
            Self::SampleListEntries => of_list(ListKind::Samples, 1),
            Self::SampleListWork => of_list(ListKind::Samples, 2),
            Self::SampleListColors => of_list(ListKind::Samples, 3),
            Self::LatticePoints => of_lattices(0),
            Self::LatticeColors => of_lattices(1),
            Self::Tiles if traced.any() => buffer(Traces::tile_bytes(size), wgpu::BufferUsages::INDIRECT | cleared),
            Self::Shadows if traced.shadows => buffer(Traces::shadow_bytes(size, m, Kept::of(settings)), cleared),
            Self::Secondary if traced.secondary => {
                buffer(Traces::secondary_bytes(size, m, Kept::of(settings)), cleared)
            }
            Self::Tiles | Self::Shadows | Self::Secondary => None,
            Self::Counters => buffer(COUNTER_BYTES, wgpu::BufferUsages::COPY_SRC | cleared),
            Self::Target => texture(shape.target_format, size, wgpu::TextureUsages::RENDER_ATTACHMENT),
        }
    }
}

const SAMPLED: wgpu::TextureUsages = wgpu::TextureUsages::TEXTURE_BINDING;

fn texture(format: wgpu::TextureFormat, size: [u32; 2], usage: wgpu::TextureUsages) -> Option<PartKind> {
    Some(PartKind::Texture { format, width: size[0], height: size[1], usage })
}

fn buffer(bytes: u64, usage: wgpu::BufferUsages) -> Option<PartKind> {
    Some(PartKind::Buffer { bytes, usage: wgpu::BufferUsages::STORAGE | usage })
}
