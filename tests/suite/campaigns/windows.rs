//! Random windows of every size, many of them near what decides: k and its reason are the twin's.

use super::Campaign;
use super::random::Random;
use super::settings::metrics;
use super::words::Writer;
use crate::harness::{Output, Rig};
use deferred_aa::glam::Vec3;
use deferred_aa::reference::metrics::{By, Input, ROUNDING_BAND, Worth};
use deferred_aa::reference::octahedral;
use deferred_aa::{DepthMeasure, Execution, Settings, Weight, Windowed};
use std::time::Duration;

pub const CAMPAIGN: Campaign = Campaign {
    name: "windows",
    share: 0.2,
    few: 24,
    limit: Duration::from_secs(60),
    start: || {
        let mut rigs: [Option<(Rig, Writer)>; 8] = Default::default();
        Box::new(move |seed| {
            let m = seed % 8 + 1;
            let (rig, writer) = rigs[seed as usize % 8].get_or_insert_with(|| rig(m));
            frame(rig, writer, seed)
        })
    },
};

const SIZE: [u32; 2] = [45, 29];

/// Colours of every magnitude that the user's word can ask for.
const SHOW: &str = "fn shade(s: DaaSample) -> vec4f {
    let c = unpack4x8unorm(s.user);
    let scale = array(0.0, 1e-30, 1e-3, 1.0, 1.0, 1.0, 60.0, 1e30)[s.material & 7u];
    return vec4f(c.rgb * scale, 1.0);
}";

fn rig(m: u32) -> (Rig, Writer) {
    let rig = Rig::new(m, SIZE[0], SIZE[1], SHOW);
    let writer = Writer::new(&rig.gpu, rig.aa.gbuffer().expect("a size"));
    (rig, writer)
}

/// Checks every window of a random frame; returns how many there are.
fn frame(rig: &mut Rig, writer: &Writer, seed: u32) -> u64 {
    let mut random = Random::new(seed);
    let windowed = metrics(&mut random);
    rig.exposure = if random.once_in(2) { 1.0 } else { random.magnitude(0.01, 100.0) };
    let gbuffer = rig.aa.gbuffer().expect("a size");
    writer.write(&rig.gpu, gbuffer, &words(&mut random, rig.aa.m(), &windowed));
    let settings = Settings { windowed, execution: Execution::Loop, weight: Weight::Linear, ..Default::default() };
    let output = rig.run(settings);
    rig.with_input(|input| assert_twin_agrees(input, &windowed, &output));
    u64::from(SIZE[0] * SIZE[1])
}

/// Holds k and its reason against the twin.
fn assert_twin_agrees(input: &Input<'_>, windowed: &Windowed, output: &Output) {
    let mut apart = 0;
    for (i, &(k, by, _)) in output.plan.iter().enumerate() {
        let at = (i % input.width, i / input.width);
        let worth = input.worth(at.0, at.1, windowed);
        let told = format!("m = {}, window {at:?}: GPU {k} by {by}, twin {worth:?}, {windowed:?}", input.m);
        if k != worth.k {
            assert!(may_be(input, at, windowed, k), "{told}");
            apart += 1;
        } else if by != worth.by as u32 {
            assert!(ties(input, at, windowed, &worth), "{told}");
        }
    }
    assert!(apart * 50 <= output.plan.len(), "{apart} of {} windows lie in the rounding band", output.plan.len());
}

/// Whether rounding may give k: within the band, or where a threshold of luminance is as near.
fn may_be(input: &Input<'_>, (x, y): (usize, usize), windowed: &Windowed, k: u32) -> bool {
    [1.0, 1.0 - 1e-5, 1.0 + 1e-5].into_iter().any(|nudge| {
        let luminance_min = windowed.luminance_min * nudge;
        let luminance_edge = windowed.luminance_edge * nudge;
        let worth = input.worth(x, y, &Windowed { luminance_min, luminance_edge, ..*windowed });
        worth.k == k || worth.is_near_a_half() && worth.k.abs_diff(k) == 1
    })
}

/// Whether another metric asks for as much as the one that decided, or as all samples.
fn ties(input: &Input<'_>, (x, y): (usize, usize), windowed: &Windowed, worth: &Worth) -> bool {
    let mut others = *windowed;
    match worth.by {
        By::Depth => others.depth_scale = 0.0,
        By::Normal => others.normal_scale = 0.0,
        By::Luminance => others.luminance_scale = 0.0,
        By::Identity => others.identity_samples = 0.0,
        By::User => others.user_scale = 0.0,
        By::Least => others.least_samples = 1.0,
        By::Nothing | By::Shadow => {}
    }
    input.worth(x, y, &others).exact > worth.exact - 2.0 * ROUNDING_BAND
}

/// What a window is made of.
#[derive(Clone, Copy)]
struct Window {
    depth: u32,
    normal: u32,
    color: u32,
    identity: u32,
    base: f32,
    slope: [f32; 2],
    /// A step of depth, or an angle, that asks for about half a sample more than a whole number.
    step: f32,
    angle: f32,
    axis: Vec3,
    user: u32,
    material: u32,
}

impl Window {
    fn new(random: &mut Random, m: u32, windowed: &Windowed) -> Self {
        let half = random.below(m * m + 1) as f32 + 0.5 + random.pick(&[-1.0, 1.0]) * random.magnitude(1e-5, 0.5);
        let ask = |scale: f32| half / scale.max(1e-3);
        let step = match windowed.depth {
            DepthMeasure::Discontinuity => ask(windowed.depth_scale),
            // Half of the samples are a step nearer.
            DepthMeasure::Variance => 2.0 * ask(windowed.depth_scale).sqrt(),
        };
        Self {
            depth: random.below(10),
            normal: random.below(6),
            color: random.below(4),
            identity: random.below(4),
            base: if random.once_in(2) { 0.1 } else { random.magnitude(1e-4, 0.5) },
            slope: [0; 2].map(|_| random.within(-1.0, 1.0) * random.magnitude(1e-7, 0.02)),
            step: step.min(0.9),
            angle: 2.0 * (2f32.sqrt() * ask(windowed.normal_scale)).min(1.0).asin(),
            axis: random.vector().try_normalize().unwrap_or(Vec3::Z),
            user: random.bits(),
            material: random.bits(),
        }
    }

    fn depth(&self, random: &mut Random, (x, y): (u32, u32), near: bool) -> f32 {
        let plane = self.base * (1.0 + self.slope[0] * x as f32 + self.slope[1] * y as f32).max(1e-3);
        match self.depth {
            0..=2 => plane,
            3 | 4 if near => plane * (1.0 + self.step),
            3 | 4 => plane,
            5 if near => 0.0,
            5 => plane,
            6 => random.magnitude(1e-38, 1e-25),
            7 => random.pick(&[1.0, 1.0 - f32::EPSILON, 0.0, f32::MIN_POSITIVE, 1e-40, 1e-30, 1.1e-30]),
            8 => random.unit(),
            _ => 0.0,
        }
    }

    fn normal(&self, random: &mut Random, near: bool) -> u32 {
        let code = |n: Vec3| octahedral::encode(n.as_dvec3());
        match self.normal {
            0 => code(self.axis),
            1 | 2 => {
                let (sin, cos) = (0.5 * if near { self.angle } else { -self.angle }).sin_cos();
                code(self.axis * cos + self.axis.any_orthonormal_vector() * sin)
            }
            3 => code(if near { self.axis } else { -self.axis }),
            4 => code(self.axis).wrapping_add(u32::from(near)),
            _ => random.bits(),
        }
    }

    /// The words of a sample.
    fn sample(&self, random: &mut Random, at: (u32, u32), near: bool) -> [u32; 9] {
        let depth = self.depth(random, at, near);
        let normal = self.normal(random, near);
        let identity = match self.identity {
            0 | 1 => self.material,
            2 => self.material ^ u32::from(near) << 16,
            _ => random.bits(),
        };
        let user = match self.color {
            0 => 0x8080_8080,
            1 => self.user,
            2 => self.user ^ (u32::from(near) * random.pick(&[1, 0x0101, 0xff00, 0x0300_0000])),
            _ => random.bits(),
        };
        [depth.to_bits(), normal, identity, 0, user, 0, 0, 0, 0]
    }
}

fn words(random: &mut Random, m: u32, windowed: &Windowed) -> Vec<u32> {
    let [width, height] = SIZE;
    // Neighbours are often alike, so that luminance and depth go on from one to the next.
    let mut row = vec![Window::new(random, m, windowed); width as usize];
    let mut all = Vec::new();
    for y in 0..height {
        for x in 0..width as usize {
            row[x] = match random.below(3) {
                0 => Window::new(random, m, windowed),
                1 => row[x.saturating_sub(1)],
                _ => row[x],
            };
        }
        for sy in 0..m {
            for x in 0..width {
                for sx in 0..m {
                    let near = if y % 2 == 0 { sx * 2 < m } else { random.once_in(2) };
                    all.extend(row[x as usize].sample(random, (x * m + sx, y * m + sy), near));
                }
            }
        }
    }
    all
}
