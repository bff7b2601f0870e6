//! Groups at equal error: one light for a group of a surface's samples, weighted by the group's exact coverage.

use super::surfaces::{Geometry, Window};
use super::{Bound, decibels, slope};
use crate::host::Host;
use crate::measure::quality::QualityError;
use crate::picture::Picture;
use glam::{DMat3, DVec3};

/// Squared errors below are rounding.
const NO_ERROR: f64 = 1e-20;
/// Steps of the power iteration, which need not converge: any line orders the samples.
const ITERATIONS: usize = 16;

/// The surfaces of all windows by what lighting more groups of their samples saves in error.
///
/// A light is the colour of one sample of a group, the one nearest to the group's mean, and stands for all samples of
/// it. A group is of one surface and holds samples that follow each other along the line on which the surface's colours
/// vary most; of all such groupings the best is taken. The errors of groups add up as squares, so that none cancels
/// another's.
///
/// This is what the technique `Surfaces` could reach if it knew the colours, with one light a surface as the least. It
/// is no lower bound over everything: light that is interpolated over several pixels, the light of a mean material, or
/// groups that are no runs along a line may need fewer.
#[derive(Debug, Clone)]
pub struct Groups {
    /// n · w · h.
    samples: f64,
    /// w · h.
    windows: f64,
    /// The best allocations, from one light a surface to no error at all. What lies between two of them are the same
    /// lights but for those of one surface.
    best: Vec<Allocation>,
}

/// Lights of all windows, and the sum of the windows' squared errors.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Allocation {
    lights: f64,
    error: f64,
}

/// A colour, and its place along the line on which those of its surface vary most.
#[derive(Debug, Clone, Copy)]
struct Place {
    color: DVec3,
    along: f64,
}

/// More lights of one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    lights: usize,
    /// The error that each of them takes away.
    gain: f64,
}

impl Groups {
    /// Of the host of m = 1 at m times the picture's size whose last frame was `Full` by `camera`.
    ///
    /// Colours are brought to display by the slope of the display curve at their window's mean, as
    /// [`Windows::new`](super::Windows::new) does.
    pub fn new(samples: &Host, camera: &deferred_aa::Camera, m: u32) -> Result<Self, QualityError> {
        let colors = samples.picture();
        Self::of(&colors, &Geometry::seen(samples, &colors, camera), m)
    }

    fn of(colors: &Picture, geometry: &Geometry, m: u32) -> Result<Self, QualityError> {
        let (mut windows, mut lights, mut steps) = (0_usize, 0, Vec::new());
        for window in geometry.windows(colors, m)? {
            windows += 1;
            lights += window.surfaces.len();
            let points = displayed(colors, &window);
            for ranks in &window.surfaces {
                steps.extend(worthwhile(&errors(ranks.iter().map(|&rank| points[rank]).collect())));
            }
        }
        // Of one surface the steps come by falling gain, so they stay in their order.
        steps.sort_by(|a: &Step, b| b.gain.total_cmp(&a.gain));
        Ok(Self { samples: colors.rgba.len() as f64, windows: windows as f64, best: allocations(lights, &steps) })
    }

    /// The fewest lights whose root mean squared error, of displayed values in [0, 1], is at most `rmse`. `None` if that
    /// is negative or not finite.
    pub fn at(&self, rmse: f64) -> Option<Bound> {
        if !(rmse.is_finite() && rmse >= 0.0) {
            return None;
        }
        let wanted = rmse * rmse * self.windows;
        let next = self.best.partition_point(|a| a.error > wanted);
        Some(self.between(next, |from, to| (from.error - wanted) / (from.error - to.error)))
    }

    /// At least two points of the bound, from one light a surface to no error at all, evenly spaced in the log of
    /// lights.
    pub fn curve(&self, points: usize) -> Vec<Bound> {
        let last = points.max(2) - 1;
        let (least, most) = (self.best[0].lights, self.best[self.best.len() - 1].lights);
        let point = |i: usize| {
            let lights = if i == last { most } else { least * (most / least).powf(i as f64 / last as f64) };
            let next = self.best.partition_point(|a| a.lights < lights);
            self.between(next, |from, to| (lights - from.lights) / (to.lights - from.lights))
        };
        (0..=last).map(point).collect()
    }

    /// The first allocation, or what lies before another at a share of the way from the one before. A surface may have
    /// fractions of a light there, so that no whole numbers do better.
    fn between(&self, next: usize, share: impl Fn(Allocation, Allocation) -> f64) -> Bound {
        let to = self.best[next];
        let Allocation { lights, error } = match next.checked_sub(1).map(|before| self.best[before]) {
            Some(from) => {
                let share = share(from, to);
                let lights = from.lights + share * (to.lights - from.lights);
                Allocation { lights, error: from.error + share * (to.error - from.error) }
            }
            None => to,
        };
        Bound { ratio: lights / self.samples, psnr_db: decibels(error / self.windows) }
    }
}

/// The allocations from `lights` on, one a surface, by steps of falling gain. After the last there is no error.
fn allocations(lights: usize, steps: &[Step]) -> Vec<Allocation> {
    let end = lights + steps.iter().map(|s| s.lights).sum::<usize>();
    let mut best = vec![Allocation { lights: end as f64, error: 0.0 }];
    // From the end, where errors are small, so that none is the rounded difference of great ones.
    for step in steps.iter().rev() {
        let Allocation { lights, error } = best[best.len() - 1];
        let taken = step.lights as f64;
        best.push(Allocation { lights: lights - taken, error: error + taken * step.gain });
    }
    best.reverse();
    best
}

/// The colours of a window's samples, by rank, so scaled that the squared length of a difference is the mean square of
/// its channels as displayed, where one sample is off by so much.
fn displayed(colors: &Picture, window: &Window) -> Vec<DVec3> {
    let color = |&i: &usize| DVec3::from_slice(&colors.rgba[i].map(f64::from)[..3]);
    let n = window.pixels.len() as f64;
    let mean = window.pixels.iter().map(color).sum::<DVec3>() / n;
    let scale = mean.map(slope) / (n * 3.0_f64.sqrt());
    window.pixels.iter().map(|i| color(i) * scale).collect()
}

/// The least squared errors of a surface that is lit once, twice, and so on until there is none.
fn errors(points: Vec<DVec3>) -> Vec<f64> {
    let line = line_of_colors(&points);
    let mut places: Vec<Place> = points.into_iter().map(|color| Place { color, along: color.dot(line) }).collect();
    places.sort_by(|a, b| a.along.total_cmp(&b.along));
    let n = places.len();
    // Of the first samples, by how many they are, with as many lights as there are errors.
    let mut least = run_errors(&places);
    let mut errors = vec![least[n]];
    if errors[0] == 0.0 {
        return errors;
    }
    let runs: Vec<Vec<f64>> = (0..n).map(|from| run_errors(&places[from..])).collect();
    for lights in 1..n {
        let mut with_one_more = vec![f64::INFINITY; n + 1];
        for from in lights..n {
            for (error, run) in with_one_more[from + 1..].iter_mut().zip(&runs[from][1..]) {
                *error = error.min(least[from] + run);
            }
        }
        least = with_one_more;
        errors.push(least[n]);
        if least[n] == 0.0 {
            break;
        }
    }
    errors
}

/// For the first samples, by how many they are: the squared error of a window where they have the colour of the one of
/// them that is nearest to their mean.
fn run_errors(places: &[Place]) -> Vec<f64> {
    let mut errors = vec![0.0];
    let (mut sum, mut below) = (DVec3::ZERO, 0);
    let mut sum_along = 0.0;
    for (i, place) in places.iter().enumerate() {
        sum += place.color;
        sum_along += place.along;
        let n = (i + 1) as f64;
        let mean = Place { color: sum / n, along: sum_along / n };
        // The mean moves only up the line.
        below += places[below..i].iter().take_while(|p| p.along < mean.along).count();
        let above = mean.nearest(places[below..=i].iter(), f64::INFINITY);
        let error = n * n * mean.nearest(places[..below].iter().rev(), above);
        errors.push(if error < NO_ERROR { 0.0 } else { error });
    }
    errors
}

impl Place {
    /// The squared distance to the nearest of places ever farther along the line, or `known` if none is nearer.
    fn nearest<'a>(&self, places: impl Iterator<Item = &'a Self>, known: f64) -> f64 {
        let mut nearest = known;
        for place in places {
            if (place.along - self.along).powi(2) >= nearest {
                break;
            }
            nearest = nearest.min(place.color.distance_squared(self.color));
        }
        nearest
    }
}

/// The direction in which points vary most, by power iteration from the channel that varies with most others.
fn line_of_colors(points: &[DVec3]) -> DVec3 {
    let mean = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut covariance = DMat3::ZERO;
    for d in points.iter().map(|&p| p - mean) {
        covariance += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let columns = [covariance.x_axis, covariance.y_axis, covariance.z_axis];
    let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    let mut line = longest.unwrap_or_default().normalize_or_zero();
    for _ in 0..ITERATIONS {
        line = (covariance * line).normalize_or_zero();
    }
    line
}

/// The steps of the lower convex hull of a surface's errors over its lights, steepest first.
fn worthwhile(errors: &[f64]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut at = 0;
    while at + 1 < errors.len() {
        let step = |to: usize| Step { lights: to - at, gain: (errors[at] - errors[to]) / (to - at) as f64 };
        let Some(steepest) = (at + 1..errors.len()).map(step).max_by(|a, b| a.gain.total_cmp(&b.gain)) else { break };
        at += steepest.lights;
        steps.push(steepest);
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::super::surfaces::tests::of_objects;
    use super::*;
    use crate::measure::quality::IDENTICAL_DB;

    fn picture(width: u32, colors: Vec<[f32; 3]>) -> Picture {
        let height = colors.len() as u32 / width;
        Picture::new(width, height, colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()).unwrap()
    }

    /// Of grey samples, row by row.
    fn groups(width: u32, m: u32, values: &[f32], object: impl Fn(usize) -> u32) -> Groups {
        let colors = picture(width, values.iter().map(|&v| [v; 3]).collect());
        Groups::of(&colors, &of_objects(values.len(), object), m).unwrap()
    }

    #[test]
    fn flat_surfaces_need_one_light() {
        // Windows of 4 × 4, of which the right one shows two objects.
        let object = |i: usize| (i % 8 == 7).into();
        let values: Vec<f32> = (0..32).map(|i| if object(i) == 1 { 0.3 } else { 7.1 }).collect();
        let groups = groups(8, 4, &values, object);
        let three = Bound { ratio: 3.0 / 32.0, psnr_db: IDENTICAL_DB };
        for rmse in [0.0, 1e-9, 0.1, 10.0] {
            assert_eq!(groups.at(rmse), Some(three));
        }
        assert_eq!(groups.curve(3), [three; 3]);
    }

    #[test]
    fn half_black_and_half_white() {
        // One surface needs two lights. With one, half of a window is off by 1.
        let halves = groups(2, 2, &[0.0, 1.0, 1.0, 0.0], |_| 0);
        assert_eq!(halves.at(0.0), Some(Bound { ratio: 0.5, psnr_db: IDENTICAL_DB }));
        let rmse = slope(0.5) / 2.0;
        for (share_of_error, lights) in [(1.0, 1.0), (0.25, 1.75)] {
            let bound = halves.at(rmse * f64::sqrt(share_of_error)).unwrap();
            assert!((bound.ratio - lights / 4.0).abs() < 1e-9, "{bound:?}");
            let error = rmse * rmse * share_of_error;
            assert!((bound.psnr_db + 10.0 * error.log10()).abs() < 1e-6, "{bound:?}");
        }
        // Two surfaces have two lights anyway.
        let apart = groups(2, 2, &[0.0, 1.0, 1.0, 0.0], |i| (i % 3 == 0).into());
        assert_eq!(apart.at(10.0), Some(Bound { ratio: 0.5, psnr_db: IDENTICAL_DB }));
        // Colours of one luminance are two colours, too.
        let (red, green) = ([0.9, 0.0, 0.2], [0.0, 0.9, 0.2]);
        let colors = picture(2, vec![red, red, green, green]);
        let two = Groups::of(&colors, &of_objects(4, |_| 0), 2).unwrap();
        assert_eq!(two.at(0.0), halves.at(0.0));
    }

    #[test]
    fn the_extremes_are_one_light_and_all() {
        let values: Vec<f32> = (0..64).map(|i| ((i * 37 % 64) as f32).powf(1.7) / 100.0).collect();
        let groups = groups(8, 4, &values, |_| 0);
        assert_eq!(groups.at(0.0), Some(Bound { ratio: 1.0, psnr_db: IDENTICAL_DB }));
        let one = groups.at(1e3).unwrap();
        assert_eq!(one.ratio, 1.0 / 16.0);
        assert!(groups.at(f64::NAN).is_none() && groups.at(-1.0).is_none());
        let curve = groups.curve(20);
        assert_eq!((curve.len(), curve[0], curve[19]), (20, one, groups.at(0.0).unwrap()));
        assert!(curve.is_sorted_by(|a, b| a.ratio < b.ratio && a.psnr_db < b.psnr_db), "{curve:?}");
        for p in &curve[1..19] {
            let same = groups.at(10.0_f64.powf(-p.psnr_db / 20.0)).unwrap();
            assert!((same.ratio / p.ratio - 1.0).abs() < 1e-9, "{p:?} {same:?}");
        }
    }

    #[test]
    fn no_other_allocation_does_better() {
        // Three windows of four greys each, ascending, so that runs are read off.
        let windows = [[0.0, 0.1, 0.5, 2.0], [0.2, 0.3, 0.5, 0.6], [0.0, 0.4, 3.0, 3.1]];
        let values: Vec<f32> = (0..12).map(|i| windows[i / 4][i % 4] as f32).collect();
        let groups = groups(2, 2, &values, |_| 0);
        // Bit i of `cuts` parts a window's samples i and i + 1.
        let lit = |window: &[f64; 4], cuts: u32| {
            let (mut error, mut from) = (0.0, 0);
            for to in (1..=4).filter(|&to| to == 4 || cuts >> (to - 1) & 1 == 1) {
                let run = &window[from..to];
                let mean = run.iter().sum::<f64>() / run.len() as f64;
                let off = run.iter().map(|v| (v - mean).abs()).fold(f64::INFINITY, f64::min);
                error += (run.len() as f64 / 4.0 * off * slope(window.iter().sum::<f64>() / 4.0)).powi(2);
                from = to;
            }
            (1 + cuts.count_ones(), error)
        };
        let mut all = Vec::new();
        for cuts in 0..512_u32 {
            let each: Vec<_> = (0..3).map(|i| lit(&windows[i], cuts >> (3 * i) & 7)).collect();
            all.push((each.iter().map(|e| e.0).sum::<u32>(), each.iter().map(|e| e.1).sum::<f64>()));
        }
        for &(lights, error) in &all {
            let bound = groups.at((error / 3.0).sqrt()).unwrap().ratio * 12.0;
            assert!(bound < f64::from(lights) + 1e-4, "{lights} lights have an error of {error}, the bound is {bound}");
        }
        for best in &groups.best {
            let is_it = |&(l, e): &(u32, f64)| f64::from(l) == best.lights && (e - best.error).abs() < 1e-6;
            assert!(all.iter().any(is_it), "none is {best:?}");
        }
        assert!(groups.best.len() > 4, "{:?}", groups.best);
    }

    #[test]
    fn broken_input_is_refused() {
        let of = |colors: &Picture, m| Groups::of(colors, &of_objects(colors.rgba.len(), |_| 0), m);
        let mut colors = picture(4, vec![[0.0; 3]; 16]);
        assert!(matches!(of(&colors, 3), Err(QualityError::Windows { m: 3, .. })));
        assert!(matches!(of(&colors, 0), Err(QualityError::Windows { m: 0, .. })));
        colors.rgba[7][2] = f32::NAN;
        assert!(matches!(of(&colors, 2), Err(QualityError::ReferenceNotFinite { x: 3, y: 1 })));
    }
}
