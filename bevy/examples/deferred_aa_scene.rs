//! Shows a glTF scene, or the example's own, with `DeferredAa` on and off.
//!
//! `cargo run --release --example deferred_aa_scene -- [FILE.gltf]`
//!
//! Space switches it on and off, 1 to 3 choose a preset, 4 shades all samples, M steps through 1 to 4 samples a side,
//! the arrow keys turn the camera, and + and − move it.

mod support;

use bevy_app::prelude::*;
use bevy_asset::RecursiveDependencyLoadState;
use bevy_asset::prelude::*;
use bevy_camera::Hdr;
use bevy_camera::prelude::*;
use bevy_color::Color;
use bevy_core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy_core_pipeline::tonemapping::Tonemapping;
use bevy_deferred_aa::deferred_aa::Preset;
use bevy_deferred_aa::{DeferredAa, DeferredAaPlugin, DeferredAaState, DeferredAaStatus};
use bevy_diagnostic::DiagnosticsStore;
use bevy_ecs::prelude::*;
use bevy_gizmos::prelude::*;
use bevy_input::prelude::*;
use bevy_math::prelude::*;
use bevy_time::Time;
use bevy_transform::prelude::*;
use bevy_window::Window;
use bevy_world_serialization::WorldAssetRoot;
use support::{plugins, scene};

/// What the camera turns about, and from how far.
#[derive(Component)]
struct Orbit {
    centre: Vec3,
    distance: f32,
    angle: Vec2,
}

/// What the keys have chosen.
#[derive(Resource)]
struct Choice {
    on: bool,
    aa: DeferredAa,
    name: &'static str,
}

fn main() -> AppExit {
    let mut words = std::env::args().skip(1);
    let file = words.next();
    let checked = match (&file, words.next()) {
        (Some(option), _) if option.starts_with('-') => Err(format!("no option {option}; it takes a glTF file")),
        (_, Some(further)) => Err(format!("it takes one glTF file, not {further}, too")),
        (Some(file), None) => support::check_scene(file),
        (None, None) => Ok(()),
    };
    if let Err(e) = checked {
        eprintln!("deferred_aa_scene: {e}");
        return AppExit::from_code(2);
    }
    let mut app = App::new();
    let window = Window {
        title: "DeferredAa".to_owned(),
        resolution: (960, 540).into(),
        present_mode: bevy_window::PresentMode::AutoNoVsync,
        ..Default::default()
    };
    support::make("deferred_aa_scene", || plugins::add_to(&mut app, Some(window), Default::default()));
    app.add_plugins(DeferredAaPlugin)
        .insert_resource(Choice { on: true, aa: DeferredAa::default(), name: "balanced" })
        .add_systems(Startup, move |world: &mut World| setup(world, file.as_deref()))
        .add_systems(Update, (watch, choose, orbit, say).chain());
    app.run()
}

/// Ends the app if its scene can't be loaded.
fn watch(
    scenes: Query<&WorldAssetRoot>,
    server: Res<AssetServer>,
    mut told: Local<bool>,
    mut exit: MessageWriter<AppExit>,
) {
    for scene in &scenes {
        if let RecursiveDependencyLoadState::Failed(e) = server.recursive_dependency_load_state(&scene.0)
            && !std::mem::replace(&mut *told, true)
        {
            eprintln!("deferred_aa_scene: {}", support::first_line(&*e));
            exit.write(AppExit::from_code(2));
        }
    }
}

fn setup(world: &mut World, file: Option<&str>) {
    let (orbit, surroundings) = match file {
        Some(file) => {
            let path = std::fs::canonicalize(file).unwrap_or_else(|_| file.into());
            let scene = bevy_gltf::GltfAssetLabel::Scene(0).from_asset(path);
            let scene = world.resource::<AssetServer>().load(scene);
            world.spawn(WorldAssetRoot(scene));
            scene::spawn_sun(world);
            (Orbit { centre: Vec3::ZERO, distance: 0.0, angle: Vec2::new(0.3, 0.3) }, scene::surroundings(world))
        }
        None => {
            scene::spawn(world);
            let centre = Vec3::new(0.0, 0.9, 0.0);
            (Orbit { centre, distance: 7.2, angle: Vec2::new(0.0, 0.24) }, scene::surroundings(world))
        }
    };
    let is_file = file.is_some();
    let mut camera = world.spawn((Camera3d::default(), Hdr, Tonemapping::Reinhard, DeferredPrepass, DepthPrepass));
    camera.insert((surroundings, orbit));
    if is_file {
        camera.remove::<bevy_pbr::DistanceFog>();
    }
}

fn choose(
    keys: Res<ButtonInput<KeyCode>>,
    mut choice: ResMut<Choice>,
    mut commands: Commands,
    camera: Single<Entity, With<Camera3d>>,
) {
    let presets = [(KeyCode::Digit1, "fast"), (KeyCode::Digit2, "balanced"), (KeyCode::Digit3, "quality")];
    let m = choice.aa.m;
    for ((key, name), preset) in presets.into_iter().zip(Preset::ALL) {
        if keys.just_pressed(key) {
            (choice.aa, choice.name) = (DeferredAa { m, ..DeferredAa::preset(preset) }, name);
        }
    }
    if keys.just_pressed(KeyCode::Digit4) {
        (choice.aa, choice.name) = (DeferredAa::full(m), "all samples");
    }
    if keys.just_pressed(KeyCode::KeyM) {
        choice.aa.m = m % 4 + 1;
    }
    if keys.just_pressed(KeyCode::Space) {
        choice.on = !choice.on;
    }
    if choice.is_changed() {
        let mut camera = commands.entity(*camera);
        if choice.on {
            camera.insert(choice.aa);
        } else {
            camera.remove::<DeferredAa>();
        }
    }
}

fn orbit(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    camera: Single<(&mut Orbit, &mut Transform)>,
    meshes: Query<(&bevy_camera::primitives::Aabb, &GlobalTransform)>,
) {
    let (mut orbit, mut place) = camera.into_inner();
    if orbit.distance == 0.0 && !meshes.is_empty() {
        let corners = meshes.iter().flat_map(|(bounds, place)| {
            let (centre, half) = (Vec3::from(bounds.center), Vec3::from(bounds.half_extents));
            [centre - half, centre + half].map(|corner| place.transform_point(corner))
        });
        let (least, most) =
            corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), corner| (a.min(corner), b.max(corner)));
        (orbit.centre, orbit.distance) = ((least + most) * 0.5, (most - least).length() * 1.1);
    }
    let held = |plus: KeyCode, minus: KeyCode| f32::from(keys.pressed(plus)) - f32::from(keys.pressed(minus));
    let turn = Vec2::new(held(KeyCode::ArrowRight, KeyCode::ArrowLeft), held(KeyCode::ArrowUp, KeyCode::ArrowDown));
    orbit.angle += turn * time.delta_secs();
    orbit.angle.y = orbit.angle.y.clamp(-1.5, 1.5);
    orbit.distance *= (held(KeyCode::Minus, KeyCode::Equal) * time.delta_secs()).exp();
    let [x, y] = orbit.angle.to_array();
    let towards = Vec3::new(x.sin() * y.cos(), y.sin(), x.cos() * y.cos());
    *place = Transform::from_translation(orbit.centre + towards * orbit.distance.max(1e-3))
        .looking_at(orbit.centre, Vec3::Y);
}

/// Writes what is on and what it costs across the top of the image.
fn say(
    choice: Res<Choice>,
    status: Option<Single<&DeferredAaStatus>>,
    diagnostics: Res<DiagnosticsStore>,
    camera: Single<(&Camera, &Transform)>,
    mut gizmos: Gizmos,
) {
    let time = |names: &[&str]| -> f64 {
        let path = |name: &&str| format!("render/{name}/elapsed_gpu");
        let of = |path: String| diagnostics.iter().find(|d| d.path().as_str() == path)?.smoothed();
        names.iter().map(path).filter_map(of).sum()
    };
    let line = match (choice.on, status.as_deref().map(|status| (&status.state, &status.statistics, status.bytes))) {
        (true, Some((DeferredAaState::Active, statistics, bytes))) => {
            let passes = ["deferred_aa_raster", "deferred_aa_pack", "deferred_aa_shade", "deferred_aa_composite"];
            let lit = statistics.as_ref().map_or(0.0, |statistics| statistics.mean_k);
            let (m, megabytes) = (choice.aa.m, bytes as f64 / 1e6);
            format!("{} at m = {m}: {lit:.2} lights a pixel, {megabytes:.0} MB, {:.1} ms", choice.name, time(&passes))
        }
        (true, Some((DeferredAaState::Refused(e), ..))) => e.to_string(),
        (true, _) => format!("{} is compiling", choice.name),
        (false, _) => format!("off: deferred lighting {:.1} ms", time(&["deferred_lighting"])),
    };
    let (camera, place) = camera.into_inner();
    // A plane just before the camera.
    let Ok(ray) = camera.viewport_to_world(&GlobalTransform::from(*place), Vec2::new(12.0, 24.0)) else { return };
    let Ok(beside) = camera.viewport_to_world(&GlobalTransform::from(*place), Vec2::new(13.0, 24.0)) else { return };
    let depth = 0.3;
    let at = |ray: bevy_shape::Ray3d| ray.origin + *ray.direction * (depth / ray.direction.dot(*place.forward()));
    let pixel = at(beside).distance(at(ray));
    let plane = Isometry3d::new(at(ray), place.rotation);
    gizmos.text(plane, &line, 16.0 * pixel, Vec2::new(-0.5, 0.0), Color::WHITE);
}
