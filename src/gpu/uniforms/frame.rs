//! The frame's constants: `DaaFrame` of frame.wgsl. Each technique fills in its own part.

use crate::TILE;
use crate::gpu::sizes::Results;
use crate::gpu::uniforms::audited::Audited;
use crate::host::band::Band;
use crate::host::error::RecordError;
use crate::host::frame::Frame;
use crate::host::needs::RayInputs;
use crate::settings::{Effect, Weight, Windowed};
use crate::window;
use bytemuck::{Pod, Zeroable};

/// `DaaWindowed` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct WindowedUniform {
    pub depth_scale: f32,
    pub normal_scale: f32,
    pub luminance_scale: f32,
    pub luminance_min: f32,
    pub luminance_edge: f32,
    pub identity_samples: f32,
    pub shadow_samples: f32,
    pub user_scale: f32,
}

/// `DaaAudit` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct AuditUniform {
    pub period: u32,
    pub phase: u32,
    pub step: f32,
    pub least_samples: f32,
}

/// `DaaReconstruct` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct ReconstructUniform {
    pub samples: u32,
    pub depth_scale: f32,
    pub normal_scale: f32,
    pub contrast_scale: f32,
    pub contrast_min: f32,
    pub least_weight: f32,
    pub padding: [u32; 2],
}

/// `DaaSelective` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct SelectiveUniform {
    pub primary: [f32; 4],
    pub reflected: [f32; 4],
    pub color: f32,
    pub contrast_min: f32,
    pub normal_cosine: f32,
    pub samples: u32,
    pub ranks: [[u32; 4]; 2],
}

/// `DaaMultiResolution` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct MultiResolutionUniform {
    pub color: f32,
    pub position: f32,
    pub padding: [u32; 2],
}

/// `DaaSurfaces` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct SurfacesUniform {
    pub normal_cosine: f32,
    pub plane: f32,
    pub most: u32,
    pub taps: u32,
    pub first_taps: u32,
    pub most_groups: u32,
    pub tap_spread: f32,
    pub spread: f32,
    pub widening: f32,
    pub block_spread: f32,
    pub block_contrast: f32,
    pub shadow_reach: u32,
}

/// `DaaResults` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct ResultsUniform {
    pub ranks: u32,
    pub planned: u32,
    pub audited: u32,
    pub words: u32,
}

impl From<Results> for ResultsUniform {
    /// More words than 2³² exceed what any device binds.
    fn from(results: Results) -> Self {
        let words = |words| u32::try_from(words).unwrap_or(u32::MAX);
        let Results { ranks, planned, audited, words: all } = results;
        Self { ranks, planned: words(planned), audited, words: words(all) }
    }
}

/// `DaaFrame` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct FrameUniform {
    pub relative_from_clip: [[f32; 4]; 4],
    pub camera_position: [f32; 3],
    pub exposure: f32,
    pub camera_forward: [f32; 3],
    pub orthographic: u32,
    pub size: [u32; 2],
    pub tiles_x: u32,
    pub flags: u32,
    pub footprint: f32,
    pub least_samples: f32,
    pub tile_limit: u32,
    pub casting: u32,
    pub view: u32,
    pub around: u32,
    pub origin: [u32; 2],
    pub image: [u32; 2],
    pub target_origin: [u32; 2],
    pub shown: [u32; 4],
    pub results: ResultsUniform,
    pub windowed: WindowedUniform,
    pub audit: AuditUniform,
    pub reconstruct: ReconstructUniform,
    pub selective: SelectiveUniform,
    pub multi_resolution: MultiResolutionUniform,
    pub surfaces: SurfacesUniform,
    pub order: [[u32; 4]; 16],
    pub centres: [[f32; 4]; 32],
}

/// The bits of `DaaFrame::flags`. A test compares them with the shader.
pub(crate) mod flag {
    pub const DEPTH_PLANE: u32 = 1;
    pub const TWO_SIDED: u32 = 2;
    pub const LUMINANCE_PERCEPTUAL: u32 = 4;
    pub const LUMINANCE_CENTRE: u32 = 8;
    pub const WEIGHT_LUMINANCE: u32 = 16;
    pub const FULL: u32 = 32;
    pub const EDGE_AWARE_FIRST: u32 = 128;
    pub const PLANES: u32 = 256;
    pub const CUT_IDENTITY: u32 = 512;
    pub const CUT_SHADOW: u32 = 1024;
    pub const OWN_FIRST: u32 = 2048;
    pub const TRACE_ALL: u32 = 4096;
    pub const REFLECTIONS: u32 = 8192;
    pub const REFRACTIONS: u32 = 16384;
    pub const REFLECTIONS_APART: u32 = 32768;
    pub const SELECTIVE: u32 = 1 << 16;
    pub const SHADOW_LIGHTS: u32 = 1 << 17;
    pub const BILINEAR: u32 = 1 << 18;
    pub const FOCUSED: u32 = 1 << 19;
    pub const BY_LUMINANCE: u32 = 1 << 20;
    pub const BY_GRADIENT: u32 = 1 << 21;
    pub const VETO: u32 = 1 << 22;
    pub const WEIGHTED: u32 = 1 << 23;
    pub const SUPERSAMPLED: u32 = 1 << 24;
    pub const LATTICE: u32 = 1 << 25;
    pub const REFLECTS: u32 = 1 << 26;
    pub const SURFACES: u32 = 1 << 27;
    pub const LUMINANCE_CHANNELS: u32 = 1 << 28;
    pub const WHOLE_HOOK: u32 = 1 << 29;
}

impl FrameUniform {
    /// The constants that all techniques share. The image's first pixel lies at `at` in the target. Samples have their
    /// own texture footprints; their order and the technique's part are not filled in.
    pub fn new(frame: &Frame<'_>, band: &Band, at: [u32; 2], audited: Audited) -> Result<Self, RecordError> {
        let (relative_from_clip, position, forward) = frame.camera.relative()?;
        if !(frame.exposure.is_finite() && frame.exposure > 0.0) {
            return Err(RecordError::Exposure(frame.exposure));
        }
        let inputs = RayInputs::of(&frame.settings, &frame.needs);
        let Band { raster, output, image, .. } = *band;
        let [left, top] = [output.x - raster.x, output.y - raster.y];
        let mut uniform = Self {
            relative_from_clip: relative_from_clip.to_cols_array_2d(),
            camera_position: position.to_array(),
            exposure: frame.exposure,
            camera_forward: forward.to_array(),
            orthographic: u32::from(frame.camera.is_orthographic()),
            size: [raster.width, raster.height],
            tiles_x: raster.width.div_ceil(TILE),
            footprint: 1.0,
            least_samples: 1.0,
            tile_limit: Windowed::NO_TILE_LIMIT,
            casting: if inputs.shadows { frame.needs.shadows.len() as u32 } else { 0 },
            view: frame.settings.view as u32,
            origin: [raster.x, raster.y],
            image,
            target_origin: [at[0] + raster.x, at[1] + raster.y],
            shown: [left, top, left + output.width, top + output.height],
            audit: AuditUniform {
                period: audited.period,
                phase: audited.phase,
                step: audited.step,
                least_samples: 1.0,
            },
            ..Zeroable::zeroed()
        };
        uniform.flag(flag::WEIGHT_LUMINANCE, frame.settings.weight == Weight::Luminance);
        uniform.flag(flag::REFLECTIONS, frame.settings.reflections != Effect::Off);
        uniform.flag(flag::REFRACTIONS, frame.settings.refraction != Effect::Off);
        uniform.flag(flag::REFLECTS, inputs.reflections);
        Ok(uniform)
    }

    /// Sets a flag if `on`.
    pub fn flag(&mut self, bit: u32, on: bool) {
        self.flags |= if on { bit } else { 0 };
    }

    /// Sets the positions of a window's samples in the order in which they are shaded.
    pub fn set_order(&mut self, m: u32, places: &[(u8, u8)]) {
        for (rank, &(x, y)) in places.iter().enumerate() {
            self.order[rank / 4][rank % 4] |= u32::from(x) | u32::from(y) << 4 | window::quadrants(m, x, y) << 8;
            let place = usize::from(y) * m as usize + usize::from(x);
            self.order[place / 4][place % 4] |= (rank as u32) << 16;
        }
    }

    /// Sets the offset from the mean position of the first k samples to the window's centre, for each k.
    pub fn set_centres(&mut self, m: u32, places: &[(u8, u8)]) {
        let mut sum = [0.0; 2];
        for (rank, &(x, y)) in places.iter().enumerate() {
            for (axis, place) in [x, y].into_iter().enumerate() {
                sum[axis] += f32::from(place);
                self.centres[rank / 2][rank % 2 * 2 + axis] = (m - 1) as f32 * 0.5 - sum[axis] / (rank + 1) as f32;
            }
        }
    }
}
