//! A wall of 8 × 8 squares that fills a square picture, some of them mirrors for what stands behind the camera.

use glam::{Vec2, Vec3};

use super::shape::Shape;
use super::stage::{self, Stage, perspective};
use crate::scene::Material;

/// Squares along a side.
const SIDE: u32 = 8;

/// All squares.
pub const SQUARES: u32 = SIDE * SIDE;

pub(super) fn build(mirrors: u32) -> Stage {
    let mut stage = Stage::default();
    let matt = stage.material(Material { base_color: stage::srgb(0x8c9aa8), ..stage::matt("matt") });
    let mirror = stage.material(Material { metallic: 1.0, roughness: 0.0, ..stage::matt("mirror") });
    let (u, v) = (Vec3::X, Vec3::Y);
    for i in 0..SQUARES {
        let corner = Vec3::new((i % SIDE) as f32, (i / SIDE) as f32, 0.0) - Vec3::new(4.0, 4.0, 0.0);
        let mut square = Shape::default();
        square.quad(corner, u, v, Vec2::ZERO, Vec2::ONE);
        stage.draw("square", square, if i < mirrors { mirror } else { matt });
    }
    for i in 0..400 {
        let (x, y) = ((i % 20) as f32 - 10.0, (i / 20) as f32 - 10.0);
        let mut plate = Shape::default();
        // Facing the wall.
        plate.quad(Vec3::new(x * 2.0, y * 2.0, 16.0), Vec3::Y * 1.5, Vec3::X * 1.5, Vec2::ZERO, Vec2::ONE);
        stage.draw("plate", plate, matt);
    }
    for (x, y) in [(-6.0, 5.0), (6.0, 5.0), (0.0, -6.0)] {
        stage.point_light(Vec3::new(x, y, 8.0), Vec3::splat(120.0), 60.0);
    }
    stage.camera(perspective(Vec3::new(0.0, 0.0, 12.0), Vec3::ZERO, 2.0 * (4.0f32 / 12.0).atan().to_degrees(), 0.1));
    stage
}
