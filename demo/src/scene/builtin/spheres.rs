//! Spheres from mirror to chalk under small bright lights: highlights far above white that flicker.

use glam::{Mat4, Vec2, Vec3};

use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Material, Sky, Sun};

const COLUMNS: u32 = 9;
const RADIUS: f32 = 0.46;

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    // Dim surroundings, so that the highlights stand out.
    stage.sky(Sky {
        zenith: Vec3::new(0.05, 0.07, 0.12),
        horizon: Vec3::new(0.22, 0.24, 0.28),
        ground: Vec3::new(0.08, 0.075, 0.07),
    });
    stage.sun(Sun { to_sun: Vec3::new(-0.4, 0.7, 0.6).normalize(), irradiance: Vec3::splat(1.2), casts: false });

    let table = stage.material(Material { base_color: srgb(0x6a6a6e), roughness: 0.5, ..matt("table") });
    let mut plane = Shape::default();
    let (u, v) = (Vec3::X * 60.0, Vec3::NEG_Z * 60.0);
    plane.quad(Vec3::new(-30.0, -RADIUS, 20.0), u, v, Vec2::ZERO, Vec2::splat(60.0));
    stage.draw("table", plane, table);

    for (row, (color, metallic)) in
        [(0xf4f0e8, 0.0), (0xb8342c, 0.0), (0xffdb91, 1.0), (0xf0f0f0, 1.0)].into_iter().enumerate()
    {
        for column in 0..COLUMNS {
            let roughness = column as f32 / (COLUMNS - 1) as f32;
            let name = format!("row {row} roughness {roughness:.2}");
            let material = stage.material(Material { base_color: srgb(color), metallic, roughness, ..matt(&name) });
            let mut ball = Shape::default();
            ball.ball(RADIUS, 40);
            let mesh = stage.mesh(&name, ball, material);
            let x = column as f32 - (COLUMNS - 1) as f32 / 2.0;
            // Rows rise towards the back, so that none hides another.
            stage.place(mesh, Mat4::from_translation(Vec3::new(x, row as f32 * 0.55, -(row as f32) * 1.1)));
        }
    }
    let warm = Vec3::new(1.0, 0.85, 0.65);
    let cold = Vec3::new(0.65, 0.8, 1.0);
    for (x, tint) in [(-6.0, warm), (-2.0, cold), (2.0, warm), (6.0, cold)] {
        stage.point_light(Vec3::new(x, 5.0, 2.5), tint * 22.0, f32::INFINITY);
    }
    stage.camera(perspective(Vec3::new(0.0, 2.9, 6.6), Vec3::new(0.0, 0.55, -1.4), 42.0, 0.1));
    stage
}
