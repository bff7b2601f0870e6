//! The lattices of points over the G-buffer that a frame refines, and the steps between them. lattice.wgsl has their
//! geometry.

use crate::TILE;
use crate::host::graph::LatticeShape;
use crate::settings::{MultiResolution, Pattern};

/// `DAA_EQUILATERAL_ROW` of lattice.wgsl: the height of an equilateral triangle of side 1, in 65536ths.
const EQUILATERAL_ROW: u32 = 56756;

/// A lattice of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Level {
    /// One point for each pixel: its first sample.
    Pixels,
    /// One point for each pixel, with shifted rows.
    Shifted,
    Half,
    Quarter,
    Eighth,
}

impl Level {
    pub const COUNT: usize = 5;

    /// The base-2 logarithm of its pitch in pixels.
    fn pitch(self) -> u32 {
        match self {
            Self::Pixels | Self::Shifted => 0,
            Self::Half => 1,
            Self::Quarter => 2,
            Self::Eighth => 3,
        }
    }
}

/// The use of a lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum LatticeUse {
    Shading,
    Rays,
}

impl LatticeUse {
    pub const ALL: [Self; 2] = [Self::Shading, Self::Rays];
}

/// The lattices of a use, from the coarsest to the finest.
pub(crate) fn levels(settings: &MultiResolution, of: LatticeUse) -> impl Iterator<Item = Level> + Clone + use<> {
    let coarsest = match of {
        LatticeUse::Shading => settings.shading.coarsest,
        LatticeUse::Rays => settings.rays.coarsest,
    };
    let coarse = [Level::Eighth, Level::Quarter, Level::Half].map(|level| (level.pitch() <= coarsest).then_some(level));
    let shifted = (settings.shading.pattern != Pattern::Quad).then_some(Level::Shifted);
    let fine = match of {
        LatticeUse::Shading => [shifted, Some(Level::Pixels)],
        LatticeUse::Rays => [Some(Level::Pixels), shifted],
    };
    coarse.into_iter().chain(fine).flatten()
}

/// How far around a point of the finest lattice of a use the values lie that decide its own, in pixels. A point follows
/// from its parents, and they from their neighbours. Rows of equilateral triangles lie at rounded places.
pub(crate) fn reach(settings: &MultiResolution, of: LatticeUse) -> u32 {
    let finer = levels(settings, of).skip(1).count();
    let parents = levels(settings, of).take(finer);
    parents.map(|parent| 2 << parent.pitch()).sum::<u32>() + 1
}

/// `DaaLattice` of lattice.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct LatticeUniform {
    pub kind: u32,
    pub level: u32,
    pub width: u32,
    pub height: u32,
    pub first: u32,
    pub place: u32,
    pub origin: [u32; 2],
}

impl LatticeUniform {
    /// The lattice over the part of an image that begins at the pixel `origin`, a multiple of [`TILE`].
    fn placed(self, origin: [u32; 2], image: [u32; 2]) -> Self {
        let pattern = [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral][self.kind as usize];
        let row = match pattern {
            Pattern::Quad | Pattern::Triangular => origin[1] >> self.level,
            // The last row of the coarsest lattice at or above the origin; it is also a row of all others.
            Pattern::Equilateral => {
                let rows = u64::from(origin[1]) * 65536 / u64::from(TILE * EQUILATERAL_ROW);
                (rows as u32) << (TILE.ilog2() - self.level)
            }
        };
        let rows = points(image, image, LatticeShape { pattern, level: self.level })[1];
        Self { origin: [origin[0] >> self.level, row], height: self.height.min(rows - row), ..self }
    }
}

/// `DaaStep` of lattice.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct StepUniform {
    pub points: LatticeUniform,
    pub parents: LatticeUniform,
    pub scale: [f32; 2],
    pub coarsest: u32,
    pub rays: u32,
    pub found: u32,
    pub padding: [u32; 3],
}

impl StepUniform {
    /// The step over the part of an image that begins at the pixel `origin`.
    pub fn placed(self, origin: [u32; 2], image: [u32; 2]) -> Self {
        let [points, parents] = [self.points, self.parents].map(|lattice| lattice.placed(origin, image));
        Self { points, parents, ..self }
    }
}

/// A step of a frame: from the next coarser lattice to this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct LatticeStep {
    pub of: LatticeUse,
    pub level: Level,
}

impl LatticeStep {
    pub const COUNT: u64 = 2 * Level::COUNT as u64;

    /// The index, below [`COUNT`](Self::COUNT).
    pub fn index(self) -> u64 {
        self.of as u64 * Level::COUNT as u64 + self.level as u64
    }

    /// The shapes of its lattice and of the next coarser one. For the coarsest, both are its own.
    pub fn shapes(self, settings: &MultiResolution) -> [LatticeShape; 2] {
        let coarser = levels(settings, self.of).take_while(|&level| level != self.level).last();
        [self.level, coarser.unwrap_or(self.level)].map(|level| shape(settings, self.of, level))
    }
}

fn shape(settings: &MultiResolution, of: LatticeUse, level: Level) -> LatticeShape {
    let pattern = match (of, level) {
        (_, Level::Pixels) => Pattern::Quad,
        (LatticeUse::Rays, Level::Half | Level::Quarter | Level::Eighth) => settings.rays.pattern,
        _ => settings.shading.pattern,
    };
    LatticeShape { pattern, level: level.pitch() }
}

/// All steps of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LatticeSteps {
    steps: [[StepUniform; Level::COUNT]; 2],
    /// The number of points of all lattices, and of the lattices for shading.
    points: [u64; 2],
}

impl LatticeSteps {
    /// Lays out the lattices of a frame over `size` pixels, which are `image` or a part of it. `rays` has bit 0 for
    /// shadows and bit 1 for reflections and refractions; with 0 there are no lattices for rays.
    pub fn new(settings: &MultiResolution, size: [u32; 2], image: [u32; 2], rays: u32) -> Self {
        let mut made = Self { steps: Default::default(), points: [0; 2] };
        // The image is taken from the lattice of pixels, which lies before all others.
        let [width, height] = points(size, image, LatticeShape { pattern: Pattern::Quad, level: 0 });
        made.points[0] = u64::from(width) * u64::from(height);
        for of in LatticeUse::ALL {
            let mut parents: Option<LatticeUniform> = None;
            for level in levels(settings, of).filter(|_| of == LatticeUse::Shading || rays != 0) {
                let shape = shape(settings, of, level);
                let [width, height] = points(size, image, shape);
                let lattice = LatticeUniform {
                    kind: shape.pattern as u32,
                    level: shape.level,
                    width,
                    height,
                    first: if (of, level) == (LatticeUse::Shading, Level::Pixels) { 0 } else { made.points[0] as u32 },
                    place: level as u32,
                    origin: [0; 2],
                };
                if lattice.first > 0 {
                    made.points[0] += u64::from(width) * u64::from(height);
                }
                let pitch = |l: LatticeUniform| (1 << l.level) as f32;
                let row = |l: LatticeUniform| {
                    if l.kind == Pattern::Equilateral as u32 { EQUILATERAL_ROW as f32 / 65536.0 } else { 1.0 }
                };
                let scale = parents.map_or(1.0, |p| pitch(lattice) / pitch(p));
                made.steps[of as usize][level as usize] = StepUniform {
                    points: lattice,
                    parents: parents.unwrap_or_default(),
                    scale: [scale, scale * parents.map_or(1.0, |p| row(lattice) / row(p))],
                    coarsest: u32::from(parents.is_none()),
                    rays: if of == LatticeUse::Rays { rays } else { 0 },
                    found: 0,
                    padding: [0; 3],
                };
                parents = Some(lattice);
            }
            if of == LatticeUse::Shading {
                made.points[1] = made.points[0];
            }
        }
        let [all, shaded] = made.points;
        for step in &mut made.steps[LatticeUse::Rays as usize] {
            step.found = (all - shaded) as u32;
        }
        made
    }

    pub fn step(&self, step: LatticeStep) -> &StepUniform {
        &self.steps[step.of as usize][step.level as usize]
    }

    /// Whether any of the lattices has this pattern.
    pub fn has(&self, pattern: Pattern) -> bool {
        self.steps.as_flattened().iter().any(|step| step.points.width > 0 && step.points.kind == pattern as u32)
    }

    /// The bytes of the points, and of their colours.
    pub fn bytes(&self) -> [u64; 2] {
        [(2 * self.points[0] - self.points[1]) * 16, self.points[1] * 16]
    }
}

/// The number of columns and rows of a lattice: enough that the lattice has all parents of every point, and all
/// neighbours of these. `size` is that of the image or of a part of it.
pub(crate) fn points(size: [u32; 2], image: [u32; 2], shape: LatticeShape) -> [u32; 2] {
    // The rows of a part may begin up to one row of the coarsest lattice above it.
    let above = if size == image { 0 } else { u64::from(TILE) };
    let rows = match shape.pattern {
        Pattern::Equilateral => ((u64::from(size[1]) + above) * 65536).div_ceil(u64::from(EQUILATERAL_ROW)) as u32,
        Pattern::Quad | Pattern::Triangular => size[1],
    };
    let mut points = [size[0] + 1, rows + 1];
    for _ in 0..shape.level {
        points = points.map(|n| n / 2 + 3);
    }
    points
}
