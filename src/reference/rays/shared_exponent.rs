//! Twin of `shaders/shared/shared_exponent.wgsl`: encodes radiance in three mantissas of 9 bits and an exponent of 5.

use glam::DVec3;

/// The code of black radiance that was traced. 0 means that nothing was traced.
pub const TRACED_BLACK: u32 = 0x0800_0000;

/// The code of traced radiance. Values above 65408 are clamped to it.
pub fn encode(c: DVec3) -> u32 {
    let v = c.clamp(DVec3::ZERO, DVec3::splat(65408.0));
    let greatest = v.max_element();
    let mut e = exponent(greatest).max(-16) + 16;
    let mut scale = 2f64.powi(24 - e);
    if (greatest * scale).round_ties_even() >= 512.0 {
        e += 1;
        scale *= 0.5;
    }
    let m = v.to_array().map(|c| (c * scale).round_ties_even() as u32);
    let code = m[0] | m[1] << 9 | m[2] << 18 | (e as u32) << 27;
    if m == [0; 3] { TRACED_BLACK } else { code }
}

/// The radiance of a code.
pub fn decode(code: u32) -> DVec3 {
    DVec3::from([code, code >> 9, code >> 18].map(|m| f64::from(m & 511))) * step(code)
}

/// The step between two neighbouring values with the exponent of this code. Rounding is off by at most half of it.
pub fn step(code: u32) -> f64 {
    2f64.powi((code >> 27) as i32 - 24)
}

/// ⌊log₂ v⌋; for 0 a value below all exponents.
fn exponent(v: f64) -> i32 {
    (v.to_bits() >> 52) as i32 - 1023
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_within_half_a_step_and_never_0() {
        for i in 0..200_000 {
            let f = f64::from(i);
            // Covers exponents from below the least to above the greatest, and all ratios of the channels.
            let greatest = 2f64.powf(f * 2e-4 - 22.0);
            let c = DVec3::new(1.0, (f * 0.37).fract(), (f * 0.011).fract()) * greatest;
            let code = encode(c);
            let apart = (decode(code) - c.min(DVec3::splat(65408.0))).abs().max_element();
            assert!(code != 0 && apart <= 0.5 * step(code), "{c} {code:#x} {apart}");
            // One of the channels needs all bits, except at the least exponent.
            assert!(code >> 27 <= 1 || decode(code).max_element() >= 256.0 * step(code), "{c} {code:#x}");
        }
    }

    #[test]
    fn ends_are_what_the_shader_says() {
        assert_eq!((encode(DVec3::ZERO), decode(TRACED_BLACK)), (TRACED_BLACK, DVec3::ZERO));
        assert_eq!(encode(DVec3::splat(-1.0)), TRACED_BLACK);
        assert_eq!(decode(encode(DVec3::splat(1e30))), DVec3::splat(65408.0));
        // 511.5 rounds up to the next exponent.
        assert_eq!(decode(encode(DVec3::new(511.5 / 512.0, 0.0, 0.25))), DVec3::new(1.0, 0.0, 0.25));
        assert_eq!(decode(encode(DVec3::new(1.0, 0.5, 0.25))), DVec3::new(1.0, 0.5, 0.25));
    }
}
