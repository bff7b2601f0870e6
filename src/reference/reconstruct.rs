//! Twin of `shaders/passes/reconstruct.wgsl`.

use super::octahedral;
use crate::reference::sample::relative_from_clip;
use crate::{Camera, Reconstructed, window};
use glam::{DMat4, DVec3, DVec4};

/// The input of the pass.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The camera of the frame.
    pub camera: Camera,
    /// The number of samples along one side of a window.
    pub m: u32,
    /// The size of the output in pixels.
    pub size: [u32; 2],
    /// The depth target, rows from the top.
    pub depth: &'a [f32],
    /// The first colour target.
    pub surface: &'a [[u32; 2]],
    /// S, the image of first samples.
    pub first: &'a [[f32; 4]],
    /// The shadow bits of a pixel and a rank.
    pub shadow: &'a dyn Fn(u32, u32, u32) -> u32,
    /// The result of the host's code for a pixel and a rank.
    pub shade: &'a dyn Fn(u32, u32, u32) -> [f64; 4],
}

/// The result for a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel {
    /// The mean of its samples with equal weights.
    pub color: [f64; 4],
    /// The number of shaded samples, the first included.
    pub k: u32,
    /// Whether rounding could not have changed the result: no weight is too near to a threshold.
    pub sure: bool,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Geometry {
    pub position: DVec3,
    pub depth: f64,
    pub normal: DVec3,
    pub identity: u32,
    pub shadow: u32,
}

/// The greatest distance from a threshold that rounding may bridge.
const NEAR: f64 = 1e-3;

impl Input<'_> {
    fn order(&self, settings: &Reconstructed) -> Vec<(u8, u8)> {
        if settings.rotated_grid { window::rotated(self.m) } else { window::order(self.m) }
    }

    fn geometry(&self, order: &[(u8, u8)], x: u32, y: u32, rank: usize) -> Geometry {
        let at = [x, y, rank as u32];
        geometry(&View::new(&self.camera), self.m, self.size, self.depth, self.surface, self.shadow, order, at)
    }

    /// Computes one pixel of the frame, with an exposure of 1.
    pub fn pixel(&self, x: u32, y: u32, settings: &Reconstructed) -> Pixel {
        let order = self.order(settings);
        let samples = settings.samples(self.m) as usize;
        let mut sure = true;
        let mut above = |value: f64, threshold: f64| {
            sure &= (value - threshold).abs() > NEAR * threshold.max(NEAR);
            value >= threshold
        };
        let first = |x: u32, y: u32| self.first[(y * self.size[0] + x) as usize].map(f64::from);
        let own = self.geometry(&order, x, y, 0);
        let last = self.size.map(|side| i64::from(side) - 1);
        let beside = |dx: i64, dy: i64| (i64::from(x) + dx, i64::from(y) + dy);

        // Contrast that the geometry does not explain.
        let mut k = 1;
        if settings.own_first && settings.contrast_scale > 0.0 && own.depth > 0.0 {
            let mut near = vec![shown(first(x, y))];
            for (dx, dy) in [(0, -1), (-1, 0), (0, 1), (1, 0)] {
                let (nx, ny) = beside(dx, dy);
                let (nx, ny) = (nx.clamp(0, last[0]) as u32, ny.clamp(0, last[1]) as u32);
                if above(weight(settings, &own, &self.geometry(&order, nx, ny, 0)), 0.5) {
                    near.push(shown(first(nx, ny)));
                }
            }
            let range = greatest_range(&near);
            let range = if above(range, f64::from(settings.contrast_min)) { range } else { 0.0 };
            let wanted = f64::from(settings.contrast_scale) * f64::from(self.m) / 4.0 * range;
            k = wanted.round().clamp(1.0, samples as f64) as usize;
            for half in [wanted.floor() + 0.5, wanted.ceil() - 0.5] {
                above(wanted, half);
            }
        }
        let mut shaded = 1;
        let mut own_mean = vec![first(x, y)];
        for rank in 1..k {
            if above(weight(settings, &self.geometry(&order, x, y, rank), &own), 0.5) {
                own_mean.push((self.shade)(x, y, rank as u32));
                shaded += 1;
            }
        }
        let own_color = mean(&own_mean);

        let mut colors = Vec::new();
        for rank in 0..samples {
            let i = self.geometry(&order, x, y, rank);
            if settings.own_first && above(weight(settings, &i, &own), 0.5) {
                colors.push(own_color);
                continue;
            }
            let (mut sum, mut weights) = ([0.0; 4], 0.0);
            for (dy, dx) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))) {
                let (nx, ny) = beside(dx, dy);
                if nx < 0 || ny < 0 || nx > last[0] || ny > last[1] {
                    continue;
                }
                let (nx, ny) = (nx as u32, ny as u32);
                let w = weight(settings, &i, &self.geometry(&order, nx, ny, 0));
                weights += w;
                let color = first(nx, ny);
                sum = std::array::from_fn(|c| sum[c] + color[c] * w);
            }
            if above(weights, f64::from(settings.least_weight)) {
                colors.push(sum.map(|c| c / weights));
            } else if rank > 0 {
                colors.push((self.shade)(x, y, rank as u32));
                shaded += 1;
            } else {
                colors.push(own_color);
            }
        }
        Pixel { color: mean(&colors), k: shaded, sure }
    }
}

fn shown([r, g, b, _]: [f64; 4]) -> [f64; 3] {
    [r, g, b].map(|c| (c / (1.0 + c)).sqrt())
}

/// The greatest range of a channel.
fn greatest_range(colors: &[[f64; 3]]) -> f64 {
    let range = |channel: usize| {
        let values = colors.iter().map(|c| c[channel]);
        values.clone().fold(0.0, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    (0..3).map(range).fold(0.0, f64::max)
}

fn mean(colors: &[[f64; 4]]) -> [f64; 4] {
    std::array::from_fn(|c| colors.iter().map(|color| color[c]).sum::<f64>() / colors.len() as f64)
}

/// The values that are derived from a frame's camera.
#[derive(Debug, Clone, Copy)]
pub struct View {
    relative_from_clip: DMat4,
    forward: DVec3,
}

impl View {
    /// Derives the values.
    pub fn new(camera: &Camera) -> Self {
        let forward = -camera.world_from_view.as_dmat4().z_axis.truncate().normalize();
        Self { relative_from_clip: relative_from_clip(camera), forward }
    }
}

/// `daa_geometry` of a pixel and a rank.
#[expect(clippy::too_many_arguments, reason = "what a frame has")]
pub(super) fn geometry(
    view: &View,
    m: u32,
    size: [u32; 2],
    depth: &[f32],
    surface: &[[u32; 2]],
    shadow: &dyn Fn(u32, u32, u32) -> u32,
    order: &[(u8, u8)],
    [x, y, rank]: [u32; 3],
) -> Geometry {
    let place = order[rank as usize];
    let (sx, sy) = (x * m + u32::from(place.0), y * m + u32::from(place.1));
    let [width, height] = size.map(|side| side * m);
    let at = (sy * width + sx) as usize;
    let valid = depth[at] > 1e-30;
    let d = if valid { f64::from(depth[at]) } else { 1.0 };
    let ndc =
        [(f64::from(sx) + 0.5) / f64::from(width) * 2.0 - 1.0, 1.0 - (f64::from(sy) + 0.5) / f64::from(height) * 2.0];
    let p = view.relative_from_clip * DVec4::new(ndc[0], ndc[1], d, 1.0);
    let position = p.truncate() / p.w;
    Geometry {
        position,
        depth: if valid { position.dot(view.forward) } else { 0.0 },
        normal: octahedral::decode(surface[at][0]),
        identity: if valid { surface[at][1] } else { 0 },
        shadow: if valid { shadow(x, y, rank) } else { 0 },
    }
}

/// `daa_reconstruct_weight`.
pub(super) fn weight(settings: &Reconstructed, i: &Geometry, j: &Geometry) -> f64 {
    if i.depth == 0.0 || j.depth == 0.0 {
        return f64::from(u8::from(i.depth == j.depth));
    }
    if (settings.cut_identity && i.identity != j.identity) || (settings.cut_shadow && i.shadow != j.shadow) {
        return 0.0;
    }
    let (apart, bent) = if settings.planes {
        let way = j.position - i.position;
        (way.dot(i.normal) / way.length().max(1e-6 * i.depth).max(1e-15), (j.normal - i.normal).length())
    } else {
        ((j.depth - i.depth) / i.depth, 1.0 - i.normal.dot(j.normal).clamp(0.0, 1.0))
    };
    let (z, n) = (f64::from(settings.depth_scale) * apart, f64::from(settings.normal_scale) * bent);
    (-(z * z + n * n)).exp()
}
