//! Twin of `shaders/passes/metrics.wgsl`.

use super::octahedral;
pub use crate::host::plan::DecidedBy as By;
use crate::settings::{DepthMeasure, LuminanceCurve, Windowed};
use glam::DVec3;

/// Depths at or below this are the sky.
pub const SKY_DEPTH: f32 = 1e-30;

/// The greatest rounding error of a metric in f32: GPU and twin may differ in k if the metric lies within this of a
/// half.
pub const ROUNDING_BAND: f64 = 2e-3;

/// The input of the metrics.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// The number of samples along one side of a window.
    pub m: usize,
    /// The width of the output in pixels.
    pub width: usize,
    /// The height of the output in pixels.
    pub height: usize,
    /// The depth target, (m·width) × (m·height), in reading order.
    pub depth: &'a [f32],
    /// The first colour target, in the same order: normal, identity.
    pub surface: &'a [[u32; 2]],
    /// S, width × height.
    pub first: &'a [[f32; 4]],
    /// The host's 32 bits of the samples, in the order of `depth`; empty if the G-buffer has none.
    pub user: &'a [u32],
    /// The shadow bits of the first samples, width × height; empty if nothing was traced.
    pub shadow: &'a [u32],
    /// Whether `probe` has found an edge of a shadow in each window, width × height; empty if it has not run.
    pub probed: &'a [bool],
    /// The exposure, [`Frame::exposure`](crate::Frame::exposure).
    pub exposure: f32,
}

/// The result of the metrics for a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worth {
    /// The number of samples, 1 to n.
    pub k: u32,
    /// The number of samples before rounding, 1 to n.
    pub exact: f64,
    /// The metric that decided it.
    pub by: By,
}

impl Worth {
    /// Whether rounding in f32 may give another k.
    pub fn is_near_a_half(&self) -> bool {
        ((self.exact - self.exact.floor()) - 0.5).abs() < ROUNDING_BAND
    }
}

impl Input<'_> {
    fn depth(&self, x: isize, y: isize) -> f64 {
        let clamp = |v: isize, side: usize| v.clamp(0, (side * self.m) as isize - 1) as usize;
        let d = self.depth[clamp(y, self.height) * self.width * self.m + clamp(x, self.width)];
        if d > SKY_DEPTH { f64::from(d) } else { 0.0 }
    }

    fn surface(&self, x: usize, y: usize) -> [u32; 2] {
        self.surface[y * self.width * self.m + x]
    }

    /// The first sample of a pixel as the luminance metric sees it: the channels, or luminance as a grey.
    fn color(&self, x: isize, y: isize, w: &Windowed) -> [f64; 3] {
        let clamp = |v: isize, side: usize| v.clamp(0, side as isize - 1) as usize;
        let [r, g, b, _] = self.first[clamp(y, self.height) * self.width + clamp(x, self.width)].map(f64::from);
        let seen = if w.luminance_channels { [r, g, b] } else { [0.2126 * r + 0.7152 * g + 0.0722 * b; 3] };
        seen.map(|c| {
            let c = (c * f64::from(self.exposure)).min(1e30);
            match w.luminance {
                LuminanceCurve::Linear => c,
                LuminanceCurve::Perceptual => (c / (1.0 + c)).sqrt(),
            }
        })
    }

    fn samples(&self, px: usize, py: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let m = self.m;
        (0..m * m).map(move |i| (px * m + i % m, py * m + i / m))
    }

    fn is_sky(&self, x: usize, y: usize) -> bool {
        self.depth(x as isize, y as isize) == 0.0
    }

    /// The variance of the depths over their squared mean, Σ(d − mean)²/n over mean², in two passes.
    pub fn depth_variance(&self, px: usize, py: usize) -> f64 {
        let n = (self.m * self.m) as f64;
        let depths: Vec<f64> = self.samples(px, py).map(|(x, y)| self.depth(x as isize, y as isize)).collect();
        let mean = depths.iter().sum::<f64>() / n;
        if mean <= 0.0 {
            return 0.0;
        }
        depths.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / n / (mean * mean)
    }

    /// The greatest step between neighbours that extrapolation from neither side explains, over the nearer one's depth.
    pub fn depth_discontinuity(&self, px: usize, py: usize) -> f64 {
        let m = self.m as isize;
        let (x0, y0) = (px as isize * m, py as isize * m);
        let mut greatest: f64 = 0.0;
        for i in 0..m {
            for j in 0..m - 1 {
                let row = [-1, 0, 1, 2].map(|o| self.depth(x0 + j + o, y0 + i));
                let column = [-1, 0, 1, 2].map(|o| self.depth(x0 + i, y0 + j + o));
                for [a, b, c, d] in [row, column] {
                    let nearer = b.max(c);
                    if nearer > 0.0 {
                        let step = (2.0 * b - a - c).abs().min((2.0 * c - d - b).abs());
                        greatest = greatest.max(step / nearer);
                    }
                }
            }
        }
        greatest
    }

    /// √(1 − min n̄·n); 2 if the normals cancel; 0 if all have one code.
    pub fn normal_cone(&self, px: usize, py: usize, two_sided: bool) -> f64 {
        let codes: Vec<u32> =
            self.samples(px, py).filter(|&(x, y)| !self.is_sky(x, y)).map(|(x, y)| self.surface(x, y)[0]).collect();
        if codes.windows(2).all(|pair| pair[0] == pair[1]) {
            return 0.0;
        }
        let normals: Vec<DVec3> = codes.iter().map(|&c| octahedral::decode(c)).collect();
        let sum: DVec3 = normals.iter().sum();
        if sum.length() / (normals.len() as f64) < 1e-3 {
            return 2.0;
        }
        let mean = sum.normalize();
        let apart = |n: &DVec3| {
            let squared = (mean - *n).length_squared();
            if two_sided { squared.min((mean + *n).length_squared()) } else { squared }
        };
        (normals.iter().map(apart).fold(0.0, f64::max) * 0.5).sqrt()
    }

    /// The greatest range of a channel over the four direct neighbours and, on request, the pixel itself. A range below
    /// the greater of the two thresholds is 0.
    pub fn luminance_range(&self, px: usize, py: usize, w: &Windowed) -> f64 {
        let (x, y) = (px as isize, py as isize);
        let mut values = vec![(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
        if w.luminance_centre {
            values.push((x, y));
        }
        let colors: Vec<[f64; 3]> = values.into_iter().map(|(x, y)| self.color(x, y, w)).collect();
        let edge = |channel: usize| {
            let values = colors.iter().map(|c| c[channel]);
            let greatest = values.clone().fold(f64::NEG_INFINITY, f64::max);
            let range = greatest - values.fold(f64::INFINITY, f64::min);
            let threshold = f64::from(w.luminance_min).max(greatest * f64::from(w.luminance_edge));
            if range < threshold { 0.0 } else { range }
        };
        (0..3).map(edge).fold(0.0, f64::max)
    }

    /// The greatest range of one of the host's four bytes, each 0 to 1, over the window's samples. The sky has none.
    pub fn user_range(&self, px: usize, py: usize) -> f64 {
        let shown = self.samples(px, py).filter(|&(x, y)| !self.is_sky(x, y));
        let bytes: Vec<[u8; 4]> =
            shown.filter_map(|(x, y)| self.user.get(y * self.width * self.m + x)).map(|u| u.to_le_bytes()).collect();
        let range = |i: usize| {
            let values = bytes.iter().map(|b| b[i]);
            values.clone().max().unwrap_or(0) - values.min().unwrap_or(0)
        };
        f64::from((0..4).map(range).max().unwrap_or(0)) / 255.0
    }

    /// Whether the window has more than one material or object. The sky counts as one.
    pub fn mixed_identity(&self, px: usize, py: usize) -> bool {
        let identity = |(x, y): (usize, usize)| (!self.is_sky(x, y)).then(|| self.surface(x, y)[1]);
        let mut all = self.samples(px, py).map(identity);
        let first = all.next();
        all.any(|i| Some(i) != first)
    }

    /// Whether an edge of a shadow was found in the window, or the first sample has other shadow bits than that of a direct
    /// neighbour. The sky is ignored.
    pub fn mixed_shadow(&self, px: usize, py: usize) -> bool {
        let corner = |x: usize, y: usize| {
            let (dx, dy) = crate::window::order(self.m as u32)[0];
            !self.is_sky(x * self.m + dx as usize, y * self.m + dy as usize)
        };
        let bits = |x: usize, y: usize| self.shadow.get(y * self.width + x).copied().unwrap_or(0);
        let around = [
            (px.saturating_sub(1), py),
            ((px + 1).min(self.width - 1), py),
            (px, py.saturating_sub(1)),
            (px, (py + 1).min(self.height - 1)),
        ];
        let probed = self.probed.get(py * self.width + px).copied().unwrap_or(false);
        corner(px, py) && (probed || around.into_iter().any(|(x, y)| corner(x, y) && bits(x, y) != bits(px, py)))
    }

    /// The k of a window: the greatest of all metrics.
    pub fn worth(&self, px: usize, py: usize, w: &Windowed) -> Worth {
        let n = (self.m * self.m) as f64;
        let mut exact = 1.0;
        let mut by = By::Nothing;
        let mut ask = |wanted: f64, metric: By| {
            if wanted > exact {
                (exact, by) = (wanted, metric);
            }
        };
        if w.depth_scale > 0.0 {
            let depth = match w.depth {
                DepthMeasure::Variance => self.depth_variance(px, py),
                DepthMeasure::Discontinuity => self.depth_discontinuity(px, py),
            };
            ask(f64::from(w.depth_scale) * depth, By::Depth);
        }
        if w.normal_scale > 0.0 {
            let cone = self.normal_cone(px, py, w.two_sided);
            ask(if cone > 1.9 { n } else { f64::from(w.normal_scale) * cone }, By::Normal);
        }
        let all_sky = self.samples(px, py).all(|(x, y)| self.is_sky(x, y));
        if w.luminance_scale > 0.0 && !all_sky {
            ask(f64::from(w.luminance_scale) * self.m as f64 / 4.0 * self.luminance_range(px, py, w), By::Luminance);
        }
        if w.identity_samples > 0.0 && self.mixed_identity(px, py) {
            ask(f64::from(w.identity_samples), By::Identity);
        }
        if w.shadow_samples > 0.0 && self.mixed_shadow(px, py) {
            ask(f64::from(w.shadow_samples), By::Shadow);
        }
        if w.user_scale > 0.0 {
            ask(f64::from(w.user_scale) * self.user_range(px, py), By::User);
        }
        if !all_sky {
            ask(f64::from(w.least_samples), By::Least);
        }
        let exact = exact.min(n);
        let k = exact.round_ties_even() as u32;
        Worth { k, exact, by: if k == 1 { By::Nothing } else { by } }
    }
}
