//! What one frame needs from the host, and how it reaches the shaders.

use crate::audit::Audited;
use crate::effects::{Needs, Traced};
use crate::error::RecordError;
use crate::settings::{ColorReference, DepthMeasure, Effect, LuminanceCurve, Settings, Technique, Weight, Windowed};
use crate::window;
use glam::{DMat4, DVec4, Mat4, Vec3};

/// Where the scene is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World from view: rotation and translation, no scale. View space looks along −z, y up.
    pub world_from_view: Mat4,
    /// The projection that the G-buffer was rendered with, reversed z: 1 at the near plane, 0 at the far plane or at
    /// infinity.
    pub clip_from_view: Mat4,
}

/// One frame to record.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// The camera that the G-buffer was rendered with.
    pub camera: Camera,
    /// How to sample. May differ from frame to frame.
    pub settings: Settings,
    /// Radiance × exposure is what the luminance metric and the luminance weight see; what is written to the target stays
    /// unexposed. Above 0; 1 if the host's radiance is about 1 where a picture is bright.
    pub exposure: f32,
    /// The host's bind group, set at [`HOST_GROUP`](crate::HOST_GROUP) wherever its WGSL runs. Needed if
    /// [`new`](crate::DeferredAa::new) was given a layout.
    pub host_bind_group: Option<&'a wgpu::BindGroup>,
    /// The textures that `daa_texture` reads. Needed if the descriptor has a texture tier.
    pub textures: Option<&'a crate::TextureTable>,
    /// The image goes here: the size of the node, the format of the descriptor, usage `RENDER_ATTACHMENT`. A texture that
    /// differs in sRGB alone is let through, since its view may have the right format and wgpu can't be asked.
    pub target: &'a wgpu::TextureView,
    /// What the scene calls for; `Needs::default()` if nothing but shading.
    pub needs: Needs<'a>,
    /// Collect [`Statistics`](crate::Statistics) of this frame: a copy of a few hundred bytes, and timestamps where the
    /// device has them.
    pub statistics: bool,
}

impl<'a> Frame<'a> {
    /// A frame with the default settings, exposure 1, no group of the host's, no textures, no needs and no statistics.
    pub fn new(camera: Camera, target: &'a wgpu::TextureView) -> Self {
        Self {
            camera,
            settings: Settings::default(),
            exposure: 1.0,
            host_bind_group: None,
            textures: None,
            target,
            needs: Needs::default(),
            statistics: false,
        }
    }
}

/// `DaaFrame` of contract.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct FrameUniform {
    pub relative_from_clip: [[f32; 4]; 4],
    pub camera_position: [f32; 3],
    pub exposure: f32,
    pub camera_forward: [f32; 3],
    pub orthographic: u32,
    pub size: [u32; 2],
    pub tiles_x: u32,
    pub flags: u32,
    pub depth_scale: f32,
    pub normal_scale: f32,
    pub luminance_scale: f32,
    pub luminance_min: f32,
    pub luminance_edge: f32,
    pub identity_samples: f32,
    pub shadow_samples: f32,
    pub tile_limit: u32,
    pub footprint: f32,
    pub view: u32,
    pub least_samples: f32,
    pub audit_period: u32,
    pub audit_phase: u32,
    pub audit_step: f32,
    pub audit_least: f32,
    pub geometry: u32,
    pub reconstruct_depth: f32,
    pub reconstruct_normal: f32,
    pub reconstruct_contrast: f32,
    pub reconstruct_contrast_min: f32,
    pub reconstruct_least: f32,
    pub lattice_color: f32,
    pub lattice_position: f32,
    pub casting: u32,
    pub selective_primary: [f32; 4],
    pub selective_secondary: [f32; 4],
    pub selective_color: f32,
    pub selective_floor: f32,
    pub selective_normal: f32,
    pub selective_samples: u32,
    pub order: [[u32; 4]; 16],
    pub centres: [[f32; 4]; 32],
}

/// `DAA_OFF` of select.wgsl.
pub(crate) const OFF: f32 = 2.0;

/// Bits of `DaaFrame::flags`; their values are read from the shader by a test.
pub(crate) mod flag {
    pub const DEPTH_PLANE: u32 = 1;
    pub const TWO_SIDED: u32 = 2;
    pub const LUMINANCE_PERCEPTUAL: u32 = 4;
    pub const LUMINANCE_CENTRE: u32 = 8;
    pub const WEIGHT_LUMINANCE: u32 = 16;
    pub const FULL: u32 = 32;
    pub const PLANNED: u32 = 64;
    pub const EDGE_AWARE_FIRST: u32 = 128;
    pub const PLANES: u32 = 256;
    pub const CUT_IDENTITY: u32 = 512;
    pub const CUT_SHADOW: u32 = 1024;
    pub const OWN_FIRST: u32 = 2048;
    pub const TRACE_ALL: u32 = 4096;
    pub const REFLECTIONS: u32 = 8192;
    pub const REFRACTIONS: u32 = 16384;
    pub const SECONDARY_APART: u32 = 32768;
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
    pub const BOUNCES: u32 = 1 << 26;
}

impl FrameUniform {
    pub fn new(frame: &Frame<'_>, size: [u32; 2], m: u32, audited: Audited) -> Result<Self, RecordError> {
        let (relative_from_clip, position, forward) = frame.camera.relative()?;
        if !(frame.exposure.is_finite() && frame.exposure > 0.0) {
            return Err(RecordError::Exposure(frame.exposure));
        }
        let traced = Traced::of(&frame.settings, &frame.needs);
        let w = &frame.settings.windowed;
        let r = &frame.settings.reconstructed;
        // Only a window with more samples to come may leave something to them.
        let technique = frame.settings.technique;
        let windowed = technique == Technique::Windowed;
        let s = &frame.settings.selective;
        let selective = technique == Technique::Selective;
        // Off: more than any contrast, and than any threshold that is on.
        let thresholds = s.thresholds().map(|tau| tau.unwrap_or(OFF));
        let l = &frame.settings.multi_resolution;
        let lattice = technique == Technique::MultiResolution;
        let curve = match technique {
            Technique::Selective => s.curve,
            Technique::MultiResolution => l.curve,
            _ => w.luminance,
        };
        let flags = [
            (w.depth == DepthMeasure::Discontinuity, flag::DEPTH_PLANE),
            (w.two_sided, flag::TWO_SIDED),
            (curve == LuminanceCurve::Perceptual, flag::LUMINANCE_PERCEPTUAL),
            (w.luminance_centre, flag::LUMINANCE_CENTRE),
            (frame.settings.weight == Weight::Luminance, flag::WEIGHT_LUMINANCE),
            (technique == Technique::Full, flag::FULL),
            (!matches!(technique, Technique::Full | Technique::Single), flag::PLANNED),
            (windowed && w.edge_aware_first || selective && s.edge_aware_first, flag::EDGE_AWARE_FIRST),
            (r.planes, flag::PLANES),
            (r.cut_identity, flag::CUT_IDENTITY),
            (r.cut_shadow, flag::CUT_SHADOW),
            (r.own_first, flag::OWN_FIRST),
            (r.trace_all, flag::TRACE_ALL),
            (technique == Technique::Reconstructed && r.secondary_apart, flag::SECONDARY_APART),
            (frame.settings.reflections != Effect::Off, flag::REFLECTIONS),
            (frame.settings.refraction != Effect::Off, flag::REFRACTIONS),
            (selective, flag::SELECTIVE),
            (s.shadow_lights, flag::SHADOW_LIGHTS),
            (s.bilinear, flag::BILINEAR),
            (s.focused, flag::FOCUSED),
            (s.reference == ColorReference::Luminance, flag::BY_LUMINANCE),
            (s.reference == ColorReference::Gradient, flag::BY_GRADIENT),
            (l.veto, flag::VETO),
            (l.weighted, flag::WEIGHTED),
            (l.supersampled, flag::SUPERSAMPLED),
            (lattice, flag::LATTICE),
            (traced.secondary, flag::BOUNCES),
        ];
        let places = match technique {
            Technique::Reconstructed if r.rotated_grid => window::rotated(m),
            Technique::Selective => window::centred(m),
            _ => window::order(m),
        };
        let mut order = [[0; 4]; 16];
        let mut centres = [[0.0; 4]; 32];
        let mut sum = [0.0; 2];
        for (rank, (x, y)) in places.into_iter().enumerate() {
            order[rank / 4][rank % 4] |= u32::from(x) | u32::from(y) << 4 | window::quadrants(m, x, y) << 8;
            let place = usize::from(y) * m as usize + usize::from(x);
            order[place / 4][place % 4] |= (rank as u32) << 16;
            for (axis, place) in [x, y].into_iter().enumerate() {
                sum[axis] += f32::from(place);
                if windowed && w.centred {
                    centres[rank / 2][rank % 2 * 2 + axis] = (m - 1) as f32 * 0.5 - sum[axis] / (rank + 1) as f32;
                }
            }
        }
        Ok(Self {
            relative_from_clip: relative_from_clip.to_cols_array_2d(),
            camera_position: position.to_array(),
            exposure: frame.exposure,
            camera_forward: forward.to_array(),
            orthographic: u32::from(frame.camera.is_orthographic()),
            size,
            tiles_x: size[0].div_ceil(crate::TILE),
            flags: flags.iter().map(|&(on, bit)| if on { bit } else { 0 }).sum(),
            depth_scale: w.depth_scale,
            normal_scale: w.normal_scale,
            luminance_scale: w.luminance_scale * m as f32 / 4.0,
            luminance_min: w.luminance_min,
            luminance_edge: w.luminance_edge,
            identity_samples: w.identity_samples,
            shadow_samples: w.shadow_samples,
            tile_limit: if windowed { w.tile_limit } else { Windowed::NO_TILE_LIMIT },
            footprint: match technique {
                Technique::Windowed => w.footprint,
                Technique::Reconstructed => r.footprint,
                Technique::Selective => s.footprint,
                Technique::MultiResolution if l.supersampled => l.footprint,
                Technique::Full | Technique::Single | Technique::MultiResolution => 1.0,
            },
            view: frame.settings.view as u32,
            least_samples: if windowed { w.least_samples } else { 1.0 },
            audit_period: audited.period,
            audit_phase: audited.phase,
            audit_step: audited.step,
            audit_least: audited.least_below,
            geometry: frame.settings.reconstructed.samples(m),
            reconstruct_depth: r.depth_scale,
            reconstruct_normal: r.normal_scale,
            reconstruct_contrast: r.contrast_scale * m as f32 / 4.0,
            reconstruct_contrast_min: r.contrast_min,
            reconstruct_least: r.least_weight,
            lattice_color: l.color_threshold,
            lattice_position: l.position_threshold,
            casting: if traced.shadows { frame.needs.shadows.len() as u32 } else { 0 },
            selective_primary: std::array::from_fn(|i| thresholds[1 + i]),
            selective_secondary: std::array::from_fn(|i| thresholds[5 + i]),
            selective_color: thresholds[0],
            selective_floor: s.contrast_min,
            selective_normal: s.normal_cosine,
            selective_samples: window::quadrant_samples(m),
            order,
            centres,
        })
    }
}

impl Camera {
    /// Whether depth falls with the distance. Of a sound camera.
    pub(crate) fn is_reversed(&self) -> bool {
        let depth = |distance: f64| {
            let clip = self.clip_from_view.as_dmat4() * DVec4::new(0.0, 0.0, -distance, 1.0);
            clip.z / clip.w
        };
        depth(1.0) > depth(2.0)
    }

    fn is_orthographic(&self) -> bool {
        self.clip_from_view.row(3) == glam::Vec4::W
    }

    /// Camera-relative position from clip space, the eye and the view direction. Inverted in f64: an infinite projection
    /// with a small near plane is close to singular in f32.
    fn relative(&self) -> Result<(Mat4, Vec3, Vec3), RecordError> {
        let clip_from_view = self.clip_from_view.as_dmat4();
        let view_from_clip = clip_from_view.inverse();
        let sound = |m: &DMat4| m.is_finite() && m.determinant() != 0.0;
        if !sound(&clip_from_view) || !sound(&view_from_clip) {
            return Err(RecordError::Camera("projection"));
        }
        let world_from_view = self.world_from_view.as_dmat4();
        if !sound(&world_from_view) {
            return Err(RecordError::Camera("view"));
        }
        let mut rotation = world_from_view;
        rotation.w_axis = DVec4::W;
        let relative_from_clip = (rotation * view_from_clip).as_mat4();
        let forward = -world_from_view.z_axis.truncate().normalize().as_vec3();
        if !relative_from_clip.is_finite() {
            return Err(RecordError::Camera("projection"));
        }
        Ok((relative_from_clip, self.world_from_view.w_axis.truncate(), forward))
    }
}
