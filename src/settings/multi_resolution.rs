//! Settings of `Technique::MultiResolution`.

use super::curve::LuminanceCurve;

/// The lattices of [`Technique::MultiResolution`](crate::Technique::MultiResolution): points in squares or triangles
/// over first samples, from a coarse pitch down to pixels.
///
/// A point of a finer lattice is sampled if a coarser point around it departs from the mean of its neighbours on
/// opposite sides (the thesis, section 4.2, Algorithm 1); otherwise it is interpolated between the coarser points.
/// Lattices are nested, so that no sample is lost, whereas the thesis samples anew at each resolution. Rays are cast
/// first, at the points of their own lattices, so that everything that is shaded has their results.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct MultiResolution {
    /// The lattice on which colours are shaded.
    pub shading: Lattice,
    /// The lattice on which shadow, mirrored and refracted rays are cast.
    pub rays: Lattice,
    /// Takes more samples in windows that are not smooth at one sample per pixel: 4 if m is even, 16 if m is a multiple
    /// of 4, or all; always all at geometric edges. [`Execution`](crate::Execution) runs them. Off: at most one sample
    /// per pixel, no anti-aliasing.
    pub supersampled: bool,
    /// A neighbourhood is not smooth if a channel of its exposed colour, on [`curve`](Self::curve), departs from the
    /// means of opposite neighbours by more than this, 0 to 1: the sum over the pairs divided by the number of
    /// neighbours. Higher: fewer samples, small and faint details are lost. 0: only exactly even colour is
    /// interpolated. 1: colour is ignored. The thesis prints no value.
    pub color_threshold: f32,
    /// A neighbourhood is not smooth if its position in the world departs from the means of opposite neighbours by more
    /// than this share of its distance from the camera, 0 to 1, averaged as for colour. The border between sky and
    /// surfaces is never smooth. Higher: fewer samples at edges and folds. The thesis prints no value.
    pub position_threshold: f32,
    /// The curve on which colours are compared.
    pub curve: LuminanceCurve,
    /// Never interpolates across materials, objects or shadows: such a point is sampled, and with
    /// [`supersampled`](Self::supersampled) a window with two materials or objects gets all its samples. Not in the
    /// thesis. On: thin features survive.
    pub veto: bool,
    /// Also weights the interpolation as [`Settings::reconstructed`](crate::Settings::reconstructed) does, with its
    /// scales and cuts, and samples points where less than half of the weight remains. Not in the thesis. On: sharper
    /// folds and more samples, which gain less than lower thresholds do.
    pub weighted: bool,
    /// Scales the texture footprint of a shaded sample, 0 to 4; without [`supersampled`](Self::supersampled) it is 1.
    /// At 1 it covers the samples that the shaded one stands for; it is never smaller than the sample's own. Higher:
    /// blurrier textures.
    pub footprint: f32,
}

/// The lattices of [`MultiResolution`] for one kind of work: how they are arranged and where they begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Lattice {
    /// How the points are arranged.
    pub pattern: Pattern,
    /// log2 of the coarsest pitch in pixels, 0 to 3: every pixel, or 1/2, 1/4 or 1/8 of the resolution along each side.
    /// Higher: fewer samples in smooth regions, but details smaller than the pitch may be missed.
    pub coarsest: u32,
}

/// How the points of a [`Lattice`] are arranged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[repr(u32)]
pub enum Pattern {
    /// Squares: eight neighbours in four opposite pairs.
    #[default]
    Quad = 0,
    /// Triangles: every other row is shifted by half a pitch, in the finest lattice by half a pixel, which leaves six
    /// neighbours in three opposite pairs. Pixels are mapped from it, in shifted rows between two points (section 4.3).
    /// For shading it needs m of 2 or more. For rays it reaches down to a pitch of 2 pixels; below, rays are cast at
    /// the points that are shaded.
    Triangular = 1,
    /// Equilateral triangles: like [`Triangular`](Self::Triangular), but rows are closer by √3/2, rounded to the
    /// nearest sample, which makes 15 % more points.
    Equilateral = 2,
}

impl Default for Lattice {
    fn default() -> Self {
        Self { pattern: Pattern::Quad, coarsest: 2 }
    }
}

impl MultiResolution {
    /// As in the thesis: three resolutions up to the image's, triangular, without veto and weights. The thesis prints
    /// no thresholds.
    pub const PAPER: Self = Self {
        shading: Lattice { pattern: Pattern::Triangular, coarsest: 2 },
        rays: Lattice { pattern: Pattern::Triangular, coarsest: 2 },
        supersampled: false,
        color_threshold: 0.02,
        position_threshold: 0.02,
        curve: LuminanceCurve::Perceptual,
        veto: false,
        weighted: false,
        footprint: 1.0,
    };
}

impl Default for MultiResolution {
    fn default() -> Self {
        Self {
            shading: Lattice::default(),
            rays: Lattice::default(),
            supersampled: true,
            color_threshold: 0.01,
            position_threshold: 0.02,
            curve: LuminanceCurve::Perceptual,
            veto: true,
            weighted: false,
            footprint: 0.5,
        }
    }
}
