//! Twin of `shaders/surfaces/light.wgsl`: the taps of a surface, their groups, and their light.

use super::cover::Covered;
use crate::reference::resolve;
use crate::settings::{Surfaces, Weight};
use glam::DVec3;

/// `DaaMaterial` of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Material {
    /// Linear base colour and alpha.
    pub base_color: [f64; 4],
    /// Linear emitted radiance.
    pub emissive: [f64; 3],
    /// Perceptual roughness.
    pub roughness: f64,
    /// Normal after normal mapping.
    pub normal: DVec3,
    /// Metalness.
    pub metallic: f64,
    /// Ambient visibility.
    pub occlusion: f64,
}

/// `DaaSpread` of the contract: what decides which taps share a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// What light depends on in more than proportion.
    pub shape: [f64; 4],
    /// What light is multiplied by.
    pub tint: [f64; 4],
}

impl Spread {
    /// Adds a share of another.
    fn add(&mut self, other: &Self, share: f64) {
        self.shape.iter_mut().zip(other.shape).for_each(|(sum, v)| *sum += share * v);
        self.tint.iter_mut().zip(other.tint).for_each(|(sum, v)| *sum += share * v);
    }
}

/// `DaaLight` of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Light {
    /// What the base colour is multiplied by.
    pub diffuse: [f64; 3],
    /// The rest, and alpha.
    pub rest: [f64; 4],
}

impl Light {
    /// The radiance of a material in this light.
    pub fn radiance(&self, m: &Material) -> [f64; 4] {
        let [r, g, b] = std::array::from_fn(|i| self.diffuse[i] * m.base_color[i] + self.rest[i] + m.emissive[i]);
        [r, g, b, self.rest[3]]
    }

    /// The channels of that radiance, exposed, negative components left out.
    fn exposed(&self, m: &Material, exposure: f64) -> [f64; 3] {
        let [r, g, b, _] = self.radiance(m);
        [r, g, b].map(|c| (c.max(0.0) * exposure).min(1e30))
    }

    fn add(&mut self, other: &Self, share: f64) {
        self.diffuse.iter_mut().zip(other.diffuse).for_each(|(sum, v)| *sum += share * v);
        self.rest.iter_mut().zip(other.rest).for_each(|(sum, v)| *sum += share * v);
    }

    fn scale(&mut self, by: f64) {
        self.diffuse.iter_mut().chain(&mut self.rest).for_each(|v| *v *= by);
    }
}

/// What the host reads of a tap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tap {
    /// The sky's radiance.
    Sky([f64; 4]),
    /// A surface.
    Surface {
        /// Position relative to the camera.
        position: DVec3,
        /// Unit interpolated normal.
        normal: DVec3,
        /// material | object << 16.
        identity: u32,
        /// The shadow bits.
        shadow: u32,
        /// The host's material.
        material: Material,
    },
}

/// A lookup of a tap: the rank, the factor on the texture footprint, and the offset of the lookup in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lookup {
    /// The rank of the sample.
    pub rank: usize,
    /// The factor on the gradients of uv.
    pub footprint: f64,
    /// The offset along the surface, in samples.
    pub offset: [f64; 2],
}

/// The surface that a group of taps is lit as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group {
    /// Mean position relative to the camera.
    pub position: DVec3,
    /// Unit mean normal.
    pub normal: DVec3,
    /// The bits of lights that reach no tap.
    pub shadow: u32,
    /// The mean material.
    pub material: Material,
    /// The share of the window.
    pub coverage: f64,
}

/// A window after it is lit.
#[derive(Debug, Clone, PartialEq)]
pub struct Lit {
    /// The colour of the pixel.
    pub color: [f64; 4],
    /// The number of lights.
    pub lights: u32,
    /// The number of surfaces that took their light from the corners of the block.
    pub interpolated: u32,
    /// The number of taps that were read.
    pub taps: u32,
    /// How near a decision came to its threshold, over what rounding may change: spreads are kept in halves. GPU and
    /// twin may differ below 1.
    pub margin: f64,
}

/// The weight of a squared deviation of the tint where lights are shared.
const TINT_WEIGHT: f64 = 0.04;

/// The rounding of a half.
const HALF: f64 = 1.0 / 2048.0;

/// The most taps of a surface.
const MOST_TAPS: usize = 16;

fn luminance(c: [f64; 3]) -> f64 {
    0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]
}

/// The features of a material where the host has no `spread`. `view` is the unit vector to the camera.
pub fn default_spread(m: &Material, view: DVec3) -> Spread {
    let color: [f64; 3] = std::array::from_fn(|i| m.base_color[i].max(0.0));
    let specular = color.map(|c| 0.04 + (c - 0.04) * m.metallic);
    let diffuse = color.map(|c| c * (1.0 - m.metallic));
    let alpha = (m.roughness * m.roughness).max(0.002);
    let grazing = 1.0 - m.normal.dot(view).clamp(0.0, 1.0);
    let fresnel = luminance(specular) + (1.0 - luminance(specular)) * grazing.powi(5);
    let sharpness = (fresnel / alpha + 1.5 * luminance(diffuse)).max(0.0).sqrt();
    let shown: [f64; 3] =
        std::array::from_fn(|i| ((specular[i] + diffuse[i]).max(0.0) + m.emissive[i].clamp(0.0, 1.0)).sqrt());
    let n = m.normal * sharpness;
    Spread { shape: [n.x, n.y, n.z, 0.3 * m.roughness], tint: [shown[0], shown[1], shown[2], 1.5 * m.metallic] }
}

/// NaN and infinity become 0.
fn finite(v: [f64; 4]) -> [f64; 4] {
    v.map(|v| if v.is_finite() { v.clamp(-6e4, 6e4) } else { 0.0 })
}

/// The squared deviations from the mean of each feature, first those of the shape, then those of the tint.
fn deviations(spreads: &[Spread]) -> [f64; 8] {
    let feature = |s: &Spread, i: usize| if i < 4 { s.shape[i] } else { s.tint[i - 4] };
    std::array::from_fn(|i| {
        let mean = spreads.iter().map(|s| feature(s, i)).sum::<f64>() / spreads.len() as f64;
        spreads.iter().map(|s| (feature(s, i) - mean).powi(2)).sum()
    })
}

fn light_deviation(d: &[f64; 8]) -> f64 {
    d[..4].iter().sum::<f64>() + TINT_WEIGHT * d[4..].iter().sum::<f64>()
}

/// The perceptual roughness that also stands for normals whose mean has this length (Tokuyoshi, Kaplanyan 2019).
pub fn widened(roughness: f64, length: f64, widening: f64) -> f64 {
    let lost = 1.0 - length * length;
    if lost <= 1e-5 || widening == 0.0 {
        return roughness;
    }
    let kappa = (3.0 * length - length.powi(3)) / lost;
    let squared = (roughness * roughness).clamp(0.0, 1.0).powi(2);
    let slopes = squared / (1.0 - squared).max(1e-6);
    let mut widened = slopes + 2.0 * widening / kappa.max(1e-6);
    if slopes < 1.0 {
        widened = widened.min(1.0);
    }
    (widened / (1.0 + widened)).sqrt().sqrt()
}

/// The decisions on a surface's taps, with the margin to their thresholds.
struct Decided {
    margin: f64,
}

impl Decided {
    fn above(&mut self, value: f64, threshold: f64) -> bool {
        // Of equal taps, twin and GPU round to either side of 0.
        self.above_within(value, threshold, (threshold * 1e-4).max(1e-12))
    }

    /// Whether the value is above the threshold, where rounding may change it by so much.
    fn above_within(&mut self, value: f64, threshold: f64, rounding: f64) -> bool {
        self.margin = self.margin.min((value - threshold).abs() / rounding.max(1e-300));
        value > threshold
    }
}

/// A window before it is lit, with the host's functions.
pub struct Window<'a> {
    /// The surfaces.
    pub covered: &'a Covered,
    /// The places of samples, by rank.
    pub order: &'a [(u8, u8)],
    /// The settings.
    pub settings: &'a Surfaces,
    /// How samples are weighted.
    pub weight: Weight,
    /// The exposure of the luminance weight.
    pub exposure: f64,
    /// What the host reads of a tap.
    pub tap: &'a dyn Fn(Lookup) -> Tap,
    /// The host's light.
    pub light: &'a dyn Fn(&Group) -> Light,
    /// The block that the window lies in, if blocks share their light.
    pub block: Option<Block<'a>>,
}

/// The first taps of a window of one surface, or all.
struct Whole {
    taps: Vec<Tap>,
    read: u32,
    /// Whether they are too far apart to share a light.
    apart: bool,
    /// Whether they are too few.
    coarse: bool,
}

impl Window<'_> {
    /// Lights the window.
    pub fn lit(&self) -> Lit {
        let mut lit = Lit { color: [0.0; 4], lights: 0, interpolated: 0, taps: 0, margin: 0.0 };
        let mut decided = Decided { margin: f64::INFINITY };
        let (mut colors, mut shares) = (Vec::new(), Vec::new());
        for label in 0..self.covered.surfaces {
            let ranks: Vec<usize> = (0..self.order.len()).filter(|&rank| self.covered.labels[rank] == label).collect();
            for (color, share) in self.surface(&ranks, &mut lit, &mut decided) {
                colors.push(resolve::clean(color));
                shares.push(share);
            }
        }
        let weights: Vec<f64> = colors
            .iter()
            .zip(&shares)
            .map(|(c, share)| match self.weight {
                Weight::Linear => *share,
                Weight::Luminance => share / (1.0 + (luminance([c[0], c[1], c[2]]) * self.exposure).min(1e30)),
            })
            .collect();
        let sum: f64 = weights.iter().sum();
        let color = std::array::from_fn(|i| colors.iter().zip(&weights).map(|(c, w)| c[i] * w).sum::<f64>() / sum);
        Lit { color, margin: decided.margin, ..lit }
    }

    /// What the window lends to others as a corner of its block, and the margin of the decisions, as of [`Lit`].
    pub fn corner(&self) -> (Option<Corner>, f64) {
        let mut decided = Decided { margin: f64::INFINITY };
        let ranks: Vec<usize> = (0..self.order.len()).collect();
        let whole = (self.covered.surfaces == 1).then(|| self.whole(&ranks, self.settings.first_taps, &mut decided));
        let corner = whole.filter(|whole| !whole.apart && !whole.coarse).and_then(|whole| {
            let all: Vec<usize> = (0..whole.taps.len()).collect();
            let (light, color) = self.lit_group(&whole.taps, &all, 1.0);
            let &Tap::Surface { position, .. } = self.taps(&ranks, 1).first()? else { return None };
            let is_good = color.iter().all(|c| c.is_finite() && *c >= 0.0);
            self.as_corner(&whole.taps).filter(|_| is_good).map(|corner| Corner { light, position, ..corner })
        });
        (corner, decided.margin)
    }

    /// Taps of a surface as they are compared with the corners. `None` if they show the sky or an edge of a shadow.
    fn as_corner(&self, taps: &[Tap]) -> Option<Corner> {
        let &Tap::Surface { position, normal, identity, shadow, .. } = taps.last()? else { return None };
        if taps.iter().any(|tap| matches!(tap, Tap::Sky(_)) || bits(tap) != shadow) {
            return None;
        }
        let mut spread = Spread { shape: [0.0; 4], tint: [0.0; 4] };
        taps.iter().for_each(|tap| spread.add(&self.spread_of(tap), 1.0 / taps.len() as f64));
        Some(Corner { light: Light::default(), spread, position, normal, identity, shadow })
    }

    /// Reads a window of one surface at some taps. At a corner of a block it is read at all if those are too few.
    fn whole(&self, ranks: &[usize], first: u32, decided: &mut Decided) -> Whole {
        let s = self.settings;
        let all = self.most_taps(ranks);
        let mut count = all.min(first as usize);
        let mut read = 0;
        // The shadow bits of all samples are there to be read.
        let every: Vec<u32> = self.taps(ranks, ranks.len()).iter().map(bits).collect();
        let mixed = every.iter().any(|b| *b != every[0]);
        loop {
            let taps = self.taps(ranks, count);
            read += count as u32;
            if taps.iter().all(|tap| matches!(tap, Tap::Sky(_))) {
                return Whole { taps, read, apart: false, coarse: false };
            }
            let d = self.spread(&taps).0;
            let limit = f64::from(s.tap_spread) * ((count as f64).max(2.0) - 1.0);
            let few = count < all && decided.above(d.iter().sum(), limit);
            let spreads = s.groups > 1 && decided.above(light_deviation(&d) / count as f64, f64::from(s.spread));
            let apart = s.groups > 1 && (spreads || mixed);
            let coarse = count < all && (few || mixed);
            if !apart && coarse && self.block.is_some_and(|block| block.is_corner()) {
                count = all;
                continue;
            }
            return Whole { taps, read, apart, coarse };
        }
    }

    fn most_taps(&self, ranks: &[usize]) -> usize {
        ranks.len().min(self.settings.taps as usize).min(MOST_TAPS)
    }

    /// The colours of a surface's groups, with their shares of the window.
    fn surface(&self, ranks: &[usize], lit: &mut Lit, decided: &mut Decided) -> Vec<([f64; 4], f64)> {
        let all = self.most_taps(ranks);
        let (taps, apart, at_corner);
        if self.covered.surfaces == 1 {
            let mut whole = self.whole(ranks, self.settings.first_taps, decided);
            lit.taps += whole.read;
            at_corner = !whole.apart && !whole.coarse && self.block.is_some_and(|block| block.is_corner());
            if whole.coarse && !whole.apart {
                whole = self.whole(ranks, all as u32, decided);
                lit.taps += whole.read;
            }
            if whole.apart {
                // To find the groups.
                whole.taps = self.taps(ranks, all);
                lit.taps += all as u32;
            }
            (taps, apart) = (whole.taps, whole.apart);
        } else {
            taps = self.taps(ranks, all);
            lit.taps += all as u32;
            at_corner = false;
            let (d, mixed) = self.spread(&taps);
            let share = ranks.len() as f64 / (self.order.len() * all) as f64;
            let spreads = decided.above(light_deviation(&d) * share, f64::from(self.settings.spread));
            apart = self.settings.groups > 1 && (spreads || mixed);
        }
        let share = ranks.len() as f64 / (self.order.len() * taps.len()) as f64;
        let coverage = |group: &[usize]| share * group.len() as f64;
        if apart {
            // To light them.
            lit.taps += all as u32;
            let groups = self.groups(&taps, share, decided);
            lit.lights += groups.len() as u32;
            return groups.iter().map(|g| (self.lit_group(&taps, g, coverage(g)).1, coverage(g))).collect();
        }
        let one: Vec<usize> = (0..taps.len()).collect();
        if !at_corner && let Some(color) = self.interpolated(&taps, decided) {
            lit.interpolated += 1;
            return vec![(color, coverage(&one))];
        }
        lit.lights += 1;
        vec![(self.lit_group(&taps, &one, coverage(&one)).1, coverage(&one))]
    }

    /// The colour of a surface by light from the corners of its block.
    fn interpolated(&self, taps: &[Tap], decided: &mut Decided) -> Option<[f64; 4]> {
        let block = self.block?;
        let colors = mean_colors(taps);
        let here = self.as_corner(taps)?;
        let light = block.between(&here, &colors, self.exposure, self.settings, decided)?;
        Some(light.radiance(&colors))
    }

    /// Reads the first taps of a surface.
    fn taps(&self, ranks: &[usize], taps: usize) -> Vec<Tap> {
        let mean = |ranks: &[usize]| -> [f64; 2] {
            let sum = ranks.iter().fold([0.0, 0.0], |sum, &rank| {
                let (x, y) = self.order[rank];
                [sum[0] + f64::from(x), sum[1] + f64::from(y)]
            });
            sum.map(|s| s / ranks.len() as f64)
        };
        let (of_all, of_taps) = (mean(ranks), mean(&ranks[..taps]));
        let offset = [of_all[0] - of_taps[0], of_all[1] - of_taps[1]];
        let footprint = ((ranks.len() as f64 / taps as f64).sqrt() * f64::from(self.settings.footprint)).max(1.0);
        ranks[..taps].iter().map(|&rank| (self.tap)(Lookup { rank, footprint, offset })).collect()
    }

    fn spread_of(&self, tap: &Tap) -> Spread {
        match tap {
            Tap::Sky(_) => Spread { shape: [0.0; 4], tint: [0.0; 4] },
            Tap::Surface { material, position, .. } => {
                let spread = default_spread(material, -position.normalize());
                Spread { shape: finite(spread.shape), tint: finite(spread.tint) }
            }
        }
    }

    /// The deviations of those taps that show a surface, and whether their shadow bits differ.
    fn spread(&self, taps: &[Tap]) -> ([f64; 8], bool) {
        let surfaces: Vec<&Tap> = taps.iter().filter(|tap| matches!(tap, Tap::Surface { .. })).collect();
        let spreads: Vec<Spread> = surfaces.iter().map(|tap| self.spread_of(tap)).collect();
        let bits: Vec<u32> = surfaces.iter().map(|tap| bits(tap)).collect();
        (deviations(&spreads), bits.iter().any(|b| *b != bits[0]))
    }

    /// The groups of taps that share a light, as indices of taps.
    fn groups(&self, taps: &[Tap], share: f64, decided: &mut Decided) -> Vec<Vec<usize>> {
        let spreads: Vec<Spread> = taps.iter().map(|tap| self.spread_of(tap)).collect();
        let mut groups = vec![(0..taps.len()).collect::<Vec<usize>>()];
        let mut i = 0;
        while i < groups.len() && groups.len() < self.settings.groups as usize {
            match self.cut(taps, &spreads, &groups[i], share, decided) {
                Some(off) => {
                    groups[i].retain(|tap| !off.contains(tap));
                    groups.push(off);
                }
                None => i += 1,
            }
        }
        groups
    }

    /// The taps of a group that are cut off.
    fn cut(
        &self,
        taps: &[Tap],
        spreads: &[Spread],
        group: &[usize],
        share: f64,
        decided: &mut Decided,
    ) -> Option<Vec<usize>> {
        let any = group.iter().fold(0, |any, &tap| any | bits(&taps[tap]));
        let all = group.iter().fold(u32::MAX, |all, &tap| all & bits(&taps[tap]));
        if any != all {
            let light = (any & !all).trailing_zeros();
            return Some(group.iter().copied().filter(|&tap| bits(&taps[tap]) >> light & 1 == 0).collect());
        }
        let own: Vec<Spread> = group.iter().map(|&tap| spreads[tap]).collect();
        let mut d = deviations(&own);
        let feature = |tap: usize, i: usize| if i < 4 { spreads[tap].shape[i] } else { spreads[tap].tint[i - 4] };
        let means: [f64; 8] =
            std::array::from_fn(|i| group.iter().map(|&tap| feature(tap, i)).sum::<f64>() / group.len() as f64);
        // A half is rounded by up to 2⁻¹¹ of itself.
        let mut rounding: [f64; 8] = std::array::from_fn(|i| {
            group.iter().map(|&tap| 2.0 * HALF * feature(tap, i).abs() * (feature(tap, i) - means[i]).abs()).sum()
        });
        rounding[4..].iter_mut().for_each(|r| *r *= TINT_WEIGHT);
        let by_halves = rounding.iter().sum::<f64>() * share;
        if !decided.above_within(light_deviation(&d) * share, f64::from(self.settings.spread), by_halves) {
            return None;
        }
        d[4..].iter_mut().for_each(|d| *d *= TINT_WEIGHT);
        let most = (0..8).fold(0, |most, i| if d[i] > d[most] { i } else { most });
        for other in (0..8).filter(|&i| i != most) {
            decided.above_within(d[most], d[other], rounding[most] + rounding[other]);
        }
        let value = |tap: usize| feature(tap, most);
        let mean = means[most];
        let greatest = group.iter().map(|&tap| value(tap).abs()).fold(0.0, f64::max);
        for &tap in group {
            decided.above_within(value(tap), mean, 2.0 * HALF * greatest);
        }
        let off: Vec<usize> = group.iter().copied().filter(|&tap| value(tap) > mean).collect();
        (!off.is_empty() && off.len() < group.len()).then_some(off)
    }

    /// The light of a group, and its colour.
    fn lit_group(&self, taps: &[Tap], group: &[usize], coverage: f64) -> (Light, [f64; 4]) {
        let mut sky = [0.0; 4];
        let mut count = 0.0;
        let (mut position, mut normal, mut shadow) = (DVec3::ZERO, DVec3::ZERO, u32::MAX);
        let mut m = Material::default();
        for &tap in group {
            match &taps[tap] {
                Tap::Sky(radiance) => sky.iter_mut().zip(radiance).for_each(|(sum, c)| *sum += c),
                Tap::Surface { position: p, normal: n, shadow: bits, material, .. } => {
                    count += 1.0;
                    position += *p;
                    normal += *n;
                    shadow &= bits;
                    m.base_color.iter_mut().zip(material.base_color).for_each(|(sum, c)| *sum += c);
                    m.emissive.iter_mut().zip(material.emissive).for_each(|(sum, c)| *sum += c);
                    m.roughness += material.roughness;
                    m.normal += material.normal;
                    m.metallic += material.metallic;
                    m.occlusion += material.occlusion;
                }
            }
        }
        let (mut light, mut radiance) = (Light::default(), [0.0; 4]);
        if count > 0.0 {
            let mean = m.normal / count;
            let cancels = mean.length_squared() <= 1e-6;
            let material = Material {
                base_color: m.base_color.map(|c| c / count),
                emissive: m.emissive.map(|c| c / count),
                roughness: widened(m.roughness / count, mean.length().min(1.0), f64::from(self.settings.widening)),
                normal: if cancels { normal.normalize_or_zero() } else { mean.normalize() },
                metallic: m.metallic / count,
                occlusion: m.occlusion / count,
            };
            let group =
                Group { position: position / count, normal: normal.normalize_or_zero(), shadow, material, coverage };
            light = (self.light)(&group);
            radiance = light.radiance(&material);
        }
        (light, std::array::from_fn(|i| (radiance[i] * count + sky[i]) / group.len() as f64))
    }
}

/// The mean base colour and emission of taps that all show a surface.
fn mean_colors(taps: &[Tap]) -> Material {
    let mut mean = Material::default();
    for tap in taps {
        if let Tap::Surface { material, .. } = tap {
            mean.base_color.iter_mut().zip(material.base_color).for_each(|(sum, c)| *sum += c / taps.len() as f64);
            mean.emissive.iter_mut().zip(material.emissive).for_each(|(sum, c)| *sum += c / taps.len() as f64);
        }
    }
    mean
}

fn bits(tap: &Tap) -> u32 {
    match tap {
        Tap::Sky(_) => 0,
        Tap::Surface { shadow, .. } => *shadow,
    }
}

/// What is known of a window at a corner of a block, or of a surface that may take its light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Of a corner; black for others.
    pub light: Light,
    /// The means of the features of its taps.
    pub spread: Spread,
    /// Position relative to the camera: of a corner that of its first sample, of others that of their last tap.
    pub position: DVec3,
    /// Unit interpolated normal of the last tap.
    pub normal: DVec3,
    /// material | object << 16.
    pub identity: u32,
    /// The shadow bits.
    pub shadow: u32,
}

/// The corners of a window's block: `None` where the window there lends no light.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// The place of the window, 0 to 3 along x and y.
    pub place: [u32; 2],
    /// In the order (0, 0), (3, 0), (0, 3), (3, 3).
    pub corners: &'a [Option<Corner>; 4],
    /// View direction of the camera.
    pub forward: DVec3,
}

impl Block<'_> {
    /// Whether the window is a corner itself.
    pub fn is_corner(&self) -> bool {
        self.place.iter().all(|p| *p == 0 || *p == 3)
    }

    /// The light of a surface of those colours, if it need not be lit.
    fn between(
        &self,
        here: &Corner,
        colors: &Material,
        exposure: f64,
        settings: &Surfaces,
        decided: &mut Decided,
    ) -> Option<Light> {
        let along = self.place.map(|p| f64::from(p) / 3.0);
        let mut share = 0.0;
        let (mut least, mut most) = ([f64::INFINITY; 3], [0.0_f64; 3]);
        let mut light = Light::default();
        let mut spread = Spread { shape: [0.0; 4], tint: [0.0; 4] };
        for (i, corner) in self.corners.iter().enumerate() {
            let weight: f64 =
                (0..2).map(|axis| if i >> axis & 1 == 1 { along[axis] } else { 1.0 - along[axis] }).product();
            let Some(corner) = corner.filter(|_| weight > 0.0) else { continue };
            if corner.identity != here.identity || corner.shadow != here.shadow {
                continue;
            }
            let distance = here.position.dot(self.forward).abs();
            let off = here.normal.dot(corner.position - here.position).abs() / distance;
            // Normals of corners are kept in 16 bits a component.
            let far = decided.above_within(off, f64::from(settings.plane), 1e-5);
            let bent = !decided.above_within(here.normal.dot(corner.normal), settings.normal_cosine.into(), 1e-4);
            if far || bent {
                continue;
            }
            share += weight;
            light.add(&corner.light, weight);
            spread.add(&corner.spread, weight);
            for (channel, c) in corner.light.exposed(colors, exposure).into_iter().enumerate() {
                least[channel] = least[channel].min(c / (1.0 + c));
                most[channel] = most[channel].max(c / (1.0 + c));
            }
        }
        let contrast = (0..3).map(|channel| most[channel] - least[channel]).fold(0.0, f64::max);
        if share == 0.0 || decided.above_within(contrast, settings.block_contrast.into(), 1e-5) {
            return None;
        }
        let (mut apart, mut rounding) = (0.0, 0.0);
        let weights = [1.0, TINT_WEIGHT];
        let pairs = [(spread.shape, here.spread.shape), (spread.tint, here.spread.tint)];
        for ((of_corners, own), weight) in pairs.into_iter().zip(weights) {
            for (a, b) in of_corners.into_iter().zip(own) {
                let difference = a / share - b;
                apart += weight * difference * difference;
                rounding += weight * 2.0 * difference.abs() * HALF * (a / share).abs() + 1e-9;
            }
        }
        if decided.above_within(apart, settings.block_spread.into(), rounding) {
            return None;
        }
        light.scale(1.0 / share);
        Some(light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_length_widens_and_nothing_lost_does_not() {
        assert_eq!(widened(0.3, 1.0, 0.25), 0.3);
        assert_eq!(widened(0.3, 0.5, 0.0), 0.3);
        let widths: Vec<f64> = (1..10).rev().map(|i| widened(0.3, f64::from(i) * 0.1, 0.25)).collect();
        assert!(widths.windows(2).all(|w| w[0] <= w[1]) && widths[0] > 0.3, "{widths:?}");
        // Slopes of a smooth surface widen to at most 1, α² = 1/2; a rough one stays below α = 1.
        assert!(widened(0.3, 0.0, 1.0) <= 0.5_f64.powf(0.25) + 1e-12 && widened(1.0, 0.0, 1.0) <= 1.0);
    }

    #[test]
    fn a_matt_wall_spreads_by_its_normal_and_metal_by_more() {
        let stone =
            Material { base_color: [0.5, 0.5, 0.5, 1.0], roughness: 0.9, normal: DVec3::Z, ..Default::default() };
        let metal = Material { metallic: 1.0, roughness: 0.2, ..stone };
        let length = |m: &Material| default_spread(m, DVec3::Z).shape[2];
        assert!((length(&stone) - (0.04 / 0.81 + 0.75_f64).sqrt()).abs() < 1e-12);
        assert!(length(&metal) > 3.0 * length(&stone));
    }
}
