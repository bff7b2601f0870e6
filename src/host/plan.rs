//! What the plan says of a pixel, and where it says so.

use crate::TILE;

/// Where pixels and samples lie in the buffers that go tile by tile: `daa_slot` and `daa_sample_index` in WGSL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Slots {
    tiles: [u32; 2],
}

impl Slots {
    /// The slots of an output of `width` × `height` pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self { tiles: [width, height].map(|side| side.div_ceil(TILE)) }
    }

    /// The number of tiles along x and y.
    pub fn tiles(self) -> [u32; 2] {
        self.tiles
    }

    /// The number of slots: one for each pixel of each tile, those beyond the image's edge included.
    pub fn count(self) -> usize {
        (self.tiles[0] * self.tiles[1] * TILE * TILE) as usize
    }

    /// The slot of a pixel, below [`count`](Self::count).
    pub fn pixel(self, x: u32, y: u32) -> usize {
        let tile = (y / TILE) * self.tiles[0] + x / TILE;
        (tile * TILE * TILE + (y % TILE) * TILE + x % TILE) as usize
    }

    /// The place of a pixel's sample in buffers that hold a word for each sample: all samples of rank 0, slot by slot,
    /// then those of rank 1, and so on.
    pub fn sample(self, x: u32, y: u32, rank: u32) -> usize {
        rank as usize * self.count() + self.pixel(x, y)
    }
}

/// The word that the plan has of a pixel: [`Intermediates::plan`](crate::Intermediates::plan). What stands in its upper
/// half depends on the technique. `shaders/shared/plan_word.wgsl` has the same accessors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PlanWord(pub u32);

/// The reason for the k of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DecidedBy {
    /// No metric asked for more than one sample.
    Nothing = 0,
    /// The depth metric.
    Depth = 1,
    /// The normal metric.
    Normal = 2,
    /// The luminance metric.
    Luminance = 3,
    /// The identity metric: the window has more than one material or object.
    Identity = 4,
    /// The setting for the least k.
    Least = 5,
    /// The shadow metric: the shadow bits differ from those of a neighbour.
    Shadow = 6,
    /// The metric of the host's own bytes, `user`.
    User = 7,
}

impl DecidedBy {
    /// All reasons, in the order of their numbers.
    pub const ALL: [Self; 8] = [
        Self::Nothing,
        Self::Depth,
        Self::Normal,
        Self::Luminance,
        Self::Identity,
        Self::Least,
        Self::Shadow,
        Self::User,
    ];
}

/// The attribute that a threshold of [`Technique::Selective`](crate::Technique::Selective) belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Attribute {
    /// Colour, where no other attribute disagrees.
    Color = 0,
    /// The object that the pixels show.
    Object = 1,
    /// The normal of the surface that the pixels show.
    Normal = 2,
    /// The shadows on the surface that the pixels show.
    Shadow = 3,
    /// The texture existence of the surface that the pixel shows.
    Texture = 4,
    /// The object that the pixels reflect or refract.
    ReflectedObject = 5,
    /// The normal of the surface that the pixels reflect or refract.
    ReflectedNormal = 6,
    /// The shadows on the surface that the pixels reflect or refract.
    ReflectedShadow = 7,
    /// The texture existence of the surface that the pixel reflects or refracts.
    ReflectedTexture = 8,
}

impl Attribute {
    /// All attributes, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::Color,
        Self::Object,
        Self::Normal,
        Self::Shadow,
        Self::Texture,
        Self::ReflectedObject,
        Self::ReflectedNormal,
        Self::ReflectedShadow,
        Self::ReflectedTexture,
    ];
}

impl PlanWord {
    /// The number of samples of the window that are shaded, 1 to n. 0 outside the image, and for an interpolated pixel
    /// of [`Technique::MultiResolution`](crate::Technique::MultiResolution).
    pub fn k(self) -> u32 {
        self.0 & 0xff
    }

    /// The reason for k. For [`Technique::Selective`](crate::Technique::Selective) use [`attribute`](Self::attribute)
    /// instead.
    pub fn decided_by(self) -> DecidedBy {
        *DecidedBy::ALL.get((self.0 >> 8 & 15) as usize).unwrap_or(&DecidedBy::Nothing)
    }

    /// For [`Technique::Selective`](crate::Technique::Selective): the attribute whose threshold applies to the first
    /// active quadrant, `None` if no quadrant is active.
    pub fn attribute(self) -> Option<Attribute> {
        Attribute::ALL.get((self.0 >> 8 & 15).checked_sub(1)? as usize).copied()
    }

    /// For [`Technique::MultiResolution`](crate::Technique::MultiResolution): the lattice on which the pixel's point,
    /// or that of its parents, was chosen. 0 is the lattice of pixels, 1 the shifted one, and 2, 3 and 4 are those of
    /// every second, fourth and eighth pixel.
    pub fn level(self) -> u32 {
        self.0 >> 12 & 7
    }

    /// For [`Technique::MultiResolution`](crate::Technique::MultiResolution): whether the pixel's point was shaded
    /// instead of interpolated.
    pub fn is_own(self) -> bool {
        self.0 & 0x8000 != 0
    }

    /// The number of the tile's samples beyond the first ones that come before this window's.
    pub fn before(self) -> u32 {
        self.0 >> 20
    }

    /// For [`Technique::Selective`](crate::Technique::Selective): the active quadrants, a bit each in the order of
    /// [`window::quadrants`](crate::window::quadrants).
    pub fn quadrants(self) -> u32 {
        self.0 >> 16 & 15
    }
}

/// The word that [`Technique::Surfaces`](crate::Technique::Surfaces) has of a pixel:
/// [`Intermediates::surfaces`](crate::Intermediates::surfaces). `shaders/surfaces/masks.wgsl` has the same accessors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct SurfaceWord(pub u32);

impl SurfaceWord {
    /// The number of surfaces in the window, 1 to 6; 0 outside the image.
    pub fn surfaces(self) -> u32 {
        self.0 & 7
    }

    /// Whether the window has more surfaces than are told apart, so that some were merged.
    pub fn is_merged(self) -> bool {
        self.0 & 8 != 0
    }

    /// The number of surfaces that were not lit but took their light from the corners of a block.
    pub fn interpolated(self) -> u32 {
        self.0 >> 5 & 7
    }

    /// The number of lights: the host's `light` was called so often for the window.
    pub fn lights(self) -> u32 {
        self.0 >> 8 & 127
    }

    /// The number of taps: the host's `material` was called so often for the window.
    pub fn taps(self) -> u32 {
        self.0 >> 16
    }
}
