//! Curves of samples over PSNR, compared at the same PSNR.

/// A curve's name, and its points of PSNR and samples.
pub type Curve<'a> = Option<(&'a str, Vec<(f64, f64)>)>;

/// Of (series, PSNR, samples): the first series that there is.
pub fn first_curve<'a>(rows: impl Iterator<Item = (Option<&'a str>, f64, f64)> + Clone) -> Curve<'a> {
    let name = rows.clone().find_map(|(series, ..)| series)?;
    let points = rows.filter(|(series, ..)| *series == Some(name)).map(|(_, db, samples)| (db, samples));
    Some((name, points.collect()))
}

/// Samples of a point of another series over those of the curve at this PSNR, between its neighbouring points by their
/// logarithms.
pub fn same_psnr(curve: &Curve<'_>, series: Option<&str>, db: f64, samples: f64) -> Option<f64> {
    let (name, points) = curve.as_ref()?;
    series.filter(|s| s != name)?;
    let around = |w: &&[(f64, f64)]| w[0].0 != w[1].0 && (w[0].0 - db) * (w[1].0 - db) <= 0.0;
    let w = points.windows(2).find(around)?;
    let share = (db - w[0].0) / (w[1].0 - w[0].0);
    Some(samples / (w[0].1.ln() + share * (w[1].1 / w[0].1).ln()).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_compare_at_the_same_psnr() {
        let rows = [(None, 50.0, 16.0), (Some("a"), 40.0, 4.0), (Some("a"), 36.0, 1.0), (Some("b"), 38.0, 1.0)];
        let curve = first_curve(rows.into_iter());
        // In the middle of 1 and 4 by their logarithms is 2.
        assert!((same_psnr(&curve, Some("b"), 38.0, 1.0).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(same_psnr(&curve, Some("b"), 40.0, 4.0), Some(1.0));
        assert_eq!(same_psnr(&curve, Some("b"), 41.0, 4.0), None, "beyond the curve");
        assert_eq!(same_psnr(&curve, Some("a"), 38.0, 2.0), None, "the curve itself");
        assert_eq!(same_psnr(&curve, None, 38.0, 2.0), None);
    }
}
