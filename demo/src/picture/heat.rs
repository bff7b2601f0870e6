//! The colours of sample counts.

use super::error::PictureError;
use super::size::{check_size, image_of};
use image::RgbImage;

/// The colour of a count of 0, where nothing was shaded and the colour came from neighbours.
pub const NOT_SHADED: [u8; 3] = [16, 52, 62];

/// The colour of a count above the maximum, which no technique may reach.
pub const OVER_MAX: [u8; 3] = [0, 255, 255];

/// The colour of `k` samples out of `n_max`: near-black for 1, pale yellow for all, lightness rising in between.
///
/// The scale is logarithmic, since 2 samples instead of 1 double a pixel's cost and 16 instead of 15 do not matter.
/// 0 is [`NOT_SHADED`] and more than `n_max` [`OVER_MAX`].
pub fn heat(k: u32, n_max: u32) -> [u8; 3] {
    match k {
        0 => NOT_SHADED,
        _ if k > n_max.max(1) => OVER_MAX,
        1 => inferno(0.0),
        _ => inferno((k as f32).ln() / (n_max as f32).ln()),
    }
}

/// The colour map Inferno by Nathaniel Smith and Stéfan van der Walt, whose lightness is monotone: from near-black at 0
/// to pale yellow at 1.
pub(crate) fn inferno(t: f32) -> [u8; 3] {
    colorous::INFERNO.eval_continuous(f64::from(t)).into_array()
}

/// The sample counts as an image of the same size, coloured by [`heat`]. `counts` has one entry a pixel.
pub fn heat_map(counts: &[u32], width: u32, height: u32, n_max: u32) -> Result<RgbImage, PictureError> {
    check_size(width, height, counts.len())?;
    image_of(width, height, counts.iter().map(|&k| heat(k, n_max)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_rises_from_near_black() {
        let lightness = |c: [u8; 3]| 0.2126 * f32::from(c[0]) + 0.7152 * f32::from(c[1]) + 0.0722 * f32::from(c[2]);
        for n in [1, 2, 4, 9, 16, 64, 256] {
            let steps: Vec<f32> = (1..=n).map(|k| lightness(heat(k, n))).collect();
            // 256 steps in 8 bits: neighbours may be a rounding of red apart.
            let rise = if n <= 16 { 1.0 } else { -0.22 };
            assert!(steps.is_sorted_by(|a, b| b - a >= rise), "{n}: {steps:?}");
            assert!(steps[0] < 3.0 && (n == 1 || steps[steps.len() - 1] > 230.0), "{n}: {steps:?}");
            assert_eq!((heat(0, n), heat(n + 1, n)), (NOT_SHADED, OVER_MAX));
        }
        assert_eq!(heat(1, 0), heat(1, 1));
        // matplotlib's Inferno at 0, 1/2 and 1.
        for (k, expected) in [(1, [0, 0, 4]), (4, [188, 55, 84]), (16, [252, 255, 164])] {
            let found = heat(k, 16);
            assert!(found.iter().zip(expected).all(|(a, b): (&u8, u8)| a.abs_diff(b) <= 1), "{k}: {found:?}");
        }
    }

    #[test]
    fn heat_map_checks_its_size() {
        let map = heat_map(&[0, 1, 4, 16, 17, 2], 3, 2, 16).unwrap();
        assert_eq!(map.get_pixel(0, 1).0, heat(16, 16));
        assert!(matches!(heat_map(&[1; 5], 3, 2, 16), Err(PictureError::Length { found: 5, .. })));
        assert!(matches!(heat_map(&[], 0, 0, 16), Err(PictureError::Empty { .. })));
    }
}
