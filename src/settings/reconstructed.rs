//! Settings of `Technique::Reconstructed`.

use crate::window;

/// The bilateral filter of [`Technique::Reconstructed`](crate::Technique::Reconstructed) over the shaded samples of 3 ×
/// 3 windows. The default adds to the paper remedies for what its authors call its limits; [`Self::PAPER`] is as
/// printed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Reconstructed {
    /// σz, 0 to 1e6: a shaded sample is weighted by exp(−(σz Δ)²). Δ is the difference of depths over the geometric
    /// sample's depth, or with [`planes`](Self::planes) the sine of the angle at which the shaded sample rises from the
    /// geometric sample's plane. Higher: sharper at depth edges, and more samples have no similar neighbour and are
    /// shaded. Lower: blurrier; 0: depth is ignored.
    pub depth_scale: f32,
    /// σn, 0 to 1e6: the weight is multiplied by exp(−(σn Δ)²). Δ is 1 − nj · ni, or with [`planes`](Self::planes) the
    /// chord |nj − ni|. Higher: sharper at creases; 0: normals are ignored. At the paper's 0.25 no Δ from 0 to 1
    /// reduces the weight by more than 6 %.
    pub normal_scale: f32,
    /// Measures depth by planes and normals by chords, see [`depth_scale`](Self::depth_scale) and
    /// [`normal_scale`](Self::normal_scale). Off: by plain differences, as in the paper.
    pub planes: bool,
    /// Ignores samples of other materials and objects. Not in the paper, which names this as its limit.
    pub cut_identity: bool,
    /// Ignores samples that other lights reach: one bit for each of up to 32 lights, where the paper has one light.
    pub cut_shadow: bool,
    /// Gives samples on the surface of their window's own shaded sample its colour. Off: the mean over all nine
    /// windows, as in the paper, which blurs textures.
    pub own_first: bool,
    /// Keeps reflections and refractions out of the filter: every geometric sample has what it traced itself. The paper
    /// filters them by the geometry at their own hits. Off: they are filtered together with everything else, as in the
    /// original for deferred shading.
    pub reflections_apart: bool,
    /// Uses m geometric samples on a rotated grid at m = 4, 6 and 8: the paper's 4. Off: all n. Fewer samples: fewer
    /// rays, coarser edges.
    pub rotated_grid: bool,
    /// A sample whose weights sum to less than this is shaded, 1e-6 to 10; nine windows with full weight sum to 9.
    /// Higher: more samples at edges are shaded, fewer are guessed.
    pub least_weight: f32,
    /// Samples per unit of the greatest range of a channel between the shaded samples of direct neighbours on one
    /// surface and in one shadow, 0 to 1e6. It holds for m = 4 and is multiplied by m/4 at other m. That many of the
    /// window's samples on that surface are shaded; needs [`own_first`](Self::own_first). Higher: better textures and
    /// highlights, more samples; 0: off, as in the paper.
    pub contrast_scale: f32,
    /// Ranges below this count as 0, 0 to 1, with each channel on the curve √(c/(1+c)). Higher: less work in
    /// noise.
    pub contrast_min: f32,
    /// Scales the texture footprint of a shaded sample, 0 to 4. At 1, the paper's, it covers the samples that the
    /// shaded one stands for; it is never smaller than the sample's own. Higher: blurrier textures.
    pub footprint: f32,
    /// Traces shadow rays from every geometric sample, as in the paper. Off: only where the window holds two surfaces,
    /// or the shaded samples of the 3 × 3 windows differ in shadow or identity; shadows narrower than a pixel may then
    /// break up.
    pub trace_all: bool,
}

impl Reconstructed {
    /// The filter as printed, with σz = 10 and σn = 0.25.
    pub const PAPER: Self = Self {
        depth_scale: 10.0,
        normal_scale: 0.25,
        planes: false,
        cut_identity: false,
        cut_shadow: true,
        own_first: false,
        reflections_apart: true,
        rotated_grid: true,
        least_weight: 1e-3,
        contrast_scale: 0.0,
        contrast_min: 0.0,
        footprint: 1.0,
        trace_all: true,
    };

    /// The number of geometric samples in a window.
    pub(crate) fn samples(&self, m: u32) -> u32 {
        if self.rotated_grid { window::rotated_samples(m) } else { m * m }
    }
}

impl Default for Reconstructed {
    fn default() -> Self {
        Self {
            depth_scale: 10.0,
            normal_scale: 8.0,
            planes: true,
            cut_identity: true,
            cut_shadow: true,
            own_first: true,
            reflections_apart: true,
            rotated_grid: false,
            least_weight: 1.0,
            contrast_scale: 72.0,
            contrast_min: 0.02,
            footprint: 0.5,
            trace_all: false,
        }
    }
}
