//! Anti-aliasing for Bevy's deferred renderer.
//!
//! Add [`DeferredAaPlugin`] to the app and [`DeferredAa`] to a camera:
//!
//! ```no_run
//! # use bevy_app::prelude::*; use bevy_camera::prelude::*; use bevy_ecs::prelude::*;
//! use bevy_deferred_aa::{DeferredAa, DeferredAaPlugin};
//!
//! # fn main() { let mut app = App::new();
//! app.add_plugins(DeferredAaPlugin);
//! # }
//! fn setup(mut commands: Commands) {
//!     commands.spawn((Camera3d::default(), DeferredAa::default()));
//! }
//! ```
//!
//! # How it works
//! Bevy's deferred phases, which hold the camera's opaque and masked meshes with their pipelines, are drawn once more
//! into a G-buffer with m × m samples a pixel. Bevy's lighting, composed from its own shaders with the definitions that
//! the camera's deferred lighting pass has, becomes the `material` and `light` of a [`deferred_aa`] node, which decides
//! for each pixel what to read and what to light. Its image is drawn over the camera's target and its depth into the
//! camera's depth, before Bevy's main pass.
//!
//! # What it costs
//! 33 bytes of memory for each of the m × m samples, one more raster of the deferred meshes at that size, and the
//! node's passes. [`DeferredAaStatus`] has the bytes and the counts, and the render diagnostics have the times, under
//! `deferred_aa`.
//!
//! # Limits
//! - Materials are read per sample by Bevy's own fragment shaders, with footprints of a sample.
//! - MSAA is off, as Bevy has it for deferred cameras. A camera with `TemporalJitter` (TAA, DLSS), a
//!   `MainPassResolutionOverride` or `OcclusionCulling` is refused, and so is an `Atmosphere`. Clustered decals do not
//!   show.
//! - All of an app's `Camera3d` should be deferred (`DeferredPrepass`): the plugin makes deferred the default of
//!   opaque materials, and Bevy does not draw those to a camera that is not.

#![warn(missing_docs)]

mod bindings;
mod component;
mod composite;
mod diagnostics;
mod error;
mod extract;
mod fullscreen;
mod pack;
mod program;
mod raster;
pub mod settings;
mod view;

pub use component::{DeferredAa, DeferredAaState, DeferredAaStatus};
pub use deferred_aa;
pub use diagnostics::{BYTES, SAMPLE_RATIO};
pub use error::DeferredAaError;

use bevy_app::prelude::*;
use bevy_asset::embedded_asset;
use bevy_core_pipeline::core_3d::main_opaque_pass_3d;
use bevy_core_pipeline::schedule::{Core3d, Core3dSystems};
use bevy_ecs::prelude::*;
use bevy_pbr::deferred::deferred_lighting;
use bevy_pbr::{DefaultOpaqueRendererMethod, screen_space_reflections};
use bevy_render::{ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems};

/// Adds [`DeferredAa`] to an app. It comes after Bevy's own plugins.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeferredAaPlugin;

/// The systems of [`DeferredAa`] in [`Core3d`], for others to be ordered against.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeferredAaSystems {
    /// The deferred meshes are drawn into the enlarged G-buffer.
    Raster,
    /// The samples are shaded, and the image is drawn over the camera's target.
    Shade,
}

impl Plugin for DeferredAaPlugin {
    fn build(&self, app: &mut App) {
        embedded_asset!(app, "shading.wesl");
        app.register_type::<DeferredAa>()
            .insert_resource(DefaultOpaqueRendererMethod::deferred())
            .init_resource::<diagnostics::Reports>()
            .add_plugins(diagnostics::plugin);
        let reports = app.world().resource::<diagnostics::Reports>().clone();
        let shader = program::root_shader(app.world());
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        render_app
            .insert_resource(reports)
            .insert_resource(program::RootShader(shader))
            .init_gpu_resource::<program::Composer>()
            .init_gpu_resource::<program::Programs>()
            .init_gpu_resource::<pack::PackPipeline>()
            .init_gpu_resource::<composite::CompositePipelines>()
            .add_systems(RenderStartup, view::forget)
            .add_systems(ExtractSchedule, (extract::cameras, program::extract_shaders))
            .add_systems(
                Render,
                (view::prepare.in_set(RenderSystems::PrepareViews), view::finish.in_set(RenderSystems::Cleanup)),
            )
            .configure_sets(
                Core3d,
                (DeferredAaSystems::Raster, DeferredAaSystems::Shade)
                    .chain()
                    .in_set(Core3dSystems::MainPass)
                    .after(deferred_lighting)
                    // It adds to the image, and reads it.
                    .before(screen_space_reflections)
                    .before(main_opaque_pass_3d),
            )
            .add_systems(
                Core3d,
                (raster::raster.in_set(DeferredAaSystems::Raster), view::shade.in_set(DeferredAaSystems::Shade)),
            );
    }
}
