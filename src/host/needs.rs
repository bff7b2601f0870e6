//! What a scene needs besides shading: rays, the marks of materials and objects that `Selective` reads, and depth at
//! the output's size.

use crate::rays::RayScene;
use crate::settings::{Effect, Settings};
use glam::Vec3;

/// What the scene of a frame needs besides shading. What is not needed is not traced, bound, compiled or allocated.
#[derive(Debug, Clone, Copy, Default)]
pub struct Needs<'a> {
    /// The scene that rays are traced in, [updated](RayScene::update) for this frame's camera. Required if the frame
    /// traces any rays, and by [`GBufferTier::Visibility`](crate::GBufferTier::Visibility), whose ids name its meshes
    /// and instances.
    pub rays: Option<&'a RayScene>,
    /// The lights that cast shadows, at most 32. Bit i of `DaaSurface::shadow` says that light i of this list does not
    /// reach the surface. Leave out lights that cast no shadows.
    pub shadows: &'a [CastingLight],
    /// The materials (values of `DaaSample::material`, below 65536) whose surfaces reflect or refract. The host's
    /// `reflection` is called for these materials; no rays start from others.
    pub reflective: &'a [u32],
    /// The materials (below 65536) that have a texture: the texture existence of
    /// [`Technique::Selective`](crate::Technique::Selective). Other techniques ignore them.
    pub textured: &'a [u32],
    /// The objects whose attributes count where [`Selective::focused`](crate::Selective::focused) is set, each at most
    /// once. All other objects have the importance 0.
    pub importance: &'a [ObjectImportance],
    /// Which depth the frame also writes, into [`Frame::depth`](crate::Frame::depth), for what the host draws over the
    /// image. `None`: no pass, and no cost.
    pub depth: Option<Depth>,
}

/// Which of a window's samples gives the depth of its pixel at the output's size. Depth is that of the G-buffer: 1 is
/// near, 0 is far and the sky. Depth that is not a number is written as 0, and other values are limited to 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Depth {
    /// The nearest sample. What is drawn over the image keeps out of each pixel in which a sample hides it, and leaves
    /// a rim one pixel wide around what is in front of it. For a sky that must not tint any surface.
    Nearest,
    /// The farthest sample. What is drawn over the image covers each pixel in which it hides a sample, so that nothing
    /// shines through at the edges of what is in front of it. For transparent surfaces.
    Farthest,
    /// The first sample: that of rank 0. For gizmos, and for whatever reads a depth that lies on a surface as seen from
    /// one point, such as fog or depth of field.
    First,
}

/// How much the attributes of an object count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectImportance {
    /// The id of the object: `DaaSample::object`, below 65536.
    pub object: u32,
    /// The importance, 0 to 1, stored in steps of 1/255. At 1 the thresholds of the attributes apply; at 0 the
    /// threshold of colour applies, as if no attribute disagreed; in between, a threshold between the two.
    pub importance: f32,
}

/// The most lights that can cast shadows: one for each bit of a word.
pub const MAX_CASTING_LIGHTS: usize = 32;

/// A light that casts shadows, as far as shadow rays need it. In world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CastingLight {
    /// An infinitely distant light, such as the sun.
    Directional {
        /// The direction towards the light, of any length above 0.
        towards: Vec3,
    },
    /// A point or spot light.
    Punctual {
        /// The position of the light.
        position: Vec3,
        /// The distance beyond which the light is dark. Infinity, 0 or a negative value: no limit.
        range: f32,
        /// The axis of its cone and half the cone's angle in radians; `None` if it shines in all directions.
        cone: Option<(Vec3, f32)>,
    },
}

/// The kinds of ray results that a frame's samples have. They decide which buffers group 0 binds, and so which variant
/// of a pipeline is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(crate) struct RayInputs {
    pub shadows: bool,
    pub reflections: bool,
}

impl RayInputs {
    /// The number of combinations.
    pub const COUNT: usize = 4;
    /// All combinations, in the order of [`index`](Self::index).
    pub const ALL: [Self; Self::COUNT] = [
        Self { shadows: false, reflections: false },
        Self { shadows: true, reflections: false },
        Self { shadows: false, reflections: true },
        Self { shadows: true, reflections: true },
    ];

    pub fn of(settings: &Settings, needs: &Needs<'_>) -> Self {
        let gets = |effect, needed: bool| match effect {
            Effect::Auto => needed,
            Effect::On => true,
            Effect::Off => false,
        };
        let reflective = !needs.reflective.is_empty();
        Self {
            shadows: gets(settings.shadows, !needs.shadows.is_empty()),
            reflections: gets(settings.reflections, reflective) || gets(settings.refraction, reflective),
        }
    }

    /// Whether it has everything that `other` has.
    pub fn contains(self, other: Self) -> bool {
        (self.shadows || !other.shadows) && (self.reflections || !other.reflections)
    }

    pub fn index(self) -> usize {
        usize::from(self.shadows) + 2 * usize::from(self.reflections)
    }

    pub fn any(self) -> bool {
        self.shadows || self.reflections
    }

    /// The code that [`LatticeSteps::new`](crate::gpu::uniforms::lattice::LatticeSteps::new) takes as `rays`.
    pub fn code(self) -> u32 {
        u32::from(self.shadows) | u32::from(self.reflections) << 1
    }
}
