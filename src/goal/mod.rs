//! The controller for a goal in place of fixed settings: it moves one number, the effort, until the measured frames
//! meet the goal. `at_effort` of the settings of a technique says what the effort scales.

use crate::TILE;
use crate::gpu::uniforms::audited::Audited;
use crate::settings::{DebugView, Goal, Settings};

/// The least effort: k = 1 except at the steepest edges.
const LEAST: f32 = -12.0;
/// The greatest effort: every sample of every window is shaded.
const MOST: f32 = 8.0;
/// Efforts that differ by less than this give almost the same image.
const NEAR: f32 = 1.0 / 32.0;
/// The greatest step down from one effort to the next: metrics scaled by 1/√2.
const FAR: f32 = 0.5;

/// The progress of a node towards its [`Goal`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct GoalProgress {
    /// The effort of this frame: its metrics were scaled by 2^effort, or its spreads divided by it. At -12 almost nothing
    /// is shaded beyond the first samples, at 0 the settings apply as they are, at 8 every sample is shaded, or with
    /// [`Technique::Surfaces`](crate::Technique::Surfaces) every tap that differs is lit, up to the setting `groups`.
    pub effort: f32,
    /// The estimated root mean square error of the displayed image, from the tiles audited so far. Only for
    /// [`Goal::Error`].
    pub error: Option<f32>,
    /// The share of the image that the estimate is based on. It is 1 after 32 frames of the same effort; on a still
    /// camera the estimate is then exact.
    pub audited: f32,
    /// The state of the search.
    pub state: GoalState,
}

/// The state of the search for a [`Goal`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum GoalState {
    /// The effort is still moving.
    Seeking,
    /// The goal is met, and the effort rests.
    Met,
    /// The goal can't be met: the least effort takes too long, the greatest effort has too large an error, or the
    /// device has no timestamps.
    Missed,
}

/// The measurements of a frame that has arrived.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured<'a> {
    pub effort: f32,
    /// The GPU time of all passes of the node.
    pub milliseconds: Option<f64>,
    /// The audited tiles and their summed squared errors: at the frame's effort, and a step below it.
    pub audits: Option<(Audited, &'a [[f32; 2]])>,
}

/// Moves the effort from frame to frame.
#[derive(Debug)]
pub(crate) struct Controller {
    settings: Settings,
    size: [u32; 2],
    search: Search,
}

#[derive(Debug)]
enum Search {
    None,
    Error(ErrorSearch),
    Time(TimeSearch),
}

impl Default for Controller {
    fn default() -> Self {
        Self { settings: Settings::default(), size: [0; 2], search: Search::None }
    }
}

impl Controller {
    /// Called before each frame. Starts the search anew if the goal or the size has changed, and discards the
    /// measurements if other settings have. `scales` says whether the technique can be scaled to a goal.
    pub fn follow(&mut self, settings: &Settings, size: [u32; 2], scales: bool) {
        let goal = settings.goal.filter(|_| scales);
        let settings = Settings { goal, view: DebugView::Image, ..*settings };
        if (settings, size) == (self.settings, self.size) {
            return;
        }
        let same_size = size == self.size;
        self.search = match (goal, std::mem::replace(&mut self.search, Search::None)) {
            (None, _) => Search::None,
            (Some(Goal::Error(error)), Search::Error(search)) if same_size => Search::Error(search.restarted(error)),
            (Some(Goal::Error(error)), _) => Search::Error(ErrorSearch::new(error, size)),
            (Some(Goal::Time(ms)), Search::Time(search)) => Search::Time(TimeSearch::new(ms, search.effort)),
            (Some(Goal::Time(ms)), _) => Search::Time(TimeSearch::new(ms, 0.0)),
        };
        (self.settings, self.size) = (settings, size);
    }

    /// The effort of the next frame, `None` without a goal.
    pub fn effort(&self) -> Option<f32> {
        match &self.search {
            Search::None => None,
            Search::Error(search) => Some(search.effort),
            Search::Time(search) => Some(search.effort),
        }
    }

    /// The step below the present effort at which the next audit also measures the error.
    pub fn step(&self) -> f32 {
        match &self.search {
            Search::Error(search) => search.step,
            _ => 0.0,
        }
    }

    /// Learns from a frame. A frame with another effort than the present one is ignored: it was recorded before the
    /// effort moved.
    pub fn learn(&mut self, measured: &Measured<'_>) {
        if self.effort() != Some(measured.effort) {
            return;
        }
        match &mut self.search {
            Search::None => {}
            Search::Error(search) => {
                if let Some((audited, errors)) = measured.audits.filter(|(audited, _)| audited.step == search.step) {
                    search.learn(audited, errors);
                }
            }
            Search::Time(search) => search.learn(measured.milliseconds),
        }
    }

    /// The progress, for a frame with this effort.
    pub fn progress(&self, effort: f32) -> Option<GoalProgress> {
        match &self.search {
            Search::None => None,
            Search::Error(search) => {
                let estimate = search.estimate(0);
                Some(GoalProgress {
                    effort,
                    error: estimate.map(|e| e.squared.sqrt() as f32),
                    audited: search.known as f32 / search.tiles.len().max(1) as f32,
                    state: search.state,
                })
            }
            Search::Time(search) => Some(GoalProgress { effort, error: None, audited: 0.0, state: search.state }),
        }
    }
}

/// A search from the safe side: it starts with every sample shaded, and steps down only to efforts that an audit has
/// measured first, by ever smaller steps.
#[derive(Debug)]
struct ErrorSearch {
    /// The target, squared.
    target: f64,
    effort: f32,
    /// The step below the effort at which the audit also measures the error.
    step: f32,
    state: GoalState,
    size: [u32; 2],
    /// The summed squared errors of each tile at this effort and a step below, where they are known.
    tiles: Vec<Option<[f32; 2]>>,
    known: usize,
}

/// The mean squared error of a pixel, and twice its standard error, from the tiles known so far.
#[derive(Debug, Clone, Copy)]
struct Estimate {
    squared: f64,
    margin: f64,
}

impl ErrorSearch {
    /// The least number of tiles to judge from.
    const EVIDENCE: usize = 8;

    fn new(error: f32, size: [u32; 2]) -> Self {
        let tiles = size.map(|side| side.div_ceil(TILE)).iter().product::<u32>() as usize;
        Self {
            target: f64::from(error).powi(2),
            effort: MOST,
            step: FAR,
            state: GoalState::Seeking,
            size,
            tiles: vec![None; tiles],
            known: 0,
        }
    }

    /// Continues the search from its present effort, with another target or other settings.
    fn restarted(self, error: f32) -> Self {
        let mut search = Self { target: f64::from(error).powi(2), step: FAR, ..self };
        search.move_to(search.effort);
        search
    }

    fn learn(&mut self, audited: Audited, errors: &[[f32; 2]]) {
        let mut moved = false;
        for (tile, &error) in audited.tiles(self.size).zip(errors) {
            let Some(known) = tile.and_then(|t| self.tiles.get_mut(t)) else { continue };
            // On a still camera the same effort gives the same bits.
            moved |= known.is_some_and(|before| before.map(f32::to_bits) != error.map(f32::to_bits));
            self.known += usize::from(known.is_none());
            *known = Some(error);
        }
        if moved {
            self.step = FAR;
        }
        self.decide();
    }

    /// Estimates the error at the present effort (0) or a step below it (1), by cluster sampling with the finite
    /// population correction (Cochran, "Sampling Techniques", 1977).
    fn estimate(&self, which: usize) -> Option<Estimate> {
        if self.known == 0 {
            return None;
        }
        let [width, height] = self.size.map(f64::from);
        // Tiles at the border have fewer pixels, so the mean number of pixels in a tile is used.
        let pixels = width * height / self.tiles.len() as f64;
        let known = self.known as f64;
        let of_tiles = || self.tiles.iter().flatten().map(|e| f64::from(e[which]));
        let mean = of_tiles().sum::<f64>() / known;
        let variance = of_tiles().map(|e| (e - mean).powi(2)).sum::<f64>() / (known - 1.0).max(1.0);
        let unknown = 1.0 - known / self.tiles.len() as f64;
        Some(Estimate { squared: mean / pixels, margin: 2.0 * (variance / known * unknown).sqrt() / pixels })
    }

    fn decide(&mut self) {
        if self.known < self.tiles.len().min(Self::EVIDENCE) {
            return;
        }
        let (Some(now), Some(below)) = (self.estimate(0), self.estimate(1)) else { return };
        if now.squared - now.margin > self.target {
            self.step_up(((now.squared - now.margin) / self.target).log2() as f32);
        } else if now.squared + now.margin <= self.target {
            self.state = GoalState::Met;
            if below.squared + below.margin <= self.target && self.effort > LEAST {
                self.move_to(self.effort - self.step);
            } else if below.squared - below.margin > self.target && self.step > NEAR {
                self.step *= 0.5;
                self.forget();
            }
        }
        // Otherwise the error may lie on either side of the target, and more tiles are needed.
    }

    /// Raises the effort. `excess` is log2 of the squared error over the target.
    fn step_up(&mut self, excess: f32) {
        if self.effort >= MOST {
            self.state = GoalState::Missed;
            return;
        }
        self.step = FAR;
        self.move_to(self.effort + excess.clamp(NEAR, 4.0));
    }

    fn move_to(&mut self, effort: f32) {
        self.effort = effort.clamp(LEAST, MOST);
        self.state = GoalState::Seeking;
        self.forget();
    }

    fn forget(&mut self) {
        self.tiles.fill(None);
        self.known = 0;
    }
}

/// A bracketed secant search on the logarithm of the time. After it has met the goal it rests until times stay away
/// from the goal.
#[derive(Debug)]
struct TimeSearch {
    /// The target in milliseconds.
    target: f64,
    effort: f32,
    state: GoalState,
    /// The newest times at this effort, in milliseconds.
    times: Vec<f64>,
    /// The greatest known effort within the target, with its time; `slow` is the least known effort that exceeds it.
    fast: Option<(f32, f64)>,
    slow: Option<(f32, f64)>,
}

impl TimeSearch {
    /// The share of the target that the search aims at.
    const AIM: f64 = 0.95;
    /// The search rests if the time is within these shares of the target.
    const CLOSE: std::ops::RangeInclusive<f64> = 0.9..=1.0;
    /// At rest, the effort does not move while the time is within these shares.
    const HOLD: std::ops::RangeInclusive<f64> = 0.85..=1.04;
    /// The number of times to judge from when the search is close; `MANY` when it is at rest.
    const FEW: usize = 3;
    const MANY: usize = 9;

    fn new(target: f32, effort: f32) -> Self {
        let target = f64::from(target);
        Self { target, effort, state: GoalState::Seeking, times: Vec::new(), fast: None, slow: None }
    }

    fn learn(&mut self, milliseconds: Option<f64>) {
        let Some(time) = milliseconds.filter(|&t| t > 0.0) else {
            self.state = GoalState::Missed;
            return;
        };
        if self.times.len() == Self::MANY {
            self.times.remove(0);
        }
        self.times.push(time);
        let median = median(&self.times);
        let share = median / self.target;
        let enough = match self.state {
            GoalState::Met | GoalState::Missed => Self::MANY,
            // Two times suffice if both are far off; a single one may be an outlier.
            GoalState::Seeking if self.times.iter().all(|t| (t / self.target / Self::AIM).log2().abs() > 0.4) => 2,
            GoalState::Seeking => Self::FEW,
        };
        if self.times.len() < enough {
            return;
        }
        match self.state {
            GoalState::Seeking => self.seek(median),
            GoalState::Met if Self::HOLD.contains(&share) || (self.effort >= MOST && share <= 1.0) => {}
            GoalState::Missed if share > 1.0 => {}
            // The scene has changed.
            GoalState::Met | GoalState::Missed => {
                (self.fast, self.slow) = (None, None);
                self.seek(median);
            }
        }
    }

    fn seek(&mut self, time: f64) {
        let share = time / self.target;
        if share <= 1.0 {
            self.fast = Some((self.effort, time));
        } else {
            self.slow = Some((self.effort, time));
        }
        if let (Some(fast), Some(slow)) = (self.fast, self.slow)
            && fast.0 >= slow.0
        {
            // The two contradict each other, so the older one is dropped.
            if share <= 1.0 { self.slow = None } else { self.fast = None }
        }
        if Self::CLOSE.contains(&share) || (self.effort >= MOST && share <= 1.0) {
            self.state = GoalState::Met;
            return;
        }
        if self.effort <= LEAST && share > 1.0 {
            self.state = GoalState::Missed;
            return;
        }
        let aim = self.target * Self::AIM;
        let next = match (self.fast, self.slow) {
            (Some(fast), Some(slow)) if slow.0 - fast.0 <= NEAR => {
                // The time jumps between two neighbouring efforts; the faster one is kept.
                self.move_to(fast.0);
                self.state = GoalState::Met;
                return;
            }
            (Some(fast), Some(slow)) => {
                let at = (aim / fast.1).log2() / (slow.1 / fast.1).log2();
                fast.0 + (slow.0 - fast.0) * (at as f32).clamp(0.1, 0.9)
            }
            _ => self.effort - (1.2 * (time / aim).log2() as f32).clamp(-2.0, 2.0),
        };
        self.move_to(next);
    }

    fn move_to(&mut self, effort: f32) {
        self.effort = effort.clamp(LEAST, MOST);
        self.state = GoalState::Seeking;
        self.times.clear();
    }
}

/// The median of at least one time; of an even number the lesser middle one, since disturbances only lengthen times.
fn median(times: &[f64]) -> f64 {
    let mut sorted = [0.0; TimeSearch::MANY];
    let sorted = &mut sorted[..times.len().min(TimeSearch::MANY)];
    sorted.copy_from_slice(&times[..sorted.len()]);
    sorted.sort_by(f64::total_cmp);
    sorted.get((sorted.len() - 1) / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [480, 270];

    /// A synthetic scene, which gives the squared error of a tile and the time of a frame at an effort.
    struct Plant {
        scale: f64,
        fixed: f64,
        noise: f64,
        /// The number of frames between a frame and its measurement.
        latency: usize,
    }

    impl Plant {
        const NEW: Self = Self { scale: 1.0, fixed: 20.0, noise: 0.0, latency: 0 };

        /// One tile in five has edges; from effort 6 on every sample is shaded.
        fn squared(&self, tile: usize, effort: f32) -> f32 {
            let steep = if tile.is_multiple_of(5) { 1e-2 * ((tile * 37 % 101) as f64) / 50.0 } else { 1e-4 };
            let k = (4.0 * f64::from(effort).exp2()).clamp(1.0, 16.0);
            (self.scale * 64.0 * steep * (1.0 / k - 1.0 / 16.0)) as f32
        }

        fn rms(&self, effort: f32) -> f64 {
            let tiles = SIZE.map(|side| side.div_ceil(TILE)).iter().product::<u32>() as usize;
            let sum: f64 = (0..tiles).map(|t| f64::from(self.squared(t, effort))).sum();
            (sum / f64::from(SIZE[0] * SIZE[1])).sqrt()
        }

        fn time(&self, effort: f32, frame: usize) -> f64 {
            let k = (4.0 * f64::from(effort).exp2()).clamp(0.0, 16.0);
            let wave = ((frame * 7919 % 97) as f64 / 48.0 - 1.0) * self.noise;
            (self.fixed + 10.0 * k) * (1.0 + wave)
        }

        /// Runs a number of frames and returns their efforts.
        fn run(&self, controller: &mut Controller, goal: Goal, frames: usize) -> Vec<f32> {
            let (mut efforts, mut steps) = (Vec::new(), Vec::new());
            for frame in 0..frames {
                controller.follow(&Settings { goal: Some(goal), ..Default::default() }, SIZE, true);
                efforts.push(controller.effort().unwrap());
                steps.push(controller.step());
                let Some(seen) = frame.checked_sub(self.latency) else { continue };
                let effort = efforts[seen];
                let audited = Audited { step: steps[seen], ..Audited::of(seen as u64, SIZE) };
                let both = |t| [self.squared(t, effort), self.squared(t, effort - steps[seen])];
                let errors: Vec<_> = audited.tiles(SIZE).map(|t| t.map_or([-1.0; 2], both)).collect();
                let milliseconds = Some(self.time(effort, seen));
                controller.learn(&Measured { effort, milliseconds, audits: Some((audited, &errors)) });
            }
            efforts
        }
    }

    fn state(controller: &Controller) -> GoalState {
        controller.progress(0.0).unwrap().state
    }

    #[test]
    fn an_error_is_kept_from_the_first_frame_and_with_few_samples() {
        for latency in [0, 3] {
            for target in [0.004f32, 0.006, 0.012] {
                let plant = Plant { latency, ..Plant::NEW };
                let mut controller = Controller::default();
                let efforts = plant.run(&mut controller, Goal::Error(target), 1500);
                let worst = efforts.iter().map(|&e| plant.rms(e)).fold(0.0, f64::max);
                assert!(worst <= 1.1 * f64::from(target), "{target}: {worst}");
                let end = plant.rms(*efforts.last().unwrap());
                assert!(end >= 0.9 * f64::from(target), "{target}: stops at {end}, more samples than needed");
                assert!(efforts[1000..].windows(2).all(|w| w[0] == w[1]), "{target}: still moving");
                assert_eq!(state(&controller), GoalState::Met);
                let progress = controller.progress(0.0).unwrap();
                assert_eq!(progress.audited, 1.0);
                assert!((f64::from(progress.error.unwrap()) / end - 1.0).abs() < 1e-3, "{progress:?} {end}");
            }
        }
    }

    #[test]
    fn an_error_that_grows_is_followed() {
        let mut controller = Controller::default();
        Plant::NEW.run(&mut controller, Goal::Error(0.006), 800);
        let worse = Plant { scale: 6.0, ..Plant::NEW };
        let efforts = worse.run(&mut controller, Goal::Error(0.006), 800);
        assert!(worse.rms(efforts[0]) > 0.007 && worse.rms(*efforts.last().unwrap()) <= 0.006);
    }

    #[test]
    fn no_error_at_all_is_missed_or_met_at_the_end() {
        let mut controller = Controller::default();
        let efforts = Plant::NEW.run(&mut controller, Goal::Error(0.0), 100);
        assert!(efforts.iter().all(|&e| Plant::NEW.rms(e) == 0.0));
        assert_eq!(state(&controller), GoalState::Met);
        // An error that no effort removes.
        let mut search = ErrorSearch::new(0.001, [8, 8]);
        search.learn(Audited::of(0, [8, 8]), &[[64.0; 2]]);
        assert_eq!((search.state, search.effort), (GoalState::Missed, MOST));
    }

    #[test]
    fn a_time_settles_in_thirty_frames_and_rests() {
        for latency in [0, 3] {
            for (start, target) in [(0.0, 60.0f32), (0.0, 25.0), (0.0, 150.0), (5.0, 40.0), (-9.0, 100.0)] {
                for noise in [0.0, 0.03] {
                    let plant = Plant { noise, latency, ..Plant::NEW };
                    let mut controller =
                        Controller { search: Search::Time(TimeSearch::new(1.0, start)), ..Default::default() };
                    let frames = if latency == 0 { 30 } else { 60 };
                    let efforts = plant.run(&mut controller, Goal::Time(target), frames + 100);
                    let what = format!("{start} {target} {latency} {noise}");
                    let settled = Plant::NEW.time(efforts[frames], 0) / f64::from(target);
                    assert!((0.9..=1.0 + noise).contains(&settled), "{what}: {settled}");
                    assert!(efforts[frames..].windows(2).all(|w| w[0] == w[1]), "{what}: oscillates");
                    assert_eq!(state(&controller), GoalState::Met, "{what}");
                }
            }
        }
    }

    /// Every tenth frame takes three times as long.
    #[test]
    fn hiccups_do_not_move_a_time() {
        for offset in 0..10 {
            let mut search = TimeSearch::new(45.0, 0.0);
            let mut efforts = Vec::new();
            for frame in 0..120 {
                let hiccup = if (frame + offset) % 10 == 0 { 3.0 } else { 1.0 };
                search.learn(Some(Plant::NEW.time(search.effort, 0) * hiccup));
                efforts.push(search.effort);
            }
            let least = efforts.iter().copied().fold(0.0, f32::min);
            assert!(Plant::NEW.time(least, 0) > 0.85 * 45.0, "{offset}: {efforts:?}");
            assert!(efforts[30..].windows(2).all(|w| w[0] == w[1]), "{offset}: {efforts:?}");
        }
    }

    #[test]
    fn a_time_out_of_reach_is_missed_and_one_without_end_is_met() {
        let mut controller = Controller::default();
        let efforts = Plant::NEW.run(&mut controller, Goal::Time(10.0), 60);
        assert_eq!((state(&controller), *efforts.last().unwrap()), (GoalState::Missed, LEAST));
        // The scene becomes cheaper.
        let cheap = Plant { fixed: 2.0, ..Plant::NEW };
        let efforts = cheap.run(&mut controller, Goal::Time(10.0), 60);
        assert!(
            state(&controller) == GoalState::Met && (9.0..=10.0).contains(&cheap.time(*efforts.last().unwrap(), 0))
        );
        let mut controller = Controller::default();
        let efforts = Plant::NEW.run(&mut controller, Goal::Time(1e4), 60);
        assert_eq!((state(&controller), *efforts.last().unwrap()), (GoalState::Met, MOST));
        let mut controller = Controller::default();
        controller.follow(&Settings { goal: Some(Goal::Time(10.0)), ..Default::default() }, SIZE, true);
        controller.learn(&Measured { effort: 0.0, milliseconds: None, audits: None });
        assert_eq!(state(&controller), GoalState::Missed);
    }
}
