//! The oracles: the fewest samples, or lights, that could reach an error, for one who knows all n colours of every
//! window beforehand.
//!
//! The colours come from a host of m = 1 at m times the picture's width and height, rendered with the same camera by
//! `Full`: its pixels are the samples of the picture's G-buffer, on the same grid.

mod coverage;
mod groups;
mod surfaces;

pub use coverage::{Coverage, exact_coverage};
pub use groups::Groups;

use crate::measure::quality::{self, IDENTICAL_DB, QualityError};
use crate::picture::Picture;
use deferred_aa::window::MAX_M;

/// The samples of all windows by what picking some of them costs in error.
///
/// The bound holds for unbiased means of k of the grid's own n samples, drawn at random. A technique may beat it where
/// its samples know more than that: places spread over the window by their order, a texture footprint wider than a
/// sample's own, or weights that are exact coverage.
#[derive(Debug, Clone)]
pub struct Windows {
    /// Samples of a window.
    n: f64,
    /// S of each window: the standard deviation of its colours as displayed.
    deviations: Vec<f64>,
}

/// A bound at one error.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bound {
    /// Samples, or lights, over n · w · h, at least 1/n. Windows may have fractions of one, so that no whole numbers do
    /// better.
    pub ratio: f64,
    /// Of the expected squared error of displayed values, RGB alike; [`IDENTICAL_DB`] for none.
    pub psnr_db: f64,
}

impl Windows {
    /// From the picture of the big host, whose windows are m × m of its pixels.
    ///
    /// S² of a window is the variance of its n linear colours (over n − 1), brought to display by the slope of the
    /// display curve at their mean, averaged over RGB. The slope stands for the curve: good where the error is small,
    /// rough for few samples of a window of great contrast.
    pub fn new(samples: &Picture, m: u32) -> Result<Self, QualityError> {
        check(samples, m)?;
        let n = f64::from(m * m);
        let deviation = |x: u32, y: u32| {
            let variance = |channel: usize| {
                let values = || window(samples, m, x, y).map(|pixel| f64::from(pixel[channel]));
                let mean = values().sum::<f64>() / n;
                let squares: f64 = values().map(|v| (v - mean).powi(2)).sum();
                slope(mean).powi(2) * squares / (n - 1.0).max(1.0)
            };
            ((variance(0) + variance(1) + variance(2)) / 3.0).sqrt()
        };
        let rows = 0..samples.height / m;
        let deviations = rows.flat_map(|y| (0..samples.width / m).map(move |x| (x, y)));
        Ok(Self { n, deviations: deviations.map(|(x, y)| deviation(x, y)).collect() })
    }

    /// The fewest samples whose expected root mean squared error, of displayed values in [0, 1], is at most `rmse`.
    /// `None` if that is negative or not finite.
    pub fn neyman(&self, rmse: f64) -> Option<Bound> {
        if !(rmse.is_finite() && rmse >= 0.0) {
            return None;
        }
        let wanted = rmse * rmse;
        let (mut low, mut high) = self.bounds();
        if self.error(high) <= wanted {
            return Some(self.at(high));
        }
        // The error rises with √λ: at `low` it is not above `wanted`, at `high` it is.
        for _ in 0..80 {
            let middle = (low * high).sqrt();
            if self.error(middle) <= wanted { low = middle } else { high = middle }
        }
        Some(self.at(low))
    }

    /// At least two points of the bound, from one sample a window to no error at all, evenly spaced in log λ.
    pub fn curve(&self, points: usize) -> Vec<Bound> {
        let (low, high) = self.bounds();
        let last = points.max(2) - 1;
        (0..=last).map(|i| self.at(high * (low / high).powf(i as f64 / last as f64))).collect()
    }

    /// √λ at which every window that needs it has n samples, and that at which each has one.
    fn bounds(&self) -> (f64, f64) {
        let least = self.deviations.iter().copied().filter(|&s| s > 0.0).fold(f64::INFINITY, f64::min);
        let most = self.deviations.iter().copied().fold(0.0, f64::max);
        if most > 0.0 { (least / self.n, most) } else { (1.0, 1.0) }
    }

    /// Neyman's allocation: the derivatives of all windows' errors by their k are alike, −S²/k² = −λ, within 1 to n.
    fn samples(&self, deviation: f64, root_lambda: f64) -> f64 {
        (deviation / root_lambda).clamp(1.0, self.n)
    }

    /// Of the mean of k of n, drawn without replacement: S²/k · (1 − k/n). Mean over windows.
    fn error(&self, root_lambda: f64) -> f64 {
        let error = |&s: &f64| {
            let k = self.samples(s, root_lambda);
            s * s / k * (1.0 - k / self.n)
        };
        self.deviations.iter().map(error).sum::<f64>() / self.deviations.len() as f64
    }

    fn at(&self, root_lambda: f64) -> Bound {
        let samples: f64 = self.deviations.iter().map(|&s| self.samples(s, root_lambda)).sum();
        let psnr_db = decibels(self.error(root_lambda));
        Bound { ratio: samples / (self.n * self.deviations.len() as f64), psnr_db }
    }
}

/// PSNR of a mean squared error of displayed values.
fn decibels(error: f64) -> f64 {
    (-10.0 * error.log10()).min(IDENTICAL_DB)
}

/// What `Full` makes of the same samples: the mean of each window.
pub fn grid(samples: &Picture, m: u32) -> Result<Picture, QualityError> {
    check(samples, m)?;
    let (width, height) = (samples.width / m, samples.height / m);
    let mean = |x, y| {
        let mut sum = [0.0; 4];
        for pixel in window(samples, m, x, y) {
            sum.iter_mut().zip(pixel).for_each(|(s, c)| *s += f64::from(c));
        }
        sum.map(|s| (s / f64::from(m * m)) as f32)
    };
    Ok(Picture { width, height, rgba: (0..height).flat_map(|y| (0..width).map(move |x| mean(x, y))).collect() })
}

/// The samples of a pixel's window, in reading order.
fn window(samples: &Picture, m: u32, x: u32, y: u32) -> impl Iterator<Item = [f32; 4]> {
    let start = move |row: u32| (y * m + row) as usize * samples.width as usize + (x * m) as usize;
    (0..m).flat_map(move |row| samples.rgba[start(row)..start(row) + m as usize].iter().copied())
}

fn check(samples: &Picture, m: u32) -> Result<(), QualityError> {
    quality::check(samples, samples)?;
    let (width, height) = (samples.width, samples.height);
    if (1..=MAX_M).contains(&m) && width.is_multiple_of(m) && height.is_multiple_of(m) {
        Ok(())
    } else {
        Err(QualityError::Windows { width, height, m })
    }
}

/// The derivative of `picture::display` at a radiance.
fn slope(c: f64) -> f64 {
    let c = c.max(0.0);
    let light = c / (1.0 + c);
    let srgb = if light <= 0.003_130_8 { 12.92 } else { 1.055 / 2.4 * light.powf(1.0 / 2.4 - 1.0) };
    srgb / (1.0 + c).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture;

    fn picture(width: u32, height: u32, value: impl Fn(u32, u32) -> f32) -> Picture {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Picture::new(width, height, pixels.map(|(x, y)| [value(x, y); 3]).map(|[r, g, b]| [r, g, b, 1.0]).collect())
            .unwrap()
    }

    #[test]
    fn the_slope_is_that_of_the_display() {
        for c in [1e-4_f32, 1e-3, 0.02, 0.5, 1.0, 7.0] {
            let step = c * 1e-2;
            let [above, below] = [c + step, c - step].map(|c| f64::from(picture::display([c; 3])[0]));
            let measured = (above - below) / (2.0 * f64::from(step));
            assert!((slope(f64::from(c)) / measured - 1.0).abs() < 1e-3, "{c}: {} {measured}", slope(f64::from(c)));
        }
    }

    #[test]
    fn flat_windows_need_one_sample() {
        // Flat within windows, not between them.
        let windows = Windows::new(&picture(8, 4, |x, _| (x / 4) as f32), 4).unwrap();
        let flat = Bound { ratio: 1.0 / 16.0, psnr_db: IDENTICAL_DB };
        for rmse in [0.0, 1e-9, 0.1, 10.0] {
            assert_eq!(windows.neyman(rmse), Some(flat));
        }
        assert_eq!(windows.curve(3), [flat; 3]);
        let single = Windows::new(&picture(2, 2, |x, _| x as f32), 1).unwrap();
        assert_eq!(single.neyman(0.0), Some(Bound { ratio: 1.0, psnr_db: IDENTICAL_DB }));
    }

    #[test]
    fn half_black_and_half_white() {
        // Two of four are 1, the mean is ½: the variance over n − 1 is ⅓.
        let windows = Windows::new(&picture(2, 6, |x, _| x as f32), 2).unwrap();
        let s = slope(0.5) / 3.0_f64.sqrt();
        for (k, share) in [(1.0, 0.25), (2.0, 0.5), (3.0, 0.75)] {
            let rmse = s * (1.0_f64 / k - 0.25).sqrt();
            let bound = windows.neyman(rmse).unwrap();
            assert!((bound.ratio - share).abs() < 1e-9, "{k}: {bound:?}");
            assert!((bound.psnr_db + 20.0 * rmse.log10()).abs() < 1e-6, "{k}: {bound:?}");
        }
        // As many flat windows beside them take one sample each, and halve the error.
        let windows = Windows::new(&picture(4, 6, |x, _| if x < 2 { x as f32 } else { 5.0 }), 2).unwrap();
        let bound = windows.neyman(s * (0.25_f64 / 2.0).sqrt()).unwrap();
        assert!((bound.ratio - (0.5 + 0.25) / 2.0).abs() < 1e-9, "{bound:?}");
    }

    #[test]
    fn the_extremes_are_one_sample_and_all() {
        let windows = Windows::new(&picture(8, 8, |x, y| ((x * 7 + y * 13) % 11) as f32 / 5.0), 4).unwrap();
        let all = windows.neyman(0.0).unwrap();
        assert!(all.ratio > 1.0 - 1e-9 && all.psnr_db == IDENTICAL_DB, "{all:?}");
        let one = windows.neyman(1e3).unwrap();
        assert_eq!(one.ratio, 1.0 / 16.0);
        assert!(windows.neyman(f64::NAN).is_none() && windows.neyman(-1.0).is_none());
        let curve = windows.curve(20);
        assert_eq!(curve[0], one);
        assert_eq!(curve.len(), 20);
        assert!(curve.is_sorted_by(|a, b| a.ratio <= b.ratio && a.psnr_db < b.psnr_db), "{curve:?}");
        assert!((curve[19].ratio - 1.0).abs() < 1e-9 && curve[19].psnr_db > 100.0, "{curve:?}");
    }

    #[test]
    fn no_other_allocation_does_better() {
        let windows = Windows { n: 16.0, deviations: vec![0.02, 0.1, 0.3, 1.0] };
        let root_lambda = 0.05;
        let best: Vec<f64> = windows.deviations.iter().map(|&s| windows.samples(s, root_lambda)).collect();
        let error =
            |k: &[f64]| -> f64 { windows.deviations.iter().zip(k).map(|(s, k)| s * s / k * (1.0 - k / 16.0)).sum() };
        for from in 0..4 {
            for to in 0..4 {
                let mut other = best.clone();
                other[from] -= 0.1;
                other[to] += 0.1;
                let allowed = other.iter().all(|k| (1.0..=16.0).contains(k)) && from != to;
                assert!(!allowed || error(&other) > error(&best), "{best:?} {other:?}");
            }
        }
        assert!((windows.error(root_lambda) - error(&best) / 4.0).abs() < 1e-15);
    }

    #[test]
    fn broken_input_is_refused() {
        assert!(matches!(Windows::new(&picture(5, 4, |_, _| 0.0), 2), Err(QualityError::Windows { m: 2, .. })));
        assert!(matches!(Windows::new(&picture(4, 4, |_, _| 0.0), 0), Err(QualityError::Windows { m: 0, .. })));
        let lost = picture(4, 4, |x, y| if (x, y) == (3, 1) { f32::NAN } else { 0.0 });
        assert!(matches!(Windows::new(&lost, 2), Err(QualityError::ReferenceNotFinite { x: 3, y: 1 })));
        assert!(grid(&picture(4, 5, |_, _| 0.0), 2).is_err());
    }
}
