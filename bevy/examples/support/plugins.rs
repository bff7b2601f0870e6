//! Bevy's plugins that the examples and the tests need.

use bevy_app::prelude::*;
use bevy_asset::{AssetPlugin, UnapprovedPathMode};
use bevy_log::tracing::field::{Field, Visit};
use bevy_log::tracing::{Event, Subscriber};
use bevy_log::tracing_subscriber::Layer;
use bevy_log::tracing_subscriber::layer::Context;
use bevy_render::settings::WgpuSettings;
use bevy_window::{Window, WindowPlugin};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

static LOGS: AtomicBool = AtomicBool::new(false);

/// What the plugin logged, of all apps of the process.
pub static LOGGED: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Recorder;

impl<S: Subscriber> Layer<S> for Recorder {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if event.metadata().target().starts_with("bevy_deferred_aa") {
            let mut message = Message(String::new());
            event.record(&mut message);
            LOGGED.lock().expect("no panic").push(message.0);
        }
    }
}

struct Message(String);

impl Visit for Message {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "message" {
            self.0 = format!("{value:?}");
        }
    }
}

/// Adds them, with a window or without.
pub fn add_to(app: &mut App, window: Option<Window>, settings: WgpuSettings) {
    // One logger for all apps of a process.
    if !LOGS.swap(true, Ordering::Relaxed) {
        // What does not load is said by the examples.
        let filter = format!("{},bevy_asset=off", bevy_log::DEFAULT_FILTER);
        let custom_layer = |_: &mut App| Some(Box::new(Recorder) as bevy_log::BoxedLayer);
        app.add_plugins(bevy_log::LogPlugin {
            level: bevy_log::Level::WARN,
            filter,
            custom_layer,
            ..Default::default()
        });
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
        bevy_render::RenderPlugin {
            render_creation: settings.into(),
            synchronous_pipeline_compilation: !has_window,
            ..Default::default()
        },
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
