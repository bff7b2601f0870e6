//! What a node is built from.

use crate::host::table::TextureTier;
use crate::rays::RayTier;

/// The host's shading code.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a> {
    /// WGSL: `fn shade(s: DaaSample) -> vec4f`, or `fn material(s: DaaSample) -> DaaMaterial` and
    /// `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`, linear radiance and alpha. Optional
    /// `fn sky(s: DaaSample) -> vec4f` where there is no surface; without it the sky is transparent black. For rays, optional
    /// `fn bounce(s: DaaSample) -> DaaBounce`, what a surface reflects and refracts, and `fn solid(material: u32, uv: vec2f) ->
    /// bool`, where a masked mesh stops a ray. Its resources
    /// are bound at [`HOST_GROUP`](crate::HOST_GROUP). `shaders/contract.wgsl` has all that it may use.
    pub source: &'a str,
    /// What errors call it.
    pub file: &'a str,
}

/// What is fixed when a node is built.
#[derive(Debug, Clone, Copy)]
pub struct Descriptor<'a> {
    /// Samples along one side of a pixel's window, 1 to 8. Higher: better edges and textures; G-buffer memory and raster
    /// time grow with m².
    pub m: u32,
    /// Of the view that frames are written to: float (HDR, linear), unorm or sRGB (clamped to 1).
    pub target_format: wgpu::TextureFormat,
    /// The host's WGSL.
    pub shading: Shading<'a>,
    /// How `daa_texture` reaches textures.
    pub textures: TextureTier,
    /// Most textures of a table on [`TextureTier::Bindings`].
    pub texture_capacity: u32,
    /// Who traces rays, if any frame may ever ask for them.
    pub rays: Option<RayTier>,
}

impl<'a> Descriptor<'a> {
    /// m = 4, no textures, no rays.
    pub fn new(target_format: wgpu::TextureFormat, shading: Shading<'a>) -> Self {
        Self { m: 4, target_format, shading, textures: TextureTier::None, texture_capacity: 0, rays: None }
    }
}
