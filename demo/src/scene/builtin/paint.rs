//! Textures, painted texel by texel.

use glam::{Vec2, Vec3};

/// RGBA, 8 bits a channel.
pub(super) struct Painting {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<u8>,
}

/// Asks `color` (encoded as the texture will be read, alpha opaque) for each texel, at its centre in [0, 1]².
pub(super) fn opaque(width: u32, height: u32, color: impl Fn(Vec2) -> Vec3) -> Painting {
    masked(width, height, |at| (color(at), 1.0))
}

/// As [`opaque`], with alpha.
pub(super) fn masked(width: u32, height: u32, color: impl Fn(Vec2) -> (Vec3, f32)) -> Painting {
    let size = Vec2::new(width as f32, height as f32);
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| Vec2::new(x as f32 + 0.5, y as f32 + 0.5)));
    let rgba = texels
        .flat_map(|texel| {
            let (color, alpha) = color(texel / size);
            color.extend(alpha).to_array().map(|c| (c * 255.0 + 0.5) as u8)
        })
        .collect();
    Painting { width, height, rgba }
}

/// The normal map of a tiling surface of this height, which counts in widths of the tile.
pub(super) fn relief(size: u32, height: impl Fn(Vec2) -> f32) -> Painting {
    let step = 1.0 / size as f32;
    let heights: Vec<f32> =
        (0..size * size).map(|i| height(Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5) * step)).collect();
    let at = |x: u32, y: u32| heights[((y % size) * size + x % size) as usize];
    opaque(size, size, |uv| {
        let (x, y) = ((uv.x * size as f32) as u32, (uv.y * size as f32) as u32);
        let dx = (at(x + 1, y) - at(x + size - 1, y)) / (2.0 * step);
        let dy = (at(x, y + 1) - at(x, y + size - 1)) / (2.0 * step);
        // Texture rows go down, the normal's y up.
        Vec3::new(-dx, dy, 1.0).normalize() * 0.5 + 0.5
    })
}

/// A number in [0, 1) that looks random.
pub(super) fn hash(x: i32, y: i32, seed: u32) -> f32 {
    let mut h =
        (x as u32).wrapping_mul(0x85eb_ca6b) ^ (y as u32).wrapping_mul(0xc2b2_ae35) ^ seed.wrapping_mul(0x27d4_eb2f);
    for multiplier in [0x7feb_352d_u32, 0x846c_a68b] {
        h = (h ^ h >> 16).wrapping_mul(multiplier);
    }
    (h >> 8) as f32 / (1 << 24) as f32
}

/// Smooth noise in [0, 1) with `cells` bumps a side, tiling with period 1.
pub(super) fn noise(at: Vec2, cells: i32, seed: u32) -> f32 {
    let scaled = at * cells as f32;
    let cell = scaled.floor();
    let f = scaled - cell;
    let f = f * f * (3.0 - 2.0 * f);
    let (x, y) = (cell.x as i32, cell.y as i32);
    let corner = |i: i32, j: i32| hash((x + i).rem_euclid(cells), (y + j).rem_euclid(cells), seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(corner(0, 0), corner(1, 0), f.x), mix(corner(0, 1), corner(1, 1), f.x), f.y)
}

/// Noise over `octaves`, about 0.5 on average.
pub(super) fn clouds(at: Vec2, cells: i32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for octave in 0..octaves {
        let part = 0.5_f32.powi(octave as i32);
        sum += noise(at, cells << octave, seed + octave) * part;
        weight += part;
    }
    sum / weight
}

/// 0 below `from`, 1 above `to`, smooth between.
pub(super) fn step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
