//! Twin of `shaders/passes/select.wgsl` and `shaders/passes/quadrants.wgsl`.

use super::octahedral;
use super::resolve;
use crate::settings::{ColorReference, LuminanceCurve, Selective, Weight};
use crate::window;

/// The greatest rounding error of a contrast or a cosine in f32: GPU and twin may differ if one is as near to its
/// threshold.
pub const ROUNDING_BAND: f64 = 2e-6;

/// The input of the passes.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The number of samples along one side of a window.
    pub m: u32,
    /// The order of samples, [`window::centred`].
    pub places: &'a [(u8, u8)],
    /// The size of the output in pixels.
    pub size: [u32; 2],
    /// The depth target, rows from the top.
    pub depth: &'a [f32],
    /// The first colour target.
    pub surface: &'a [[u32; 2]],
    /// S, the image of first samples.
    pub first: &'a [[f32; 4]],
    /// The exposure, [`Frame::exposure`](crate::Frame::exposure).
    pub exposure: f32,
    /// The shadow bits of a pixel's first sample.
    pub shadow: &'a dyn Fn(u32, u32) -> u32,
    /// The surface that a pixel's first sample reflects (kind 0) or refracts (1): `daa_reflection_hit`.
    pub hit: &'a dyn Fn(u32, u32, u32) -> [u32; 3],
    /// Whether a material has a texture.
    pub textured: &'a dyn Fn(u32) -> bool,
    /// The importance of an object, 0 to 1, in steps of 1/255.
    pub importance: &'a dyn Fn(u32) -> f64,
}

/// The attribute of a threshold, in the order of the thresholds: colour; object, normal, shadow and texture of the
/// shown surface; and the same of reflected and refracted surfaces.
pub type Attribute = usize;

/// A quadrant: upper left, upper right, lower left or lower right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadrant {
    /// Whether four of its samples are shaded.
    pub active: bool,
    /// The attribute of its threshold.
    pub by: Attribute,
    /// Whether rounding could not have changed the result: nothing is too near to a threshold.
    pub sure: bool,
}

/// The values by which a surface is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hit {
    object: u32,
    normal: u32,
    shadow: u32,
    textured: bool,
}

impl Input<'_> {
    fn clamped(&self, x: i64, y: i64) -> [u32; 2] {
        let clamp = |v: i64, side: u32| v.clamp(0, i64::from(side) - 1) as u32;
        [clamp(x, self.size[0]), clamp(y, self.size[1])]
    }

    fn first(&self, x: i64, y: i64) -> [f64; 4] {
        let [x, y] = self.clamped(x, y);
        self.first[(y * self.size[0] + x) as usize].map(f64::from)
    }

    fn shown(&self, v: f64, s: &Selective) -> f64 {
        let l = (v * f64::from(self.exposure)).min(1e30);
        match s.curve {
            LuminanceCurve::Linear => l,
            LuminanceCurve::Perceptual => (l / (1.0 + l)).sqrt(),
        }
    }

    fn luminance(&self, x: i64, y: i64, s: &Selective) -> f64 {
        let [r, g, b, _] = self.first(x, y);
        self.shown(0.2126 * r + 0.7152 * g + 0.0722 * b, s)
    }

    fn gradient(&self, x: i64, y: i64, s: &Selective) -> f64 {
        let side = |across: bool, sign: i64| -> f64 {
            let at = |along: i64| if across { (x + sign, y + along) } else { (x + along, y + sign) };
            [(-1, 1.0), (0, 2.0), (1, 1.0)].iter().map(|&(i, w)| w * self.luminance(at(i).0, at(i).1, s)).sum()
        };
        let [dx, dy] = [true, false].map(|across| side(across, 1) - side(across, -1));
        (dx.hypot(dy) / 4.0).min(1.0)
    }

    /// The surfaces that a pixel shows, reflects and refracts.
    fn hits(&self, x: i64, y: i64, s: &Selective) -> [Option<Hit>; 3] {
        let [x, y] = self.clamped(x, y);
        let hit = |object: u32, material: u32, normal: u32, bits: u32| Hit {
            object,
            normal,
            shadow: if s.shadow_lights { bits } else { bits.count_ones() },
            textured: (self.textured)(material),
        };
        let (sx, sy) = self.places[0];
        let at = (y * self.m + u32::from(sy)) * self.size[0] * self.m + x * self.m + u32::from(sx);
        let [normal, identity] = self.surface[at as usize];
        let own = (self.depth[at as usize] > 1e-30)
            .then(|| hit(identity >> 16, identity & 0xffff, normal, (self.shadow)(x, y)));
        let [reflected, refracted] = [0, 1].map(|kind| {
            let [names, normal, bits] = (self.hit)(x, y, kind);
            (normal != 0).then(|| hit(names & 0xffff, names >> 16, normal, bits))
        });
        [own, reflected, refracted]
    }

    fn importance_of(&self, hit: Option<Hit>, s: &Selective) -> f64 {
        if s.focused { hit.map_or(0.0, |hit| (self.importance)(hit.object)) } else { 1.0 }
    }

    /// The result for one quadrant of a pixel.
    pub fn quadrant(&self, x: u32, y: u32, quadrant: u32, s: &Selective) -> Quadrant {
        let (x, y) = (i64::from(x), i64::from(y));
        let (dx, dy) = (if quadrant & 1 == 0 { -1 } else { 1 }, if quadrant & 2 == 0 { -1 } else { 1 });
        let corner = [(x + dx, y), (x, y + dy), (x + dx, y + dy)];
        let own = self.hits(x, y, s);
        let mut sure = true;

        // The importance of every attribute that disagrees.
        let mut disagreeing = [0.0f64; 8];
        for (nx, ny) in corner {
            let other = self.hits(nx, ny, s);
            for kind in 0..3 {
                let (a, b) = (own[kind], other[kind]);
                let shadow = |hit: Option<Hit>| hit.map_or(0, |hit| hit.shadow);
                let bent = match (a, b) {
                    (Some(a), Some(b)) if a.normal != b.normal => {
                        let cosine = octahedral::decode(a.normal).dot(octahedral::decode(b.normal));
                        sure &= (cosine - f64::from(s.normal_cosine)).abs() > ROUNDING_BAND;
                        cosine < f64::from(s.normal_cosine)
                    }
                    (a, b) => a.is_some() != b.is_some(),
                };
                let involved = [own[0], other[0], a, b].map(|hit| self.importance_of(hit, s));
                let involved = involved.into_iter().fold(0.0, f64::max);
                let textured = a.is_some_and(|a| a.textured);
                let of_own = self.importance_of(own[0], s).max(self.importance_of(a, s));
                let differs = [
                    (a.map(|a| a.object) != b.map(|b| b.object), involved),
                    (bent, involved),
                    (shadow(a) != shadow(b), involved),
                    (textured, of_own),
                ];
                let first = if kind == 0 { 0 } else { 4 };
                for (i, (differs, importance)) in differs.into_iter().enumerate() {
                    if differs {
                        disagreeing[first + i] = disagreeing[first + i].max(importance);
                    }
                }
            }
        }
        let thresholds = s.thresholds().map(|tau| tau.map(f64::from));
        let mut least: Option<(f64, Attribute)> = None;
        for (i, &importance) in disagreeing.iter().enumerate() {
            if let (Some(tau), true) = (thresholds[1 + i], importance > 0.0) {
                let tau = tau * importance + thresholds[0].unwrap_or(1.0) * (1.0 - importance);
                // Rounding can decide between two thresholds only if they are almost equal.
                if least.is_none_or(|(other, _)| tau < other) {
                    least = Some((tau, 1 + i));
                }
            }
        }
        let Some((tau, by)) = least.or(thresholds[0].map(|tau| (tau, 0))) else {
            return Quadrant { active: false, by: 0, sure };
        };

        let floor = f64::from(s.contrast_min);
        let mut at_least = |value: f64, threshold: f64| {
            sure &= threshold <= 0.0 || (value - threshold).abs() > ROUNDING_BAND;
            value >= threshold
        };
        let group = [(x, y), corner[0], corner[1], corner[2]];
        let range = |values: [f64; 4]| {
            let most = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
            (values.into_iter().fold(f64::INFINITY, f64::min), most)
        };
        let mut contrast = |(least, most): (f64, f64)| {
            if at_least(most - least, floor) { (most - least) / (most + least).max(1e-6) } else { 0.0 }
        };
        let contrasts: Vec<(f64, f64)> = match s.reference {
            ColorReference::Color => [1.36, 1.02, 2.04]
                .into_iter()
                .enumerate()
                .map(|(c, scale)| (contrast(range(group.map(|(x, y)| self.shown(self.first(x, y)[c], s)))), scale))
                .collect(),
            ColorReference::Luminance => {
                vec![(contrast(range(group.map(|(x, y)| self.luminance(x, y, s)))), 1.02)]
            }
            ColorReference::Gradient => {
                let (_, most) = range(group.map(|(x, y)| self.gradient(x, y, s)));
                vec![(if at_least(most, floor) { most } else { 0.0 }, 1.02)]
            }
        };
        let mut active = false;
        for (contrast, scale) in contrasts {
            active |= at_least(contrast, tau * scale);
        }
        Quadrant { active, by, sure }
    }

    /// The word of a pixel in the plan, and whether rounding could not have changed it.
    pub fn planned(&self, x: u32, y: u32, s: &Selective) -> (u32, bool) {
        let quadrants = [0, 1, 2, 3].map(|q| self.quadrant(x, y, q, s));
        let active = (0..4).map(|q| u32::from(quadrants[q as usize].active) << q).sum();
        let by = quadrants.iter().find(|q| q.active).map_or(0, |q| q.by as u32 + 1);
        (self.samples(active) | by << 8 | active << 16, quadrants.iter().all(|q| q.sure))
    }

    /// The k of a pixel with these active quadrants.
    pub fn samples(&self, active: u32) -> u32 {
        let others = self.places.iter().skip(1);
        1 + others.filter(|&&(x, y)| window::quadrants(self.m, x, y) & active != 0).count() as u32
    }

    /// The colour of a pixel. `shade` is the result of the host's code for the sample at a position of its window.
    pub fn pixel(
        &self,
        x: u32,
        y: u32,
        active: u32,
        s: &Selective,
        weight: Weight,
        shade: &dyn Fn(u8, u8) -> [f64; 4],
    ) -> [f64; 4] {
        // Each quadrant has a quarter of the weight: the mean of its samples, weighted by the share of each that it
        // covers.
        let (mut sum, mut weights) = ([0.0; 4], 0.0);
        let mut add = |c: [f64; 4], share: f64| {
            let luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
            let w = match weight {
                Weight::Linear => share,
                Weight::Luminance => share / (1.0 + (luminance * f64::from(self.exposure)).min(1e30)),
            };
            sum = std::array::from_fn(|i| sum[i] + c[i] * w);
            weights += w;
        };
        let (px, py) = (i64::from(x), i64::from(y));
        for quadrant in 0..4 {
            if active >> quadrant & 1 == 0 {
                let (dx, dy) = (if quadrant & 1 == 0 { -1 } else { 1 }, if quadrant & 2 == 0 { -1 } else { 1 });
                let own = self.first(px, py);
                let [a, b, c] = [(px + dx, py), (px, py + dy), (px + dx, py + dy)].map(|(x, y)| self.first(x, y));
                let between: [f64; 4] = std::array::from_fn(|i| (9.0 * own[i] + 3.0 * (a[i] + b[i]) + c[i]) / 16.0);
                add(if s.bilinear { between } else { own }, 0.25);
                continue;
            }
            let share = |&(x, y): &(u8, u8)| {
                let of = window::quadrants(self.m, x, y);
                if of >> quadrant & 1 == 1 { 1.0 / f64::from(of.count_ones()) } else { 0.0 }
            };
            let all: f64 = self.places.iter().map(share).sum();
            for (rank, place) in self.places.iter().enumerate().filter(|(_, place)| share(place) > 0.0) {
                // The first sample is already shaded.
                let c = if rank == 0 { self.first(px, py) } else { resolve::clean(shade(place.0, place.1)) };
                add(c, 0.25 * share(place) / all);
            }
        }
        sum.map(|c| c / weights)
    }
}
