//! Bevy's plugins that the examples and the tests need.

use bevy_app::prelude::*;
use bevy_asset::{AssetPlugin, UnapprovedPathMode};
use bevy_window::{Window, WindowPlugin};
use std::sync::atomic::{AtomicBool, Ordering};

static LOGS: AtomicBool = AtomicBool::new(false);

/// Adds them, with a window or without.
pub fn add_to(app: &mut App, window: Option<Window>) {
    // One logger for all apps of a process.
    if !LOGS.swap(true, Ordering::Relaxed) {
        // What does not load is said by the examples.
        let filter = format!("{},bevy_asset=off", bevy_log::DEFAULT_FILTER);
        app.add_plugins(bevy_log::LogPlugin { level: bevy_log::Level::WARN, filter, ..Default::default() });
    }
    let has_window = window.is_some();
    app.add_plugins((
        bevy_app::TaskPoolPlugin::default(),
        bevy_diagnostic::FrameCountPlugin,
        bevy_time::TimePlugin,
        bevy_transform::TransformPlugin,
        bevy_diagnostic::DiagnosticsPlugin,
        bevy_input::InputPlugin,
        WindowPlugin { primary_window: window, ..Default::default() },
        bevy_a11y::AccessibilityPlugin,
        // Files are given by paths from anywhere.
        AssetPlugin { unapproved_path_mode: UnapprovedPathMode::Allow, ..Default::default() },
        bevy_world_serialization::WorldSerializationPlugin,
    ));
    if has_window {
        app.add_plugins(bevy_winit::WinitPlugin::default());
    }
    app.add_plugins((
        bevy_render::RenderPlugin { synchronous_pipeline_compilation: !has_window, ..Default::default() },
        bevy_image::ImagePlugin::default(),
        bevy_mesh::MeshPlugin,
        bevy_camera::CameraPlugin,
        bevy_light::LightPlugin,
        bevy_core_pipeline::CorePipelinePlugin,
        bevy_post_process::PostProcessPlugin,
        bevy_anti_alias::AntiAliasPlugin,
        bevy_gltf::GltfPlugin::default(),
        bevy_pbr::PbrPlugin::default(),
        bevy_animation::AnimationPlugin,
        bevy_gizmos::GizmoPlugin,
        bevy_gizmos_render::GizmoRenderPlugin,
        bevy_render::diagnostic::RenderDiagnosticsPlugin,
    ));
}
