//! The descriptor of a node.

use crate::host::gbuffer::GBufferTier;
use crate::host::table::TextureTier;
use crate::rays::RayTier;

/// The host's shading code.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a> {
    /// WGSL with either `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` and
    /// `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`. The result is linear radiance and alpha. `light` may return
    /// `DaaLight` instead: what the base colour is multiplied by, and the rest, to which the crate adds the emission. Then
    /// [`Technique::Surfaces`](crate::Technique::Surfaces) lets pixels share light and keep their colours
    /// ([`block_spread`](crate::Surfaces::block_spread)).
    ///
    /// Four functions are optional. `fn sky(s: DaaSample) -> vec4f` shades samples without a surface; without it the sky
    /// is transparent black. `fn spread(s: DaaSample, m: DaaMaterial) -> DaaSpread` says which samples `Surfaces` may
    /// light together, for materials that mean other things than the contract's names. For rays,
    /// `fn reflection(s: DaaSample) -> DaaReflection` says what a surface reflects and refracts, and
    /// `fn solid(material: u32, uv: vec2f, user: u32) -> bool` whether a masked mesh stops a ray.
    ///
    /// Its resources are bound at [`HOST_GROUP`](crate::HOST_GROUP) and, with
    /// [`DeferredAa::with_groups`](crate::DeferredAa::with_groups), at [`SECOND_HOST_GROUP`](crate::SECOND_HOST_GROUP),
    /// too. `shaders/contract.wgsl` has everything that it may use.
    pub source: &'a str,
    /// The file name that error messages give.
    pub file: &'a str,
}

/// The choices that are fixed when a node is built.
#[derive(Debug, Clone, Copy)]
pub struct Descriptor<'a> {
    /// The number of samples along one side of a window, 1 to 8. Higher: better edges and textures, while G-buffer
    /// memory and raster time grow with m².
    pub m: u32,
    /// The format of the views that frames are written to: float (HDR, linear), unorm or sRGB (clamped to 1).
    pub target_format: wgpu::TextureFormat,
    /// How the G-buffer keeps its samples, and which of their attributes.
    pub gbuffer: GBufferTier,
    /// The host's WGSL.
    pub shading: Shading<'a>,
    /// How `daa_texture` reads textures.
    pub textures: TextureTier,
    /// The most textures in a table of [`TextureTier::Bindings`]. Other tiers ignore it.
    pub texture_capacity: u32,
    /// How rays are traced; `None` if no frame will trace any.
    pub rays: Option<RayTier>,
}

impl<'a> Descriptor<'a> {
    /// A descriptor with m = 4, a G-buffer that stores every attribute, no textures and no rays.
    pub fn new(target_format: wgpu::TextureFormat, shading: Shading<'a>) -> Self {
        let (gbuffer, textures) = (GBufferTier::default(), TextureTier::None);
        Self { m: 4, target_format, gbuffer, shading, textures, texture_capacity: 0, rays: None }
    }
}
