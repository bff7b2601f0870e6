//! The search for the settings of a technique that reach an error with the fewest samples, over several views at once.
//!
//! The dial ([`tunable::Tunable`]) trades samples for error most smoothly, so it is no axis of the search: every point
//! is brought to the floor by it, and then points compare by their samples alone.

pub mod search;
pub mod subject;
pub mod tunable;

use search::{Found, pattern_search, two_digits};
use serde::Serialize;
use subject::{Figures, Subject, SubjectError};
use tunable::{Tunable, values};

/// Edges, where aliasing is seen, are held this much above the floor of the whole picture, in dB.
pub const EDGE_MARGIN_DB: f64 = 3.0;

/// Close enough to the floor for points to be compared.
const CLOSE_DB: f64 = 0.1;

/// dB that a doubled dial buys, about, or a halved one where that means more samples.
const DB_PER_OCTAVE: f64 = 3.0;

/// ln samples that a dB costs, about; for what is left of the way to the floor.
const LN_RATIO_PER_DB: f64 = 0.09;

/// What the search is for, and how long it may go on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Task {
    /// What settings must reach.
    pub floor: Floor,
    /// At most.
    pub rounds: usize,
}

/// What settings must reach.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Floor {
    /// The least PSNR against full supersampling on any view, in dB.
    Db(f64),
    /// What other settings give on the same views: in the mean over them no worse in PSNR, at edges, in FLIP and in
    /// flicker, and on none worse by more than [`WORST_DB`].
    Like(Vec<Figures>),
}

/// What a view may lose in dB where others gain it.
pub const WORST_DB: f64 = 1.5;

impl Floor {
    /// By how much figures are above it, in dB.
    fn spare_db(&self, figures: &[Figures]) -> f64 {
        match self {
            Self::Db(floor) => {
                let spare = |f: &Figures| f.psnr_db.min(f.edge_psnr_db - EDGE_MARGIN_DB) - floor;
                figures.iter().map(spare).fold(f64::INFINITY, f64::min)
            }
            Self::Like(others) => {
                let gains: Vec<_> = figures.iter().zip(others).map(|(f, other)| gains(f, other)).collect();
                let worst = gains.iter().flatten().copied().fold(f64::INFINITY, f64::min);
                let mean = |i: usize| gains.iter().map(|gain| gain[i]).sum::<f64>() / gains.len().max(1) as f64;
                (0..MEASURES).map(mean).fold(worst + WORST_DB, f64::min)
            }
        }
    }
}

const MEASURES: usize = 4;

/// How much better figures are than others, in dB: PSNR, edges, FLIP, flicker. What is better by more than
/// [`WORST_DB`] counts as that, so that one view can't pay for many.
fn gains(figures: &Figures, other: &Figures) -> [f64; MEASURES] {
    // FLIP and flicker go about with the error, as PSNR does; what none can see is no difference.
    let below = |is: f64, other: f64| 20.0 * (other.max(INVISIBLE) / is.max(INVISIBLE)).log10();
    [
        figures.psnr_db - other.psnr_db,
        figures.edge_psnr_db - other.edge_psnr_db,
        below(figures.flip, other.flip),
        below(figures.flicker, other.flicker),
    ]
    .map(|gain| gain.min(WORST_DB))
}

/// A tenth of a step of eight bits.
const INVISIBLE: f64 = 0.1 / 255.0;

/// Settings on all views.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point<T> {
    /// The settings.
    pub settings: T,
    /// One entry a view.
    pub figures: Vec<Figures>,
}

impl<T> Point<T> {
    /// By how much it is above the floor, in dB.
    fn spare_db(&self, task: &Task) -> f64 {
        task.floor.spare_db(&self.figures)
    }

    /// Whether it reaches the floor.
    pub fn reaches(&self, task: &Task) -> bool {
        self.spare_db(task) >= 0.0
    }

    /// The geometric mean of the costs, so that a view with few samples counts as much.
    pub fn mean_cost(&self) -> f64 {
        Figures::mean(&self.figures).cost
    }
}

/// A dial turned by a factor towards more samples.
fn turned<T: Tunable>(settings: &T, factor: f64) -> f32 {
    let dial = f64::from(settings.dial()) * factor.powf(T::TOWARDS_MORE);
    two_digits(dial).clamp(T::DIAL[0], T::DIAL[1]) as f32
}

/// These with the dial a little towards more samples, or fewer: by about 4 %, where two digits are that fine, and never
/// by nothing short of its end.
fn stepped<T: Tunable>(settings: &T, more: bool) -> T {
    let steps = [1.04f64, 1.07, 1.12];
    let dials = steps.map(|step| turned(settings, if more { step } else { 1.0 / step }));
    let dial = dials.into_iter().find(|&dial| dial != settings.dial());
    settings.with_dial(dial.unwrap_or(settings.dial()))
}

/// The search over the views.
#[derive(Debug)]
pub struct Tuner<'a, T> {
    /// The views.
    pub subjects: &'a mut [Subject<T>],
}

impl<T: Tunable> Tuner<'_, T> {
    /// Tries settings on all views.
    pub fn point(&mut self, settings: T) -> Result<Point<T>, SubjectError> {
        let figures = self.subjects.iter_mut().map(|subject| subject.figures(settings)).collect::<Result<_, _>>()?;
        Ok(Point { settings, figures })
    }

    /// The point with the dial such that the worst view is next to the floor, after a few tries.
    fn near_floor(&mut self, mut settings: T, task: &Task, tries: usize) -> Result<Point<T>, SubjectError> {
        let mut point = self.point(settings)?;
        for _ in 0..tries {
            let spare = point.spare_db(task);
            let dial = turned(&settings, (-spare / DB_PER_OCTAVE).clamp(-1.0, 1.0).exp2());
            if spare.abs() < CLOSE_DB || dial == settings.dial() {
                break;
            }
            settings = settings.with_dial(dial);
            let next = self.point(settings)?;
            // Other settings may hold the picture back: more samples by the dial would be for nothing.
            let gained = next.spare_db(task) - spare;
            if spare < 0.0 && gained < 0.02 {
                break;
            }
            point = next;
        }
        Ok(point)
    }

    /// The cost of settings: ln of the samples that they would need at the floor.
    fn cost(&mut self, settings: T, task: &Task) -> Result<(f64, Point<T>), SubjectError> {
        let point = self.near_floor(settings, task, 3)?;
        let spare = point.spare_db(task);
        // Below the floor a dB is dear, above it cheap: what can't reach the floor must not win.
        let rate = if spare < -CLOSE_DB { 3.0 * LN_RATIO_PER_DB } else { LN_RATIO_PER_DB };
        Ok((point.mean_cost().ln() - rate * spare.min(1.0), point))
    }

    /// The settings that need the fewest samples over the floor. `after_round` hears of the best cost so far.
    pub fn search(
        &mut self,
        start: T,
        task: &Task,
        mut after_round: impl FnMut(&Found),
    ) -> Result<Point<T>, SubjectError> {
        let given = self.point(start)?;
        let mut starts = Vec::new();
        for far in start.starts() {
            let near = self.near_floor(far, task, 8)?.settings;
            starts.push(self.cost(near, task)?);
        }
        let start = starts.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(start, |(_, point)| point.settings);
        // The dial found last is where the next point starts, so that few tries are needed.
        let mut base = start;
        let mut best = f64::INFINITY;
        let cost = |p: &[f64]| {
            let (cost, point) = self.cost(base.with_values(p), task)?;
            if cost < best {
                (best, base) = (cost, point.settings);
            }
            Ok::<_, SubjectError>(cost)
        };
        let found = pattern_search(T::AXES, &values(&start), 1.0, task.rounds, cost, &mut after_round)?;
        base = base.with_values(&found.point);
        for flipped in base.variants() {
            let (cost, point) = self.cost(flipped, task)?;
            if cost < best {
                (best, base) = (cost, point.settings);
            }
        }
        let found = self.above_floor(base, task)?;
        // The search takes less error for a little more cost; what it began with may be the cheapest.
        let is_given = given.reaches(task) && given.mean_cost() <= found.mean_cost();
        Ok(if is_given { given } else { found })
    }

    /// The dial of two digits with the fewest samples whose worst view is not below the floor, if any is.
    fn above_floor(&mut self, settings: T, task: &Task) -> Result<Point<T>, SubjectError> {
        let mut point = self.near_floor(settings, task, 8)?;
        let mut upwards = 0;
        while point.spare_db(task) < 0.0 && upwards < 8 {
            point = self.point(stepped(&point.settings, true))?;
            upwards += 1;
        }
        if upwards > 0 {
            return Ok(point);
        }
        loop {
            let lower = self.point(stepped(&point.settings, false))?;
            if lower.spare_db(task) < 0.0 || lower.settings == point.settings {
                return Ok(point);
            }
            point = lower;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::{Selective, Windowed};

    fn point(figures: &[(f64, f64, f64)]) -> Point<()> {
        let figure = |&(ratio, psnr_db, edge_psnr_db)| {
            let (flip, flicker) = (0.02, 0.01);
            Figures { ratio, cost: ratio, psnr_db, edge_psnr_db, flip, flicker }
        };
        Point { settings: (), figures: figures.iter().map(figure).collect() }
    }

    #[test]
    fn the_worst_view_decides_what_is_spare() {
        let task = Task { floor: Floor::Db(44.0), rounds: 1 };
        assert_eq!(point(&[(0.2, 46.0, 60.0), (0.3, 43.0, 60.0)]).spare_db(&task), -1.0);
        // Edges count, at their margin.
        assert_eq!(point(&[(0.2, 46.0, 45.0)]).spare_db(&task), 1.0 - EDGE_MARGIN_DB);
    }

    #[test]
    fn settings_are_held_against_others_in_the_mean() {
        let other = point(&[(0.2, 50.0, 45.0), (0.2, 40.0, 35.0)]).figures;
        let spare = |change: fn(&mut [Figures])| {
            let mut figures = other.clone();
            change(&mut figures);
            (Floor::Like(other.clone()).spare_db(&figures) * 1e3).round() / 1e3
        };
        assert_eq!(spare(|_| ()), 0.0);
        assert_eq!(spare(|f| f.iter_mut().for_each(|f| f.psnr_db += 1.0)), 0.0, "edges are no better");
        // The measure that has lost the most in the mean decides.
        assert_eq!(spare(|f| f[0].psnr_db -= 1.0), -0.5);
        assert_eq!(spare(|f| f[1].edge_psnr_db -= 0.6), -0.3);
        assert_eq!(spare(|f| f[0].flip *= 10f64.powf(0.05)), -0.5);
        assert_eq!(spare(|f| f[0].flicker *= 10f64.powf(0.05)), -0.5);
        // A view may lose what another one gains, up to a bound on both.
        assert_eq!(spare(|f| (f[0].psnr_db, f[1].psnr_db) = (f[0].psnr_db - 1.4, 90.0)), 0.0);
        assert_eq!(spare(|f| (f[0].psnr_db, f[1].psnr_db) = (f[0].psnr_db - 2.5, 90.0)), -1.0);
        assert_eq!(spare(|f| f[0].flicker = 0.0), 0.0);
    }

    #[test]
    fn costs_are_averaged_as_ratios() {
        let mean = point(&[(0.1, 50.0, 50.0), (0.4, 50.0, 50.0)]).mean_cost();
        assert!((mean - 0.2).abs() < 1e-12, "{mean}");
    }

    #[test]
    fn a_dial_turns_towards_more_samples_and_stops_at_its_ends() {
        let windowed = Windowed { luminance_scale: 100.0, ..Windowed::default() };
        assert_eq!((turned(&windowed, 2.0), turned(&windowed, 1e9)), (200.0, 2000.0));
        let selective = Selective { tau_col: 0.1, ..Selective::default() };
        assert_eq!((turned(&selective, 2.0), turned(&selective, 1e-9)), (0.05, 1.0));
        // Two digits are no finer than a tenth just above a power of ten.
        for dial in [0.01f32, 0.011, 0.05, 0.098] {
            let at = Selective { tau_col: dial, ..selective };
            let (more, fewer) = (stepped(&at, true).tau_col, stepped(&at, false).tau_col);
            assert!(more < dial && more > dial * 0.89 && fewer > dial && fewer < dial * 1.11, "{fewer} {dial} {more}");
        }
        assert_eq!(stepped(&Selective { tau_col: 0.001, ..selective }, true).tau_col, 0.001);
    }
}
