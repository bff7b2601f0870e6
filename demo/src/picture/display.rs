//! The display transform.

/// What a pixel that holds a NaN or an infinity is shown as: magenta, which no sane image has in full.
pub const NOT_FINITE: [u8; 3] = [255, 0, 255];

/// From linear radiance to sRGB in [0, 1]: c/(1+c) per channel, then the sRGB transfer function. Negative radiance is
/// black, and a pixel with a NaN or an infinity is [`NOT_FINITE`].
pub fn display(c: [f32; 3]) -> [f32; 3] {
    if !is_finite(c) {
        return NOT_FINITE.map(|c| f32::from(c) / 255.0);
    }
    c.map(|c| {
        let c = c.max(0.0);
        srgb(c / (1.0 + c))
    })
}

pub fn is_finite(c: [f32; 3]) -> bool {
    c.iter().all(|c| c.is_finite())
}

/// IEC 61966-2-1.
fn srgb(c: f32) -> f32 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

pub fn to_8bit(c: f32) -> u8 {
    (c * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::made::picture;

    #[test]
    fn display_transform_in_closed_form() {
        assert_eq!(picture(1, 1, |_, _| [0.0, -1.0, f32::MAX]).to_srgb8(), [[0, 0, 255]]);
        // c = 1 gives linear 1/2, whose sRGB value is 0.7353569.
        assert!((display([1.0; 3])[0] - 0.735_356_9).abs() < 1e-6);
        // The straight part: c = 0.001 gives 12.92·0.001/1.001.
        assert!((display([0.001; 3])[0] - 0.012_907_09).abs() < 1e-7);
        let steps: Vec<f32> = (0..1000).map(|i| display([i as f32 * 0.01; 3])[0]).collect();
        assert!(steps.is_sorted());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(picture(1, 1, |_, _| [0.5, bad, 0.5]).to_srgb8(), [NOT_FINITE]);
        }
        assert_eq!(picture(2, 1, |x, _| [1.0, if x == 0 { f32::NAN } else { 1.0 }, 1.0]).not_finite(), 1);
    }
}
