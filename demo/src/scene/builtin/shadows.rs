//! Shadows of thin casters: lattices over a ground to the horizon, a perforated sheet, and a ball with few triangles,
//! under a sun and a spot that cast and a lamp that does not.

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::paint;
use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Light, LightKind, Material, Sun};

/// Along one side of a pergola.
const SIDE: f32 = 3.0;
const HEIGHT: f32 = 2.2;
const PERGOLAS: usize = 14;

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    stage.sun(Sun {
        to_sun: Vec3::new(-0.55, 0.75, -0.3).normalize(),
        irradiance: Vec3::new(1.0, 0.94, 0.84) * PI,
        casts: true,
    });
    let stone = stage.material(Material { base_color: srgb(0xc9c2b4), ..matt("ground") });
    let wood = stage.material(Material { base_color: srgb(0x8a6a48), roughness: 0.8, ..matt("wood") });
    let steel = stage.material(Material { base_color: srgb(0x3a3f44), roughness: 0.5, ..matt("steel") });
    let chalk = stage.material(Material { base_color: srgb(0xe6e2da), ..matt("chalk") });

    let mut plane = Shape::default();
    let origin = Vec3::new(-800.0, 0.0, 60.0);
    plane.quad(origin, Vec3::X * 1600.0, Vec3::NEG_Z * 1600.0, Vec2::ZERO, Vec2::ONE);
    stage.draw("ground", plane, stone);

    let frame = stage.mesh("pergola", pergola(), wood);
    let wires = stage.mesh("wires", wires(), steel);
    for i in 0..PERGOLAS {
        let z = -(SIDE + 1.0) * i as f32;
        stage.place(frame, Mat4::from_translation(Vec3::new(-2.4, 0.0, z)));
        stage.place(wires, Mat4::from_translation(Vec3::new(2.4, 0.0, z)));
    }
    sheet(&mut stage);

    // Coarse enough for its triangles to show, were they to shadow each other.
    let mut ball = Shape::default();
    ball.ball(0.55, 12);
    let mesh = stage.mesh("coarse ball", ball, chalk);
    stage.place(mesh, Mat4::from_translation(Vec3::new(0.0, 0.55, -1.6)));

    let down = Vec3::new(0.25, -1.0, -0.1).normalize();
    stage.light(Light {
        kind: LightKind::Spot { inner: 0.3, outer: 0.5 },
        position: Vec3::new(-0.5, 4.5, -0.8),
        direction: down,
        intensity: Vec3::new(1.0, 0.5, 0.25) * 40.0,
        range: 30.0,
        casts: true,
    });
    stage.point_light(Vec3::new(5.0, 3.0, 4.0), Vec3::new(0.5, 0.7, 1.0) * 9.0, f32::INFINITY);
    stage.camera(perspective(Vec3::new(0.3, 2.0, 4.6), Vec3::new(0.0, 0.6, -4.0), 52.0, 0.05));
    stage
}

/// Laths on four posts.
fn pergola() -> Shape {
    let mut shape = Shape::default();
    let half = SIDE / 2.0;
    for (x, z) in [(-half, -half), (half, -half), (half, half), (-half, half)] {
        shape.cuboid(Vec3::new(x - 0.05, 0.0, z - 0.05), Vec3::new(x + 0.05, HEIGHT, z + 0.05));
    }
    for i in 0..=20 {
        let at = -half + SIDE * i as f32 / 20.0;
        shape.cuboid(Vec3::new(-half, HEIGHT, at - 0.012), Vec3::new(half, HEIGHT + 0.06, at + 0.012));
    }
    for i in 0..=6 {
        let at = -half + SIDE * i as f32 / 6.0;
        shape.cuboid(Vec3::new(at - 0.02, HEIGHT - 0.05, -half), Vec3::new(at + 0.02, HEIGHT, half));
    }
    shape
}

/// A net of wires far thinner than a pixel, on four posts.
fn wires() -> Shape {
    let mut shape = Shape::default();
    let half = SIDE / 2.0;
    for (x, z) in [(-half, -half), (half, -half), (half, half), (-half, half)] {
        shape.bar(Vec3::new(x, 0.0, z), Vec3::new(x, HEIGHT, z), 0.03, 8);
    }
    for i in 0..=24 {
        let at = -half + SIDE * i as f32 / 24.0;
        shape.bar(Vec3::new(-half, HEIGHT, at), Vec3::new(half, HEIGHT, at), 0.004, 5);
        shape.bar(Vec3::new(at, HEIGHT, -half), Vec3::new(at, HEIGHT, half), 0.004, 5);
    }
    shape
}

/// An upright sheet with round holes, which are its texture's.
fn sheet(stage: &mut Stage) {
    let image = paint::masked(256, 256, |at| {
        let cell = (at * 8.0).fract() - 0.5;
        (Vec3::new(0.8, 0.45, 0.4), paint::step(0.28, 0.32, cell.length()))
    });
    let image = stage.image("holes", image);
    let base_color_texture = stage.color_texture(image);
    let perforated =
        stage.material(Material { base_color_texture, alpha_cutoff: Some(0.5), double_sided: true, ..matt("sheet") });
    let mut shape = Shape::default();
    shape.quad(Vec3::new(-1.1, 0.0, -3.4), Vec3::X * 2.2, Vec3::Y * 1.6, Vec2::ZERO, Vec2::new(2.2, 1.6));
    stage.draw("sheet", shape, perforated);
}
