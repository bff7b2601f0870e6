//! What curves say: exponents, crossings, and which points no other one beats.

use crate::report::schema::cost::Fit;

/// Least squares of log y over log x. `None` below three points, or where all x are one. Points that are not above 0
/// have no logarithm and do not count.
pub fn power_law(points: &[(f64, f64)]) -> Option<Fit> {
    let logs: Vec<_> = points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    if logs.len() < 3 {
        return None;
    }
    let n = logs.len() as f64;
    let mean = logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
    let moment = |f: fn(f64, f64) -> f64| logs.iter().map(|p| f(p.0 - mean.0, p.1 - mean.1)).sum::<f64>();
    let (xx, xy, yy) = (moment(|x, _| x * x), moment(|x, y| x * y), moment(|_, y| y * y));
    if xx <= 0.0 {
        return None;
    }
    // A constant is explained whole by exponent 0.
    let r2 = if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 };
    Some(Fit { exponent: xy / xx, r2 })
}

/// The least x from which on `a` is below `b`, for points (x, a, b) of rising x, between points by interpolation of log
/// a/b over log x. The first x where `a` is below from the beginning; `None` where it is not below at the end.
pub fn crossover(points: &[(f64, f64, f64)]) -> Option<f64> {
    let ratios: Vec<_> = points.iter().map(|&(x, a, b)| (x.ln(), (a / b).ln())).collect();
    let last_above = ratios.iter().rposition(|(_, r)| *r >= 0.0);
    match last_above {
        None => points.first().map(|p| p.0),
        Some(i) => {
            let ((x0, r0), (x1, r1)) = (ratios[i], *ratios.get(i + 1)?);
            Some((x0 + (x1 - x0) * r0 / (r0 - r1)).exp())
        }
    }
}

/// Indices of the points (cost, error) that no other one beats: none is as good in both and better in one. By rising
/// cost.
pub fn frontier(points: &[(f64, f64)]) -> Vec<usize> {
    let beats = |a: (f64, f64), b: (f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
    let mut best: Vec<_> =
        (0..points.len()).filter(|&i| !points.iter().any(|&other| beats(other, points[i]))).collect();
    best.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0));
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_exponents_are_found() {
        for exponent in [0.0, 0.5, 1.0, 2.0, -1.5] {
            let points: Vec<_> = [1.0, 2.0, 5.0, 13.0].map(|x: f64| (x, 3.0 * x.powf(exponent))).to_vec();
            let fit = power_law(&points).unwrap();
            assert!((fit.exponent - exponent).abs() < 1e-12, "{exponent}: {fit:?}");
            assert!((fit.r2 - 1.0).abs() < 1e-9 || exponent == 0.0, "{exponent}: {fit:?}");
        }
    }

    #[test]
    fn scatter_lowers_r2() {
        // log2: (0, 0), (1, 2), (2, 1): slope 1/2, r² = 1²/(2·2).
        let fit = power_law(&[(1.0, 1.0), (2.0, 4.0), (4.0, 2.0)]).unwrap();
        assert!((fit.exponent - 0.5).abs() < 1e-12 && (fit.r2 - 0.25).abs() < 1e-12, "{fit:?}");
    }

    #[test]
    fn too_little_to_fit() {
        assert_eq!(power_law(&[(1.0, 1.0), (2.0, 2.0)]), None);
        assert_eq!(power_law(&[(2.0, 1.0), (2.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(power_law(&[(0.0, 1.0), (1.0, 1.0), (2.0, 2.0)]), None, "0 has no logarithm");
    }

    #[test]
    fn crossings() {
        // a/b falls from 4 to 1/4 over x = 1 to 16: 1 in the middle of the logarithms.
        let near = |points: &[_], x: f64| (crossover(points).unwrap() - x).abs() < 1e-9;
        assert!(near(&[(1.0, 4.0, 1.0), (16.0, 1.0, 4.0)], 4.0));
        assert!(near(&[(1.0, 2.0, 1.0), (2.0, 2.0, 1.0), (4.0, 1.0, 2.0)], 8f64.sqrt()));
        assert!(near(&[(1.0, 1.0, 2.0), (4.0, 1.0, 3.0)], 1.0), "below from the beginning");
        assert_eq!(crossover(&[(1.0, 2.0, 1.0), (4.0, 3.0, 1.0)]), None, "never");
        assert_eq!(crossover(&[(1.0, 1.0, 2.0), (4.0, 3.0, 1.0)]), None, "not at the end");
        assert!(near(&[(1.0, 1.0, 2.0), (2.0, 2.0, 1.0), (8.0, 1.0, 2.0)], 4.0), "the last crossing");
        assert_eq!(crossover(&[]), None);
    }

    #[test]
    fn what_is_beaten_is_not_on_the_frontier() {
        let points = [(3.0, 1.0), (1.0, 3.0), (2.0, 3.0), (2.0, 2.0), (4.0, 1.0), (2.0, 2.0)];
        assert_eq!(frontier(&points), [1, 3, 5, 0]);
        assert_eq!(frontier(&[]), [0; 0]);
    }
}
