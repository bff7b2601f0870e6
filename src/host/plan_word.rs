//! What the plan says of a pixel.

/// The word that the plan has of a pixel: [`Intermediates::plan`](crate::Intermediates::plan). What stands in its upper half depends on
/// the technique. `shaders/shared/plan_word.wgsl` has the same accessors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
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
