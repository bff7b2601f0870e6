//! The constants of `trace` and `reflect`: the samples that cast rays, and the lights.

use crate::gpu::uniforms::lattice::{LatticeStep, LatticeUse, Level, StepUniform};
use crate::host::error::RecordError;
use crate::host::needs::{CastingLight, MAX_CASTING_LIGHTS};
use glam::Vec3;

/// The samples that a pass casts rays from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum CastSamples {
    First,
    Full,
    Planned,
    Audited,
    Geometric,
    /// The chosen points of a lattice for rays.
    Points(Level),
}

impl CastSamples {
    /// The number of values.
    pub const COUNT: u64 = 5 + Level::COUNT as u64;

    /// The index, below [`COUNT`](Self::COUNT).
    pub fn index(self) -> u64 {
        match self {
            Self::First => 0,
            Self::Full => 1,
            Self::Planned => 2,
            Self::Audited => 3,
            Self::Geometric => 4,
            Self::Points(level) => 5 + level as u64,
        }
    }

    /// The value of `DAA_SAMPLES_*` of casting.wgsl.
    pub fn code(self) -> u32 {
        self.index().min(5) as u32
    }

    /// The lattice of [`Points`](Self::Points).
    pub fn step(self) -> Option<LatticeStep> {
        match self {
            Self::Points(level) => Some(LatticeStep { of: LatticeUse::Rays, level }),
            _ => None,
        }
    }
}

/// `DaaCastingLight` of casting.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct LightUniform {
    pub position: [f32; 3],
    pub punctual: u32,
    pub direction: [f32; 3],
    pub cone: f32,
    pub range: f32,
    pub padding: [u32; 3],
}

/// `DaaCasting` of casting.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct CastingUniform {
    pub count: u32,
    pub samples: u32,
    pub keeps: u32,
    pub bias: f32,
    pub step: StepUniform,
    pub lights: [LightUniform; MAX_CASTING_LIGHTS],
}

impl CastingUniform {
    /// Converts the lights to positions relative to the camera.
    pub fn new(lights: &[CastingLight], camera: Vec3) -> Result<Self, RecordError> {
        if lights.len() > MAX_CASTING_LIGHTS {
            return Err(RecordError::CastingLights { lights: lights.len(), limit: MAX_CASTING_LIGHTS });
        }
        let mut uniform: Self = bytemuck::Zeroable::zeroed();
        uniform.count = lights.len() as u32;
        for (index, (light, to)) in lights.iter().zip(&mut uniform.lights).enumerate() {
            *to = light.uniform(camera).ok_or(RecordError::CastingLight(index))?;
        }
        Ok(uniform)
    }
}

impl CastingLight {
    /// The light relative to the camera; `None` if it is not finite or has no direction.
    fn uniform(&self, camera: Vec3) -> Option<LightUniform> {
        let unit = |v: Vec3| v.as_dvec3().try_normalize().map(|v| v.as_vec3().to_array());
        match *self {
            Self::Directional { towards } => Some(LightUniform { position: unit(towards)?, ..Default::default() }),
            Self::Punctual { position, range, cone } => {
                let relative = position - camera;
                let (direction, cone) = match cone {
                    Some((axis, angle)) => (unit(axis)?, angle.cos()),
                    None => ([0.0; 3], -1.0),
                };
                let far = |v: f32| v.abs() > crate::rays::MAX_COORDINATE;
                if relative.to_array().into_iter().any(|c| !c.is_finite() || far(c)) || range.is_nan() || cone.is_nan()
                {
                    return None;
                }
                // Limited so that its square is finite.
                let range = if range > 0.0 { range.min(1e18) } else { 1e18 };
                let position = relative.to_array();
                Some(LightUniform { position, punctual: 1, direction, cone, range, padding: [0; 3] })
            }
        }
    }
}
