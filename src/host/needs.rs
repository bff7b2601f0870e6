//! What a scene calls for besides shading, and what of it a frame gets.

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

/// What rays find for a frame's samples: which buffers group 0 binds, and so which variant of a pipeline serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(crate) struct RayInputs {
    pub shadows: bool,
    pub secondary: bool,
}

impl RayInputs {
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

    /// `rays` of [`LatticeSteps::new`](crate::gpu::uniforms::lattice::LatticeSteps::new).
    pub fn code(self) -> u32 {
        u32::from(self.shadows) | u32::from(self.secondary) << 1
    }
}
