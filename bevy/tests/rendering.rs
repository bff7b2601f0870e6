//! Pictures of cameras with `DeferredAa` against Bevy's own.

#[path = "../examples/support/mod.rs"]
mod support;

use bevy_anti_alias::fxaa::Fxaa;
use bevy_anti_alias::smaa::{Smaa, SmaaPreset};
use bevy_asset::{Asset, Assets, Handle, uuid_handle};
use bevy_camera::Viewport;
use bevy_core_pipeline::prepass::{DeferredPrepass, DepthPrepass, MotionVectorPrepass};
use bevy_core_pipeline::schedule::Core3d;
use bevy_core_pipeline::tonemapping::Tonemapping;
use bevy_deferred_aa::deferred_aa::{Effect, Preset, Settings, Technique};
use bevy_deferred_aa::{DeferredAa, DeferredAaError, DeferredAaState};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::Schedules;
use bevy_gizmos::config::{DefaultGizmoConfigGroup, GizmoConfigStore};
use bevy_image::Image;
use bevy_light::{EnvironmentMapLight, RectLight, Skybox};
use bevy_math::{UVec2, Vec3};
use bevy_mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{
    DefaultOpaqueRendererMethod, ExtendedMaterial, MaterialExtension, MaterialPlugin, MeshMaterial3d,
    ScreenSpaceAmbientOcclusion, ScreenSpaceReflections, StandardMaterial,
};
use bevy_reflect::{GetPath, PartialReflect, TypePath};
use bevy_render::RenderApp;
use bevy_render::camera::TemporalJitter;
use bevy_render::occlusion_culling::OcclusionCulling;
use bevy_render::render_resource::AsBindGroup;
use bevy_render::settings::{WgpuLimits, WgpuSettings, WgpuSettingsPriority};
use bevy_render::view::Msaa;
use bevy_shader::{Shader, ShaderRef};
use bevy_transform::prelude::*;
use support::picture::Picture;
use support::{Stage, plugins, scene};

const SIZE: [u32; 2] = [320, 180];

/// A stage with the scene, and a deferred camera into an image of this size.
fn stage(size: [u32; 2]) -> (Stage, Entity, Handle<Image>) {
    filled(Stage::new(), size)
}

fn filled(mut stage: Stage, size: [u32; 2]) -> (Stage, Entity, Handle<Image>) {
    scene::spawn(stage.world());
    let surroundings = scene::surroundings(stage.world());
    let target = stage.target(size);
    let camera = stage.camera(&target, (surroundings, scene::eye(), DeferredPrepass, DepthPrepass));
    (stage, camera, target)
}

/// Bevy's own deferred image with m × m pixels for each.
fn supersampled(m: u32) -> Picture {
    let (mut stage, _, target) = stage(SIZE.map(|side| side * m));
    stage.run(12);
    let picture = stage.picture(&target);
    assert_eq!(stage.complaints(), Vec::<String>::new());
    picture
}

fn insert(stage: &mut Stage, camera: Entity, aa: DeferredAa) {
    stage.world().entity_mut(camera).insert(aa);
    stage.run(2);
    run_until_active(stage, camera);
}

fn run_until_active(stage: &mut Stage, camera: Entity) {
    stage.run_until_active(camera).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn all_samples_are_the_mean_of_bevys_own_larger_image() {
    for m in [2, 4] {
        let truth = supersampled(m).reduced(m as usize);
        let (mut stage, camera, target) = stage(SIZE);
        insert(&mut stage, camera, DeferredAa::full(m));
        let full = stage.picture(&target);
        let (shown, linear) = (full.psnr(&truth), full.psnr_linear(&truth));
        println!("m = {m}: {shown:.1} dB as displayed, {linear:.1} dB of linear radiance");
        assert_eq!(stage.complaints(), Vec::<String>::new());
        assert!(shown >= 50.0 && linear >= 50.0, "m = {m}: {shown} dB, {linear} dB");
    }
}

/// Light of a rectangle, which has no shadow map and reads tables of its own.
#[test]
fn rectangles_light_as_in_bevys_own() {
    let with_panel = |size: [u32; 2]| {
        let (mut stage, camera, target) = stage(size);
        stage.run(12);
        let before = stage.picture(&target);
        let panel = RectLight { intensity: 1_000_000.0, width: 3.0, height: 1.0, ..Default::default() };
        let at = Transform::from_xyz(-1.0, 3.0, 3.0).looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::Y);
        stage.world().spawn((panel, at));
        stage.run(12);
        (stage, camera, target, before)
    };
    let (mut large, _, large_target, before) = with_panel(SIZE.map(|side| side * 2));
    let truth = large.picture(&large_target);
    let without = before.psnr(&truth);
    assert!(without < 30.0, "it lights little: {without} dB");
    let truth = truth.reduced(2);
    let (mut stage, camera, target, _) = with_panel(SIZE);
    insert(&mut stage, camera, DeferredAa::full(2));
    let full = stage.picture(&target);
    let (shown, linear) = (full.psnr(&truth), full.psnr_linear(&truth));
    println!("{shown:.1} dB as displayed, {linear:.1} dB of linear radiance");
    assert!(shown >= 50.0 && linear >= 50.0, "{shown} dB, {linear} dB");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// A material with a lighting pass of its own is drawn into the G-buffer, and not lit.
#[test]
fn what_other_passes_light_is_left_to_them() {
    let with_own_pass = |size: [u32; 2]| {
        let (mut stage, camera, target) = stage(size);
        let world = stage.world();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Mesh::from(bevy_shape::prelude::Sphere::new(0.8)));
        let material = StandardMaterial { deferred_lighting_pass_id: 7, ..Default::default() };
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), Transform::from_xyz(0.0, 1.2, 2.0)));
        world.insert_resource(bevy_camera::ClearColor(bevy_color::Color::linear_rgb(0.0, 3.0, 0.0)));
        stage.run(12);
        (stage, camera, target)
    };
    let (mut large, _, large_target) = with_own_pass(SIZE.map(|side| side * 2));
    let truth = large.picture(&large_target).reduced(2);
    let green = truth.pixels.iter().filter(|p| p[1] > 2.5 && p[0] < 0.1).count();
    assert!(green > truth.pixels.len() / 50, "{green} pixels show what lies below");
    let (mut stage, camera, target) = with_own_pass(SIZE);
    insert(&mut stage, camera, DeferredAa::full(2));
    let psnr = stage.picture(&target).psnr(&truth);
    assert!(psnr >= 50.0, "{psnr} dB");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn presets_are_close_to_all_samples_for_fewer() {
    let (mut stage, camera, target) = stage(SIZE);
    insert(&mut stage, camera, DeferredAa::full(DeferredAa::default().m));
    let full = stage.picture(&target);
    for preset in Preset::ALL {
        insert(&mut stage, camera, DeferredAa::preset(preset));
        let picture = stage.picture(&target);
        let ratio = stage.status(camera).expect("a status").statistics.as_ref().expect("statistics").ratio;
        let psnr = picture.psnr(&full);
        println!("{preset:?}: {psnr:.1} dB at {:.1} %", 100.0 * ratio);
        assert!(preset == Preset::Fast || psnr >= 42.0 && ratio < 0.4, "{preset:?}: {psnr} dB at {ratio}");
    }
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn edges_are_better_than_those_of_fxaa_and_smaa() {
    // Both work on the tone-mapped image, so all are compared there.
    let tone_mapped = |size: [u32; 2]| {
        let (mut stage, camera, target) = stage(size);
        stage.world().entity_mut(camera).insert(Tonemapping::Reinhard);
        stage.run(12);
        (stage, camera, target)
    };
    let (mut large, _, large_target) = tone_mapped(SIZE.map(|side| side * 8));
    let large = large.picture(&large_target);
    let (truth, edges) = (large.reduced(8).before_reinhard(), large.before_reinhard().edges(8));
    let (mut stage, camera, target) = tone_mapped(SIZE);
    let at_edges = |stage: &mut Stage| {
        stage.run(8);
        stage.picture(&target).before_reinhard().psnr_where(&truth, |i| edges[i])
    };
    let off = at_edges(&mut stage);
    stage.world().entity_mut(camera).insert(Fxaa::default());
    let fxaa = at_edges(&mut stage);
    stage.world().entity_mut(camera).remove::<Fxaa>().insert(Smaa { preset: SmaaPreset::Ultra });
    let smaa = at_edges(&mut stage);
    stage.world().entity_mut(camera).remove::<Smaa>();
    insert(&mut stage, camera, DeferredAa::default());
    let ours = at_edges(&mut stage);
    println!("edges to the truth: off {off:.1} dB, FXAA {fxaa:.1}, SMAA {smaa:.1}, DeferredAa {ours:.1}");
    assert!(ours >= fxaa.max(smaa) + 6.0, "FXAA {fxaa} dB, SMAA {smaa}, DeferredAa {ours}");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// Skybox, blended meshes and gizmos are drawn after the node, against its depth.
#[test]
fn what_is_drawn_over_the_image_fits_it() {
    let with_more = |scale: u32| {
        let (mut stage, camera, target) = stage(SIZE.map(|side| side * scale));
        scene::spawn_over(stage.world());
        // Lines are as wide as that many pixels.
        let mut gizmos = stage.world().resource_mut::<GizmoConfigStore>();
        gizmos.config_mut::<DefaultGizmoConfigGroup>().0.line.width = 2.0 * scale as f32;
        stage.app.add_systems(bevy_app::Update, scene::draw_gizmos);
        stage.run(12);
        (stage, camera, target)
    };
    let (mut large, _, large_target) = with_more(4);
    let large = large.picture(&large_target);
    let (truth, edges) = (large.reduced(4), large.edges(4));
    let yellow = |picture: &Picture| picture.pixels.iter().filter(|p| p[0] > 0.9 && p[1] > 0.7 && p[2] < 0.05).count();
    let lines = yellow(&truth);
    assert!(lines > 500, "{lines} pixels show gizmos");
    let (mut stage, camera, target) = with_more(1);
    let off = stage.picture(&target);
    insert(&mut stage, camera, DeferredAa::full(4));
    let full = stage.picture(&target);
    let (inside, at_edges) = (full.psnr_where(&truth, |i| !edges[i]), full.psnr_where(&truth, |i| edges[i]));
    let without = off.psnr_where(&truth, |i| edges[i]);
    let shown = yellow(&full);
    println!("{lines} pixels of gizmos in the truth, {} without, {shown} with", yellow(&off));
    println!("inside {inside:.1} dB, at edges {at_edges:.1} dB, without {without:.1} dB");
    assert!(inside >= 45.0, "{inside} dB");
    assert!(shown.abs_diff(yellow(&off)) * 50 < shown, "{shown} pixels show gizmos");
    // What is drawn over the image has edges of its own, as before.
    assert!(at_edges >= without + 3.0, "{at_edges} dB, without {without} dB");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn the_passes_come_between_bevys_prepass_and_its_main_pass() {
    let (mut stage, camera, _) = stage([32, 32]);
    insert(&mut stage, camera, DeferredAa::default());
    let world = stage.app.sub_app(RenderApp).world();
    let schedule = world.resource::<Schedules>().get(Core3d).expect("Core3d");
    let names: Vec<String> = schedule.systems().expect("built").map(|(_, system)| system.name().to_string()).collect();
    let place =
        |name: &str| names.iter().position(|n| n.ends_with(name)).unwrap_or_else(|| panic!("no {name} in {names:#?}"));
    let order = [
        "early_deferred_prepass",
        "copy_deferred_lighting_id",
        "bevy_deferred_aa::raster::raster",
        "bevy_deferred_aa::view::shade",
        "ssr::screen_space_reflections",
        "main_opaque_pass_3d",
        "main_transparent_pass_3d",
        "tonemapping::node::tonemapping",
    ]
    .map(place);
    assert!(order.is_sorted(), "{names:#?}");
}

#[test]
fn without_the_component_bevys_image_is_back_bit_for_bit() {
    let (mut stage, camera, target) = stage(SIZE);
    stage.run(12);
    let before = stage.picture(&target);
    insert(&mut stage, camera, DeferredAa::default());
    assert_ne!(stage.picture(&target), before);
    stage.world().entity_mut(camera).remove::<DeferredAa>();
    stage.run(4);
    assert!(stage.picture(&target) == before, "the image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn the_same_frame_is_the_same_bits() {
    let (mut stage, camera, target) = stage(SIZE);
    insert(&mut stage, camera, DeferredAa::default());
    let first = stage.picture(&target);
    stage.run(3);
    assert!(stage.picture(&target) == first, "the image differs");
}

#[test]
fn what_can_t_work_is_refused_and_rendered_without() {
    let (mut stage, camera, target) = stage(SIZE);
    stage.run(12);
    let without = stage.picture(&target);
    let refused = |stage: &mut Stage, e: DeferredAaError| {
        stage.run(6);
        assert_eq!(stage.state(camera), DeferredAaState::Refused(e));
        assert!(stage.picture(&target) == without, "the image differs");
    };
    stage.world().entity_mut(camera).insert((DeferredAa::default(), OcclusionCulling));
    refused(&mut stage, DeferredAaError::OcclusionCulling);
    stage.world().entity_mut(camera).remove::<OcclusionCulling>();

    let mut settings = Settings::default();
    settings.windowed.footprint = -1.0;
    let e = settings.validate().expect_err("out of range").to_string();
    stage.world().entity_mut(camera).insert(DeferredAa { m: 2, settings, statistics: false });
    refused(&mut stage, DeferredAaError::Node(e));

    stage.world().entity_mut(camera).insert(DeferredAa { m: 9, ..DeferredAa::default() });
    let e = "m is 9: a window has 1 to 8 samples a side; set Descriptor::m to one of them";
    stage.run(60);
    refused(&mut stage, DeferredAaError::Node(e.into()));

    // And back.
    insert(&mut stage, camera, DeferredAa::default());
    stage.world().entity_mut(camera).insert(TemporalJitter::default());
    stage.run(6);
    assert_eq!(stage.state(camera), DeferredAaState::Refused(DeferredAaError::Jitter));
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn a_camera_without_the_prepass_is_rendered_as_without() {
    let (mut stage, camera, target) = stage([64, 48]);
    // With the DepthPrepass alone Bevy panics.
    stage.world().entity_mut(camera).insert(DeferredAa::default()).remove::<(DeferredPrepass, DepthPrepass)>();
    stage.run(12);
    assert_eq!(stage.state(camera), DeferredAaState::Refused(DeferredAaError::NoPrepass));
    let with = stage.picture(&target);
    stage.world().entity_mut(camera).remove::<DeferredAa>();
    stage.run(4);
    assert!(stage.picture(&target) == with, "the image differs");
    assert_eq!(logged("the camera has no DeferredPrepass"), 1);
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// How often a message with this text was logged by any test.
fn logged(text: &str) -> usize {
    plugins::LOGGED.lock().expect("no panic").iter().filter(|message| message.contains(text)).count()
}

/// The limits of WebGL, where nothing can be computed.
#[test]
fn an_adapter_without_what_it_takes_renders_as_without() {
    let on_web = |has: bool| {
        let settings = WgpuSettings {
            priority: WgpuSettingsPriority::WebGL2,
            limits: WgpuLimits::downlevel_webgl2_defaults(),
            ..Default::default()
        };
        let (mut stage, camera, target) = filled(Stage::with(settings, |_| {}), [64, 48]);
        // WebGL does not filter its format.
        stage.world().entity_mut(camera).remove::<(Skybox, EnvironmentMapLight)>();
        if has {
            stage.world().entity_mut(camera).insert(DeferredAa::default());
        }
        stage.run(12);
        if has {
            let start = std::time::Instant::now();
            while stage.state(camera) == DeferredAaState::Waiting {
                assert!(start.elapsed().as_secs() < 300, "not refused");
                stage.run(1);
            }
            stage.run(6);
        }
        (stage.picture(&target), stage.state(camera), stage.complaints())
    };
    let (without, _, complaints) = on_web(false);
    let (with, state, more) = on_web(true);
    let DeferredAaState::Refused(DeferredAaError::Adapter(missing)) = state else { panic!("{state:?}") };
    assert!(missing.iter().any(|missing| missing.contains("max_compute_workgroup_size_x")), "{missing:?}");
    assert!(with == without, "the image differs");
    assert_eq!(more, complaints);
    assert_eq!(logged("this adapter lacks"), 1);
}

/// Bevy turns multisampling off, and its images are those without.
#[test]
fn multisampling_is_off() {
    let (mut stage, camera, target) = stage([64, 48]);
    insert(&mut stage, camera, DeferredAa::default());
    let before = stage.picture(&target);
    stage.world().entity_mut(camera).insert(Msaa::Sample4);
    stage.run(6);
    assert_eq!(stage.state(camera), DeferredAaState::Active);
    assert!(stage.picture(&target) == before, "the image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn forward_meshes_are_drawn_as_without() {
    let (mut stage, camera, target) = stage([64, 48]);
    stage.world().insert_resource(DefaultOpaqueRendererMethod::forward());
    stage.run(12);
    let without = stage.picture(&target);
    insert(&mut stage, camera, DeferredAa::default());
    let psnr = stage.picture(&target).psnr(&without);
    assert!(psnr >= 60.0, "{psnr} dB");
    assert_eq!(logged("none of the meshes that it sees is deferred"), 1);
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// A material of the app's own upon Bevy's.
#[derive(Asset, AsBindGroup, TypePath, Clone, Default)]
struct Striped {}

const STRIPED: Handle<Shader> = uuid_handle!("5f0c9c3e-5f44-4d6e-9f0c-8a3a2b1c7d10");

impl MaterialExtension for Striped {
    fn deferred_fragment_shader() -> ShaderRef {
        STRIPED.into()
    }
}

const STRIPED_WESL: &str = "
import bevy_pbr::{
    deferred::functions::deferred_output,
    prepass::io::{FragmentOutput, VertexOutput},
    render::pbr_fragment::pbr_input_from_standard_material,
};

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    var pbr = pbr_input_from_standard_material(in, is_front);
    if fract(in.world_position.y * 4.0) < 0.5 {
        pbr.material.base_color = vec4(1.0, 0.0, 1.0, 1.0);
    }
    return deferred_output(in, pbr);
}
";

#[test]
fn morphed_meshes_and_extended_materials_are_bevys_own() {
    let with_both = |scale: u32| {
        let stage = Stage::with(WgpuSettings::default(), |app| {
            app.add_plugins(MaterialPlugin::<ExtendedMaterial<StandardMaterial, Striped>>::default());
        });
        let (mut stage, camera, target) = filled(stage, SIZE.map(|side| side * scale));
        let world = stage.world();
        let shader = Shader::from_wesl(STRIPED_WESL, "tests/striped.wesl");
        world.resource_mut::<Assets<Shader>>().insert(STRIPED.id(), shader).expect("the shader");
        let mut mesh = Mesh::from(bevy_shape::prelude::Sphere::new(0.4));
        // It grows to twice the height.
        let positions = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|p| p.as_float3()).expect("positions");
        let taller = |p: &[f32; 3]| MorphAttributes::new(Vec3::new(0.0, 2.0 * p[1], 0.0), Vec3::ZERO, Vec3::ZERO);
        let targets = positions.iter().map(taller).collect();
        mesh.set_morph_targets(targets);
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        let material = ExtendedMaterial { base: StandardMaterial::default(), extension: Striped::default() };
        let material = world.resource_mut::<Assets<ExtendedMaterial<_, _>>>().add(material);
        let weights = MeshMorphWeights::Value { weights: vec![0.5] };
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), weights, Transform::from_xyz(0.6, 1.4, 2.0)));
        stage.run(12);
        (stage, camera, target)
    };
    let (mut large, _, large_target) = with_both(2);
    let truth = large.picture(&large_target).reduced(2);
    let magenta = |p: &[f32; 3]| p[0] > 4.0 * p[1] && p[2] > 4.0 * p[1];
    let rows = (0..truth.size[1]).filter(|y| truth.pixels[y * truth.size[0]..][..truth.size[0]].iter().any(magenta));
    let rows = rows.count();
    println!("stripes in {rows} rows");
    let (mut stage, camera, target) = with_both(1);
    insert(&mut stage, camera, DeferredAa::full(2));
    let psnr = stage.picture(&target).psnr(&truth);
    println!("{psnr:.1} dB");
    assert!(rows > 15 && psnr >= 50.0, "stripes in {rows} rows, {psnr} dB");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// What effects that read the G-buffer of Bevy's own size add to the image, where that has enough samples.
#[test]
fn screen_space_effects_add_what_they_add_to_bevys_own() {
    let (mut stage, camera, target) = stage(SIZE);
    let world = stage.world();
    let mirror = world.resource_mut::<Assets<Mesh>>().add(Mesh::from(bevy_shape::prelude::Cuboid::new(5.0, 0.1, 2.0)));
    let material = StandardMaterial { metallic: 1.0, perceptual_roughness: 0.12, ..Default::default() };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
    world.spawn((Mesh3d(mirror), MeshMaterial3d(material), Transform::from_xyz(0.0, 0.0, 3.0)));
    stage.run(12);
    let plain = stage.picture(&target);
    insert(&mut stage, camera, DeferredAa::full(2));
    let ours = stage.picture(&target);
    stage.world().entity_mut(camera).remove::<DeferredAa>();
    // Reflections are sampled anew in every frame.
    let mean = |stage: &mut Stage| {
        let mut sum = stage.picture(&target);
        for i in 1..16 {
            stage.run(1);
            let next = stage.picture(&target);
            let share = 1.0 / (i as f32 + 1.0);
            for (mean, new) in sum.pixels.iter_mut().zip(next.pixels) {
                *mean = [0, 1, 2].map(|c| mean[c] + (new[c] - mean[c]) * share);
            }
        }
        sum
    };
    let check = |stage: &mut Stage, name: &str| {
        stage.run(12);
        let without = mean(stage);
        let added = |i: usize, c: usize| ours.pixels[i][c] + without.pixels[i][c] - plain.pixels[i][c];
        let pixels = (0..ours.pixels.len()).map(|i| [0, 1, 2].map(|c| added(i, c))).collect();
        let expected = Picture { size: ours.size, pixels };
        insert(stage, camera, DeferredAa::full(2));
        let with = mean(stage);
        let enough = |i: usize| (0..3).all(|c| (plain.pixels[i][c] - ours.pixels[i][c]).abs() < 0.01);
        let (found, effect) = (with.psnr_where(&expected, enough), expected.psnr_where(&ours, enough));
        println!("{name}: {found:.1} dB, and {effect:.1} dB from the image without it");
        assert!(found >= effect + 6.0 && effect < 50.0, "{name}: {found} dB, without the effect {effect} dB");
        stage.world().entity_mut(camera).remove::<DeferredAa>();
    };
    stage.world().entity_mut(camera).insert(ScreenSpaceAmbientOcclusion::default());
    check(&mut stage, "SSAO");
    // The prepass of normals stays.
    stage.world().entity_mut(camera).remove::<ScreenSpaceAmbientOcclusion>();
    stage.world().entity_mut(camera).insert((ScreenSpaceReflections::default(), MotionVectorPrepass));
    check(&mut stage, "SSR");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// Settings that no frame here can have, from the start and under way, and their mending.
#[test]
fn what_can_t_be_recorded_is_refused_until_it_changes() {
    let (mut stage, camera, target) = stage([64, 48]);
    stage.run(12);
    let without = stage.picture(&target);
    let vain = Settings { shadows: Effect::On, ..DeferredAa::default().settings };
    let refused = |stage: &mut Stage| {
        stage.world().entity_mut(camera).insert(DeferredAa { settings: vain, ..DeferredAa::default() });
        let start = std::time::Instant::now();
        while !matches!(stage.state(camera), DeferredAaState::Refused(_)) {
            assert!(start.elapsed().as_secs() < 300, "not refused");
            stage.run(1);
        }
        stage.run(6);
        let DeferredAaState::Refused(e) = stage.state(camera) else { panic!("not refused any more") };
        assert!(e.to_string().contains("Descriptor::rays"), "{e}");
        assert!(stage.picture(&target) == without, "the image differs");
    };
    refused(&mut stage);
    insert(&mut stage, camera, DeferredAa::default());
    let with = stage.picture(&target);
    refused(&mut stage);
    insert(&mut stage, camera, DeferredAa::default());
    assert!(stage.picture(&target) == with, "the image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn split_screens_show_what_whole_ones_do() {
    let (mut stage, camera, target) = stage(SIZE);
    insert(&mut stage, camera, DeferredAa::full(2));
    let whole = stage.picture(&target);

    // The same camera twice, in two corners of a larger image.
    let size = SIZE.map(|side| side * 2 + 10);
    let large = stage.target(size);
    let surroundings = scene::surroundings(stage.world());
    let places = [[0, 0], [SIZE[0] + 7, SIZE[1] + 3]];
    let cameras = places.map(|[x, y]| {
        let camera = stage.camera(&large, (surroundings.clone(), scene::eye(), DeferredAa::full(2)));
        let viewport = Viewport {
            physical_position: UVec2::new(x, y),
            physical_size: UVec2::from_array(SIZE),
            ..Default::default()
        };
        let mut settings = stage.world().get_mut::<bevy_camera::Camera>(camera).expect("a camera");
        settings.viewport = Some(viewport);
        settings.order = isize::from(x > 0) + 1;
        if x > 0 {
            settings.clear_color = bevy_camera::ClearColorConfig::None;
        }
        camera
    });
    cameras.into_iter().for_each(|camera| run_until_active(&mut stage, camera));
    let picture = stage.picture(&large);
    for [x, y] in places.map(|place| place.map(|c| c as usize)) {
        let row = |r: usize| &picture.pixels[(y + r) * picture.size[0] + x..][..whole.size[0]];
        let part = Picture { size: whole.size, pixels: (0..whole.size[1]).flat_map(|r| row(r).to_vec()).collect() };
        let psnr = part.psnr(&whole);
        assert!(psnr >= 60.0, "at {x}, {y}: {psnr} dB");
    }
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

#[test]
fn sizes_techniques_and_the_component_change_without_complaint() {
    if runs_elsewhere("sizes_techniques_and_the_component_change_without_complaint") {
        return;
    }
    let (mut stage, camera, target) = stage([64, 48]);
    insert(&mut stage, camera, DeferredAa::default());
    // A second camera into a target of its own, which stays as it is.
    let other = stage.target([40, 30]);
    let surroundings = scene::surroundings(stage.world());
    let second = stage.camera(&other, (surroundings, scene::eye(), DeferredAa::default()));
    run_until_active(&mut stage, second);
    let before = stage.picture(&other);
    let mut held = Vec::new();
    for i in 0..200u32 {
        let size = [1 + i * 37 % 96, 1 + i * 53 % 80];
        resize(&mut stage, &target, size);
        if i % 4 == 1 {
            stage.world().entity_mut(camera).remove::<DeferredAa>();
        } else {
            let technique = Technique::ALL[i as usize / 4 % Technique::ALL.len()];
            let settings = Settings { technique, ..Settings::default() };
            stage.world().entity_mut(camera).insert(DeferredAa { m: 4, settings, statistics: true });
        }
        stage.run(1);
        assert_eq!(stage.picture(&target).size, size.map(|side| side as usize));
        held.extend(memory());
    }
    assert!(stage.picture(&other) == before, "the other camera's image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
    // Every technique has been compiled by then, and every size was there.
    if let (Some(half), Some(end)) = (held.get(99), held.last()) {
        println!("{} MB after 100 sizes, {} MB after 200", half / 1_000_000, end / 1_000_000);
        assert!(*end < half + 60_000_000, "{half} bytes after 100 sizes, {end} after 200");
    }
}

#[test]
fn a_camera_that_rests_holds_nothing_and_comes_back() {
    let (mut stage, camera, target) = stage([64, 48]);
    insert(&mut stage, camera, DeferredAa::full(2));
    let before = stage.picture(&target);
    let activate = |stage: &mut Stage, is_active| {
        stage.world().get_mut::<bevy_camera::Camera>(camera).expect("a camera").is_active = is_active;
        stage.run(3);
    };
    activate(&mut stage, false);
    activate(&mut stage, true);
    resize(&mut stage, &target, [1, 1]);
    stage.run(3);
    resize(&mut stage, &target, [64, 48]);
    stage.run(3);
    assert!(stage.picture(&target) == before, "the image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

fn resize(stage: &mut Stage, target: &bevy_asset::Handle<bevy_image::Image>, [width, height]: [u32; 2]) {
    let mut images = stage.world().resource_mut::<bevy_asset::Assets<bevy_image::Image>>();
    let size = bevy_render::render_resource::Extent3d { width, height, depth_or_array_layers: 1 };
    images.get_mut(target).expect("the target").resize(size);
}

/// Runs a test of this file again, in a process where no other test takes memory: `false` in that process.
fn runs_elsewhere(name: &str) -> bool {
    const ALONE: &str = "DEFERRED_AA_ALONE";
    if std::env::var(ALONE).is_ok_and(|alone| alone == name) {
        return false;
    }
    let output = std::process::Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", name, "--nocapture", "--test-threads", "1"])
        .env(ALONE, name)
        .output()
        .expect("a process");
    let out = String::from_utf8_lossy(&output.stdout);
    println!("{out}{}", String::from_utf8_lossy(&output.stderr));
    // A name that no test has would succeed, too.
    assert!(output.status.success() && out.contains("1 passed"), "{name}: {}", output.status);
    true
}

/// The memory of this process, with that of a driver that runs on the CPU.
fn memory() -> Option<u64> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split(' ').nth(1)?.parse::<u64>().ok()? * 4096)
}

/// Fifty times on and off leave nothing behind.
#[test]
fn the_component_comes_and_goes() {
    if runs_elsewhere("the_component_comes_and_goes") {
        return;
    }
    let (mut stage, camera, target) = stage([64, 48]);
    insert(&mut stage, camera, DeferredAa::default());
    let with = stage.picture(&target);
    let mut held = Vec::new();
    for _ in 0..50 {
        stage.world().entity_mut(camera).remove::<DeferredAa>();
        stage.run(2);
        stage.world().entity_mut(camera).insert(DeferredAa::default());
        stage.run(3);
        assert!(stage.picture(&target) == with, "the image differs");
        held.extend(memory());
    }
    if let (Some(early), Some(end)) = (held.get(9), held.last()) {
        println!("{} MB after 10 times, {} MB after 50", early / 1_000_000, end / 1_000_000);
        assert!(*end < early + 30_000_000, "{early} bytes after 10 times, {end} after 50");
    }
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// As when shaders are edited while the app runs.
#[test]
fn a_shader_that_changes_is_composed_again() {
    let (mut stage, camera, target) = stage([64, 48]);
    stage.run(12);
    let off = stage.picture(&target);
    insert(&mut stage, camera, DeferredAa::default());
    let before = stage.picture(&target);
    let edit = |stage: &mut Stage, from: &str, to: &str| {
        let mut shaders = stage.world().resource_mut::<Assets<Shader>>();
        let ours = |(_, shader): &(_, &Shader)| shader.path.ends_with("bevy_deferred_aa/shading.wesl");
        let (id, shader) = shaders.iter().find(ours).map(|(id, shader)| (id, shader.clone())).expect("our shader");
        let text = shader.source.as_str().replace(from, to);
        assert_ne!(text, shader.source.as_str());
        let edited = Shader::from_wesl(text, shader.path.clone());
        shaders.insert(id, edited).expect("the shader");
        stage.run(2);
    };
    edit(&mut stage, "radiance = apply_pbr_lighting(pbr);", "radiance = vec4(8.0, 0.0, 0.0, 1.0);");
    run_until_active(&mut stage, camera);
    let red = stage.picture(&target);
    assert!(red.pixels.iter().filter(|p| p[0] > 4.0 && p[1] < 2.0).count() > red.pixels.len() / 4, "not red");
    edit(&mut stage, "vec4(8.0, 0.0, 0.0, 1.0)", "vec4(8.0,,)");
    stage.run(4);
    let DeferredAaState::Refused(DeferredAaError::Compose(e)) = stage.state(camera) else { panic!("not refused") };
    assert!(e.contains("shading.wesl"), "{e}");
    assert!(stage.picture(&target) == off, "not Bevy's own image");
    edit(&mut stage, "vec4(8.0,,)", "apply_pbr_lighting(pbr)");
    run_until_active(&mut stage, camera);
    assert!(stage.picture(&target) == before, "the image differs");
    assert_eq!(stage.complaints(), Vec::<String>::new());
}

/// All fields by name, as an inspector does.
#[test]
fn settings_are_reflected() {
    let mut aa = DeferredAa::default();
    aa.reflect_path_mut("settings.surfaces.spread").expect("a field").apply(&0.5f32);
    aa.reflect_path_mut("settings.windowed.two_sided").expect("a field").apply(&true);
    assert_eq!((aa.settings.surfaces.spread, aa.settings.windowed.two_sided), (0.5, true));
    let reflected = aa.reflect_clone().expect("a clone").take::<DeferredAa>().expect("the type");
    assert_eq!(reflected, aa);
}
