//! Lattices of points over the G-buffer: which a frame goes through, and what is kept of them. Geometry: lattice.wgsl.

use crate::loans::Loans;
use crate::pipeline::entry;
use crate::resources::Part;
use crate::settings::{MultiResolution, Pattern};

/// `DAA_EQUILATERAL_ROW` of lattice.wgsl: the height of an equilateral triangle of side 1, in 65536ths.
const EQUILATERAL_ROW: u32 = 56756;

/// A lattice of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Place {
    /// First samples of all pixels.
    Pixels,
    /// One point a pixel, rows of triangles.
    Shifted,
    Half,
    Quarter,
    Eighth,
}

impl Place {
    pub const COUNT: usize = 5;

    /// log2 of its pitch in pixels.
    fn level(self) -> u32 {
        match self {
            Self::Pixels | Self::Shifted => 0,
            Self::Half => 1,
            Self::Quarter => 2,
            Self::Eighth => 3,
        }
    }

    /// One of several names of a pass.
    pub fn named(self, names: [&'static str; Self::COUNT]) -> &'static str {
        names[self as usize]
    }
}

/// What a lattice is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Use {
    Shading,
    Rays,
}

impl Use {
    pub const ALL: [Self; 2] = [Self::Shading, Self::Rays];
}

/// Lattices from the coarsest to the finest, which are the points that are shaded, or those that are shaded and want rays.
pub(crate) fn places(settings: &MultiResolution, of: Use) -> impl Iterator<Item = Place> + Clone + use<> {
    let coarsest = match of {
        Use::Shading => settings.shading.coarsest,
        Use::Rays => settings.rays.coarsest,
    };
    let coarse = [Place::Eighth, Place::Quarter, Place::Half].map(|place| (place.level() <= coarsest).then_some(place));
    let shifted = (settings.shading.pattern != Pattern::Quad).then_some(Place::Shifted);
    let fine = match of {
        Use::Shading => [shifted, Some(Place::Pixels)],
        Use::Rays => [Some(Place::Pixels), shifted],
    };
    coarse.into_iter().chain(fine).flatten()
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
    pub padding: [u32; 2],
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
    /// Workgroups of `side`² points.
    pub fn groups(&self, side: u32) -> [u32; 2] {
        [self.points.width, self.points.height].map(|points| points.div_ceil(side))
    }
}

/// All steps of a frame, by use and place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Steps {
    steps: [[StepUniform; Place::COUNT]; 2],
    /// Points of all lattices, and of those that are shaded.
    points: [u32; 2],
}

impl Steps {
    /// `rays`: 1 for shadows, 2 for what is reflected and refracted; 0: there are no lattices for them.
    pub fn new(settings: &MultiResolution, size: [u32; 2], rays: u32) -> Self {
        let mut made = Self { steps: Default::default(), points: [0; 2] };
        // The image is taken from the lattice of the pixels, which is the first of all.
        let [width, height] = points(size, Pattern::Quad, 0);
        made.points[0] = width * height;
        for of in Use::ALL {
            let mut parents: Option<LatticeUniform> = None;
            for place in places(settings, of).filter(|_| of == Use::Shading || rays != 0) {
                let pattern = match (of, place) {
                    (_, Place::Pixels) => Pattern::Quad,
                    (Use::Rays, Place::Half | Place::Quarter | Place::Eighth) => settings.rays.pattern,
                    _ => settings.shading.pattern,
                };
                let [width, height] = points(size, pattern, place.level());
                let kind = pattern as u32;
                let lattice = LatticeUniform {
                    kind,
                    level: place.level(),
                    width,
                    height,
                    first: if (of, place) == (Use::Shading, Place::Pixels) { 0 } else { made.points[0] },
                    place: place as u32,
                    padding: [0; 2],
                };
                if lattice.first > 0 {
                    made.points[0] += width * height;
                }
                let pitch = |l: LatticeUniform| (1 << l.level) as f32;
                let row = |l: LatticeUniform| {
                    if l.kind == Pattern::Equilateral as u32 { EQUILATERAL_ROW as f32 / 65536.0 } else { 1.0 }
                };
                let scale = parents.map_or(1.0, |p| pitch(lattice) / pitch(p));
                made.steps[of as usize][place as usize] = StepUniform {
                    points: lattice,
                    parents: parents.unwrap_or_default(),
                    scale: [scale, scale * parents.map_or(1.0, |p| row(lattice) / row(p))],
                    coarsest: u32::from(parents.is_none()),
                    rays: if of == Use::Rays { rays } else { 0 },
                    found: 0,
                    padding: [0; 3],
                };
                parents = Some(lattice);
            }
            if of == Use::Shading {
                made.points[1] = made.points[0];
            }
        }
        let [all, shaded] = made.points;
        for step in &mut made.steps[Use::Rays as usize] {
            step.found = all - shaded;
        }
        made
    }

    pub fn step(&self, of: Use, place: Place) -> &StepUniform {
        &self.steps[of as usize][place as usize]
    }

    /// Bytes of what is kept of points, and of their colours.
    pub fn bytes(&self) -> [u64; 2] {
        [u64::from(2 * self.points[0] - self.points[1]) * 16, u64::from(self.points[1]) * 16]
    }
}

/// Columns and rows: enough that every point has all its parents, and these all their neighbours, on the lattice.
fn points(size: [u32; 2], pattern: Pattern, level: u32) -> [u32; 2] {
    let rows = match pattern {
        Pattern::Equilateral => (u64::from(size[1]) * 65536).div_ceil(u64::from(EQUILATERAL_ROW)) as u32,
        Pattern::Quad | Pattern::Triangular => size[1],
    };
    let mut points = [size[0] + 1, rows + 1];
    for _ in 0..level {
        points = points.map(|n| n / 2 + 3);
    }
    points
}

/// What is kept of lattices.
#[derive(Debug)]
pub(crate) struct Lattices {
    /// Four words of each point: why it was chosen or not, and where it lies. Then four of each that casts rays: what they found.
    pub points: wgpu::Buffer,
    pub colors: wgpu::Buffer,
}

impl Lattices {
    pub const PARTS: [Part; 2] = [Part::LatticePoints, Part::LatticeColors];

    pub fn new(device: &wgpu::Device, [points, colors]: [u64; 2], loans: &Loans) -> Self {
        let buffer = |part, label, size| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            loans.buffer_or(part, device, label, size, usage)
        };
        Self {
            points: buffer(Part::LatticePoints, "daa points", points),
            colors: buffer(Part::LatticeColors, "daa lattice colors", colors),
        }
    }

    /// Whether so much fits.
    pub fn hold(&self, [points, colors]: [u64; 2]) -> bool {
        self.points.size() >= points && self.colors.size() >= colors
    }

    /// Bytes held that are not lent.
    pub fn held(&self, loans: &Loans) -> u64 {
        loans.own(Part::LatticePoints, self.points.size()) + loans.own(Part::LatticeColors, self.colors.size())
    }
}

/// The frame's step, by a dynamic offset.
pub(crate) fn step_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    let mut entry = entry::buffer(binding, wgpu::ShaderStages::COMPUTE, true);
    entry.ty = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: true,
        min_binding_size: wgpu::BufferSize::new(size_of::<StepUniform>() as u64),
    };
    entry
}

/// Binds a [`step_entry`].
pub(crate) fn bind_step(binding: u32, steps: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    let size = wgpu::BufferSize::new(size_of::<StepUniform>() as u64);
    wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: steps, offset: 0, size }),
    }
}
