//! The octahedral code of unit vectors in f64, as `shaders/shared/octahedral.wgsl` has it in f32.

use glam::{DVec2, DVec3};

/// Decodes a unit vector from its 16+16-bit code.
pub fn decode(code: u32) -> DVec3 {
    // In snorm, −32768 and −32767 both mean −1.
    let snorm = |bits: u32| (f64::from(bits as u16 as i16) / 32767.0).max(-1.0);
    let e = DVec2::new(snorm(code), snorm(code >> 16));
    let z = 1.0 - e.x.abs() - e.y.abs();
    let sign = |v: f64| if v >= 0.0 { 1.0 } else { -1.0 };
    let xy = if z >= 0.0 { e } else { DVec2::new((1.0 - e.y.abs()) * sign(e.x), (1.0 - e.x.abs()) * sign(e.y)) };
    DVec3::new(xy.x, xy.y, z).normalize()
}

/// Encodes the direction of a vector of any length above 0 in 16+16 bits.
pub fn encode(v: DVec3) -> u32 {
    let p = v.truncate() / (v.x.abs() + v.y.abs() + v.z.abs());
    let sign = |v: f64| if v >= 0.0 { 1.0 } else { -1.0 };
    let e = if v.z >= 0.0 { p } else { DVec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y)) };
    let snorm = |c: f64| u32::from((c.clamp(-1.0, 1.0) * 32767.0 + 0.5).floor() as i16 as u16);
    snorm(e.x) | snorm(e.y) << 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_is_within_four_thousandths_of_a_degree() {
        // A spiral over the sphere, the axes, and the seams of the fold.
        let spiral = (0..1_000_000).map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 1e6;
            let (r, a) = ((1.0 - z * z).sqrt(), f64::from(i) * 2.399_963_229_728_653);
            DVec3::new(r * a.cos(), r * a.sin(), z)
        });
        let axes = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z, DVec3::new(0.0, -0.0, -1.0)];
        let seams = (0..4000).map(|i| {
            let a = f64::from(i) * std::f64::consts::TAU / 4000.0;
            DVec3::new(a.cos(), a.sin(), if i % 2 == 0 { -0.0 } else { -1e-12 }).normalize()
        });
        let worst = spiral
            .chain(axes)
            .chain(seams)
            .map(|v| 2.0 * (0.5 * (decode(encode(v)) - v).length()).asin().to_degrees())
            .fold(0.0, f64::max);
        assert!(worst <= 0.004, "{worst}°");
    }
}
