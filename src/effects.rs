//! What a scene calls for besides shading, and what of it a frame gets.

use crate::error::RecordError;
use crate::lattice::StepUniform;
use crate::rays::RayScene;
use crate::settings::{Effect, Settings};
use glam::Vec3;

/// What the frame's scene calls for. What is not needed is not traced, bound, compiled or allocated.
#[derive(Debug, Clone, Copy, Default)]
pub struct Needs<'a> {
    /// The scene for rays, [updated](RayScene::update) for this frame's camera. Needed if anything below is.
    pub rays: Option<&'a RayScene>,
    /// The lights that cast shadows, at most 32: bit i of `DaaSurface::shadow` says that light i of these does not reach the
    /// surface. Lights that cast none stay out of it.
    pub shadows: &'a [CastingLight],
    /// The materials (of `DaaSample::material`, below 65536) whose surfaces reflect or refract: the host's `bounce` is asked what
    /// of them. Others send no ray.
    pub bounces: &'a [u32],
    /// The materials (below 65536) that have a texture: what [`Technique::Selective`](crate::Technique::Selective) calls texture
    /// existence. Changes no image of the others.
    pub textured: &'a [u32],
    /// The objects whose attributes count where [`Selective::focused`](crate::Selective::focused) is set, each once; all others
    /// have 0.
    pub importance: &'a [ObjectImportance],
}

/// How much an object's attributes count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectImportance {
    /// Of `DaaSample::object`, below 65536.
    pub object: u32,
    /// 0 to 1, kept in steps of 1/255. 1: by the thresholds of its attributes; 0: as if nothing disagreed, by that of colour; between:
    /// by what lies between these two.
    pub importance: f32,
}

/// Most lights that cast shadows: one for each bit.
pub const MAX_CASTING_LIGHTS: usize = 32;

/// A light that casts shadows, as far as rays need to know it. World space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CastingLight {
    /// The sun: infinitely far.
    Directional {
        /// Towards the light, of any length above 0.
        towards: Vec3,
    },
    /// A lamp, seen as a point.
    Punctual {
        /// Where.
        position: Vec3,
        /// It is dark beyond; infinite, or 0 or less, if it has no range.
        range: f32,
        /// The axis in which it shines, and half the angle of its cone in radians; `None`: in all directions.
        cone: Option<(Vec3, f32)>,
    },
}

/// What of the scene's needs a frame gets: which buffers the samples' group binds, and with that the lattice of pipelines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(crate) struct Traced {
    pub shadows: bool,
    pub secondary: bool,
}

impl Traced {
    /// Combinations.
    pub const COUNT: usize = 4;
    /// All of them, by [`index`](Self::index).
    pub const ALL: [Self; Self::COUNT] = [
        Self { shadows: false, secondary: false },
        Self { shadows: true, secondary: false },
        Self { shadows: false, secondary: true },
        Self { shadows: true, secondary: true },
    ];

    pub fn of(settings: &Settings, needs: &Needs<'_>) -> Self {
        let gets = |effect, needed: bool| match effect {
            Effect::Auto => needed,
            Effect::On => true,
            Effect::Off => false,
        };
        let bounces = !needs.bounces.is_empty();
        Self {
            shadows: gets(settings.shadows, !needs.shadows.is_empty()),
            secondary: gets(settings.reflections, bounces) || gets(settings.refraction, bounces),
        }
    }

    /// Whether it has all that the other has.
    pub fn contains(self, other: Self) -> bool {
        (self.shadows || !other.shadows) && (self.secondary || !other.secondary)
    }

    pub fn index(self) -> usize {
        usize::from(self.shadows) + 2 * usize::from(self.secondary)
    }

    pub fn any(self) -> bool {
        self.shadows || self.secondary
    }

    /// `rays` of [`Steps::new`](crate::lattice::Steps::new).
    pub fn rays(self) -> u32 {
        u32::from(self.shadows) | u32::from(self.secondary) << 1
    }
}

/// `DaaCastingLight` of trace.wgsl.
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

/// `DaaCasting` of trace.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct CastingUniform {
    pub count: u32,
    pub samples: u32,
    pub keeps: u32,
    pub padding: u32,
    pub step: StepUniform,
    pub lights: [LightUniform; MAX_CASTING_LIGHTS],
}

impl CastingUniform {
    /// Relative to the camera.
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

/// Words of a bit for each material.
const BOUNCING_WORDS: usize = 65536 / 32;
pub(crate) const BOUNCING_BYTES: u64 = BOUNCING_WORDS as u64 * 4;

/// A bit for each material that sends rays. Whether that differs from what `words` held.
pub(crate) fn bouncing(materials: &[u32], words: &mut Vec<u32>) -> bool {
    let mut bits = [0; BOUNCING_WORDS];
    for &material in materials {
        bits[(material & 0xffff) as usize / 32] |= 1 << (material % 32);
    }
    let differs = words[..] != bits;
    if differs {
        words.clear();
        words.extend(bits);
    }
    differs
}

impl CastingLight {
    /// `None` if it is not finite where it must be.
    fn uniform(&self, camera: Vec3) -> Option<LightUniform> {
        let unit = |v: Vec3| v.as_dvec3().try_normalize().map(|v| v.as_vec3().to_array());
        match *self {
            Self::Directional { towards } => Some(LightUniform { position: unit(towards)?, ..Default::default() }),
            Self::Punctual { position, range, cone } => {
                let relative = (position.as_dvec3() - camera.as_dvec3()).as_vec3();
                let (direction, cone) = match cone {
                    Some((axis, angle)) => (unit(axis)?, angle.cos()),
                    None => ([0.0; 3], -1.0),
                };
                let far = |v: f32| v.abs() > crate::rays::MAX_COORDINATE;
                if relative.to_array().into_iter().any(|c| !c.is_finite() || far(c)) || range.is_nan() || cone.is_nan()
                {
                    return None;
                }
                // Its square is finite.
                let range = if range > 0.0 { range.min(1e18) } else { 1e18 };
                let position = relative.to_array();
                Some(LightUniform { position, punctual: 1, direction, cone, range, padding: [0; 3] })
            }
        }
    }
}
