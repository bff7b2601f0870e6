//! The Cornell box: flat colours, long straight edges, a lamp far brighter than anything else.

use glam::{Mat4, Vec2, Vec3};

use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Light, LightKind, Material, Sky};

/// Half the box's side.
const HALF: f32 = 1.0;

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    let grey = Vec3::splat(0.08);
    stage.sky(Sky { zenith: grey, horizon: grey, ground: grey });
    let white = stage.material(Material { base_color: srgb(0xddd8cc), ..matt("white") });
    let red = stage.material(Material { base_color: srgb(0xb02a22), ..matt("red") });
    let green = stage.material(Material { base_color: srgb(0x3f8f35), ..matt("green") });
    let lamp = stage.material(Material { emissive: Vec3::new(9.0, 7.6, 5.4), ..matt("lamp") });

    let wall = |origin: Vec3, u: Vec3, v: Vec3| {
        let mut shape = Shape::default();
        shape.quad(origin * HALF, u * 2.0 * HALF, v * 2.0 * HALF, Vec2::ZERO, Vec2::ONE);
        shape
    };
    stage.draw("floor", wall(Vec3::new(-1.0, -1.0, 1.0), Vec3::X, Vec3::NEG_Z), white);
    stage.draw("ceiling", wall(Vec3::new(-1.0, 1.0, -1.0), Vec3::X, Vec3::Z), white);
    stage.draw("back", wall(Vec3::new(-1.0, -1.0, -1.0), Vec3::X, Vec3::Y), white);
    stage.draw("left", wall(Vec3::new(-1.0, -1.0, 1.0), Vec3::NEG_Z, Vec3::Y), red);
    stage.draw("right", wall(Vec3::new(1.0, -1.0, -1.0), Vec3::Z, Vec3::Y), green);

    let mut patch = Shape::default();
    patch.quad(Vec3::new(-0.24, 0.998, -0.2), Vec3::X * 0.48, Vec3::Z * 0.4, Vec2::ZERO, Vec2::ONE);
    stage.draw("lamp", patch, lamp);

    for (name, half, at, degrees) in [
        ("tall box", Vec3::new(0.29, 0.6, 0.29), Vec3::new(-0.36, -0.4, -0.3), 17.0_f32),
        ("short box", Vec3::splat(0.29), Vec3::new(0.37, -0.71, 0.32), -18.0),
    ] {
        let mut shape = Shape::default();
        shape.cuboid(-half, half);
        let mesh = stage.mesh(name, shape, white);
        stage.place(mesh, Mat4::from_translation(at) * Mat4::from_rotation_y(degrees.to_radians()));
    }
    stage.light(Light {
        kind: LightKind::Point,
        position: Vec3::new(0.0, 0.8, 0.0),
        direction: Vec3::NEG_Y,
        intensity: Vec3::new(2.6, 2.3, 1.8),
        range: f32::INFINITY,
        casts: true,
    });
    stage.camera(perspective(Vec3::new(0.0, 0.0, 3.9), Vec3::ZERO, 38.0, 0.05));
    stage
}
