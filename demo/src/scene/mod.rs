//! Scenes: plain data that the renderer uploads, from glTF files or built in.
//!
//! Right-handed, y up, metres. Triangles are counter-clockwise seen from their front in mesh space; an
//! instance whose matrix mirrors keeps its fronts (the renderer flips the winding).

pub mod builtin;
mod check;
pub mod load;
pub mod open;
mod tangents;
mod vectors;
mod view;

pub use view::{Bounds, frame_camera};

use glam::{Mat4, Vec2, Vec3, Vec4};

/// Everything the renderer needs, with indices already checked: every index in a scene is in range.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// The built-in's name or the file's path, as given on the command line.
    pub name: String,
    /// One per glTF primitive that makes triangles.
    pub meshes: Vec<Mesh>,
    /// What is drawn: a mesh under a matrix.
    pub instances: Vec<Instance>,
    /// Never empty when `meshes` is not: meshes without a material use an entry with the glTF defaults.
    pub materials: Vec<Material>,
    /// What materials refer to: an image read through a sampler in a colour space.
    pub textures: Vec<Texture>,
    /// Decoded pictures, shared by textures.
    pub images: Vec<Image>,
    /// Punctual lights in world space. Empty if the scene brings none.
    pub lights: Vec<Light>,
    /// The sun, if the scene is lit by one. Loaded files without any light get a default one.
    pub sun: Option<Sun>,
    /// The ambient light and the background.
    pub sky: Sky,
    /// The scene's own views, in the file's order.
    pub cameras: Vec<Camera>,
    /// What was ignored, replaced or repaired, one readable line each (e.g. "material 3 'glass': unknown alpha mode
    /// drawn as OPAQUE").
    pub notices: Vec<String>,
}

/// Indexed triangles with one material. All attribute arrays have the same length.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// The name that messages use.
    pub name: String,
    /// Finite positions in mesh space.
    pub positions: Vec<Vec3>,
    /// Unit normals in mesh space; flat ones where the file gives none.
    pub normals: Vec<Vec3>,
    /// xyz a unit tangent orthogonal to the normal, w the bitangent's sign (+1 or −1): B = w · (N × T).
    pub tangents: Vec<Vec4>,
    /// Texture coordinates, finite; zero where the file gives none.
    pub uvs: Vec<Vec2>,
    /// Linear vertex colour and alpha in [0, 1]; white where the file gives none.
    pub colors: Vec<Vec4>,
    /// Three per triangle, each below `positions.len()`.
    pub indices: Vec<u32>,
    /// Index into [`Scene::materials`].
    pub material: usize,
}

/// A mesh placed in the world.
#[derive(Debug, Clone, Copy)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// World from mesh; affine, finite, may mirror.
    pub world_from_mesh: Mat4,
    /// The same for all primitives of one node, counted from 1; 0 is no object. Wraps past 65535.
    pub object: u16,
}

impl Scene {
    /// Whether an instance is drawn over the image.
    pub fn is_blended(&self, instance: &Instance) -> bool {
        self.materials[self.meshes[instance.mesh].material].blended
    }
}

/// glTF metallic-roughness.
#[derive(Debug, Clone)]
pub struct Material {
    /// The name that messages use.
    pub name: String,
    /// Linear, multiplies the texture and the vertex colour.
    pub base_color: Vec4,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Perceptual roughness (glTF), 0 to 1.
    pub roughness: f32,
    /// Linear radiance, KHR_materials_emissive_strength included.
    pub emissive: Vec3,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// 0 ignores the occlusion map, 1 applies it whole.
    pub occlusion_strength: f32,
    /// Fragments below are discarded. `None`: opaque.
    pub alpha_cutoff: Option<f32>,
    /// Drawn over the image, mixed with what lies behind by alpha; `alpha_cutoff` is `None` then.
    pub blended: bool,
    /// Back faces are drawn, with the normal flipped.
    pub double_sided: bool,
    /// KHR_materials_unlit: the base colour is the radiance.
    pub unlit: bool,
    /// KHR_materials_transmission: the share of light that is not reflected but passes through, 0 to 1.
    pub transmission: f32,
    /// KHR_materials_ior, at least 1.
    pub ior: f32,
    /// KHR_materials_volume: the mesh bounds a body, and light is refracted. Else it is a thin wall.
    pub volume: bool,
    /// sRGB.
    pub base_color_texture: Option<TextureRef>,
    /// Linear: g roughness, b metallic.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Linear, tangent space.
    pub normal_texture: Option<TextureRef>,
    /// Linear: r.
    pub occlusion_texture: Option<TextureRef>,
    /// sRGB.
    pub emissive_texture: Option<TextureRef>,
}

/// A texture with KHR_texture_transform: uv' = translate(offset) · rotate(rotation) · scale(scale) · uv,
/// stored as the two rows of that matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::textures`].
    pub texture: usize,
    /// (a, b, tx): u' = a·u + b·v + tx.
    pub u_row: Vec3,
    /// (c, d, ty): v' = c·u + d·v + ty.
    pub v_row: Vec3,
}

/// An image, how it wraps and filters, and its colour space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Texture {
    /// Index into [`Scene::images`].
    pub image: usize,
    /// Decoded from sRGB before filtering.
    pub srgb: bool,
    /// Along u.
    pub wrap_u: Wrap,
    /// Along v.
    pub wrap_v: Wrap,
    /// Where it is read without a filter.
    pub nearest: Nearest,
}

/// Where the nearest texel is read in place of a mean: glTF's filters NEAREST and NEAREST_MIPMAP_*.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Nearest {
    /// Where a texel covers at least what is seen of the texture.
    pub magnified: bool,
    /// Where it covers less: of the nearest mip then, without anisotropy.
    pub minified: bool,
}

/// What happens outside [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Wrap {
    /// Tiles.
    #[default]
    Repeat,
    /// Tiles, every other one mirrored.
    Mirror,
    /// The edge texel goes on.
    Clamp,
}

/// RGBA, 8 bits a channel, rows from the top; alpha straight.
#[derive(Clone)]
pub struct Image {
    /// The name that messages use.
    pub name: String,
    /// The width in texels, at least 1.
    pub width: u32,
    /// The height in texels, at least 1.
    pub height: u32,
    /// width · height · 4 bytes.
    pub rgba: std::sync::Arc<[u8]>,
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Image({:?}, {}×{})", self.name, self.width, self.height)
    }
}

/// KHR_lights_punctual point and spot lights, in world space. Directional ones become the sun (the first) or
/// `LightKind::Directional` (the others).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// What shines.
    pub kind: LightKind,
    /// World position (point, spot).
    pub position: Vec3,
    /// Unit vector in which it shines (spot, directional).
    pub direction: Vec3,
    /// Linear colour times intensity: candela (point, spot) or lux (directional).
    pub intensity: Vec3,
    /// Metres after which it is dark; infinite if not given.
    pub range: f32,
    /// Whether it casts shadows.
    pub casts: bool,
}

/// The shape of a light's emission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// It shines in all directions.
    Point,
    /// A cone, angles in radians from the axis, inner < outer ≤ π/2.
    Spot {
        /// Full intensity inside.
        inner: f32,
        /// Dark outside.
        outer: f32,
    },
    /// It shines from infinitely far.
    Directional,
}

/// A directional light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector from the scene towards the sun.
    pub to_sun: Vec3,
    /// Linear irradiance at normal incidence.
    pub irradiance: Vec3,
    /// Whether it casts shadows.
    pub casts: bool,
}

/// A vertical gradient: background and ambient light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// Linear radiance straight up.
    pub zenith: Vec3,
    /// Linear radiance at the horizon.
    pub horizon: Vec3,
    /// Linear radiance from below.
    pub ground: Vec3,
}

impl Default for Sky {
    fn default() -> Self {
        Self { zenith: Vec3::new(0.25, 0.42, 0.8), horizon: Vec3::new(0.7, 0.8, 0.9), ground: Vec3::splat(0.224) }
    }
}

/// A view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Eye, world space.
    pub eye: Vec3,
    /// A point that the eye looks at, world space, not the eye.
    pub target: Vec3,
    /// Up, world space, not along the view.
    pub up: Vec3,
    /// Perspective or orthographic.
    pub lens: Lens,
    /// Distance of the near plane, metres, above 0.
    pub near: f32,
}

/// A projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Vertical field of view in radians, in (0, π).
    Perspective {
        /// The angle.
        fov_y: f32,
    },
    /// Half the height of the view in metres, and the far plane.
    Orthographic {
        /// Half the height.
        half_height: f32,
        /// Far plane distance.
        far: f32,
    },
}
