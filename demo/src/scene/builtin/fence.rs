//! Fences that run into the distance: wires thinner than a pixel, chain link, bars and cables against sky and ground.

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::paint;
use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Material, Sun};

/// Of one panel, between two posts.
const PANEL: f32 = 2.5;
const PANELS: usize = 28;
const HEIGHT: f32 = 1.9;

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    stage.sun(Sun {
        to_sun: Vec3::new(-0.5, 0.6, 0.35).normalize(),
        irradiance: Vec3::new(1.0, 0.95, 0.86) * PI,
        casts: false,
    });
    ground(&mut stage);

    let zinc = stage.material(Material { base_color: srgb(0x9aa0a4), metallic: 0.6, roughness: 0.45, ..matt("zinc") });
    let iron = stage.material(Material { base_color: srgb(0x24272a), roughness: 0.5, ..matt("iron") });
    let rope = stage.material(Material { base_color: srgb(0x1b1c1e), roughness: 0.8, ..matt("cable") });
    let wood = stage.material(Material { base_color: srgb(0x7a5a3c), roughness: 0.9, ..matt("wood") });

    let link = stage.mesh("chain link", chain_link(), zinc);
    let bars = stage.mesh("bars", bars(), iron);
    let strands = stage.mesh("strands", strands(), zinc);
    for i in 0..PANELS {
        let z = 1.0 - PANEL * i as f32;
        stage.place(link, Mat4::from_translation(Vec3::new(-2.0, 0.0, z)));
        stage.place(bars, Mat4::from_translation(Vec3::new(2.0, 0.0, z)));
        stage.place(strands, Mat4::from_translation(Vec3::new(5.5, 0.0, z)));
    }
    // The same link crosses the view far off, where its meshes are far below a pixel.
    let across = Mat4::from_rotation_y(PI / 2.0);
    for i in -12..12 {
        let at = Mat4::from_translation(Vec3::new(PANEL * i as f32, 0.0, -PANEL * PANELS as f32));
        stage.place(link, at * across);
    }

    let pole = stage.mesh("pole", pole(), wood);
    let cables = stage.mesh("cables", cables(), rope);
    for i in 0..6 {
        let at = Mat4::from_translation(Vec3::new(-7.0, 0.0, -2.0 - 18.0 * i as f32));
        stage.place(pole, at);
        stage.place(cables, at);
    }
    let mast = stage.mesh("mast", mast(), zinc);
    stage.place(mast, Mat4::from_translation(Vec3::new(9.0, 0.0, -22.0)));
    stage.place(mast, Mat4::from_translation(Vec3::new(26.0, 0.0, -95.0)));

    stage.camera(perspective(Vec3::new(0.2, 1.65, 3.2), Vec3::new(-0.5, 1.75, -12.0), 55.0, 0.05));
    stage
}

fn ground(stage: &mut Stage) {
    let image = paint::opaque(512, 512, |at| {
        let soil = paint::clouds(at, 8, 5, 1);
        let blades = paint::noise(at, 256, 7);
        Vec3::new(0.33, 0.42, 0.2) * (0.55 + 0.5 * soil) + Vec3::new(0.1, 0.12, 0.05) * blades
    });
    let image = stage.image("grass", image);
    let base_color_texture = stage.color_texture(image);
    let grass = stage.material(Material { base_color_texture, ..matt("grass") });
    let mut plane = Shape::default();
    let origin = Vec3::new(-600.0, 0.0, 60.0);
    plane.quad(origin, Vec3::X * 1200.0, Vec3::NEG_Z * 1200.0, Vec2::ZERO, Vec2::splat(400.0));
    stage.draw("ground", plane, grass);
}

/// A panel of diamonds between two posts, along −z.
fn chain_link() -> Shape {
    const CELL: f32 = 0.1;
    let mut shape = Shape::default();
    shape.bar(Vec3::ZERO, Vec3::Y * (HEIGHT + 0.1), 0.03, 12);
    for y in [0.05, HEIGHT] {
        shape.bar(Vec3::Y * y, Vec3::new(0.0, y, -PANEL), 0.018, 8);
    }
    // Diagonals of both directions, cut off at the frame.
    let (cells_wide, cells_high) = ((PANEL / CELL) as i32, (HEIGHT / CELL) as i32);
    for start in -cells_high..cells_wide {
        let low = (-start).max(0);
        let high = cells_high.min(cells_wide - start);
        if low >= high {
            continue;
        }
        for rising in [true, false] {
            let at = |step: i32| {
                let y = if rising { step } else { cells_high - step };
                let depth = if rising { 0.003 } else { -0.003 };
                Vec3::new(depth, y as f32 * CELL, -((start + step) as f32) * CELL)
            };
            shape.bar(at(low), at(high), 0.0016, 5);
        }
    }
    shape
}

/// A panel of upright bars with points, along −z.
fn bars() -> Shape {
    let mut shape = Shape::default();
    let count = 20;
    for i in 0..count {
        let z = -PANEL * i as f32 / count as f32;
        shape.bar(Vec3::new(0.0, 0.06, z), Vec3::new(0.0, HEIGHT - 0.12, z), 0.009, 6);
        let mut point = Shape::default();
        point.lathe(&[(0.018, 0.0), (0.001, 0.12)], 6, 1.0);
        shape.add(&point, Mat4::from_translation(Vec3::new(0.0, HEIGHT - 0.12, z)));
    }
    for y in [0.2, HEIGHT - 0.3] {
        shape.cuboid(Vec3::new(-0.02, y, -PANEL), Vec3::new(0.02, y + 0.04, 0.0));
    }
    shape.cuboid(Vec3::new(-0.04, 0.0, -0.04), Vec3::new(0.04, HEIGHT + 0.05, 0.04));
    shape
}

/// A post and strands of bare wire, along −z.
fn strands() -> Shape {
    let mut shape = Shape::default();
    shape.bar(Vec3::ZERO, Vec3::Y * 1.4, 0.04, 8);
    for i in 1..=7 {
        let y = 0.19 * i as f32;
        shape.bar(Vec3::new(0.0, y, 0.0), Vec3::new(0.0, y, -PANEL), 0.0012, 5);
    }
    shape
}

/// A tall tapering lattice.
fn mast() -> Shape {
    const STOREYS: usize = 12;
    let mut shape = Shape::default();
    let corner = |storey: usize, side: usize| {
        let t = storey as f32 / STOREYS as f32;
        let half = 1.3 - 1.1 * t;
        let (x, z) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][side % 4];
        Vec3::new(x * half, 17.0 * t, z * half)
    };
    for storey in 0..STOREYS {
        for side in 0..4 {
            shape.bar(corner(storey, side), corner(storey + 1, side), 0.03, 6);
            shape.bar(corner(storey, side), corner(storey + 1, side + 1), 0.012, 5);
            shape.bar(corner(storey, side + 1), corner(storey + 1, side), 0.012, 5);
            shape.bar(corner(storey + 1, side), corner(storey + 1, side + 1), 0.015, 5);
        }
    }
    shape
}

fn pole() -> Shape {
    let mut shape = Shape::default();
    shape.bar(Vec3::ZERO, Vec3::Y * 8.5, 0.12, 14);
    shape.cuboid(Vec3::new(-1.1, 7.9, -0.06), Vec3::new(1.1, 8.05, 0.06));
    shape.cuboid(Vec3::new(-0.8, 7.2, -0.06), Vec3::new(0.8, 7.33, 0.06));
    shape
}

/// Cables from one pole to the next, sagging.
fn cables() -> Shape {
    let mut shape = Shape::default();
    for (x, y) in [(-1.0, 8.1), (-0.4, 8.1), (0.4, 8.1), (1.0, 8.1), (-0.7, 7.38), (0.7, 7.38)] {
        let points: Vec<Vec3> = (0..=16)
            .map(|i| {
                let t = i as f32 / 16.0;
                Vec3::new(x, y - 4.0 * 0.7 * t * (1.0 - t), -18.0 * t)
            })
            .collect();
        shape.wire(&points, 0.006, 5);
    }
    shape
}
