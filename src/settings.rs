//! What a host may change at any frame.

use crate::host::error::SettingsError;

/// Everything that can change between two frames without a rebuild.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Settings {
    /// How samples are planned and put together.
    pub technique: Technique,
    /// How planned samples are run. Changes the time, not the image.
    pub execution: Execution,
    /// The metrics of [`Technique::Windowed`].
    pub windowed: Windowed,
    /// The filter of [`Technique::Reconstructed`].
    pub reconstructed: Reconstructed,
    /// The thresholds of [`Technique::Selective`].
    pub selective: Selective,
    /// The lattices of [`Technique::MultiResolution`].
    pub multi_resolution: MultiResolution,
    /// How the samples of a pixel are weighted.
    pub weight: Weight,
    /// Shadow rays towards the lights of [`Needs::shadows`](crate::Needs::shadows).
    pub shadows: Effect,
    /// Mirrored rays from the materials of [`Needs::bounces`](crate::Needs::bounces).
    pub reflections: Effect,
    /// Refracted rays from them.
    pub refraction: Effect,
    /// What is written to the target.
    pub view: DebugView,
    /// An error or a time to keep to instead of the constants of [`windowed`](Self::windowed) as they stand, which are then
    /// scaled together from frame to frame. For [`Technique::Windowed`]; the others have nothing to scale.
    pub goal: Option<Goal>,
}

/// What the node keeps to by itself, from its own statistics, which it then collects in any case. How far it has come stands
/// in [`Statistics::goal`](crate::Statistics::goal).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Goal {
    /// Root mean square error of the displayed image (x/(1+x) of exposed radiance, then the sRGB curve, in [0, 1]) against
    /// all n samples, 0 to 1: 0.01 is 40 dB, 0.0032 is 50 dB. Kept with the fewest samples that do. Measured in each frame
    /// on one tile in 32 (more of a small image), all of whose samples are shaded for it: about 3 % of the cost of full
    /// supersampling. Begins with
    /// every sample, and leaves out more as the measurements allow. Lower: more samples.
    Error(f32),
    /// Milliseconds of GPU time of the node's passes, above 0. Kept with as many samples as fit. Needs
    /// [`wgpu::Features::TIMESTAMP_QUERY`]. Higher: more samples.
    Time(f32),
}

/// Whether a frame gets an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Effect {
    /// If the scene calls for it: [`Needs`](crate::Needs).
    #[default]
    Auto,
    /// In any case. The image is that of [`Auto`](Self::Auto), bit for bit; what nothing calls for costs its passes and
    /// memory.
    On,
    /// Never.
    Off,
}

/// A way to plan and reconstruct over the same G-buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Technique {
    /// Every sample is shaded: full supersampling, the grid reference.
    Full,
    /// The rank-0 sample alone, with the whole pixel as its texture footprint: plain deferred shading.
    Single,
    /// The first k samples, k from what differs in the window (Holländer, Boubekeur, Eisemann 2013).
    #[default]
    Windowed,
    /// One shaded sample a window; the other, geometric ones take the colours of shaded samples around them that lie on
    /// their surface and in the same shadow (subpixel reconstruction, Chajdas, McGuire, Luebke 2011, as brought to ray tracing at
    /// WSCG 2012). A sample that none speaks for is shaded.
    Reconstructed,
    /// Four samples of each quadrant of a pixel that contrasts with the neighbours at its corner, by a threshold for what differs
    /// there (Jin, Ihm, Chang, Park, Lee, Jung 2009). It runs its own packed list: [`Execution`] has no say.
    Selective,
    /// From a coarse lattice of points to a fine one, each point shaded, or interpolated where its neighbourhood is smooth, and likewise
    /// for its rays (University of Alaska Fairbanks thesis on tri-adaptive sampling): below one sample a pixel, and on request above.
    MultiResolution,
}

impl Technique {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Full, Self::Single, Self::Windowed, Self::Reconstructed, Self::Selective, Self::MultiResolution];
}

/// The lattices of [`Technique::MultiResolution`]: points in squares or triangles over first samples, from a coarse pitch down to
/// pixels. A point of a finer lattice is sampled where a coarser one around it departs from the mean of its neighbours on opposite
/// sides (the thesis, section 4.2, Algorithm 1); elsewhere it is interpolated between those around it. Lattices are nested, so that
/// no sample is lost, where the thesis samples anew at each resolution. First rays are cast, at the points of their own lattices,
/// then all that is to be shaded has what they found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct MultiResolution {
    /// Where colours are shaded.
    pub shading: Lattice,
    /// Where shadow, mirrored and refracted rays are cast.
    pub rays: Lattice,
    /// Windows that are not smooth at one sample a pixel get more: 4 samples, 16, all, as far as m has such levels, or all at
    /// once where geometry asks. [`Execution`] runs them. Off: one sample a pixel at most, no anti-aliasing.
    pub supersampled: bool,
    /// A neighbourhood is not smooth if a channel of colour departs from the mean of opposite neighbours by more, 0 to 1: the sum over
    /// the pairs divided by the number of neighbours, on [`curve`](Self::curve), exposed. Higher: fewer samples, what is small or
    /// faint is lost. 0: only what is exactly even is interpolated. 1: colour does not count. The thesis prints no value.
    pub color_threshold: f32,
    /// Or if its place in the world does, likewise, over its distance from the camera, 0 to 1. Where sky and surfaces meet it always
    /// does. Higher: fewer samples at edges and folds. The thesis prints no value.
    pub position_threshold: f32,
    /// Colours are compared as exposed radiance, or about as a display shows it.
    pub curve: LuminanceCurve,
    /// Never interpolates between materials, objects, or where other lights reach: such a point is sampled, and a window that holds two
    /// is refined. Not in the thesis. On: what is thin survives.
    pub veto: bool,
    /// Interpolates by the weights of [`Settings::reconstructed`] too, with its scales and cuts, and samples where less than half of them
    /// remain. Not in the thesis. On: sharper folds, more samples, which buy less than lower thresholds do.
    pub weighted: bool,
    /// The texture footprint of a shaded sample over that of the samples that it stands for, 0 to 4, where
    /// [`supersampled`](Self::supersampled); else 1. Higher: blurrier.
    pub footprint: f32,
}

/// A lattice of [`MultiResolution`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Lattice {
    /// How its points lie.
    pub pattern: Pattern,
    /// log2 of the pitch that it begins with, in pixels, 0 to 3: each pixel, 1/2, 1/4 or 1/8 of the resolution along either side. Higher:
    /// fewer samples at least, and what is smaller than the pitch may be missed.
    pub coarsest: u32,
}

/// How the points of a [`Lattice`] lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[repr(u32)]
pub enum Pattern {
    /// Squares: eight neighbours, four pairs.
    #[default]
    Quad = 0,
    /// Every other row is shifted by half a pitch, and of the finest by half a pixel: six neighbours, three pairs. Pixels are then mapped
    /// from it, between two points in the shifted rows (section 4.3). Needs m of 2 or more for shading. For rays only down to a pitch of
    /// 2 pixels, below which they are those of what is shaded.
    Triangular = 1,
    /// Rows lie closer, by √3/2, to the nearest sample: equilateral triangles, 15 % more points.
    Equilateral = 2,
}

impl Default for Lattice {
    fn default() -> Self {
        Self { pattern: Pattern::Quad, coarsest: 2 }
    }
}

impl MultiResolution {
    /// As the thesis has it: three resolutions up to the image's, triangular, no veto, no weights. It prints no thresholds.
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

/// The thresholds of [`Technique::Selective`], which compares the shaded samples at the centres of pixels: each quadrant with its own
/// pixel and the three around its corner (Jin et al. 2009, sections 4.1.3 and 4.2). Where an attribute disagrees, the least τ of those
/// that do is the quadrant's, else [`tau_col`](Self::tau_col): an attribute with a greater τ *relaxes* the test. The quadrant is
/// active, and four of its samples are shaded, where the contrast of the four colours is at least (1.36, 1.02, 2.04) τ in red, green or
/// blue. A τ lies in 0 to 1: 0 shades the quadrant whatever its colours, 1 never does, which is not the same as switched
/// [off](Enabled). Lower: more samples there. Attributes of what is reflected and refracted are known where a frame traces that.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Selective {
    /// τcol, 0 to 1: where nothing else disagrees.
    pub tau_col: f32,
    /// τpoid, 0 to 1: where the pixels show different objects, or the sky.
    pub tau_poid: f32,
    /// τpsn, 0 to 1: where their normals differ, see [`normal_cosine`](Self::normal_cosine).
    pub tau_psn: f32,
    /// τpsc, 0 to 1: where lights reach them differently, see [`shadow_lights`](Self::shadow_lights).
    pub tau_psc: f32,
    /// τpte, 0 to 1: where the pixel's own material is one of [`Needs::textured`](crate::Needs::textured), whatever its neighbours.
    pub tau_pte: f32,
    /// τsoid, 0 to 1: as τpoid, of what the pixels reflect or refract: what either ray met first, behind the body that it passes.
    pub tau_soid: f32,
    /// τssn, 0 to 1: as τpsn, likewise.
    pub tau_ssn: f32,
    /// τssc, 0 to 1: as τpsc, likewise.
    pub tau_ssc: f32,
    /// τste, 0 to 1: as τpte, likewise.
    pub tau_ste: f32,
    /// Which thresholds there are.
    pub enabled: Enabled,
    /// What is contrasted.
    pub reference: ColorReference,
    /// As what: exposed radiance, or about what a display shows of it, which has about half the contrast in the dark and much less
    /// in bright light.
    pub curve: LuminanceCurve,
    /// Differences below are no contrast, 0 to 1, of a channel on that curve. Higher: less work in dark noise. The paper has none, and a
    /// ratio sees any noise in the dark.
    pub contrast_min: f32,
    /// Normals differ if the cosine between them is less, -1 to 1. Higher: more pixels at creases and curves have τpsn. The paper has such
    /// a value but does not print it (and says cross product, which must be the dot product).
    pub normal_cosine: f32,
    /// Shadow differs if it is that of other lights. Off: of another number of lights, as in the paper.
    pub shadow_lights: bool,
    /// Quadrants that are not active take the colour between the pixels at their corner. Off: their own pixel's, as in the paper, which
    /// names the other for textures. On: smoother, and blurs what contrasts less than the threshold.
    pub bilinear: bool,
    /// Attributes disagree only where an object of [`Needs::importance`](crate::Needs::importance) is involved (section 5, "fairy
    /// focused").
    pub focused: bool,
    /// The texture footprint of a shaded sample over that of the samples that it stands for, 0 to 4. Higher: blurrier.
    pub footprint: f32,
    /// The sample at the centre of a window with an edge in it has its own texture footprint, and not the whole pixel's. Not in the
    /// paper, which filters no textures.
    pub edge_aware_first: bool,
}

/// The thresholds of [`Selective`] that there are. Without one it is as if its attribute agreed everywhere; without `col`, only
/// quadrants with a disagreement can be active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Enabled {
    /// [`Selective::tau_col`].
    pub col: bool,
    /// [`Selective::tau_poid`].
    pub poid: bool,
    /// [`Selective::tau_psn`].
    pub psn: bool,
    /// [`Selective::tau_psc`].
    pub psc: bool,
    /// [`Selective::tau_pte`].
    pub pte: bool,
    /// [`Selective::tau_soid`].
    pub soid: bool,
    /// [`Selective::tau_ssn`].
    pub ssn: bool,
    /// [`Selective::tau_ssc`].
    pub ssc: bool,
    /// [`Selective::tau_ste`].
    pub ste: bool,
}

impl Enabled {
    /// Every threshold.
    pub const ALL: Self =
        Self { col: true, poid: true, psn: true, psc: true, pte: true, soid: true, ssn: true, ssc: true, ste: true };
    /// None: nothing is active.
    pub const NONE: Self = Self {
        col: false,
        poid: false,
        psn: false,
        psc: false,
        pte: false,
        soid: false,
        ssn: false,
        ssc: false,
        ste: false,
    };
}

impl Default for Enabled {
    fn default() -> Self {
        Self::ALL
    }
}

/// What [`Technique::Selective`] contrasts (section 4.1.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum ColorReference {
    /// The shaded colours, channel by channel.
    #[default]
    Color,
    /// Their luminance, against 1.02 τ.
    Luminance,
    /// The greatest length of the four luminance gradients, by the Sobel operator, a step from black to white between two pixels
    /// being 1, against 1.02 τ: not a ratio, so that the dark counts for little.
    Gradient,
}

impl Selective {
    /// With the thresholds of the paper's table 2 for its tests at about 20 % of nine samples a pixel. τa, that of colour and
    /// textures, is 0.6 there; the paper's range is 0.1 to 1.
    pub const PAPER: Self = Self {
        tau_col: 0.6,
        tau_poid: 0.05,
        tau_psn: 0.06,
        tau_psc: 0.06,
        tau_pte: 0.6,
        tau_soid: 0.05,
        tau_ssn: 0.06,
        tau_ssc: 0.06,
        tau_ste: 0.6,
        enabled: Enabled::ALL,
        reference: ColorReference::Color,
        curve: LuminanceCurve::Linear,
        contrast_min: 0.0,
        normal_cosine: 0.9,
        shadow_lights: false,
        bilinear: false,
        focused: false,
        footprint: 1.0,
        edge_aware_first: false,
    };

    /// Names and values of the thresholds, and whether each is enabled: colour, then object, normal, shadow and texture of what
    /// pixels show, then of what they reflect and refract.
    pub(crate) fn thresholds(&self) -> [(&'static str, f32, bool); 9] {
        let e = &self.enabled;
        [
            ("selective.tau_col", self.tau_col, e.col),
            ("selective.tau_poid", self.tau_poid, e.poid),
            ("selective.tau_psn", self.tau_psn, e.psn),
            ("selective.tau_psc", self.tau_psc, e.psc),
            ("selective.tau_pte", self.tau_pte, e.pte),
            ("selective.tau_soid", self.tau_soid, e.soid),
            ("selective.tau_ssn", self.tau_ssn, e.ssn),
            ("selective.tau_ssc", self.tau_ssc, e.ssc),
            ("selective.tau_ste", self.tau_ste, e.ste),
        ]
    }
}

impl Default for Selective {
    fn default() -> Self {
        Self {
            tau_col: 0.1,
            tau_poid: 0.01,
            tau_psn: 0.01,
            tau_psc: 0.01,
            tau_pte: 0.1,
            tau_soid: 0.01,
            tau_ssn: 0.01,
            tau_ssc: 0.01,
            tau_ste: 0.1,
            enabled: Enabled::ALL,
            reference: ColorReference::Color,
            curve: LuminanceCurve::Perceptual,
            contrast_min: 0.02,
            normal_cosine: 0.95,
            shadow_lights: true,
            bilinear: true,
            focused: false,
            footprint: 0.5,
            edge_aware_first: true,
        }
    }
}

/// The bilateral filter of [`Technique::Reconstructed`] over the shaded samples of 3 × 3 windows. The default adds to the paper what
/// its authors name as its limits; [`Self::PAPER`] is as printed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Reconstructed {
    /// σz, 0 to 1e6: a shaded sample counts by exp(−(σz Δ)²). Δ is the difference of depths over the sample's own, or with
    /// [`planes`](Self::planes) the sine of the angle at which the other rises from the sample's plane. Higher: sharper at
    /// depth edges, and more samples that none speaks for, which are shaded. Lower: blurrier; 0: depth does not count.
    pub depth_scale: f32,
    /// σn, 0 to 1e6: and by exp(−(σn Δ)²), Δ = 1 − nj · ni, or with [`planes`](Self::planes) the chord |nj − ni|. Higher: sharper at
    /// creases. At the paper's 0.25 no Δ from 0 to 1 takes more than 6 % away.
    pub normal_scale: f32,
    /// Δ as above; off, as in the paper.
    pub planes: bool,
    /// Samples of other materials and objects do not count. Not in the paper, whose limit this is.
    pub cut_identity: bool,
    /// Samples that other lights reach do not count: one bit for each of up to 32 lights; the paper has one light.
    pub cut_shadow: bool,
    /// A sample that lies on the surface of its window's own shaded one has its colour. Off: the mean over all nine windows, as
    /// in the paper, which blurs texture.
    pub own_first: bool,
    /// Reflections and refractions are left out of the filter, and every geometric sample has those that it traced. The paper filters
    /// them by the geometry at their own hits. Off: they are filtered with all else, as in the original for deferred shading.
    pub secondary_apart: bool,
    /// The geometric samples are m on a rotated grid, at m = 4, 6 and 8: the paper's 4. Off: all n. Fewer: less to trace, coarser
    /// edges.
    pub rotated_grid: bool,
    /// A sample for which the weights sum to less is shaded, 1e-6 to 10: nine windows that speak for it wholly sum to 9. Higher:
    /// more samples at edges are shaded, fewer guessed.
    pub least_weight: f32,
    /// Samples per unit of luminance range between the shaded samples of direct neighbours that lie on one surface and in one
    /// shadow, 0 to 1e6, at m = 4; m/4 of it at other m. So many of the window's samples on that surface are shaded, with
    /// [`own_first`](Self::own_first). Higher: better texture and highlights, at a cost; 0: off, as in the paper.
    pub contrast_scale: f32,
    /// Ranges below are none, 0 to 1, of luminance √(l/(1+l)). Higher: less work in noise.
    pub contrast_min: f32,
    /// The texture footprint of a shaded sample over that of the samples that it stands for, 0 to 4. Higher: blurrier; the paper's 1.
    pub footprint: f32,
    /// Shadow rays at every geometric sample, as in the paper. Off: only where the window holds two surfaces, or the shaded
    /// samples of 3 × 3 windows differ in shadow or identity; shadows narrower than a pixel may break.
    pub trace_all: bool,
}

impl Reconstructed {
    /// As printed, with σz = 10 and σn = 0.25.
    pub const PAPER: Self = Self {
        depth_scale: 10.0,
        normal_scale: 0.25,
        planes: false,
        cut_identity: false,
        cut_shadow: true,
        own_first: false,
        secondary_apart: true,
        rotated_grid: true,
        least_weight: 1e-3,
        contrast_scale: 0.0,
        contrast_min: 0.0,
        footprint: 1.0,
        trace_all: true,
    };

    /// Geometric samples of a window.
    pub(crate) fn samples(&self, m: u32) -> u32 {
        if self.rotated_grid { crate::window::rotated_samples(m) } else { m * m }
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
            secondary_apart: true,
            rotated_grid: false,
            least_weight: 1.0,
            contrast_scale: 94.0,
            contrast_min: 0.02,
            footprint: 0.5,
            trace_all: false,
        }
    }
}

/// How planned samples are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Execution {
    /// Each pixel shades its own samples in a loop (Holländer et al. 2013, section 4.2). Lanes wait for the pixel with
    /// the most samples.
    Loop,
    /// A workgroup shades the samples of an 8 × 8 tile end to end, every lane busy. Lists nothing, so it needs no memory.
    Tiled,
    /// One dispatch for each k, over the pixels that have it, as Holländer et al.'s stencil variant draws one quad for each.
    Bucketed,
    /// The pixels in the order of their k, in one dispatch, every lane of a workgroup as long as any (section 4.2, after
    /// Hoberock et al. 2009). The default: nothing measured is more than noise ahead of it at any cost of shading.
    #[default]
    Sorted,
    /// [`Loop`](Self::Loop) after every pixel took the greatest k of its block of 6 × 6 pixels (section 4.2): more samples,
    /// never fewer, so the image is another one.
    MaxFiltered,
    /// The frame's samples as one packed list, one a lane (Jin et al. 2009). Holds 20 bytes for each sample that could be
    /// shaded: [`RecordError::List`](crate::RecordError::List) where that is too much.
    Packed,
}

impl Execution {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Loop, Self::Tiled, Self::Bucketed, Self::Sorted, Self::MaxFiltered, Self::Packed];
}

/// The metrics of [`Technique::Windowed`]: k is the greatest that any of them asks for, rounded, from 1 to n = m².
///
/// Each metric has a constant c of its own; 0 switches it off. The default is [`Preset::Balanced`]; [`Self::PAPER`] has the
/// paper's metrics alone.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Windowed {
    /// Which measure of depth is used.
    pub depth: DepthMeasure,
    /// Samples per unit of the depth measure, 0 to 1e9. Higher: more samples at depth edges, down to the noise of the
    /// depth buffer. Lower: fewer; 0: off. What it multiplies is relative to depth, so it needs no scene units.
    pub depth_scale: f32,
    /// Samples per √(1 − cos θ), θ from the mean normal to the one furthest from it (section 3.1), 0 to 1e6. Higher: more
    /// samples on curved surfaces and creases. Lower: fewer; 0: off.
    pub normal_scale: f32,
    /// Normals that point the opposite way count as equal: the paper's |n̄·n|. For leaves drawn as one-sided planes.
    pub two_sided: bool,
    /// Samples per unit of luminance range over the neighbouring first samples (section 3.1), 0 to 1e6, at m = 4; m/4 of it
    /// at other m, as an edge crosses m samples of a side. Higher: more samples at edges of light and texture. Lower: fewer;
    /// 0: off. Windows of sky alone keep k = 1.
    pub luminance_scale: f32,
    /// Ranges below are no edge, 0 to 1e6. Higher: less work in dark noise; lower: fainter edges are seen. FXAA's
    /// published range is 0.0312 to 0.0833.
    pub luminance_min: f32,
    /// Ranges below this share of the greatest luminance are no edge, 0 to 1. Higher: fewer samples in bright texture;
    /// lower: more. FXAA's published range is 0.125 to 0.166.
    pub luminance_edge: f32,
    /// Whether the range is taken of luminance as it is, or as a display would show it.
    pub luminance: LuminanceCurve,
    /// The pixel itself counts in its range, as in FXAA. Off: its four neighbours alone, the paper's wording.
    pub luminance_centre: bool,
    /// Samples for a window with more than one material or object, 0 to 64. Higher: better edges between coplanar
    /// materials; 0: off. Not in the paper.
    pub identity_samples: f32,
    /// Samples for a window whose first sample is lit by other casting lights than a direct neighbour's, where shadows are traced,
    /// 0 to 64. Higher: better edges of faint shadows; 0: off, and shadows are seen by their luminance alone. Not in the paper.
    pub shadow_samples: f32,
    /// k of every window that is not all sky is at least this, 1 to 64. Higher: better where the metrics see nothing, at a
    /// cost everywhere; n: full supersampling. Not in the paper.
    pub least_samples: f32,
    /// The texture footprint of a shaded sample over that of the n/k samples that it stands for, 0 to 4; never less than a
    /// sample's own. Higher: blurrier textures; lower: sharper ones, that shimmer below about ½. 1 is √(n/k), the paper's.
    pub footprint: f32,
    /// The texture footprint of k samples is moved to the window's centre. The printed matrices put the first ones up to
    /// a quarter pixel off it. Not in the paper.
    pub centred: bool,
    /// The first sample of a window with an edge in it is shaded with its own texture footprint, as one of many, and not as
    /// if it stood for the whole pixel. Not in the paper.
    pub edge_aware_first: bool,
    /// The most samples beyond the first that a tile of 8 × 8 pixels may ask for, up to 4032 = 64 · 63, where nothing is
    /// limited. A tile that asks for more falls back to k = 1 and is counted in the statistics. Lower: bounds the time
    /// of the worst tile.
    pub tile_limit: u32,
}

/// What the depth metric measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DepthMeasure {
    /// The variance of the window's depths over their squared mean (section 3.1; the paper leaves the unit of depth open).
    /// A slanted plane counts as an edge.
    Variance,
    /// The greatest step between neighbours that no plane through either side explains, over their depth. A slanted plane
    /// does not count.
    #[default]
    Discontinuity,
}

/// The luminance that the luminance metric sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum LuminanceCurve {
    /// Linear, times the exposure. For hosts whose radiance lies in [0, 1].
    Linear,
    /// √(l/(1+l)) of it: about what a display shows, so that a range means the same in light and shade.
    #[default]
    Perceptual,
}

/// How the samples of a pixel are weighted in their mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Weight {
    /// All alike: the exact linear mean.
    #[default]
    Linear,
    /// 1/(1 + exposed luminance): bright samples cannot outshine an edge (Karis 2014). Darker than the linear mean.
    Luminance,
}

/// What is written to the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[repr(u32)]
pub enum DebugView {
    /// The anti-aliased image.
    #[default]
    Image = 0,
    /// k, on a log scale: 1 black, through red and yellow, n white.
    Count = 1,
    /// The metric that decided k: black none, red depth, green normal, blue luminance, yellow identity, cyan shadow. Of
    /// [`Technique::Selective`], what the threshold of the window's first active quadrant is for: black none is, red shadow, green
    /// normal, blue colour or texture, yellow object.
    Decided = 2,
    /// The first samples S, exposed, c/(1+c).
    First = 3,
    /// Fourth root of the depth buffer's value, of the rank-0 sample as in all that follow.
    Depth = 4,
    /// Normal · ½ + ½.
    Normal = 5,
    /// Geometric normal · ½ + ½.
    GeometricNormal = 6,
    /// Tangent · ½ + ½.
    Tangent = 7,
    /// The fraction of u in red, of v in green.
    Uv = 8,
    /// log2 of the uv gradient's length: 2⁻¹⁶ black, 1 white.
    Gradient = 9,
    /// A colour for each material.
    Material = 10,
    /// A colour for each object.
    Object = 11,
    /// The host's 32 bits as RGB, 8 bits each.
    User = 12,
    /// Active quadrants of [`Technique::Selective`]: 0 black, 1 red, 2 green, 3 blue, 4 white (Jin et al. 2009, figure 1).
    Quadrants = 13,
    /// On what lattice of [`Technique::MultiResolution`] a pixel was shaded: white pixels, cyan shifted ones, green every second,
    /// yellow fourth, red eighth; black: interpolated.
    Levels = 14,
    /// How many surfaces the window's samples see, each an object with a material, the sky one too, on a log scale: 1 black, through red and
    /// yellow, n white. Where it is black there is no edge between surfaces, only within one.
    Surfaces = 15,
    /// For what rays were dispatched over each tile of 8 × 8 pixels: black nothing, blue shadow rays, as it holds a surface, yellow
    /// mirrored and refracted ones too, as one of its materials sends them. Black in a frame that traces nothing, and where
    /// [`Technique::MultiResolution`] casts at the points of its lattices alone.
    Tiles = 16,
    /// Which casting lights reach the first sample, as if the first of [`Needs::shadows`](crate::Needs::shadows) were red, the second
    /// green, the third blue, the fourth red again: each channel is the share of its lights that do. A single light is white. A
    /// light that shines from behind does not reach; one that is out of its own range counts as if it did. Black: none does, the sky, or a
    /// frame that traces no shadows.
    Shadows = 17,
    /// Rays that the pixel's samples send, towards lights and mirrored and refracted ones, on a log scale: 0 black, through red and yellow, white:
    /// each of n samples sends one to each casting light and one of both others. Not those of the points of
    /// [`Technique::MultiResolution`] that lie beyond the image's border, nor those of the audit of [`Goal::Error`]. A frame that shows it
    /// holds twice the bytes for what rays find: [`Intermediates::shadows`](crate::Intermediates::shadows) has the rays of each sample.
    Rays = 18,
}

impl DebugView {
    /// All of them, in order.
    pub const ALL: [Self; 19] = [
        Self::Image,
        Self::Count,
        Self::Decided,
        Self::First,
        Self::Depth,
        Self::Normal,
        Self::GeometricNormal,
        Self::Tangent,
        Self::Uv,
        Self::Gradient,
        Self::Material,
        Self::Object,
        Self::User,
        Self::Quadrants,
        Self::Levels,
        Self::Surfaces,
        Self::Tiles,
        Self::Shadows,
        Self::Rays,
    ];
}

impl Windowed {
    /// The metrics of Holländer et al. 2013 and nothing else. The paper gives no constants: c is chosen here, the thresholds
    /// are FXAA's defaults, which section 3.1 refers to.
    pub const PAPER: Self = Self {
        depth: DepthMeasure::Variance,
        depth_scale: 2000.0,
        normal_scale: 16.0,
        two_sided: true,
        luminance_scale: 32.0,
        luminance_min: 0.0625,
        luminance_edge: 0.125,
        luminance: LuminanceCurve::Perceptual,
        luminance_centre: false,
        identity_samples: 0.0,
        shadow_samples: 0.0,
        least_samples: 1.0,
        footprint: 1.0,
        centred: false,
        edge_aware_first: false,
        tile_limit: Self::NO_TILE_LIMIT,
    };

    /// 64 pixels of 63 samples beyond the first.
    pub const NO_TILE_LIMIT: u32 = 64 * 63;

    /// What all presets share: every addition to the paper, no metric.
    const OURS: Self = Self {
        depth: DepthMeasure::Discontinuity,
        depth_scale: 0.0,
        normal_scale: 0.0,
        two_sided: false,
        luminance_scale: 0.0,
        luminance_min: 0.0,
        luminance_edge: 0.0,
        luminance: LuminanceCurve::Perceptual,
        luminance_centre: true,
        identity_samples: 0.0,
        shadow_samples: 8.0,
        least_samples: 1.0,
        footprint: 1.0,
        centred: true,
        edge_aware_first: true,
        tile_limit: Self::NO_TILE_LIMIT,
    };
}

impl Windowed {
    /// The settings with all metrics scaled by 2^effort, -12 to 8: from 0 up their thresholds fall as much, and from 4 up to 8
    /// the least k rises to n. 0 leaves them as they are.
    pub(crate) fn at_effort(self, effort: f32, m: u32) -> Self {
        let scale = effort.exp2();
        let threshold = 1.0 / scale.max(1.0);
        let n = (m * m) as f32;
        let least = 1.0 + (n - 1.0) * ((effort - 4.0) / 4.0).clamp(0.0, 1.0);
        Self {
            depth_scale: (self.depth_scale * scale).min(1e9),
            normal_scale: (self.normal_scale * scale).min(1e6),
            luminance_scale: (self.luminance_scale * scale).min(1e6),
            luminance_min: self.luminance_min * threshold,
            luminance_edge: self.luminance_edge * threshold,
            identity_samples: (self.identity_samples * scale).min(64.0),
            shadow_samples: (self.shadow_samples * scale).min(64.0),
            least_samples: self.least_samples.max(least),
            ..self
        }
    }
}

impl Default for Windowed {
    fn default() -> Self {
        Preset::default().windowed()
    }
}

/// The metrics of [`Technique::Windowed`], in three steps of error against samples.
///
/// Found by `deferred-aa-demo tune` on the built-in scenes alone: at 320×180 and m = 4, the fewest samples that hold 41, 45.8
/// and 50 dB on every scene, and 3 dB more on its edges. It finds others for scenes of your own. `depth_scale` was then raised
/// by hand, so that steps of 0.1 % of depth are seen, and `luminance_scale` lowered for it. The figures are PSNR
/// against [`Technique::Full`] and sample ratio, by `deferred-aa-demo render --preset P --scene S --m 4` at 960×540, and of
/// Sponza, which the search never saw but the change by hand was judged on, with `--size 1024x768 --camera
/// 9,1.7,-0.3,-2,4,-0.5,60`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Preset {
    /// Sponza 40.6 dB at 16.3 % of the samples, atrium 45.1 at 20.3, checker 41.3 at 15.5, fence 53.3 at 22.1.
    Fast,
    /// Sponza 44.8 dB at 29.7 % of the samples, atrium 49.3 at 30.1, checker 45.9 at 27.2, fence 54.8 at 25.1. Sponza at
    /// m = 3: 45.2 at 36.8; at m = 2: 43.6 at 50.4.
    #[default]
    Balanced,
    /// Sponza 49.2 dB at 50.2 % of the samples, atrium 53.7 at 40.5, checker 50.3 at 34.7, fence 56.4 at 30.4.
    Quality,
}

impl Preset {
    /// All of them, the fewest samples first.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Balanced, Self::Quality];

    /// The metrics.
    pub const fn windowed(self) -> Windowed {
        match self {
            Self::Fast => Windowed {
                depth_scale: 4000.0,
                normal_scale: 24.0,
                luminance_scale: 36.0,
                luminance_min: 0.08,
                luminance_edge: 0.12,
                footprint: 0.6,
                ..Windowed::OURS
            },
            Self::Balanced => Windowed {
                depth_scale: 4000.0,
                normal_scale: 24.0,
                luminance_scale: 94.0,
                luminance_min: 0.02,
                luminance_edge: 0.085,
                footprint: 0.5,
                ..Windowed::OURS
            },
            Self::Quality => Windowed {
                depth_scale: 4000.0,
                normal_scale: 24.0,
                luminance_scale: 230.0,
                luminance_min: 0.02,
                luminance_edge: 0.057,
                footprint: 0.5,
                ..Windowed::OURS
            },
        }
    }

    /// The metrics in settings whose other fields are the defaults.
    pub fn settings(self) -> Settings {
        Settings { windowed: self.windowed(), ..Default::default() }
    }
}

impl Settings {
    /// Names the first field that is out of its range. [`record`](crate::DeferredAa::record) calls it.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let w = &self.windowed;
        let ranges = [
            ("windowed.depth_scale", w.depth_scale, 0.0, 1e9),
            ("windowed.normal_scale", w.normal_scale, 0.0, 1e6),
            ("windowed.luminance_scale", w.luminance_scale, 0.0, 1e6),
            ("windowed.luminance_min", w.luminance_min, 0.0, 1e6),
            ("windowed.luminance_edge", w.luminance_edge, 0.0, 1.0),
            ("windowed.identity_samples", w.identity_samples, 0.0, 64.0),
            ("windowed.shadow_samples", w.shadow_samples, 0.0, 64.0),
            ("windowed.least_samples", w.least_samples, 1.0, 64.0),
            ("windowed.footprint", w.footprint, 0.0, 4.0),
            ("reconstructed.depth_scale", self.reconstructed.depth_scale, 0.0, 1e6),
            ("reconstructed.normal_scale", self.reconstructed.normal_scale, 0.0, 1e6),
            ("reconstructed.least_weight", self.reconstructed.least_weight, 1e-6, 10.0),
            ("reconstructed.contrast_scale", self.reconstructed.contrast_scale, 0.0, 1e6),
            ("reconstructed.contrast_min", self.reconstructed.contrast_min, 0.0, 1.0),
            ("reconstructed.footprint", self.reconstructed.footprint, 0.0, 4.0),
            ("selective.contrast_min", self.selective.contrast_min, 0.0, 1.0),
            ("selective.normal_cosine", self.selective.normal_cosine, -1.0, 1.0),
            ("selective.footprint", self.selective.footprint, 0.0, 4.0),
            ("multi_resolution.shading.coarsest", self.multi_resolution.shading.coarsest as f32, 0.0, 3.0),
            ("multi_resolution.rays.coarsest", self.multi_resolution.rays.coarsest as f32, 0.0, 3.0),
            ("multi_resolution.color_threshold", self.multi_resolution.color_threshold, 0.0, 1.0),
            ("multi_resolution.position_threshold", self.multi_resolution.position_threshold, 0.0, 1.0),
            ("multi_resolution.footprint", self.multi_resolution.footprint, 0.0, 4.0),
            ("windowed.tile_limit", w.tile_limit as f32, 0.0, Windowed::NO_TILE_LIMIT as f32),
            match self.goal {
                Some(Goal::Error(error)) => ("goal.error", error, 0.0, 1.0),
                Some(Goal::Time(milliseconds)) => ("goal.time", milliseconds, f32::MIN_POSITIVE, 1e6),
                None => ("goal", 0.0, 0.0, 0.0),
            },
        ];
        let thresholds = self.selective.thresholds().map(|(field, value, _)| (field, value, 0.0, 1.0));
        for (field, value, least, most) in ranges.into_iter().chain(thresholds) {
            // Written so that NaN fails.
            if !(least..=most).contains(&value) {
                return Err(SettingsError { field, value, least, most });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_sound_and_differ() {
        for preset in Preset::ALL {
            assert_eq!(preset.settings().validate(), Ok(()), "{preset:?}");
            assert_eq!(preset.settings(), Settings { windowed: preset.windowed(), ..Default::default() });
        }
        let [fast, balanced, quality] = Preset::ALL.map(Preset::windowed);
        assert!(fast != balanced && balanced != quality && quality != fast);
        assert_eq!(Windowed::default(), balanced);
        assert_eq!(Settings::default(), Preset::Balanced.settings());
    }
}
