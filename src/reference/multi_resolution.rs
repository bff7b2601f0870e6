//! Twin of `lattice.wgsl`, `residual.wgsl`, `refine.wgsl` and `lattice_to_pixels.wgsl` in `shaders/lattice`.

use super::metrics::SKY_DEPTH;
use super::reconstruct::{Geometry, View, geometry, weight};
use crate::gpu::uniforms::lattice::{self, LatticeStep, LatticeSteps, LatticeUse};
use crate::settings::{LuminanceCurve, MultiResolution, Pattern, Reconstructed};
use glam::DVec3;

/// The greatest rounding error of a residual of colour in f32: GPU and twin may differ if one is as near to its
/// threshold.
pub const COLOR_BAND: f64 = 2e-6;
/// The same for a residual of position.
pub const POSITION_BAND: f64 = 2e-5;
/// The same for the weights of interpolation.
pub const WEIGHT_BAND: f64 = 1e-3;

/// The reason for choosing a point: the second byte of its word.
pub mod by {
    /// The point is not chosen.
    pub const SMOOTH: u32 = 0;
    /// Its colour differs from the mean of opposite neighbours.
    pub const COLOR: u32 = 1;
    /// Its position in the world differs from the mean of opposite neighbours.
    pub const POSITION: u32 = 2;
    /// Its parents lie on another surface.
    pub const EDGE: u32 = 3;
    /// Its shadow bits differ.
    pub const SHADOW: u32 = 4;
    /// Its lattice is the coarsest.
    pub const COARSEST: u32 = 5;
}

/// A lattice of points over a G-buffer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// The arrangement of the points.
    pub pattern: Pattern,
    /// The base-2 logarithm of their pitch in pixels.
    pub level: u32,
    /// The number of columns and rows. The last few lie beyond the image.
    pub size: [u32; 2],
    /// The index of the first point's word and colour.
    pub first: u32,
    /// The position among the lattices, as in [`Statistics::points`](crate::Statistics::points).
    pub place: u32,
}

/// The step from one lattice to the next finer one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The finer lattice.
    pub points: Lattice,
    /// The coarser lattice. `None`: there is none, and every point is chosen.
    pub parents: Option<Lattice>,
    /// Whether the lattice's points cast rays.
    pub rays: bool,
}

/// The steps of a frame, from the coarsest.
pub fn steps(settings: &MultiResolution, size: [u32; 2], rays: bool) -> Vec<Step> {
    let all = LatticeSteps::new(settings, size, size, u32::from(rays));
    let of = if rays { LatticeUse::Rays } else { LatticeUse::Shading };
    let patterns = [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral];
    let lattice = |l: &lattice::LatticeUniform| Lattice {
        pattern: patterns[l.kind as usize],
        level: l.level,
        size: [l.width, l.height],
        first: l.first,
        place: l.place,
    };
    lattice::levels(settings, of)
        .map(|level| {
            let step = all.step(LatticeStep { of, level });
            let parents = (step.coarsest == 0).then(|| lattice(&step.parents));
            Step { points: lattice(&step.points), parents, rays }
        })
        .collect()
}

/// A sample of the G-buffer: pixel and rank.
pub type Sample = [u32; 3];

impl Lattice {
    /// The height of a row over the pitch.
    fn row(&self) -> f64 {
        if self.pattern == Pattern::Equilateral { 56756.0 / 65536.0 } else { 1.0 }
    }

    fn shift(&self, row: i64) -> f64 {
        if self.pattern != Pattern::Quad && row % 2 != 0 { 0.5 } else { 0.0 }
    }

    fn clamped(&self, [i, j]: [i64; 2]) -> [i64; 2] {
        [i.clamp(0, i64::from(self.size[0]) - 1), j.clamp(0, i64::from(self.size[1]) - 1)]
    }

    /// The index of a point's word and colour.
    pub fn index(&self, at: [i64; 2]) -> usize {
        let [i, j] = self.clamped(at);
        self.first as usize + (j * i64::from(self.size[0]) + i) as usize
    }

    /// The offsets to pairs of opposite neighbours.
    fn pairs(&self, row: i64) -> Vec<[[i64; 2]; 2]> {
        if self.pattern == Pattern::Quad {
            return vec![[[-1, 0], [1, 0]], [[0, -1], [0, 1]], [[-1, -1], [1, 1]], [[-1, 1], [1, -1]]];
        }
        let right = row.rem_euclid(2);
        vec![[[-1, 0], [1, 0]], [[right - 1, -1], [right, 1]], [[right, -1], [right - 1, 1]]]
    }
}

impl Step {
    /// The coarser points around a point, with their weights.
    pub fn parents(&self, [i, j]: [i64; 2]) -> Vec<([i64; 2], f64)> {
        let Some(coarse) = self.parents else { return Vec::new() };
        let scale = f64::from(1 << self.points.level) / f64::from(1 << coarse.level);
        let x = (i as f64 + self.points.shift(j)) * scale;
        let y = j as f64 * scale * (self.points.row() / coarse.row());
        let (row, fy) = (y.floor() as i64, y - y.floor());
        // The point to the left of x on a row, and the way from it to x.
        let on_row = |row: i64, x: f64| {
            let along = x - coarse.shift(row);
            (along.floor() as i64, along - along.floor())
        };
        let found = if coarse.pattern == Pattern::Quad {
            let (i, fx) = on_row(row, x);
            vec![
                ([i, row], (1.0 - fx) * (1.0 - fy)),
                ([i + 1, row], fx * (1.0 - fy)),
                ([i, row + 1], (1.0 - fx) * fy),
                ([i + 1, row + 1], fx * fy),
            ]
        } else {
            // Follows the side of the triangle down to its base.
            let (lower, fa) = on_row(row, x - fy / 2.0);
            let (upper, _) = on_row(row + 1, lower as f64 + coarse.shift(row) + 0.5);
            if fa + fy <= 1.0 {
                vec![([lower, row], 1.0 - fa - fy), ([lower + 1, row], fa), ([upper, row + 1], fy)]
            } else {
                vec![([lower + 1, row], 1.0 - fy), ([upper, row + 1], 1.0 - fa), ([upper + 1, row + 1], fa + fy - 1.0)]
            }
        };
        found.into_iter().filter(|&(_, share)| share > 0.0).collect()
    }
}

/// The input of the passes.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The camera of the frame.
    pub view: View,
    /// The number of samples along one side of a window.
    pub m: u32,
    /// The order of samples, [`window::order`](crate::window::order).
    pub places: &'a [(u8, u8)],
    /// The size of the output in pixels.
    pub size: [u32; 2],
    /// The depth target, rows from the top.
    pub depth: &'a [f32],
    /// The first colour target.
    pub surface: &'a [[u32; 2]],
    /// The exposure, [`Frame::exposure`](crate::Frame::exposure).
    pub exposure: f32,
    /// The shadow bits of a point, given its index and its sample.
    pub shadow: &'a dyn Fn(usize, Sample) -> u32,
    /// The colour of a point, or the radiance that it reflects and refracts, with 1 in w if anything was traced.
    pub value: &'a dyn Fn(usize, Sample) -> [f64; 4],
}

/// The result for a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refined {
    /// The low 16 bits of its word.
    pub word: u32,
    /// The interpolated value, or that of a coarser point.
    pub value: Option<[f64; 4]>,
    /// The interpolated shadow bits, or those of a coarser point.
    pub shadow: u32,
    /// Whether rounding could not have changed the result: nothing is too near to a threshold.
    pub sure: bool,
}

/// The residual of a neighbourhood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// The greatest residual of the three channels.
    pub color: f64,
    /// The reason to refine, see [`by`].
    pub by: u32,
    /// Whether rounding could not have changed the result.
    pub sure: bool,
}

impl Input<'_> {
    /// The position of a point in samples.
    fn place(&self, l: &Lattice, at: [i64; 2]) -> [i64; 2] {
        let [i, j] = l.clamped(at);
        let first = self.places[0];
        let pitch = i64::from(self.m) << l.level;
        let shifted = if l.shift(j) > 0.0 { pitch / 2 } else { 0 };
        let row = if l.pattern == Pattern::Equilateral { (j * pitch * 56756 + 32768) >> 16 } else { j * pitch };
        [i * pitch + shifted + i64::from(first.0), row + i64::from(first.1)]
    }

    /// Whether a point lies in the image.
    pub fn is_inside(&self, l: &Lattice, at: [i64; 2]) -> bool {
        self.place(l, at).into_iter().zip(self.size).all(|(v, side)| v < i64::from(self.m * side))
    }

    /// The sample of a point.
    pub fn sample(&self, l: &Lattice, at: [i64; 2]) -> Sample {
        let m = i64::from(self.m);
        let [x, y] = self.place(l, at);
        let place = ((x % m) as u8, (y % m) as u8);
        let rank = self.places.iter().position(|&p| p == place).expect("a place of the window");
        let pixel = |v: i64, side: u32| (v / m).min(i64::from(side) - 1) as u32;
        [pixel(x, self.size[0]), pixel(y, self.size[1]), rank as u32]
    }

    fn geometry(&self, index: usize, [x, y, rank]: Sample, shadows: bool) -> Geometry {
        let shadow = |x, y, rank| if shadows { (self.shadow)(index, [x, y, rank]) } else { 0 };
        geometry(&self.view, self.m, self.size, self.depth, self.surface, &shadow, self.places, [x, y, rank])
    }

    fn shown(&self, v: f64, settings: &MultiResolution) -> f64 {
        let l = (v * f64::from(self.exposure)).min(1e30);
        match settings.curve {
            LuminanceCurve::Linear => l,
            LuminanceCurve::Perceptual => (l / (1.0 + l)).sqrt(),
        }
    }

    /// The residual of a point. Beyond the lattice, points of its border are repeated.
    pub fn residual(&self, l: &Lattice, at: [i64; 2], rays: bool, settings: &MultiResolution) -> Residual {
        struct Judged {
            shown: [f64; 3],
            shadow: u32,
            position: DVec3,
            sky: bool,
        }
        let judged = |at: [i64; 2]| {
            let sample = self.sample(l, at);
            let geometry = self.geometry(l.index(at), sample, rays);
            let value = (self.value)(l.index(at), sample);
            Judged {
                shown: std::array::from_fn(|c| self.shown(value[c], settings)),
                shadow: geometry.shadow,
                position: geometry.position,
                sky: geometry.depth == 0.0,
            }
        };
        let own = judged(at);
        let (mut color, mut position, mut shadow) = ([0.0; 3], 0.0, false);
        let pairs = l.pairs(at[1]);
        for pair in &pairs {
            let [a, b] = pair.map(|[dx, dy]| judged([at[0] + dx, at[1] + dy]));
            for (c, sum) in color.iter_mut().enumerate() {
                *sum += (own.shown[c] - (a.shown[c] + b.shown[c]) / 2.0).abs();
            }
            position += match [own.sky, a.sky, b.sky] {
                [true, true, true] => 0.0,
                [false, false, false] => {
                    (own.position - (a.position + b.position) / 2.0).length() / own.position.length()
                }
                _ => 1e9,
            };
            shadow |= a.shadow != own.shadow || b.shadow != own.shadow;
        }
        let neighbours = 2.0 * pairs.len() as f64;
        let color = color.into_iter().fold(0.0, f64::max) / neighbours;
        let position = position / neighbours;
        let [of_color, of_position] = [settings.color_threshold, settings.position_threshold].map(f64::from);
        let by = if color > of_color {
            by::COLOR
        } else if position > of_position {
            by::POSITION
        } else if shadow {
            by::SHADOW
        } else {
            by::SMOOTH
        };
        let near_color = color > 0.0 && (color - of_color).abs() <= COLOR_BAND;
        let near_position = position > 0.0 && (position - of_position).abs() <= POSITION_BAND;
        Residual { color, by, sure: !near_color && !near_position }
    }

    /// The result for a point of a step with parents.
    pub fn refine(
        &self,
        step: &Step,
        at: [i64; 2],
        settings: &MultiResolution,
        filter: &Reconstructed,
        word: &dyn Fn(usize) -> u32,
    ) -> Option<Refined> {
        let coarse = step.parents?;
        let sample = self.sample(&step.points, at);
        let parents = step.parents(at);
        if let [(parent, _)] = parents[..]
            && self.sample(&coarse, parent) == sample
        {
            let index = coarse.index(parent);
            let value = Some((self.value)(index, sample));
            return Some(Refined {
                word: word(index) & 0xfffe,
                value,
                shadow: (self.shadow)(index, sample),
                sure: true,
            });
        }
        let own = self.geometry(step.points.index(at), sample, !step.rays);
        let (mut sum, mut total, mut why, mut sure) = ([0.0; 4], 0.0, by::SMOOTH, true);
        let mut shadow: Option<u32> = None;
        for (parent, share) in parents {
            let of_parent = self.sample(&coarse, parent);
            let geometry = self.geometry(coarse.index(parent), of_parent, true);
            let judged = self.residual(&coarse, coarse.clamped(parent), step.rays, settings);
            sure &= judged.sure;
            let other_lights = if step.rays {
                shadow.is_some_and(|bits| bits != geometry.shadow)
            } else {
                settings.veto && geometry.shadow != own.shadow
            };
            let apart = geometry.identity != own.identity || (geometry.depth == 0.0) != (own.depth == 0.0);
            let reasons =
                [(other_lights, by::SHADOW), (settings.veto && apart, by::EDGE), (judged.by != by::SMOOTH, judged.by)];
            if why == by::SMOOTH {
                why = reasons.into_iter().find(|&(is, _)| is).map_or(why, |(_, by)| by);
            }
            shadow = Some(geometry.shadow);
            let asked = Geometry { shadow: if step.rays { geometry.shadow } else { own.shadow }, ..own };
            let share = share * if settings.weighted { weight(filter, &asked, &geometry) } else { 1.0 };
            let value = (self.value)(coarse.index(parent), of_parent);
            sum = std::array::from_fn(|c| sum[c] + value[c] * share);
            total += share;
        }
        if why == by::SMOOTH {
            sure &= (total - 0.5).abs() > WEIGHT_BAND;
            if total < 0.5 {
                why = by::EDGE;
            }
        }
        let place = step.points.place << 4;
        Some(if step.rays && own.depth == 0.0 {
            Refined { word: 2 | place, value: None, shadow: 0, sure: true }
        } else if why == by::SMOOTH {
            let value = Some(sum.map(|c| c / total));
            Refined { word: coarse.place << 4, value, shadow: shadow.unwrap_or(0), sure }
        } else {
            Refined { word: 3 | place | why << 8, value: None, shadow: 0, sure }
        })
    }

    /// The k of a pixel that may be refined beyond the lattice of pixels, and whether rounding could not have changed
    /// it. `own` says whether its point was shaded.
    pub fn windows(&self, pixels: &Lattice, x: u32, y: u32, own: bool, settings: &MultiResolution) -> (u32, bool) {
        let residual = self.residual(pixels, [i64::from(x), i64::from(y)], false, settings);
        let n = self.m * self.m;
        let (mut k, mut sure) = (u32::from(own), residual.sure);
        let mut level = f64::from(settings.color_threshold);
        for f in 1..=3 {
            sure &= level == 0.0 || (residual.color - level).abs() > COLOR_BAND * f64::from(1 << (2 * f));
            if residual.color <= level {
                break;
            }
            k = if self.m.is_multiple_of(1 << f) { (1 << (2 * f)).min(n) } else { n };
            level *= 4.0;
        }
        let identity = |i: u32| {
            let (sx, sy) = (x * self.m + i % self.m, y * self.m + i / self.m);
            let at = (sy * self.size[0] * self.m + sx) as usize;
            (self.depth[at] > SKY_DEPTH).then(|| self.surface[at][1])
        };
        let holds_edge = (1..n).any(|i| identity(i) != identity(0));
        if residual.by == by::POSITION || (settings.veto && holds_edge) {
            k = n;
        }
        (k, sure)
    }
}
