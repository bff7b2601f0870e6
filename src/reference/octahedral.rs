//! Twin of `shaders/shared/octahedral.wgsl`.

use glam::{DVec3, DVec4};
use std::f64::consts::TAU;

pub use crate::octahedral::{decode, encode};

/// Decodes a unit tangent and the bitangent's sign from their 16-bit code; `n` is the decoded normal.
pub fn tangent_decode(n: DVec3, code: u32) -> DVec4 {
    let s = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + n.z);
    let x = DVec3::new(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
    let angle = f64::from(code & 0x7fff) * (TAU / 32768.0);
    let along = angle.cos() * x + angle.sin() * n.cross(x);
    along.extend(if code & 0x8000 != 0 { -1.0 } else { 1.0 })
}
