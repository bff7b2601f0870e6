//! Pattern search: each axis up and down in turn, then once more along what a round gained; the step is halved where a
//! round gains nothing (Hooke and Jeeves 1961). No gradients and no chance: the same search twice takes the same
//! points.

/// A dimension, searched on a log scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Of the setting.
    pub name: &'static str,
    /// Above 0.
    pub least: f64,
    /// Above `least`.
    pub most: f64,
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// One value an axis.
    pub point: Vec<f64>,
    /// Of that point, the least that was seen.
    pub cost: f64,
}

/// A value that reads well in source: two digits.
pub fn two_digits(value: f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return 0.0;
    }
    let unit = 10f64.powi(value.log10().floor() as i32 - 1);
    // Divided and not multiplied by a unit below 1, which has no exact double.
    if unit < 1.0 { (value / unit).round() / (1.0 / unit).round() } else { (value / unit).round() * unit }
}

/// Minimises `cost` from `start`, whose first step is a factor of 2^`octaves`, over at most `rounds` rounds.
/// `after_round` hears of each.
pub fn pattern_search<E>(
    axes: &[Axis],
    start: &[f64],
    octaves: f64,
    rounds: usize,
    mut cost: impl FnMut(&[f64]) -> Result<f64, E>,
    mut after_round: impl FnMut(&Found),
) -> Result<Found, E> {
    let mut best = Found { point: start.to_vec(), cost: cost(start)? };
    let mut step = octaves;
    for _ in 0..rounds {
        let before = best.clone();
        for (i, axis) in axes.iter().enumerate() {
            for direction in [step, -step] {
                let mut point = best.point.clone();
                point[i] = two_digits(point[i] * direction.exp2()).clamp(axis.least, axis.most);
                if try_point(point, &mut best, &mut cost)? {
                    break;
                }
            }
        }
        if best.cost < before.cost {
            let along = |(i, axis): (usize, &Axis)| {
                two_digits(best.point[i] * best.point[i] / before.point[i]).clamp(axis.least, axis.most)
            };
            let point = axes.iter().enumerate().map(along).collect();
            try_point(point, &mut best, &mut cost)?;
        } else {
            step *= 0.5;
        }
        after_round(&best);
    }
    Ok(best)
}

/// Whether the point is better; it is `best` then.
fn try_point<E>(point: Vec<f64>, best: &mut Found, cost: &mut impl FnMut(&[f64]) -> Result<f64, E>) -> Result<bool, E> {
    if point == best.point {
        return Ok(false);
    }
    let found = cost(&point)?;
    let better = found < best.cost;
    if better {
        *best = Found { point, cost: found };
    }
    Ok(better)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    const AXES: [Axis; 3] = [
        Axis { name: "a", least: 1e-3, most: 1e3 },
        Axis { name: "b", least: 1e-3, most: 1e3 },
        Axis { name: "c", least: 5.0, most: 1e3 },
    ];

    /// Least at a = 20, b = 0.3 and c at its end, with a valley aslant between a and b.
    fn bowl(p: &[f64]) -> f64 {
        let (a, b) = ((p[0] / 20.0).log2(), (p[1] / 0.3).log2());
        (a + b).powi(2) + 0.3 * (a - b).powi(2) + (p[2] / 2.0).log2()
    }

    fn search(rounds: usize) -> (Found, usize) {
        let mut seen = 0;
        let cost = |p: &[f64]| {
            seen += 1;
            Ok::<_, Infallible>(bowl(p))
        };
        let found = pattern_search(&AXES, &[1.0, 1.0, 100.0], 1.0, rounds, cost, |_| {}).unwrap();
        (found, seen)
    }

    #[test]
    fn a_known_optimum_is_found() {
        let (found, seen) = search(30);
        assert!((found.point[0] / 20.0).log2().abs() < 0.1, "{found:?}");
        assert!((found.point[1] / 0.3).log2().abs() < 0.1, "{found:?}");
        assert_eq!(found.point[2], 5.0);
        assert_eq!(found.cost, bowl(&found.point));
        assert!(seen < 200, "{seen}");
        assert_eq!(search(30), (found, seen), "another search found another point");
    }

    #[test]
    fn more_rounds_are_never_worse() {
        let costs: Vec<_> = (0..12).map(|rounds| search(rounds).0.cost).collect();
        assert!(costs.is_sorted_by(|a, b| a >= b), "{costs:?}");
        assert_eq!(search(0).0.point, [1.0, 1.0, 100.0]);
    }

    #[test]
    fn a_failure_ends_it() {
        let failing = |p: &[f64]| if p[0] > 1.0 { Err("lost") } else { Ok(1.0) };
        assert_eq!(pattern_search(&AXES, &[1.0, 1.0, 100.0], 1.0, 3, failing, |_| {}), Err("lost"));
    }

    #[test]
    fn two_digits_are_kept() {
        let pairs = [(110.4, 110.0), (0.02049, 0.02), (0.0237, 0.024), (9.96, 10.0), (4321.0, 4300.0), (0.6, 0.6)];
        for (value, kept) in pairs {
            assert_eq!(two_digits(value), kept);
        }
        assert_eq!(two_digits(0.0), 0.0);
        assert_eq!(two_digits(f64::NAN), 0.0);
    }
}
