//! The component that a camera gets, and what the plugin reports of it.

use crate::error::DeferredAaError;
use bevy_camera::Hdr;
use bevy_core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use deferred_aa::{Preset, Settings, Statistics, Technique};

/// Anti-aliases the deferred rendering of a [`Camera3d`](bevy_camera::Camera3d): its opaque and masked meshes are
/// rasterised with [`m`](Self::m) × `m` samples a pixel, and Bevy's own lighting runs on those samples that the pixel
/// needs.
///
/// Materials, lights, shadow maps, fog and environment stay as they are. What follows after the opaque meshes (skybox,
/// blended meshes, gizmos, bloom, tonemapping, UI) does, too. There is no history, so nothing ghosts.
///
/// Removing the component gives Bevy's own deferred image back. Where it can't work, the camera is rendered as if the
/// component were not there, and [`DeferredAaStatus`] says why.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(Hdr, DeferredPrepass, DepthPrepass, DeferredAaStatus)]
pub struct DeferredAa {
    /// The number of samples along one side of a pixel, 1 to 8. Higher: finer edges, textures and highlights, while the
    /// memory of the G-buffer, 33 bytes a sample, and the time to rasterise grow with m²: at 1920×1080 that is 274 MB for
    /// m = 2, 616 MB for m = 3 and 1.1 GB for m = 4. `NormalPrepass`, which SSAO needs, and `MotionVectorPrepass` add 4
    /// bytes a sample each.
    pub m: u32,
    /// How samples are chosen, and everything else that may change from frame to frame.
    #[reflect(remote = crate::settings::Settings)]
    pub settings: Settings,
    /// Whether to collect [`Statistics`] each frame, at the price of a copy of a few hundred bytes.
    pub statistics: bool,
}

impl DeferredAa {
    /// Settings by a preset, with m = 3.
    pub fn preset(preset: Preset) -> Self {
        // `user` holds base colour and roughness, which `Windowed` needs to see: its textures are read per sample, so
        // that a window with a single shaded sample would alias them.
        let mut settings = Settings { technique: Technique::Surfaces, ..preset.settings() };
        settings.windowed.user_scale = 16.0;
        Self { m: 3, settings, statistics: true }
    }

    /// All samples are shaded: the image that other settings are compared with, at the full price.
    pub fn full(m: u32) -> Self {
        Self { m, settings: Settings { technique: Technique::Full, ..Settings::default() }, statistics: true }
    }
}

impl Default for DeferredAa {
    fn default() -> Self {
        Self::preset(Preset::Balanced)
    }
}

/// What became of a camera's [`DeferredAa`], some frames ago.
#[derive(Component, Clone, Debug, Default)]
pub struct DeferredAaStatus {
    /// Whether the last frame was anti-aliased.
    pub state: DeferredAaState,
    /// The newest statistics, if [`DeferredAa::statistics`] asks for them.
    pub statistics: Option<Statistics>,
    /// The GPU memory of the camera's G-buffer and everything beside it, in bytes.
    pub bytes: u64,
}

/// Whether a camera is anti-aliased.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum DeferredAaState {
    /// Shaders are loading or pipelines compile; until then the camera is rendered without.
    #[default]
    Waiting,
    /// It is.
    Active,
    /// It can't be. The error was logged once.
    Refused(DeferredAaError),
}
