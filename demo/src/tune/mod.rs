//! The search for the settings of [`Technique::Windowed`](deferred_aa::Technique::Windowed) that reach an error with the
//! fewest samples, over several views at once.
//!
//! `luminance_scale` trades samples for error most smoothly, so it is no axis of the search: every point is brought to the
//! floor by it, and then points compare by their samples alone.

pub mod search;
pub mod subject;

use deferred_aa::{DepthMeasure, LuminanceCurve, Windowed};
use search::{Axis, Found, pattern_search, two_digits};
use serde::Serialize;
use subject::{Figures, Subject, SubjectError};

/// What is searched besides `luminance_scale`.
pub const AXES: [Axis; 5] = [
    Axis { name: "luminance_edge", least: 0.005, most: 0.3 },
    Axis { name: "depth_scale", least: 10.0, most: 10_000.0 },
    Axis { name: "normal_scale", least: 2.0, most: 100.0 },
    Axis { name: "luminance_min", least: 0.001, most: 0.1 },
    // Textures shimmer below a half, which no error of a single frame shows.
    Axis { name: "footprint", least: 0.5, most: 1.2 },
];

/// Of `luminance_scale`.
const SCALES: [f64; 2] = [1.0, 2000.0];

/// `luminance_min` and `luminance_edge` that see faint edges too, and those that see strong ones alone: few samples for many
/// windows or many for few. Two valleys; no step leads from one into the other, so a search begins in the better one.
const FAINT: (f32, f32) = (0.01, 0.02);
const STRONG: (f32, f32) = (0.02, 0.12);

/// Where the first search begins, whatever the presets are by now, so that it finds them again.
pub const START: Windowed = Windowed {
    depth: DepthMeasure::Discontinuity,
    depth_scale: 100.0,
    normal_scale: 12.0,
    two_sided: false,
    luminance_scale: 120.0,
    luminance_min: STRONG.0,
    luminance_edge: STRONG.1,
    luminance: LuminanceCurve::Perceptual,
    luminance_centre: true,
    identity_samples: 0.0,
    shadow_samples: 8.0,
    least_samples: 1.0,
    footprint: 0.6,
    centred: true,
    edge_aware_first: true,
    tile_limit: Windowed::NO_TILE_LIMIT,
};

/// Edges, where aliasing is seen, are held this much above the floor of the whole picture, in dB.
pub const EDGE_MARGIN_DB: f64 = 3.0;

/// Close enough to the floor for points to be compared.
const CLOSE_DB: f64 = 0.1;

/// dB that a doubled `luminance_scale` buys, about.
const DB_PER_OCTAVE: f64 = 3.0;

/// ln samples that a dB costs, about; for what is left of the way to the floor.
const LN_RATIO_PER_DB: f64 = 0.09;

/// What the search is for, and how long it may go on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Task {
    /// The least PSNR against full supersampling on any view, in dB.
    pub floor_db: f64,
    /// At most.
    pub rounds: usize,
}

/// Settings on all views.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// The settings.
    pub windowed: Windowed,
    /// One entry a view.
    pub figures: Vec<Figures>,
}

impl Point {
    /// By how much the worst view is above the floor, in dB.
    fn spare_db(&self, floor_db: f64) -> f64 {
        let spare = |f: &Figures| f.psnr_db.min(f.edge_psnr_db - EDGE_MARGIN_DB) - floor_db;
        self.figures.iter().map(spare).fold(f64::INFINITY, f64::min)
    }

    /// The mean over the views of the logarithm of the sample ratio, so that a view with few samples counts as much.
    fn ln_ratio(&self) -> f64 {
        self.figures.iter().map(|f| f.ratio.ln()).sum::<f64>() / self.figures.len().max(1) as f64
    }

    /// The geometric mean of the sample ratios.
    pub fn mean_ratio(&self) -> f64 {
        self.ln_ratio().exp()
    }
}

/// The axes' values of settings.
fn values(w: &Windowed) -> [f64; 5] {
    [w.luminance_edge, w.depth_scale, w.normal_scale, w.luminance_min, w.footprint].map(|v| two_digits(f64::from(v)))
}

/// `base` with the axes' values.
fn with_values(base: Windowed, p: &[f64]) -> Windowed {
    let &[luminance_edge, depth_scale, normal_scale, luminance_min, footprint] = p else { return base };
    Windowed {
        luminance_edge: luminance_edge as f32,
        depth_scale: depth_scale as f32,
        normal_scale: normal_scale as f32,
        luminance_min: luminance_min as f32,
        footprint: footprint as f32,
        ..base
    }
}

/// The search over the views.
#[derive(Debug)]
pub struct Tuner<'a> {
    /// The views.
    pub subjects: &'a mut [Subject],
    /// The one that is left out.
    pub held_out: Option<usize>,
}

impl Tuner<'_> {
    /// Tries settings on all views but the one that is left out.
    pub fn point(&mut self, windowed: Windowed) -> Result<Point, SubjectError> {
        let held_out = self.held_out;
        let kept = self.subjects.iter_mut().enumerate().filter(|(i, _)| Some(*i) != held_out);
        let figures = kept.map(|(_, subject)| subject.figures(windowed)).collect::<Result<_, _>>()?;
        Ok(Point { windowed, figures })
    }

    /// The point with `luminance_scale` such that the worst view is next to the floor, after a few tries.
    fn near_floor(&mut self, mut windowed: Windowed, floor_db: f64, tries: usize) -> Result<Point, SubjectError> {
        let mut point = self.point(windowed)?;
        for _ in 0..tries {
            let spare = point.spare_db(floor_db);
            let scale = f64::from(windowed.luminance_scale) * (-spare / DB_PER_OCTAVE).clamp(-1.0, 1.0).exp2();
            let scale = two_digits(scale).clamp(SCALES[0], SCALES[1]) as f32;
            if spare.abs() < CLOSE_DB || scale == windowed.luminance_scale {
                break;
            }
            windowed.luminance_scale = scale;
            let next = self.point(windowed)?;
            // Other metrics may hold the picture back: more luminance samples would be for nothing.
            let gained = next.spare_db(floor_db) - spare;
            if spare < 0.0 && gained < 0.02 {
                break;
            }
            point = next;
        }
        Ok(point)
    }

    /// The cost of settings: ln of the samples that they would need at the floor.
    fn cost(&mut self, windowed: Windowed, floor_db: f64) -> Result<(f64, Point), SubjectError> {
        let point = self.near_floor(windowed, floor_db, 3)?;
        let spare = point.spare_db(floor_db);
        // Below the floor a dB is dear, above it cheap: what can't reach the floor must not win.
        let rate = if spare < -CLOSE_DB { 3.0 * LN_RATIO_PER_DB } else { LN_RATIO_PER_DB };
        Ok((point.ln_ratio() - rate * spare.min(1.0), point))
    }

    /// The settings that need the fewest samples over the floor. `after_round` hears of the best cost so far.
    pub fn search(
        &mut self,
        start: Windowed,
        task: Task,
        mut after_round: impl FnMut(&Found),
    ) -> Result<Point, SubjectError> {
        let mut starts = Vec::new();
        for (luminance_min, luminance_edge) in [(start.luminance_min, start.luminance_edge), FAINT, STRONG] {
            let far = Windowed { luminance_min, luminance_edge, ..start };
            let near = self.near_floor(far, task.floor_db, 8)?.windowed;
            starts.push(self.cost(near, task.floor_db)?);
        }
        let start = starts.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(start, |(_, point)| point.windowed);
        // The scale found last is where the next point starts, so that few tries are needed.
        let mut base = start;
        let mut best = f64::INFINITY;
        let cost = |p: &[f64]| {
            let (cost, point) = self.cost(with_values(base, p), task.floor_db)?;
            if cost < best {
                (best, base) = (cost, point.windowed);
            }
            Ok::<_, SubjectError>(cost)
        };
        let found = pattern_search(&AXES, &values(&start), 1.0, task.rounds, cost, &mut after_round)?;
        base = with_values(base, &found.point);
        for flipped in variants(base) {
            let (cost, point) = self.cost(flipped, task.floor_db)?;
            if cost < best {
                (best, base) = (cost, point.windowed);
            }
        }
        self.above_floor(base, task.floor_db)
    }

    /// The least `luminance_scale` of two digits whose worst view is not below the floor, if any is.
    fn above_floor(&mut self, windowed: Windowed, floor_db: f64) -> Result<Point, SubjectError> {
        let mut point = self.near_floor(windowed, floor_db, 8)?;
        let step = |scale: f32, factor: f64| two_digits(f64::from(scale) * factor).clamp(SCALES[0], SCALES[1]) as f32;
        let mut upwards = 0;
        while point.spare_db(floor_db) < 0.0 && upwards < 8 {
            let luminance_scale = step(point.windowed.luminance_scale, 1.04);
            point = self.point(Windowed { luminance_scale, ..point.windowed })?;
            upwards += 1;
        }
        if upwards > 0 {
            return Ok(point);
        }
        loop {
            let luminance_scale = step(point.windowed.luminance_scale, 1.0 / 1.04);
            let lower = self.point(Windowed { luminance_scale, ..point.windowed })?;
            if lower.spare_db(floor_db) < 0.0 || lower.windowed == point.windowed {
                return Ok(point);
            }
            point = lower;
        }
    }
}

/// The choices that have no scale, one changed at a time.
fn variants(w: Windowed) -> impl Iterator<Item = Windowed> {
    let samples = [0.0, 2.0, 4.0, 8.0].into_iter().map(move |identity_samples| Windowed { identity_samples, ..w });
    let centre = Windowed { luminance_centre: !w.luminance_centre, ..w };
    samples.chain([centre]).filter(move |v| *v != w)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(figures: &[(f64, f64, f64)]) -> Point {
        let figure = |&(ratio, psnr_db, edge_psnr_db)| Figures { ratio, psnr_db, edge_psnr_db };
        Point { windowed: Windowed::default(), figures: figures.iter().map(figure).collect() }
    }

    #[test]
    fn the_worst_view_decides_what_is_spare() {
        assert_eq!(point(&[(0.2, 46.0, 60.0), (0.3, 43.0, 60.0)]).spare_db(44.0), -1.0);
        // Edges count, at their margin.
        assert_eq!(point(&[(0.2, 46.0, 45.0)]).spare_db(44.0), 1.0 - EDGE_MARGIN_DB);
    }

    #[test]
    fn ratios_are_averaged_as_ratios() {
        let mean = point(&[(0.1, 50.0, 50.0), (0.4, 50.0, 50.0)]).mean_ratio();
        assert!((mean - 0.2).abs() < 1e-12, "{mean}");
    }

    #[test]
    fn values_go_there_and_back() {
        let w = Windowed::default();
        assert_eq!(with_values(w, &values(&w)), w);
        let moved = with_values(w, &[0.1, 20.0, 30.0, 0.04, 0.5]);
        assert_eq!(values(&moved), [0.1, 20.0, 30.0, 0.04, 0.5]);
        assert_eq!(Windowed { luminance_scale: 7.0, ..moved }.depth_scale, 20.0);
        for axis in AXES {
            let at = AXES.iter().position(|a| a.name == axis.name).unwrap_or(9);
            let mut p = values(&w);
            p[at] = axis.most;
            let tree = serde_json::to_value(with_values(w, &p)).unwrap();
            let value = tree[axis.name].as_f64().unwrap();
            assert!((value - axis.most).abs() < 1e-6 * axis.most, "{}: {value}", axis.name);
        }
    }

    #[test]
    fn every_variant_is_sound_and_another() {
        let w = Windowed::default();
        let all: Vec<_> = variants(w).collect();
        assert_eq!(all.len(), 4);
        for v in all {
            assert_ne!(v, w);
            assert_eq!(subject::windowed(v).validate(), Ok(()));
        }
    }
}
