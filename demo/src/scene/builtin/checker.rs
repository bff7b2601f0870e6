//! Texture coordinates of every awkward kind: a checker floor to the horizon, and panels with mirrored halves,
//! distant tiles, wrap modes and coordinates that do not change at all.

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::paint::{self, Painting};
use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Material, Nearest, Sun, Texture, Wrap};

const PANEL: f32 = 2.0;
const PER_ROW: usize = 4;

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    stage.sun(Sun { to_sun: Vec3::new(0.35, 0.6, 0.7).normalize(), irradiance: Vec3::splat(PI), casts: false });

    let checker = stage.image("checker", paint::opaque(256, 256, checker));
    let picture = stage.image("test picture", picture());
    let dents = stage.image("dents", paint::relief(256, dents));

    let base_color_texture = stage.color_texture(checker);
    let floor = stage.material(Material { base_color_texture, ..matt("floor") });
    let mut plane = Shape::default();
    let origin = Vec3::new(-1000.0, 0.0, 100.0);
    plane.quad(origin, Vec3::X * 2000.0, Vec3::NEG_Z * 2000.0, Vec2::ZERO, Vec2::splat(500.0));
    stage.draw("floor", plane, floor);

    let base =
        Texture { image: picture, srgb: true, wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, nearest: Nearest::default() };
    let wraps = |wrap| Texture { wrap_u: wrap, wrap_v: wrap, ..base };
    let panels: [(&str, Texture, Shape); 8] = [
        ("mirrored halves", base, mirrored_halves()),
        ("1000 tiles away", base, panel(Vec2::splat(1000.0), Vec2::splat(1001.0))),
        ("negative tiles", base, panel(Vec2::splat(-7.25), Vec2::splat(-5.25))),
        ("clamped", wraps(Wrap::Clamp), panel(Vec2::splat(-0.5), Vec2::splat(1.5))),
        ("mirrored wrap", wraps(Wrap::Mirror), panel(Vec2::splat(-1.0), Vec2::splat(2.0))),
        (
            "nearest",
            Texture { nearest: Nearest { magnified: true, minified: true }, ..base },
            panel(Vec2::ZERO, Vec2::splat(0.25)),
        ),
        ("one point", base, panel(Vec2::splat(0.3), Vec2::splat(0.3))),
        ("one line", base, panel(Vec2::new(0.0, 0.6), Vec2::new(2.0, 0.6))),
    ];
    let normal_texture = stage.data_texture(dents);
    for (i, (name, texture, shape)) in panels.into_iter().enumerate() {
        let base_color_texture = Some(stage.texture(texture));
        let material = stage.material(Material { base_color_texture, normal_texture, roughness: 0.45, ..matt(name) });
        let mesh = stage.mesh(name, shape, material);
        // Two rows on an arc around the viewer, so that the outer ones are seen at a slant.
        let (row, column) = (i / PER_ROW, i % PER_ROW);
        let angle = (column as f32 - (PER_ROW - 1) as f32 / 2.0) * 0.40;
        let at = Vec3::new(0.0, 1.35 + row as f32 * (PANEL + 0.2), -6.2);
        let slant = Mat4::from_rotation_y(-0.7 * angle);
        stage.place(mesh, Mat4::from_rotation_y(-angle) * Mat4::from_translation(at) * slant);
    }

    // Two walls of fine stripes, tiled hard.
    let stripes = stage.image("stripes", paint::opaque(64, 64, |at| Vec3::splat(if at.x < 0.5 { 0.15 } else { 0.85 })));
    let base_color_texture = stage.color_texture(stripes);
    let striped = stage.material(Material { base_color_texture, base_color: srgb(0xf0d8b0), ..matt("stripes") });
    let mut walls = Shape::default();
    walls.quad(Vec3::new(-14.0, 0.0, 0.0), Vec3::NEG_Z * 80.0, Vec3::Y * 3.0, Vec2::ZERO, Vec2::new(320.0, 1.0));
    walls.quad(Vec3::new(14.0, 0.0, -80.0), Vec3::Z * 80.0, Vec3::Y * 3.0, Vec2::ZERO, Vec2::new(320.0, 1.0));
    stage.draw("striped walls", walls, striped);

    stage.camera(perspective(Vec3::new(0.0, 1.7, 1.2), Vec3::new(0.0, 2.0, -8.0), 58.0, 0.05));
    stage
}

/// Two by two squares.
fn checker(at: Vec2) -> Vec3 {
    if (at.x < 0.5) == (at.y < 0.5) { Vec3::splat(0.88) } else { Vec3::splat(0.12) }
}

/// Fine rings and a frame over a gradient, with every corner of its own colour.
fn picture() -> Painting {
    paint::opaque(512, 512, |at| {
        let centre = at - 0.5;
        let rings = 0.5 + 0.5 * (centre.length_squared() * 700.0).sin();
        let frame = centre.abs().max_element() > 0.47;
        let wedge = centre.y.atan2(centre.x) / PI;
        let tint = Vec3::new(at.x, at.y, 1.0 - at.x).lerp(Vec3::ONE, 0.35);
        let ink = if frame { 0.08 } else { 0.35 + 0.65 * rings };
        tint * ink * (1.0 - 0.2 * wedge.abs())
    })
}

fn dents(at: Vec2) -> f32 {
    let cell = (at * 8.0).fract() - 0.5;
    0.02 * paint::step(0.12, 0.38, cell.length())
}

fn panel(from: Vec2, to: Vec2) -> Shape {
    let mut shape = Shape::default();
    shape.quad(Vec3::new(-PANEL / 2.0, -PANEL / 2.0, 0.0), Vec3::X * PANEL, Vec3::Y * PANEL, from, to);
    shape
}

/// Both halves show the left half of the picture, one of them mirrored, over shared corners in the middle.
fn mirrored_halves() -> Shape {
    let mut shape = Shape::default();
    shape.surface(2, 1, |s, t| {
        let position = Vec3::new(s - 0.5, t - 0.5, 0.0) * PANEL;
        (position, Vec3::Z, Vec2::new(0.5 - (s - 0.5).abs(), 1.0 - t))
    });
    shape
}
