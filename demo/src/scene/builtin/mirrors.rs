//! A plane mirror, a chrome ball and a glass ball, and lettering that is seen in all three: what reflection and
//! refraction rays must not alias.

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::paint;
use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Light, LightKind, Material, Sun};

/// Five dots across, seven down.
const LETTERS: [(char, [u8; 7]); 7] = [
    ('M', [0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11]),
    ('I', [0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e]),
    ('R', [0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11]),
    ('O', [0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e]),
    ('S', [0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e]),
    ('4', [0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02]),
    ('7', [0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08]),
];

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    stage.sun(Sun {
        to_sun: Vec3::new(0.5, 0.8, 0.6).normalize(),
        irradiance: Vec3::new(1.0, 0.95, 0.88) * PI * 0.7,
        casts: true,
    });
    let tiles = paint::opaque(256, 256, |at| {
        let cell = (at * 2.0).floor();
        let dark = (cell.x + cell.y) as i32 % 2 == 0;
        if dark { Vec3::new(0.32, 0.36, 0.42) } else { Vec3::new(0.78, 0.76, 0.7) }
    });
    let tiles = stage.image("tiles", tiles);
    let base_color_texture = stage.color_texture(tiles);
    let floor = stage.material(Material { base_color_texture, ..matt("floor") });
    let mut plane = Shape::default();
    let (u, v) = (Vec3::X * 24.0, Vec3::NEG_Z * 24.0);
    plane.quad(Vec3::new(-12.0, 0.0, 12.0), u, v, Vec2::ZERO, Vec2::splat(16.0));
    stage.draw("floor", plane, floor);

    let silver = Material { base_color: srgb(0xf2f2f0), metallic: 1.0, roughness: 0.0, ..matt("silver") };
    let silver = stage.material(silver);
    let chrome =
        stage.material(Material { base_color: srgb(0xd8dce0), metallic: 1.0, roughness: 0.05, ..matt("chrome") });
    let glass = stage.material(Material { transmission: 1.0, volume: true, roughness: 0.0, ..matt("glass") });
    let wood = stage.material(Material { base_color: srgb(0x5d3f28), roughness: 0.7, ..matt("frame") });

    let mut mirror = Shape::default();
    mirror.quad(Vec3::new(-2.4, 0.15, -2.6), Vec3::X * 4.8, Vec3::Y * 2.4, Vec2::ZERO, Vec2::ONE);
    stage.draw("mirror", mirror, silver);
    let mut frame = Shape::default();
    frame.cuboid(Vec3::new(-2.55, 0.0, -2.7), Vec3::new(2.55, 0.15, -2.55));
    frame.cuboid(Vec3::new(-2.55, 2.55, -2.7), Vec3::new(2.55, 2.7, -2.55));
    frame.cuboid(Vec3::new(-2.55, 0.15, -2.7), Vec3::new(-2.4, 2.55, -2.55));
    frame.cuboid(Vec3::new(2.4, 0.15, -2.7), Vec3::new(2.55, 2.55, -2.55));
    stage.draw("frame", frame, wood);

    for (name, x, material) in [("chrome ball", -0.85, chrome), ("glass ball", 0.85, glass)] {
        let mut ball = Shape::default();
        ball.ball(0.6, 96);
        let mesh = stage.mesh(name, ball, material);
        stage.place(mesh, Mat4::from_translation(Vec3::new(x, 0.6, -0.6)));
    }

    // Faces the mirror, and the camera's back: read in the mirror, and on the balls.
    let ink = stage.material(Material { base_color: srgb(0xb3231d), ..matt("ink") });
    let paper = stage.material(Material { base_color: srgb(0xf3efe6), double_sided: true, ..matt("paper") });
    let mut sheet = Shape::default();
    sheet.quad(Vec3::new(2.3, 0.5, 3.6), Vec3::NEG_X * 4.6, Vec3::Y * 1.3, Vec2::ZERO, Vec2::ONE);
    stage.draw("sheet", sheet, paper);
    let facing_away = Mat4::from_translation(Vec3::new(2.0, 0.7, 3.59)) * Mat4::from_rotation_y(PI);
    let text = stage.mesh("lettering", lettering("MIRRORS47"), ink);
    stage.place(text, facing_away);
    // The same in the open, behind the glass ball and small.
    let small = Mat4::from_translation(Vec3::new(-0.3, 0.02, -1.9)) * Mat4::from_scale(Vec3::splat(0.55));
    stage.place(text, small);

    stage.light(Light {
        kind: LightKind::Point,
        position: Vec3::new(-1.5, 3.0, 2.0),
        direction: Vec3::NEG_Y,
        intensity: Vec3::new(1.0, 0.85, 0.7) * 6.0,
        range: f32::INFINITY,
        casts: true,
    });
    stage.camera(perspective(Vec3::new(0.2, 1.45, 3.3), Vec3::new(0.0, 0.85, -1.5), 48.0, 0.05));
    stage
}

/// Letters of dots, 0.9 high, from the origin along x.
fn lettering(text: &str) -> Shape {
    const DOT: f32 = 0.9 / 7.0 * 0.62;
    let mut shape = Shape::default();
    for (place, letter) in text.chars().enumerate() {
        let Some((_, rows)) = LETTERS.iter().find(|(c, _)| *c == letter) else { continue };
        for (row, bits) in rows.iter().enumerate() {
            for column in 0..5 {
                if bits >> (4 - column) & 1 == 1 {
                    let x = (place as f32 * 6.0 + column as f32) * DOT * 0.95;
                    let origin = Vec3::new(x, (6 - row) as f32 * DOT, 0.0);
                    shape.quad(origin, Vec3::X * DOT, Vec3::Y * DOT, Vec2::ZERO, Vec2::ONE);
                }
            }
        }
    }
    shape
}
