//! Twin of `shaders/passes/check.wgsl`.

use super::octahedral;
use super::rays::trace::geometric_normal;
use crate::reference::sample::relative_from_clip;
use crate::{Camera, InputCounts, NormalCounts};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// A G-buffer, with its rows from the top.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// The camera of the frame.
    pub camera: Camera,
    /// The number of samples along x and y.
    pub samples: [u32; 2],
    /// The number of samples along one side of a window.
    pub m: u32,
    /// The depth target.
    pub depth: &'a [f32],
    /// The first colour target.
    pub surface: &'a [[u32; 2]],
    /// The second colour target.
    pub frame: &'a [[u32; 2]],
    /// The third colour target.
    pub uv: &'a [[u32; 4]],
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    position: DVec3,
    depth: f64,
    uv: DVec2,
    identity: u32,
    valid: bool,
}

/// The values that are derived from a frame's camera.
struct View {
    relative_from_clip: DMat4,
    rotation: DMat3,
    perspective: bool,
}

impl Input<'_> {
    /// The counts of all samples.
    pub fn counts(&self) -> InputCounts {
        let view = View {
            relative_from_clip: relative_from_clip(&self.camera),
            rotation: DMat3::from_mat4(self.camera.world_from_view.as_dmat4()),
            perspective: self.camera.clip_from_view.row(3) != glam::Vec4::W,
        };
        let mut counts = InputCounts::default();
        let [width, height] = self.samples.map(i64::from);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            self.count(&view, [x, y], &mut counts);
        }
        counts
    }

    fn index(&self, [x, y]: [i64; 2]) -> usize {
        let [width, height] = self.samples.map(i64::from);
        (y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize
    }

    /// `daa_checked`.
    fn sample(&self, view: &View, at: [i64; 2]) -> Sample {
        let [width, height] = self.samples.map(i64::from);
        let i = self.index(at);
        let d = self.depth[i];
        let inside = (0..width).contains(&at[0]) && (0..height).contains(&at[1]);
        let valid = inside && d > 1e-30 && d <= 1.0;
        let place = [at[0].clamp(0, width - 1), at[1].clamp(0, height - 1)];
        let ndc = |axis: usize| (place[axis] as f64 + 0.5) / f64::from(self.samples[axis]) * 2.0 - 1.0;
        let p = view.relative_from_clip * DVec4::new(ndc(0), -ndc(1), if valid { f64::from(d) } else { 1.0 }, 1.0);
        let position = p.truncate() / p.w;
        let depth = position.dot(-view.rotation.z_axis);
        let [u, v, ..] = self.uv[i].map(|bits| f64::from(f32::from_bits(bits)));
        Sample { position, depth, uv: DVec2::new(u, v), identity: self.surface[i][1], valid }
    }

    fn count(&self, view: &View, [x, y]: [i64; 2], counts: &mut InputCounts) {
        let i = self.index([x, y]);
        let d = self.depth[i];
        counts.bad_depth += u32::from(!d.is_finite() || !(0.0..=1.0).contains(&d));
        let here = self.sample(view, [x, y]);
        if !here.valid {
            return;
        }
        counts.covered += 1;
        counts.near += u32::from(view.perspective && d > 0.9);
        counts.objects += u32::from(here.identity >> 16 != 0);
        let beside = |dx, dy| self.sample(view, [x + dx, y + dy]);
        let (left, right, up, down) = (beside(-1, 0), beside(1, 0), beside(0, -1), beside(0, 1));
        counts.steps += u32::from(right.valid && (right.depth - here.depth).abs() > 0.1 * here.depth.abs());
        let [.., ddx, ddy] = self.uv[i];
        self.count_gradient(&here, &right, ddx, counts);
        self.count_gradient(&here, &down, ddy, counts);

        if !on_line(&left, &here, &right) || !on_line(&up, &here, &down) {
            return;
        }
        let plane = (right.position - left.position).cross(up.position - down.position);
        let Some(plane) = plane.try_normalize() else { return };
        let towards = if view.perspective { -here.position } else { view.rotation.z_axis };
        let plane = if plane.dot(towards) < 0.0 { -plane } else { plane };
        counts.planes += 1;
        let (normal, geometric) = (self.surface[i][0], self.frame[i][0]);
        count_normal(&mut counts.normal, octahedral::decode(normal), normal, plane, view);
        let code = geometric & 0xffff;
        count_normal(&mut counts.geometric_normal, geometric_normal(geometric), code, plane, view);
    }

    fn count_gradient(&self, here: &Sample, next: &Sample, gradient: u32, counts: &mut InputCounts) {
        let slope = (next.uv - here.uv).length();
        let least = 1e-5 + 1e-5 * here.uv.length();
        // Written so that NaN is not counted.
        let counted = slope > least && slope < 1e9;
        if !next.valid || next.identity != here.identity || !counted {
            return;
        }
        let ratio = DVec2::new(half(gradient), half(gradient >> 16)).length() / slope;
        let m = f64::from(self.m);
        counts.slopes += 1;
        counts.gradient_fits += u32::from(ratio > 0.6 && ratio < 1.5);
        counts.gradient_missing += u32::from(ratio == 0.0);
        counts.gradient_per_pixel += u32::from(self.m > 1 && ratio > 0.75 * m && ratio < 1.34 * m);
    }
}

/// `daa_on_line`.
fn on_line(a: &Sample, b: &Sample, c: &Sample) -> bool {
    if !a.valid || !c.valid || a.identity != b.identity || c.identity != b.identity {
        return false;
    }
    let (before, behind) = (b.position - a.position, c.position - b.position);
    before.cross(behind).length_squared() < 0.0025 * before.length_squared() * behind.length_squared()
}

fn count_normal(counts: &mut NormalCounts, normal: DVec3, code: u32, plane: DVec3, view: &View) {
    let c = normal.dot(plane);
    counts.fits += u32::from(c > 0.7);
    counts.unset += u32::from(code == 0);
    counts.in_view += u32::from((view.rotation * normal).dot(plane) > 0.7);
    counts.flipped += u32::from(c < -0.7);
}

/// A finite f16 in the low bits.
fn half(bits: u32) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, mantissa) = ((bits >> 10 & 31) as i32, f64::from(bits & 0x3ff));
    sign * if exponent == 0 { mantissa * 2f64.powi(-24) } else { (1024.0 + mantissa) * 2f64.powi(exponent - 25) }
}
