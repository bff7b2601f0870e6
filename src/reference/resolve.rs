//! Twin of `shaders/shared/mean.wgsl` and `shaders/passes/resolve.wgsl`: the colour of a pixel from its samples.

pub mod depth;

use crate::settings::Weight;

/// A sample after its clean-up: NaN and infinity become opaque black, negative components become 0, and values are
/// limited to 1e30.
pub fn clean(c: [f64; 4]) -> [f64; 4] {
    if c.iter().all(|v| v.is_finite()) { c.map(|v| v.clamp(0.0, 1e30)) } else { [0.0, 0.0, 0.0, 1.0] }
}

/// The weighted mean of a pixel's samples.
pub fn mean(samples: &[[f64; 4]], weight: Weight, exposure: f64) -> [f64; 4] {
    let mut sum = [0.0; 4];
    let mut weights = 0.0;
    for &sample in samples {
        let c = clean(sample);
        let luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        let w = match weight {
            Weight::Linear => 1.0,
            Weight::Luminance => 1.0 / (1.0 + (luminance * exposure).min(1e30)),
        };
        for (s, v) in sum.iter_mut().zip(c) {
            *s += v * w;
        }
        weights += w;
    }
    sum.map(|s| s / weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_against_a_firefly_stays_monotone_with_the_weight() {
        let grey = |v: f64| [v, v, v, 1.0];
        let edge = |k: usize| {
            let samples: Vec<_> = (0..16).map(|i| grey(if i < k { 50.0 } else { 0.0 })).collect();
            mean(&samples, Weight::Luminance, 1.0)[0]
        };
        let steps: Vec<f64> = (0..=16).map(edge).collect();
        assert!(steps.windows(2).all(|s| s[0] < s[1]));
        // A single firefly barely shows, and the linear mean is the mean.
        assert!(steps[1] < 0.1);
        let three = [grey(0.0), grey(1.0), grey(50.0)];
        assert!((mean(&three, Weight::Linear, 1.0)[0] - 17.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_but_numbers_gets_in() {
        assert_eq!(clean([f64::NAN, 1.0, 1.0, 1.0]), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(clean([f64::INFINITY, 1.0, 1.0, 1.0]), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(clean([-1.0, 2.0, 1e31, 1.0]), [0.0, 2.0, 1e30, 1.0]);
    }
}
