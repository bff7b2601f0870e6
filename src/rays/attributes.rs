//! The attributes of a vertex, from which hits are shaded, in 16 bytes as in the G-buffer.

use crate::octahedral;
use glam::{DVec3, Vec3};

/// The attributes of a vertex, in the mesh's own space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attributes {
    /// The normal, of any length above 0.
    pub normal: [f32; 3],
    /// The tangent; w is the sign of the bitangent. Zero if there is none.
    pub tangent: [f32; 4],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// The host's own 32 bits. Where the vertices of a triangle differ, each of the four bytes is interpolated, as
    /// those of a colour; a triangle whose vertices have the same bits keeps them.
    pub user: u32,
}

impl Attributes {
    pub(super) fn is_finite(&self) -> bool {
        [&self.normal[..], &self.tangent, &self.uv].into_iter().flatten().all(|c| c.is_finite())
    }
}

/// Normal (octahedral 16+16), tangent (the way around the decoded normal and a sign, 16), u and v.
pub(super) fn packed(a: &Attributes) -> [u32; 4] {
    let normal = Vec3::from(a.normal).as_dvec3();
    let code = octahedral::encode(if normal == DVec3::ZERO { DVec3::Y } else { normal });
    [code, tangent(code, a.tangent), a.uv[0].to_bits(), a.uv[1].to_bits()]
}

/// The code that `daa_vertex_tangent` of triangle.wgsl decodes, and the sign of the bitangent.
fn tangent(normal: u32, [x, y, z, w]: [f32; 4]) -> u32 {
    let along = DVec3::new(x.into(), y.into(), z.into());
    let n = octahedral::decode(normal);
    let [e, f] = [normal as i16, (normal >> 16) as i16].map(|c| i32::from(c).abs());
    let s = if e + f <= 32767 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + n.z);
    let basis = DVec3::new(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
    let (across, up) = (along.dot(basis), along.dot(n.cross(basis)));
    let sum = across.abs() + up.abs();
    let way = match (sum > 0.0, up >= 0.0) {
        (false, _) => 0.0,
        (true, true) => 1.0 - across / sum,
        (true, false) => 3.0 + across / sum,
    };
    let code = (way * 8192.0).round() as u32 & 0x7fff;
    code | if w < 0.0 { 0x8000 } else { 0 }
}
