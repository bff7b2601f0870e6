//! The plan's word for a pixel.

/// The word of a pixel in the plan, [`Intermediates::plan`](crate::Intermediates::plan). The meaning of its upper half
/// depends on the technique. `shaders/shared/plan_word.wgsl` has the same accessors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
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
}

impl DecidedBy {
    /// All reasons, in the order of their numbers.
    pub const ALL: [Self; 7] =
        [Self::Nothing, Self::Depth, Self::Normal, Self::Luminance, Self::Identity, Self::Least, Self::Shadow];
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
    SecondaryObject = 5,
    /// The normal of the surface that the pixels reflect or refract.
    SecondaryNormal = 6,
    /// The shadows on the surface that the pixels reflect or refract.
    SecondaryShadow = 7,
    /// The texture existence of the surface that the pixel reflects or refracts.
    SecondaryTexture = 8,
}

impl Attribute {
    /// All attributes, in the order of their numbers.
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

    /// The number of the tile's samples beyond the first ones that come before this window's. Not for
    /// [`Technique::Selective`](crate::Technique::Selective).
    pub fn before(self) -> u32 {
        self.0 >> 16
    }

    /// For [`Technique::Selective`](crate::Technique::Selective): the active quadrants, a bit each in the order of
    /// [`window::quadrants`](crate::window::quadrants).
    pub fn quadrants(self) -> u32 {
        self.0 >> 16 & 15
    }
}
