//! Reflection of the crate's settings, which do not know Bevy: each type here mirrors the one of its name, and the
//! compiler refuses a field that differs. Their documentation is with the originals.

use bevy_reflect::reflect_remote;
use deferred_aa as daa;

// Derives that the macro puts on its wrappers.
#[reflect_remote(daa::LuminanceCurve)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum LuminanceCurve {
    Linear,
    Perceptual,
}

#[reflect_remote(daa::Execution)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum Execution {
    Loop,
    Tiled,
    Bucketed,
    Sorted,
    MaxFiltered,
    Packed,
}

#[reflect_remote(daa::DebugView)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum DebugView {
    Image,
    Count,
    Decided,
    First,
    Depth,
    Normal,
    GeometricNormal,
    Tangent,
    Uv,
    Gradient,
    Material,
    Object,
    User,
    Quadrants,
    Levels,
    Surfaces,
    Tiles,
    Shadows,
    Rays,
    Taps,
}

#[reflect_remote(daa::DepthMeasure)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum DepthMeasure {
    Variance,
    Discontinuity,
}

#[reflect_remote(daa::Windowed)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Windowed {
    #[reflect(remote = DepthMeasure)]
    pub depth: daa::DepthMeasure,
    pub depth_scale: f32,
    pub normal_scale: f32,
    pub two_sided: bool,
    pub luminance_scale: f32,
    pub luminance_min: f32,
    pub luminance_edge: f32,
    #[reflect(remote = LuminanceCurve)]
    pub luminance: daa::LuminanceCurve,
    pub luminance_channels: bool,
    pub luminance_centre: bool,
    pub identity_samples: f32,
    pub shadow_samples: f32,
    pub shadow_reach: u32,
    pub user_scale: f32,
    pub least_samples: f32,
    pub footprint: f32,
    pub centred: bool,
    pub edge_aware_first: bool,
    pub tile_limit: u32,
}

#[reflect_remote(daa::Reconstructed)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Reconstructed {
    pub depth_scale: f32,
    pub normal_scale: f32,
    pub planes: bool,
    pub cut_identity: bool,
    pub cut_shadow: bool,
    pub own_first: bool,
    pub reflections_apart: bool,
    pub rotated_grid: bool,
    pub least_weight: f32,
    pub contrast_scale: f32,
    pub contrast_min: f32,
    pub footprint: f32,
    pub trace_all: bool,
}

#[reflect_remote(daa::Enabled)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Enabled {
    pub col: bool,
    pub poid: bool,
    pub psn: bool,
    pub psc: bool,
    pub pte: bool,
    pub soid: bool,
    pub ssn: bool,
    pub ssc: bool,
    pub ste: bool,
}

#[reflect_remote(daa::ColorReference)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum ColorReference {
    Color,
    Luminance,
    Gradient,
}

#[reflect_remote(daa::Selective)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Selective {
    pub tau_col: f32,
    pub tau_poid: f32,
    pub tau_psn: f32,
    pub tau_psc: f32,
    pub tau_pte: f32,
    pub tau_soid: f32,
    pub tau_ssn: f32,
    pub tau_ssc: f32,
    pub tau_ste: f32,
    #[reflect(remote = Enabled)]
    pub enabled: daa::Enabled,
    #[reflect(remote = ColorReference)]
    pub reference: daa::ColorReference,
    #[reflect(remote = LuminanceCurve)]
    pub curve: daa::LuminanceCurve,
    pub contrast_min: f32,
    pub normal_cosine: f32,
    pub shadow_lights: bool,
    pub bilinear: bool,
    pub focused: bool,
    pub footprint: f32,
    pub edge_aware_first: bool,
}

#[reflect_remote(daa::Pattern)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum Pattern {
    Quad,
    Triangular,
    Equilateral,
}

#[reflect_remote(daa::Lattice)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Lattice {
    #[reflect(remote = Pattern)]
    pub pattern: daa::Pattern,
    pub coarsest: u32,
}

#[reflect_remote(daa::MultiResolution)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct MultiResolution {
    #[reflect(remote = Lattice)]
    pub shading: daa::Lattice,
    #[reflect(remote = Lattice)]
    pub rays: daa::Lattice,
    pub supersampled: bool,
    pub color_threshold: f32,
    pub position_threshold: f32,
    #[reflect(remote = LuminanceCurve)]
    pub curve: daa::LuminanceCurve,
    pub veto: bool,
    pub weighted: bool,
    pub footprint: f32,
}

#[reflect_remote(daa::Surfaces)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Surfaces {
    pub spread: f32,
    pub groups: u32,
    pub taps: u32,
    pub first_taps: u32,
    pub tap_spread: f32,
    pub block_spread: f32,
    pub block_contrast: f32,
    pub shadow_reach: u32,
    pub surfaces: u32,
    pub normal_cosine: f32,
    pub plane: f32,
    pub widening: f32,
    pub footprint: f32,
}

#[reflect_remote(daa::Technique)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum Technique {
    Full,
    Single,
    Windowed,
    Reconstructed,
    Selective,
    MultiResolution,
    Surfaces,
}

#[reflect_remote(daa::Weight)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum Weight {
    Linear,
    Luminance,
}

#[reflect_remote(daa::Effect)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub enum Effect {
    Auto,
    On,
    Off,
}

#[reflect_remote(daa::Settings)]
#[derive(Clone, Copy, Debug)]
#[reflect(Clone, Debug)]
pub struct Settings {
    #[reflect(remote = Technique)]
    pub technique: daa::Technique,
    #[reflect(remote = Execution)]
    pub execution: daa::Execution,
    #[reflect(remote = Windowed)]
    pub windowed: daa::Windowed,
    #[reflect(remote = Reconstructed)]
    pub reconstructed: daa::Reconstructed,
    #[reflect(remote = Selective)]
    pub selective: daa::Selective,
    #[reflect(remote = MultiResolution)]
    pub multi_resolution: daa::MultiResolution,
    #[reflect(remote = Surfaces)]
    pub surfaces: daa::Surfaces,
    #[reflect(remote = Weight)]
    pub weight: daa::Weight,
    #[reflect(remote = Effect)]
    pub shadows: daa::Effect,
    #[reflect(remote = Effect)]
    pub reflections: daa::Effect,
    #[reflect(remote = Effect)]
    pub refraction: daa::Effect,
    pub ray_samples: f32,
    pub ray_bias: f32,
    #[reflect(remote = DebugView)]
    pub view: daa::DebugView,
    #[reflect(ignore)]
    pub goal: Option<daa::Goal>,
}
