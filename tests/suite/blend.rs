//! Blended surfaces of the demo: by the over operator, in order, behind what hides them, and lit as all others are.

use crate::reflections_twin::{at, block, faces, scaled, scene, turned};
use crate::shadows::{full, looking};
use crate::visibility::{self, adapter, has_ids};
use deferred_aa::glam::{Mat4, Vec3, Vec4, vec3};
use deferred_aa::{DebugView, Effect, GBufferTier, Settings, SizeError, Technique};
use deferred_aa_demo::host::{Host, HostError, gbuffer_tier};
use deferred_aa_demo::measure::reference::MovedFrames;
use deferred_aa_demo::raster::node_camera;
use deferred_aa_demo::scene::{Camera, Material, Mesh, Scene, Sun, builtin};

const SIZE: [u32; 2] = [64, 48];

const WALL: Vec4 = Vec4::new(0.1, 0.8, 0.3, 1.0);
const FAR: Vec4 = Vec4::new(0.9, 0.2, 0.0, 0.5);
const NEAR: Vec4 = Vec4::new(0.05, 0.3, 1.0, 0.25);
const BLOCKER: Vec4 = Vec4::new(0.6, 0.5, 0.4, 1.0);

fn camera() -> Camera {
    looking(Vec3::ZERO, Vec3::NEG_Z, 0.1)
}

fn plain() -> Material {
    builtin::builtin("flat").expect("a scene").materials[0].clone()
}

fn paint(base_color: Vec4) -> Material {
    Material { base_color, unlit: true, blended: base_color.w < 1.0, ..plain() }
}

fn white(mut mesh: Mesh) -> Mesh {
    mesh.colors.fill(Vec4::ONE);
    mesh
}

/// An upright square that faces the camera.
fn square(material: usize, [x, y, z]: [f32; 3], half: f32) -> (Mesh, Mat4) {
    (white(faces(material, &[2])), at(x, y, z - 1.0) * scaled(half, half, 1.0))
}

/// Two panes that overlap before a wall, and a block before both.
fn panes() -> Scene {
    let blocker = square(3, [0.0, 0.0, -1.0], 0.05);
    let placed = vec![
        square(2, [0.3, 0.0, -1.5], 0.5),
        square(1, [-0.3, 0.0, -2.0], 0.5),
        square(0, [0.0, 0.0, -4.0], 8.0),
        blocker,
    ];
    Scene { materials: [WALL, FAR, NEAR, BLOCKER].map(paint).to_vec(), ..scene(placed) }
}

/// The way of a ray, of depth 1, and the colours that it meets, the nearest first.
const RAYS: [([f32; 2], &[Vec4]); 6] = [
    ([0.0, 0.1], &[NEAR, FAR, WALL]),
    ([0.0, -0.15], &[NEAR, FAR, WALL]),
    ([-0.25, 0.0], &[FAR, WALL]),
    ([0.25, 0.1], &[NEAR, WALL]),
    ([-0.45, 0.0], &[WALL]),
    ([0.0, 0.0], &[BLOCKER]),
];

fn over(met: &[Vec4]) -> Vec3 {
    met.iter().rev().fold(Vec3::ZERO, |behind, c| c.truncate() * c.w + behind * (1.0 - c.w))
}

/// Holds pixels inside the panes, and beside them, against the colours that their rays meet.
fn assert_over(picture: &deferred_aa_demo::picture::Picture, what: &str) {
    let camera = node_camera(&camera(), picture.width, picture.height);
    for (way, met) in RAYS {
        let ndc = camera.clip_from_view.project_point3(vec3(way[0], way[1], -1.0));
        let x = ((ndc.x + 1.0) * 0.5 * picture.width as f32) as u32;
        let y = ((1.0 - ndc.y) * 0.5 * picture.height as f32) as u32;
        let found = picture.rgba[(y * picture.width + x) as usize];
        let expected = over(met).extend(1.0);
        // Each layer is rounded to 11 bits.
        assert!((Vec4::from(found) - expected).abs().max_element() < 2e-3, "{what}: {found:?}, not {expected}");
    }
}

fn tiers(scene: &Scene) -> Vec<GBufferTier> {
    let mut tiers = vec![GBufferTier::default()];
    if has_ids() {
        tiers.push(gbuffer_tier(scene, &adapter()));
    }
    tiers
}

fn picture(host: &mut Host, settings: Settings) -> Vec<[f32; 4]> {
    host.frame(&camera(), settings).expect("a frame");
    assert_eq!(host.gpu.take_errors(), Vec::<String>::new());
    host.picture().rgba
}

#[test]
fn panes_are_mixed_by_the_over_operator() {
    let made = panes();
    for tier in tiers(&made) {
        let mut host = visibility::host(made.clone(), 2, SIZE, tier);
        for technique in Technique::ALL {
            let settings = Settings { technique, ..Default::default() };
            picture(&mut host, settings);
            assert_over(&host.picture(), &format!("{technique:?} on {tier:?}"));
            host.shade_again(&camera(), settings).expect("a frame");
            assert_over(&host.picture(), &format!("{technique:?} on {tier:?}, again"));
        }
        // A truth is the mean of moved frames.
        let mut frames = MovedFrames::new((SIZE[0], SIZE[1]), 4, 2);
        for _ in 0..frames.progress().1 {
            host.frame_with(frames.moved(node_camera(&camera(), SIZE[0], SIZE[1])), full()).expect("a frame");
            frames.add(&host.picture());
        }
        assert_over(&frames.mean(), &format!("the truth on {tier:?}"));
        host.resize(80, 50).expect("a size");
        picture(&mut host, full());
        assert_over(&host.picture(), &format!("{tier:?} of another size"));
    }
}

/// Along the edges of a block before a pane that lets nothing through, nothing of the wall behind both is seen.
#[test]
fn no_background_shines_through_at_edges() {
    let opaque = Material { blended: true, ..paint(Vec4::new(FAR.x, FAR.y, FAR.z, 1.0)) };
    let placed =
        vec![square(0, [0.0, 0.0, -4.0], 8.0), square(1, [0.0, 0.0, -2.0], 4.0), square(2, [0.013, 0.007, -1.0], 0.1)];
    let made = Scene { materials: vec![paint(WALL), opaque, paint(BLOCKER)], ..scene(placed) };
    let mut host = visibility::host(made, 4, SIZE, GBufferTier::default());
    let seen = picture(&mut host, full());
    assert!(seen.iter().any(|c| (c[1] - BLOCKER.y).abs() < 1e-3) && seen.iter().any(|c| (c[1] - FAR.y).abs() < 1e-3));
    let greenest = seen.iter().map(|c| c[1]).fold(0.0, f32::max);
    assert!(greenest < BLOCKER.y + 1e-3, "{greenest}");
}

/// Whatever the order of the scene's instances, with the same bits; and panes of the same distance stay in one order.
#[test]
fn the_order_of_instances_makes_no_difference() {
    let mut made = panes();
    let beside = square(1, [0.0, 0.0, -1.5], 0.3);
    made.meshes.push(beside.0);
    let mesh = made.meshes.len() - 1;
    made.instances.push(deferred_aa_demo::scene::Instance { mesh, world_from_mesh: beside.1, object: 9 });
    for tier in tiers(&made) {
        let mut reversed = made.clone();
        reversed.instances.reverse();
        let [mut one, mut other] = [made.clone(), reversed].map(|scene| visibility::host(scene, 2, SIZE, tier));
        assert!(picture(&mut one, full()) == picture(&mut other, full()), "{tier:?}");
    }
}

#[test]
fn bands_are_drawn_over_once() {
    let made = panes();
    for tier in tiers(&made) {
        let mut whole = visibility::host(made.clone(), 2, SIZE, tier);
        let mut banded = Host::within(whole.gpu.clone(), made.clone(), whole.options, Some(0)).expect("a host");
        for technique in Technique::ALL {
            let settings = Settings { technique, ..Default::default() };
            banded.memory = Some(0);
            let Err(HostError::Size(SizeError::Limit { least, .. })) = banded.bands(&settings) else {
                panic!("no limit")
            };
            banded.memory = Some(least);
            assert!(banded.bands(&settings).expect("bands").len() > 1);
            let expected = picture(&mut whole, settings);
            assert!(picture(&mut banded, settings) == expected, "{technique:?} on {tier:?}");
        }
    }
}

/// Back faces are seen of double-sided materials alone, of mirrored instances, too.
#[test]
fn back_faces_are_seen_of_double_sided_panes() {
    let wall = || square(0, [0.0, 0.0, -4.0], 8.0);
    for (double_sided, turns, mirrors) in
        [(false, false, false), (false, true, false), (true, true, false), (false, false, true), (false, true, true)]
    {
        let turn = Mat4::from_rotation_y(if turns { std::f32::consts::PI } else { 0.0 });
        let mirror = scaled(if mirrors { -1.0 } else { 1.0 }, 1.0, 1.0);
        let pane = (white(faces(1, &[2])), at(0.0, 0.0, -2.0) * turn * at(0.0, 0.0, -1.0) * mirror);
        let pane_paint = Material { double_sided, ..paint(FAR) };
        let made = Scene { materials: vec![paint(WALL), pane_paint], ..scene(vec![wall(), pane]) };
        let mut host = visibility::host(made, 1, SIZE, GBufferTier::default());
        let middle = picture(&mut host, full())[(24 * 64 + 32) as usize];
        let expected = if double_sided || !turns { over(&[FAR, WALL]) } else { WALL.truncate() };
        let what = format!("{double_sided} {turns} {mirrors}: {middle:?}, not {expected}");
        assert!((Vec4::from(middle).truncate() - expected).abs().max_element() < 2e-3, "{what}");
    }
}

/// A blended surface that lets nothing through looks as an opaque one does, from all sides.
#[test]
fn blended_surfaces_are_lit_as_others() {
    let made = |blended| {
        let placed = vec![
            (white(block(0)), at(-1.2, 0.2, -4.0) * turned(0.6)),
            (white(block(0)), at(1.3, -0.2, -5.0) * turned(2.1) * scaled(-1.0, 1.0, 0.7)),
            square(1, [0.0, 0.0, -8.0], 9.0),
        ];
        let own =
            Material { base_color: Vec4::new(0.7, 0.5, 0.3, 1.0), roughness: 0.4, metallic: 0.3, blended, ..plain() };
        let sun = Sun { to_sun: vec3(0.4, 0.7, 0.6).normalize(), irradiance: Vec3::splat(2.0), casts: false };
        Scene { materials: vec![own, plain()], sun: Some(sun), ..scene(placed) }
    };
    for blended in [false, true] {
        let [mut expected, mut found] =
            [made(false), made(blended)].map(|scene| visibility::host(scene, 1, [96, 72], GBufferTier::default()));
        let (expected, found) = (picture(&mut expected, full()), picture(&mut found, full()));
        let apart = |(a, b): (&[f32; 4], &[f32; 4])| (Vec4::from(*a) - Vec4::from(*b)).abs().max_element();
        let differ = expected.iter().zip(&found).filter(|&pair| apart(pair) > 4e-3).count();
        // A pixel at an edge may be covered by the one and not by the other.
        assert!(differ <= if blended { 20 } else { 0 }, "{differ} pixels differ");
    }
}

/// A pane between the sun and the wall takes no light from it, as rays don't meet it.
#[test]
fn blended_surfaces_cast_no_shadow() {
    let lit = |pane: Option<Material>| {
        let mut placed = vec![square(0, [0.0, 0.0, -4.0], 8.0)];
        // Behind the camera.
        placed.extend(pane.is_some().then(|| square(1, [0.0, 0.0, 1.0], 8.0)));
        let sun = Sun { to_sun: Vec3::Z, irradiance: Vec3::splat(2.0), casts: true };
        let materials = vec![plain(), pane.unwrap_or(plain())];
        let made = Scene { materials, sun: Some(sun), ..scene(placed) };
        let mut host = visibility::host(made, 1, SIZE, GBufferTier::default());
        picture(&mut host, Settings { shadows: Effect::On, ..full() })
    };
    let bare = lit(None);
    assert!(lit(Some(Material { unlit: false, ..paint(FAR) })) == bare);
    assert!(lit(Some(plain())) != bare, "an opaque one does");
}

/// Views of something else than the image stay what they are.
#[test]
fn views_are_not_drawn_over() {
    let without = |mut scene: Scene| {
        scene.instances.retain(|i| !scene.materials[scene.meshes[i.mesh].material].blended);
        scene
    };
    let mut one = visibility::host(panes(), 2, SIZE, GBufferTier::default());
    let mut other = visibility::host(without(panes()), 2, SIZE, GBufferTier::default());
    for view in [DebugView::Count, DebugView::First, DebugView::Depth] {
        let settings = Settings { view, ..Default::default() };
        assert!(picture(&mut one, settings) == picture(&mut other, settings), "{view:?}");
    }
    assert!(picture(&mut one, full()) != picture(&mut other, full()));
}
