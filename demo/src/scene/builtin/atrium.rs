//! An open hall between arcades of two storeys, looking out to the horizon: stone, brick, cloth, iron and leaves,
//! with edges from metres down to far below a pixel.

use std::f32::consts::PI;

use glam::{EulerRot, Mat4, Quat, Vec2, Vec3};

use super::paint::{self, Painting, clouds, hash, noise, step};
use super::shape::Shape;
use super::stage::{Stage, matt, perspective, srgb};
use crate::scene::{Material, Nearest, Sky, Sun, Texture, TextureRef, Wrap};

/// Where the arcade nearest to the viewer begins; the hall runs towards −z.
const START: f32 = 14.0;
const BAY: f32 = 4.0;
const BAYS: usize = 8;
const LENGTH: f32 = BAY * BAYS as f32;
/// From the middle of the hall to the middle of an arcade.
const HALF_WIDTH: f32 = 4.0;
/// From the middle of the hall to the outer wall.
const WALL: f32 = 7.8;
/// Where the lower arches begin.
const SPRING: f32 = 3.65;
/// The floor of the upper storey.
const UPPER: f32 = 5.9;
const ROOF: f32 = 9.4;

/// The scene's material numbers.
struct Palette {
    floor: usize,
    marble: usize,
    ashlar: usize,
    brick: usize,
    plaster: usize,
    iron: usize,
    bronze: usize,
    terracotta: usize,
    leaves: usize,
    lamp: usize,
    hills: usize,
    cloths: [usize; 4],
}

pub(super) fn build() -> Stage {
    let mut stage = Stage::default();
    stage.sky(Sky {
        zenith: Vec3::new(0.17, 0.34, 0.78),
        horizon: Vec3::new(0.72, 0.82, 0.95),
        ground: Vec3::new(0.2, 0.17, 0.14),
    });
    stage.sun(Sun {
        to_sun: Vec3::new(-0.25, 0.85, 0.5).normalize(),
        irradiance: Vec3::new(1.0, 0.93, 0.8) * PI * 1.4,
        casts: true,
    });
    let palette = palette(&mut stage);

    landscape(&mut stage, &palette);
    arcades(&mut stage, &palette);
    walls(&mut stage, &palette);
    railings(&mut stage, &palette);
    cloths(&mut stage, &palette);
    lanterns(&mut stage, &palette);
    greenery(&mut stage, &palette);
    orb(&mut stage, &palette);

    stage.camera(perspective(Vec3::new(-1.1, 1.7, 12.6), Vec3::new(0.9, 3.5, -8.0), 57.0, 0.05));
    stage
}

// ---- Materials ----

fn palette(stage: &mut Stage) -> Palette {
    let image = stage.image("floor slabs", slabs());
    let relief = stage.image("floor relief", paint::relief(512, |at| 0.004 * slab_gap(at)));
    let floor = Material {
        base_color_texture: scaled(stage.color_texture(image), 0.25),
        normal_texture: scaled(stage.data_texture(relief), 0.25),
        roughness: 0.42,
        ..matt("floor")
    };
    let image = stage.image("marble", marble());
    let marble = Material { base_color_texture: stage.color_texture(image), roughness: 0.38, ..matt("marble") };
    let image = stage.image("ashlar", blocks(3, 2, ashlar_color));
    let relief = stage.image("ashlar relief", paint::relief(512, |at| 0.006 * block_height(at, 3, 2)));
    let ashlar = Material {
        base_color_texture: scaled(stage.color_texture(image), 0.5),
        normal_texture: scaled(stage.data_texture(relief), 0.5),
        roughness: 0.85,
        ..matt("ashlar")
    };
    let image = stage.image("brick", blocks(12, 4, brick_color));
    let relief = stage.image("brick relief", paint::relief(512, |at| 0.006 * block_height(at, 12, 4)));
    let brick = Material {
        base_color_texture: stage.color_texture(image),
        normal_texture: stage.data_texture(relief),
        roughness: 0.9,
        ..matt("brick")
    };
    let image = stage.image("plaster", plaster());
    let relief = stage.image("plaster relief", paint::relief(256, |at| 0.02 * clouds(at, 8, 4, 31)));
    let plaster = Material {
        base_color_texture: scaled(stage.color_texture(image), 0.4),
        normal_texture: scaled(stage.data_texture(relief), 0.4),
        ..matt("plaster")
    };
    let image = stage.image("leaves", leaves());
    let leaf_texture = stage.texture(Texture {
        image,
        srgb: true,
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        nearest: Nearest::default(),
    });
    let leaves = Material {
        base_color_texture: Some(leaf_texture),
        alpha_cutoff: Some(0.5),
        double_sided: true,
        roughness: 0.7,
        ..matt("leaves")
    };
    let image = stage.image("cloth pattern", cloth_pattern());
    let pattern = stage.color_texture(image);
    let cloths = [("red", 0xc02a2e), ("blue", 0x2a55b0), ("gold", 0xe0a030), ("green", 0x2f8a5a)].map(|(name, dye)| {
        stage.material(Material {
            base_color: srgb(dye),
            base_color_texture: pattern,
            double_sided: true,
            roughness: 0.95,
            ..matt(&format!("{name} cloth"))
        })
    });
    Palette {
        floor: stage.material(floor),
        marble: stage.material(marble),
        ashlar: stage.material(ashlar),
        brick: stage.material(brick),
        plaster: stage.material(plaster),
        iron: stage.material(Material { base_color: srgb(0x2b2e30), roughness: 0.5, ..matt("iron") }),
        bronze: stage.material(Material {
            base_color: srgb(0xd8a860),
            metallic: 1.0,
            roughness: 0.22,
            ..matt("bronze")
        }),
        terracotta: stage.material(Material { base_color: srgb(0xb5643c), roughness: 0.8, ..matt("terracotta") }),
        leaves: stage.material(leaves),
        lamp: stage.material(Material { emissive: Vec3::new(9.0, 5.6, 2.4), ..matt("lamp") }),
        hills: stage.material(Material { base_color: srgb(0x8fa3b4), ..matt("hills") }),
        cloths,
    }
}

/// The same texture, `per_metre` times a metre.
fn scaled(texture: Option<TextureRef>, per_metre: f32) -> Option<TextureRef> {
    texture.map(|texture| TextureRef { u_row: texture.u_row * per_metre, v_row: texture.v_row * per_metre, ..texture })
}

/// Four by four slabs, laid as a checkerboard of two stones.
fn slabs() -> Painting {
    paint::opaque(512, 512, |at| {
        let slab = (at * 4.0).floor();
        let (x, y) = (slab.x as i32, slab.y as i32);
        let dark = (x + y) % 2 == 0;
        let stone = if dark { Vec3::new(0.52, 0.33, 0.25) } else { Vec3::new(0.88, 0.77, 0.60) };
        let veins = clouds(at + Vec2::new(hash(x, y, 3), hash(x, y, 4)), 16, 4, 5);
        let shade = 0.86 + 0.16 * hash(x, y, 6) + 0.24 * (veins - 0.5);
        stone * shade * (0.55 + 0.45 * slab_gap(at))
    })
}

/// 0 in the gaps between slabs, 1 on them.
fn slab_gap(at: Vec2) -> f32 {
    let to_edge = 0.5 - ((at * 4.0).fract() - 0.5).abs();
    step(0.008, 0.03, to_edge.min_element())
}

fn marble() -> Painting {
    paint::opaque(512, 512, |at| {
        let bend = clouds(at, 4, 5, 11);
        let vein = 1.0 - ((at.y * 2.0 + bend * 3.0) * PI).sin().abs();
        let grain = noise(at, 128, 13);
        Vec3::new(0.9, 0.87, 0.81) - Vec3::new(0.22, 0.22, 0.2) * vein.powi(6) - Vec3::splat(0.05 * grain)
    })
}

/// Courses of blocks, every other one shifted by half a block, painted by block and height.
fn blocks(rows: i32, columns: i32, color: impl Fn(Vec2, i32, i32) -> Vec3) -> Painting {
    paint::opaque(512, 512, |at| {
        let (_, x, y) = block(at, rows, columns);
        let height = block_height(at, rows, columns);
        Vec3::new(0.62, 0.58, 0.52).lerp(color(at, x, y), step(0.1, 0.6, height)) * (0.7 + 0.3 * height)
    })
}

/// The place within a block, in units of a course, and the block's numbers.
fn block(at: Vec2, rows: i32, columns: i32) -> (Vec2, i32, i32) {
    let y = (at.y * rows as f32).floor();
    let shift = if y as i32 % 2 == 0 { 0.0 } else { 0.5 };
    let x = at.x * columns as f32 + shift;
    let aspect = rows as f32 / columns as f32;
    let within = Vec2::new(x.fract() * aspect, (at.y * rows as f32).fract());
    let to_edge = Vec2::new(within.x.min(aspect - within.x), within.y.min(1.0 - within.y));
    (to_edge, (x.floor() as i32).rem_euclid(columns), y as i32)
}

fn block_height(at: Vec2, rows: i32, columns: i32) -> f32 {
    let (to_edge, ..) = block(at, rows, columns);
    let joint = 0.006 * rows as f32;
    step(joint * 0.4, joint * 1.8, to_edge.min_element()) * (0.85 + 0.15 * clouds(at, 32, 3, 21))
}

fn ashlar_color(at: Vec2, x: i32, y: i32) -> Vec3 {
    Vec3::new(0.86, 0.79, 0.66) * (0.86 + 0.1 * hash(x, y, 22) + 0.12 * clouds(at, 16, 4, 23))
}

fn brick_color(at: Vec2, x: i32, y: i32) -> Vec3 {
    let fired = hash(x, y, 24);
    Vec3::new(0.72, 0.36, 0.24).lerp(Vec3::new(0.5, 0.24, 0.2), fired) * (0.8 + 0.35 * clouds(at, 32, 3, 25))
}

fn plaster() -> Painting {
    paint::opaque(256, 256, |at| Vec3::new(0.9, 0.76, 0.55) * (0.84 + 0.24 * clouds(at, 4, 5, 30)))
}

/// A spray of leaves on a stalk.
fn leaves() -> Painting {
    paint::masked(256, 256, |at| {
        let mut cover = 0.0_f32;
        let mut shade = 0.5;
        for i in 0..9 {
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            let along = i as f32 / 8.0;
            let root = Vec2::new(0.5 + 0.03 * (along * 9.0).sin(), 0.95 - 0.72 * along);
            let angle = if i == 8 { 0.0 } else { side * (0.95 - 0.3 * along) };
            let direction = Vec2::new(angle.sin(), -angle.cos());
            let local = at - root;
            let length = 0.36 - 0.12 * along;
            let (x, y) = (local.dot(direction) / length, local.perp_dot(direction).abs() / length);
            // Pointed at both ends, widest before the middle.
            let width = 0.30 * (x.clamp(0.0, 1.0).powf(0.7) * PI).sin();
            let inside = step(-0.02, 0.02, width - y);
            if x > 0.0 && x < 1.0 && inside > 0.0 {
                cover = cover.max(inside);
                shade = 0.55 + 0.4 * hash(i, 0, 40) - 0.25 * step(0.03, 0.0, y);
            }
        }
        let stalk = step(0.012, 0.006, (at.x - 0.5 - 0.03 * ((0.95 - at.y) * 12.5).sin()).abs());
        let stalk = if at.y > 0.22 { stalk } else { 0.0 };
        // The colour goes on where the mask is empty, so that filtering takes up nothing foreign.
        (Vec3::new(0.36, 0.56, 0.2) * (0.45 + 0.6 * shade), cover.max(stalk))
    })
}

/// Light figures on a dyed ground, to be tinted.
fn cloth_pattern() -> Painting {
    paint::opaque(256, 512, |at| {
        let p = Vec2::new(at.x, at.y * 2.0);
        let border = (0.5 - (at.x - 0.5).abs()).min(2.0 * at.y.min(1.0 - at.y));
        let cell = (p * 3.0 + Vec2::splat(0.5)).fract() - 0.5;
        let diamond = cell.x.abs() + cell.y.abs();
        let figure = (diamond < 0.16) || (0.26..0.32).contains(&diamond);
        let stripe = (0.06..0.075).contains(&border) || (0.085..0.09).contains(&border);
        let weave = 0.94 + 0.06 * ((at.x * 256.0 * PI * 0.5).sin() * (at.y * 512.0 * PI * 0.5).sin());
        let ink = if border < 0.05 {
            Vec3::splat(0.62)
        } else if figure || stripe {
            Vec3::new(1.0, 0.98, 0.9)
        } else {
            Vec3::splat(0.78)
        };
        ink * weave
    })
}

// ---- Outside ----

fn landscape(stage: &mut Stage, palette: &Palette) {
    let mut floor = Shape::default();
    let (origin, size) = (Vec3::new(-700.0, 0.0, 60.0), 1400.0);
    floor.quad(origin, Vec3::X * size, Vec3::NEG_Z * size, Vec2::ZERO, Vec2::splat(size));
    stage.draw("floor", floor, palette.floor);

    for (ridge, distance, height) in [(0, 520.0, 26.0), (1, 680.0, 62.0)] {
        let mut hills = Shape::default();
        hills.surface(160, 1, |s, t| {
            let top = height * (0.35 + clouds(Vec2::new(s, 0.3), 12, 4, 50 + ridge));
            let position = Vec3::new((s - 0.5) * 1500.0, t * top - 1.0, -distance);
            (position, Vec3::new(0.0, 0.6, 0.8), Vec2::new(s, t))
        });
        stage.draw("hills", hills, palette.hills);
    }

    // An avenue of obelisks leads the eye out.
    let mut obelisk = Shape::default();
    obelisk.cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 0.6, 0.5));
    let mut needle = Shape::default();
    needle.lathe(&[(0.42, 0.6), (0.26, 4.2), (0.0, 4.8)], 4, 1.0);
    obelisk.add(&needle, Mat4::from_rotation_y(PI / 4.0));
    let obelisk = stage.mesh("obelisk", obelisk, palette.ashlar);
    let tree = stage.mesh("cypress", cypress(), palette.leaves);
    for i in 0..14 {
        for side in [-1.0, 1.0] {
            let z = START - LENGTH - 6.0 - 9.0 * i as f32;
            stage.place(obelisk, Mat4::from_translation(Vec3::new(side * 4.6, 0.0, z)));
            let turn = Mat4::from_rotation_y(hash(i, side as i32, 52) * PI);
            stage.place(tree, Mat4::from_translation(Vec3::new(side * 10.5, 0.0, z - 4.5)) * turn);
        }
    }
}

fn cypress() -> Shape {
    let mut shape = Shape::default();
    for i in 0..220 {
        let up = (i as f32 + 0.5) / 220.0;
        let around = i as f32 * 2.4;
        let out = 0.75 * (1.0 - up).powf(0.7) * (0.5 + 0.5 * hash(i, 1, 60));
        let at = Vec3::new(around.cos() * out, 0.3 + 6.2 * up, around.sin() * out);
        let tilt = Quat::from_euler(EulerRot::YXZ, -around, 0.5 * (hash(i, 2, 60) - 0.5), 0.4 * (hash(i, 3, 60) - 0.5));
        leaf_card(&mut shape, Mat4::from_rotation_translation(tilt, at), 0.85);
    }
    shape
}

// ---- Building ----

/// The hall's two sides, mirror images of each other.
fn sides() -> [Mat4; 2] {
    [Mat4::IDENTITY, Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))]
}

fn arcades(stage: &mut Stage, palette: &Palette) {
    let lower = stage.mesh("lower column", column(0.34, SPRING), palette.marble);
    let upper = stage.mesh("upper column", column(0.17, 2.2), palette.marble);
    let plinths = stage.mesh("plinths", plinths(), palette.ashlar);
    let wide = Arch { width: BAY, radius: 1.55, spring: SPRING, top: UPPER - 0.3, thickness: 0.7 };
    let narrow = Arch { width: BAY / 2.0, radius: 0.76, spring: UPPER + 2.2, top: ROOF, thickness: 0.4 };
    let wide = stage.mesh("lower arch", wide.shape(), palette.ashlar);
    let narrow = stage.mesh("upper arch", narrow.shape(), palette.ashlar);
    let cornice = stage.mesh("cornices", cornices(), palette.ashlar);

    for side in sides() {
        for i in 0..=BAYS {
            let z = START - BAY * i as f32;
            let at = |dz: f32| side * Mat4::from_translation(Vec3::new(HALF_WIDTH, 0.0, z + dz));
            stage.place(lower, at(0.0));
            stage.place(plinths, at(0.0));
            stage.place(upper, at(0.0) * Mat4::from_translation(Vec3::Y * UPPER));
            if i < BAYS {
                stage.place(wide, at(-BAY / 2.0));
                for quarter in [0.25, 0.75] {
                    stage.place(narrow, at(-BAY * quarter));
                }
                stage.place(upper, at(-BAY / 2.0) * Mat4::from_translation(Vec3::Y * UPPER));
                stage.place(cornice, at(-BAY / 2.0));
            }
        }
    }
}

/// A round column with base and capital, `radius` thick and `height` high.
fn column(radius: f32, height: f32) -> Shape {
    let r = |factor: f32| radius * factor;
    let mut profile = vec![(r(1.45), 0.5), (r(1.52), 0.62), (r(1.45), 0.75), (r(1.22), 0.85)];
    profile.extend([(r(1.22), 0.92), (r(1.3), 1.0), (r(1.22), 1.08), (r(1.04), 1.15)]);
    for point in &mut profile {
        point.1 *= r(0.9);
    }
    // A slight swelling, as the Greeks had it.
    let (foot, neck) = (r(1.15 * 0.9), height - r(1.35));
    profile.extend((0..=6).map(|i| {
        let t = i as f32 / 6.0;
        (r(1.0 - 0.14 * t * t), foot + (neck - foot) * t)
    }));
    profile.extend([(r(0.96), neck + r(0.04)), (r(0.96), neck + r(0.14)), (r(0.86), neck + r(0.2))]);
    profile.extend((0..=5).map(|i| {
        let t = i as f32 / 5.0;
        (r(0.86 + 0.5 * t * t), neck + r(0.25 + 0.75 * t))
    }));
    let mut shape = Shape::default();
    shape.lathe(&profile, 32, 2.0);
    let slab = |half: f32, from: f32, to: f32| (Vec3::new(-half, from, -half), Vec3::new(half, to, half));
    for (min, max) in [slab(r(1.55), 0.0, r(0.45)), slab(r(1.5), height - r(0.38), height)] {
        shape.cuboid(min, max);
    }
    shape
}

/// A low step under each lower column.
fn plinths() -> Shape {
    let mut shape = Shape::default();
    shape.cuboid(Vec3::new(-0.62, 0.0, -0.62), Vec3::new(0.62, 0.09, 0.62));
    shape
}

/// A wall over a round arch, centred on z = 0, its middle plane at x = 0.
struct Arch {
    width: f32,
    radius: f32,
    spring: f32,
    top: f32,
    thickness: f32,
}

impl Arch {
    const STEPS: u32 = 28;

    fn shape(&self) -> Shape {
        let Self { width, radius, spring, top, thickness } = *self;
        let half = thickness / 2.0;
        let mut shape = Shape::default();
        // Along the outline from the far foot over the top to the near foot. (z, y)
        let rim = |s: f32, radius: f32| {
            let angle = (s * PI).clamp(0.0, PI);
            Vec2::new(-radius * angle.cos(), spring + radius * angle.sin())
        };
        let steps = Self::STEPS;
        // The first and last cells close the gap between the arch's feet and the edges of the bay.
        let inner = |s: f32| rim((s * (steps + 2) as f32 - 1.0) / steps as f32, radius);
        let outer = |s: f32| {
            let k = s * (steps + 2) as f32;
            if k < 0.5 {
                Vec2::new(-width / 2.0, spring)
            } else if k > steps as f32 + 1.5 {
                Vec2::new(width / 2.0, spring)
            } else {
                Vec2::new(((k - 1.0) / steps as f32 - 0.5) * width, top)
            }
        };
        for facing in [-1.0, 1.0] {
            shape.surface(steps + 2, 1, |s, t| {
                let s = if facing < 0.0 { s } else { 1.0 - s };
                let p = inner(s).lerp(outer(s), t);
                (Vec3::new(facing * half, p.y, p.x), Vec3::X * facing, Vec2::new(p.x * facing, -p.y))
            });
            // A raised band around the opening.
            let band = |s: f32| if facing < 0.0 { s } else { 1.0 - s };
            let proud = facing * (half + 0.045);
            let wide = radius + 0.16 * radius.sqrt();
            shape.surface(steps, 1, |s, t| {
                let p = rim(band(s), radius).lerp(rim(band(s), wide), t);
                (Vec3::new(proud, p.y, p.x), Vec3::X * facing, Vec2::new(s * 3.0, t * 0.2))
            });
            shape.surface(steps, 1, |s, t| {
                let p = rim(band(s), wide);
                let normal = (p - Vec2::new(0.0, spring)) / wide;
                let x = proud + (facing * half - proud) * t;
                (Vec3::new(x, p.y, p.x), Vec3::new(0.0, normal.y, normal.x), Vec2::new(s * 3.0, t * 0.05))
            });
        }
        let depth = half + 0.045;
        shape.surface(steps, 1, |s, t| {
            let p = rim(s, radius);
            let normal = (Vec2::new(0.0, spring) - p) / radius;
            let position = Vec3::new(depth - 2.0 * depth * t, p.y, p.x);
            (position, Vec3::new(0.0, normal.y, normal.x), Vec2::new(s * PI * radius, position.x))
        });
        // The bearings beside the opening, and a keystone.
        for side in [-1.0, 1.0] {
            let (near, far) = (side * radius, side * width / 2.0);
            let (from, to) = (near.min(far), near.max(far));
            let origin = Vec3::new(-half, spring, from);
            shape.quad(origin, Vec3::X * thickness, Vec3::Z * (to - from), Vec2::ZERO, Vec2::ONE);
        }
        let key = 0.09 * radius;
        shape.cuboid(
            Vec3::new(-half - 0.09, spring + radius - 0.03, -key),
            Vec3::new(half + 0.09, spring + radius * 1.28, key),
        );
        shape
    }
}

/// What crowns both storeys over one bay: mouldings with rows of little blocks below.
fn cornices() -> Shape {
    let mut shape = Shape::default();
    let half = BAY / 2.0;
    for (y, proud, teeth) in [(UPPER - 0.3, 0.45, 16), (ROOF, 0.34, 20)] {
        let band = |from: f32, to: f32, proud: f32| (Vec3::new(-proud, y + from, -half), Vec3::new(0.3, y + to, half));
        for (min, max) in [band(0.0, 0.08, proud), band(0.16, 0.24, proud + 0.16), band(0.24, 0.3, proud + 0.22)] {
            shape.cuboid(min, max);
        }
        let pitch = BAY / teeth as f32;
        for i in 0..teeth {
            let z = -half + pitch * (i as f32 + 0.25);
            shape.cuboid(Vec3::new(-proud - 0.12, y + 0.08, z), Vec3::new(-proud + 0.05, y + 0.16, z + pitch * 0.5));
        }
        shape.cuboid(Vec3::new(-proud, y + 0.08, -half), Vec3::new(0.3, y + 0.16, half));
    }
    shape
}

fn walls(stage: &mut Stage, palette: &Palette) {
    let (near, far) = (START + 1.0, START - LENGTH - 0.4);
    let length = near - far;
    let panel = |y: f32, height: f32| {
        let mut shape = Shape::default();
        // The side at +x, seen from the hall.
        let (from, to) = (Vec2::new(0.0, -y - height), Vec2::new(length, -y));
        shape.quad(Vec3::new(WALL, y, far), Vec3::Z * length, Vec3::Y * height, from, to);
        shape
    };
    let mut dado = Shape::default();
    dado.cuboid(Vec3::new(WALL - 0.12, 0.0, far), Vec3::new(WALL, 0.9, near));
    dado.cuboid(Vec3::new(WALL - 0.18, 0.9, far), Vec3::new(WALL, 1.0, near));
    for i in 0..=BAYS {
        let z = START - BAY * i as f32;
        dado.cuboid(Vec3::new(WALL - 0.28, 0.0, z - 0.3), Vec3::new(WALL, UPPER - 0.3, z + 0.3));
    }
    let mut slabs = Shape::default();
    slabs.cuboid(Vec3::new(HALF_WIDTH - 0.3, UPPER - 0.3, far), Vec3::new(WALL + 0.4, UPPER, near));
    slabs.cuboid(Vec3::new(HALF_WIDTH - 0.3, ROOF + 0.3, far), Vec3::new(WALL + 0.4, ROOF + 0.5, near));

    for (name, shape, material) in [
        ("lower wall", panel(0.0, UPPER), palette.brick),
        ("upper wall", panel(UPPER, ROOF + 0.3 - UPPER), palette.plaster),
        ("dado", dado, palette.ashlar),
        ("slabs", slabs, palette.plaster),
    ] {
        let mesh = stage.mesh(name, shape, material);
        for side in sides() {
            stage.place(mesh, side);
        }
    }
}

fn railings(stage: &mut Stage, palette: &Palette) {
    let mut bay = Shape::default();
    let half = BAY / 2.0;
    let along = |bay: &mut Shape, y: f32, radius: f32, sides: u32| {
        bay.bar(Vec3::new(0.0, y, -half), Vec3::new(0.0, y, half), radius, sides);
    };
    along(&mut bay, 1.0, 0.03, 10);
    along(&mut bay, 0.12, 0.015, 6);
    along(&mut bay, 0.86, 0.01, 6);
    for i in 0..32 {
        let z = -half + BAY * (i as f32 + 0.5) / 32.0;
        bay.bar(Vec3::new(0.0, 0.12, z), Vec3::new(0.0, 0.86, z), 0.007, 6);
    }
    // Bare wires between rail and hand rail.
    along(&mut bay, 0.91, 0.002, 5);
    along(&mut bay, 0.95, 0.002, 5);
    let mesh = stage.mesh("railing", bay, palette.iron);
    for side in sides() {
        for i in 0..BAYS {
            let at = Vec3::new(HALF_WIDTH - 0.32, UPPER, START - BAY * (i as f32 + 0.5));
            stage.place(mesh, side * Mat4::from_translation(at));
        }
    }
}

// ---- Furniture ----

fn cloths(stage: &mut Stage, palette: &Palette) {
    // Long banners from the gallery, in front of every other column.
    let hanging = palette.cloths.map(|cloth| stage.mesh("banner", banner(1.15, 2.9, 0.05), cloth));
    for (row, side) in sides().into_iter().enumerate() {
        for i in 0..BAYS {
            let at = Vec3::new(HALF_WIDTH - 0.56, UPPER - 0.55, START - BAY * (i as f32 + 1.0));
            let turned = Mat4::from_rotation_y(-PI / 2.0) * Mat4::from_scale(Vec3::new(1.0, 0.72, 1.0));
            stage.place(hanging[(i + 2 * row) % 4], side * Mat4::from_translation(at) * turned);
        }
    }

    // Banners and pennants on cables across the hall.
    let mut cables = Shape::default();
    let across = palette.cloths.map(|cloth| stage.mesh("cross banner", banner(1.5, 2.3, 0.07), cloth));
    let pennants = palette.cloths.map(|cloth| {
        let mut pennant = Shape::default();
        pennant.triangle([Vec3::new(0.13, 0.0, 0.0), Vec3::new(-0.13, 0.0, 0.0), Vec3::new(0.0, -0.34, 0.0)].map(flip));
        stage.mesh("pennant", pennant, cloth)
    });
    for i in 0..4 {
        let z = START - BAY * (2.0 * i as f32 + 1.0);
        let span = HALF_WIDTH - 0.5;
        let at = |t: f32, sag: f32, y: f32, dz: f32| {
            Vec3::new((2.0 * t - 1.0) * span, y - sag * 4.0 * t * (1.0 - t), z + dz * t)
        };
        let curve =
            |sag: f32, y: f32, dz: f32| -> Vec<Vec3> { (0..=24).map(|k| at(k as f32 / 24.0, sag, y, dz)).collect() };
        cables.wire(&curve(0.25, 9.0, 0.0), 0.006, 6);
        stage.place(across[(i + 1) % 4], Mat4::from_translation(at(0.5, 0.25, 9.0, 0.0)));
        for (dz, y) in [(BAY, 8.7), (-BAY, 8.4)] {
            cables.wire(&curve(0.7, y, dz), 0.003, 5);
            for k in 0..22 {
                let t = (k as f32 + 0.5) / 22.0;
                let swing = 0.5 * (hash(k, i as i32, 70) - 0.5);
                let pose = Mat4::from_translation(at(t, 0.7, y, dz)) * Mat4::from_rotation_x(swing);
                stage.place(pennants[k as usize % 4], pose);
            }
        }
    }
    stage.draw("cables", cables, palette.iron);
}

/// Turned to face +z.
fn flip(corner: Vec3) -> Vec3 {
    Vec3::new(-corner.x, corner.y, corner.z)
}

/// A cloth that hangs from the origin and faces +z, in waves of this depth.
fn banner(width: f32, height: f32, depth: f32) -> Shape {
    let wave = |s: f32, t: f32| {
        let loose = (1.0 - t) * (0.4 + 0.6 * (1.0 - t));
        let fold = (s * 11.0 + t * 2.0).sin() + 0.5 * (s * 5.0 - t * 4.0).cos();
        // The lower edge ends in two tips.
        let cut = 0.12 * (1.0 - t) * (1.0 - (4.0 * (s - 0.5).abs() - 1.0).abs());
        Vec3::new((s - 0.5) * width, (t - 1.0) * height - cut * height, depth * loose * fold)
    };
    let mut shape = Shape::default();
    shape.surface(28, 36, |s, t| {
        let e = 1e-3;
        let across = wave(s + e, t) - wave(s - e, t);
        let up = wave(s, t + e) - wave(s, t - e);
        (wave(s, t), across.cross(up).normalize(), Vec2::new(s, 1.0 - t))
    });
    shape
}

fn lanterns(stage: &mut Stage, palette: &Palette) {
    let mut bulb = Shape::default();
    bulb.ball(0.11, 14);
    let mut cage = Shape::default();
    cage.bar(Vec3::Y * 0.2, Vec3::Y * 1.55, 0.007, 6);
    cage.lathe(&[(0.17, 0.14), (0.02, 0.24)], 8, 1.0);
    cage.lathe(&[(0.03, -0.2), (0.15, -0.14)], 8, 1.0);
    for i in 0..8 {
        let (sin, cos) = (i as f32 * PI / 4.0).sin_cos();
        let at = |y: f32| Vec3::new(0.15 * cos, y, 0.15 * sin);
        cage.bar(at(-0.15), at(0.15), 0.006, 5);
    }
    let bulb = stage.mesh("lamp", bulb, palette.lamp);
    let cage = stage.mesh("lantern", cage, palette.iron);
    for side in [-1.0, 1.0] {
        for i in 0..BAYS {
            let at = Vec3::new(side * 5.8, UPPER - 1.85, START - BAY * (i as f32 + 0.5));
            stage.place(bulb, Mat4::from_translation(at));
            stage.place(cage, Mat4::from_translation(at));
            // Light from every other lantern is plenty.
            if i % 2 == 0 {
                stage.point_light(at, Vec3::new(7.0, 4.1, 1.7), 9.0);
            }
        }
    }
}

fn greenery(stage: &mut Stage, palette: &Palette) {
    let mut pot = Shape::default();
    pot.lathe(
        &[(0.0, 0.02), (0.22, 0.02), (0.34, 0.55), (0.38, 0.55), (0.38, 0.64), (0.31, 0.64), (0.3, 0.56)],
        24,
        1.0,
    );
    pot.lathe(&[(0.3, 0.56), (0.0, 0.58)], 24, 1.0);
    let pot = stage.mesh("pot", pot, palette.terracotta);
    let bushes = [0, 1, 2].map(|kind| stage.mesh("bush", bush(kind), palette.leaves));
    for side in [-1.0, 1.0] {
        for i in 0..BAYS {
            let at = Vec3::new(side * (HALF_WIDTH - 0.95), 0.0, START - BAY * (i as f32 + 0.5) - 0.9 * side);
            let turn = Mat4::from_rotation_y(2.0 * i as f32 + side);
            stage.place(pot, Mat4::from_translation(at));
            stage.place(bushes[i % 3], Mat4::from_translation(at + Vec3::Y * 0.56) * turn);
        }
    }
    let ivy = stage.mesh("ivy", ivy(), palette.leaves);
    for (side, bay) in [(0, 1), (0, 4), (1, 2), (1, 3), (1, 6)] {
        let at = Vec3::new(HALF_WIDTH - 0.38, UPPER - 0.35, START - BAY * (bay as f32 + 0.5));
        stage.place(ivy, sides()[side] * Mat4::from_translation(at));
    }
}

/// Sprays from a pot at the origin.
fn bush(kind: i32) -> Shape {
    let mut shape = Shape::default();
    for i in 0..46 {
        let around = i as f32 * 2.4 + kind as f32;
        let lean = 0.15 + 0.95 * hash(i, kind, 80);
        let size = 0.55 + 0.4 * hash(i, kind, 81);
        let turn =
            Quat::from_rotation_y(around) * Quat::from_rotation_x(lean) * Quat::from_rotation_y(hash(i, kind, 82) * PI);
        let root = Vec3::Y * 0.55 * hash(i, kind, 83);
        leaf_card(&mut shape, Mat4::from_rotation_translation(turn, root), size);
    }
    shape
}

/// Trails that hang down a wall whose front is at x = 0, facing −x.
fn ivy() -> Shape {
    let mut shape = Shape::default();
    for trail in 0..9 {
        let z = (trail as f32 - 4.0) * 0.36;
        let length = 0.5 + 1.5 * hash(trail, 0, 90);
        // Over the arch there is wall to hang on only near the bay's ends.
        let length = length.min(0.25 + 0.55 * z.abs());
        let count = (length * 9.0) as i32 + 3;
        for i in 0..count {
            let down = length * i as f32 / count as f32;
            let sway = 0.12 * (hash(i, trail, 91) - 0.5);
            let at = Vec3::new(-0.04 - 0.06 * hash(i, trail, 92), -down, z + sway);
            let hang = PI + 1.4 * (hash(i, trail, 93) - 0.5);
            let turn =
                Quat::from_rotation_y(-PI / 2.0 + 0.7 * (hash(i, trail, 94) - 0.5)) * Quat::from_rotation_z(hang);
            leaf_card(&mut shape, Mat4::from_rotation_translation(turn, at), 0.34);
        }
    }
    shape
}

/// A spray of leaves, rooted at the matrix's origin and growing along its y.
fn leaf_card(shape: &mut Shape, matrix: Mat4, size: f32) {
    let mut card = Shape::default();
    // The stalk of the picture begins a little above its lower edge.
    let origin = Vec3::new(-0.5, -0.05, 0.0) * size;
    card.quad(origin, Vec3::X * size, Vec3::Y * size, Vec2::ZERO, Vec2::ONE);
    shape.add(&card, matrix);
}

/// A bronze ball on a pedestal, for highlights.
fn orb(stage: &mut Stage, palette: &Palette) {
    let at = Vec3::new(1.5, 0.0, 4.6);
    let mut pedestal = Shape::default();
    pedestal.cuboid(Vec3::new(-0.42, 0.0, -0.42), Vec3::new(0.42, 0.12, 0.42));
    pedestal.cuboid(Vec3::new(-0.3, 0.12, -0.3), Vec3::new(0.3, 0.86, 0.3));
    pedestal.cuboid(Vec3::new(-0.38, 0.86, -0.38), Vec3::new(0.38, 0.95, 0.38));
    let pedestal = stage.mesh("pedestal", pedestal, palette.marble);
    stage.place(pedestal, Mat4::from_translation(at));
    let mut ball = Shape::default();
    ball.ball(0.34, 40);
    let ball = stage.mesh("orb", ball, palette.bronze);
    stage.place(ball, Mat4::from_translation(at + Vec3::Y * 1.28));
}
