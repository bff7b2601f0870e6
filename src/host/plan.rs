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

    /// The place of a pixel's sample in buffers that hold a word for each sample: all samples of rank 0, slot by slot, then those of
    /// rank 1, and so on.
    pub fn sample(self, x: u32, y: u32, rank: u32) -> usize {
        rank as usize * self.count() + self.pixel(x, y)
    }
}

/// The word that the plan has of a pixel: [`Intermediates::plan`](crate::Intermediates::plan). What stands in its upper half depends on
/// the technique. `shaders/shared/plan_word.wgsl` has the same accessors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PlanWord(pub u32);

/// What decided the k of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DecidedBy {
    /// Nothing asked for more than one sample.
    Nothing = 0,
    /// The depth metric.
    Depth = 1,
    /// The normal metric.
    Normal = 2,
    /// The luminance metric.
    Luminance = 3,
    /// The identity metric: two materials or objects.
    Identity = 4,
    /// The least k that the settings allow.
    Least = 5,
    /// The shadow metric: shadow bits that differ from a neighbour's.
    Shadow = 6,
}

impl DecidedBy {
    /// All of them, by their numbers.
    pub const ALL: [Self; 7] =
        [Self::Nothing, Self::Depth, Self::Normal, Self::Luminance, Self::Identity, Self::Least, Self::Shadow];
}

/// What a threshold of [`Technique::Selective`](crate::Technique::Selective) is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Attribute {
    /// Colour alone.
    Color = 0,
    /// The object that pixels show.
    Object = 1,
    /// The normal that they show.
    Normal = 2,
    /// The shadow on what they show.
    Shadow = 3,
    /// The texture of what they show.
    Texture = 4,
    /// The object that they reflect or refract.
    SecondaryObject = 5,
    /// The normal of what they reflect or refract.
    SecondaryNormal = 6,
    /// The shadow on what they reflect or refract.
    SecondaryShadow = 7,
    /// The texture of what they reflect or refract.
    SecondaryTexture = 8,
}

impl Attribute {
    /// All of them, by their numbers.
    pub const ALL: [Self; 9] = [
        Self::Color,
        Self::Object,
        Self::Normal,
        Self::Shadow,
        Self::Texture,
        Self::SecondaryObject,
        Self::SecondaryNormal,
        Self::SecondaryShadow,
        Self::SecondaryTexture,
    ];
}

impl PlanWord {
    /// Samples of the window that are shaded, 1 to n. 0 beyond the image, and for an interpolated pixel of
    /// [`Technique::MultiResolution`](crate::Technique::MultiResolution).
    pub fn k(self) -> u32 {
        self.0 & 0xff
    }

    /// What decided k. Of [`Technique::Selective`](crate::Technique::Selective) see [`attribute`](Self::attribute) instead.
    pub fn decided_by(self) -> DecidedBy {
        *DecidedBy::ALL.get((self.0 >> 8 & 15) as usize).unwrap_or(&DecidedBy::Nothing)
    }

    /// Of [`Technique::Selective`](crate::Technique::Selective) what the threshold of the first active quadrant is for, `None` if no
    /// quadrant is active.
    pub fn attribute(self) -> Option<Attribute> {
        Attribute::ALL.get((self.0 >> 8 & 15).checked_sub(1)? as usize).copied()
    }

    /// Of [`Technique::MultiResolution`](crate::Technique::MultiResolution) the lattice that the pixel's point was chosen on, or its
    /// parents': 0 of the pixels, 1 shifted, 2, 3 and 4 of every second, fourth and eighth pixel.
    pub fn level(self) -> u32 {
        self.0 >> 12 & 7
    }

    /// Of [`Technique::MultiResolution`](crate::Technique::MultiResolution) whether the pixel's point was shaded, and not interpolated.
    pub fn is_own(self) -> bool {
        self.0 & 0x8000 != 0
    }

    /// Samples of the tile, beyond the first ones, that lie before this window's. Not of
    /// [`Technique::Selective`](crate::Technique::Selective).
    pub fn before(self) -> u32 {
        self.0 >> 16
    }

    /// Of [`Technique::Selective`](crate::Technique::Selective) the active quadrants, a bit each as
    /// [`window::quadrants`](crate::window::quadrants) has them.
    pub fn quadrants(self) -> u32 {
        self.0 >> 16 & 15
    }
}
