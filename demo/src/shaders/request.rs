//! Which shaders to write, and in which language.

use super::lang::Lang;
use deferred_aa::rays::RayTier;
use deferred_aa::{Depth, GBufferTier, Settings, Shading, TextureTier};

/// What to write.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// In which language.
    pub lang: Lang,
    /// Samples along one side of a window, 1 to 8: a constant in all that is written.
    pub m: u32,
    /// Of the frames.
    pub settings: &'a Settings,
    /// How `daa_texture` reaches textures.
    pub textures: TextureTier,
    /// Who traces rays, where the settings have effects on.
    pub rays: RayTier,
    /// How the G-buffer keeps its samples.
    pub gbuffer: GBufferTier,
    /// Which depth the frames write at the output's size, if any.
    pub depth: Option<Depth>,
    /// The host's WGSL.
    pub shading: Shading<'a>,
}
