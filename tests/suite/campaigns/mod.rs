//! Random campaigns: cases that no one thought of, each made from a seed. The suite runs few of each, the same every
//! time; `./x soak` runs new ones for as long as it is told.

mod frames;
mod gbuffers;
mod loader;
mod models;
mod random;
mod rays;
mod settings;
mod windows;
pub mod words;

use std::env;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// The variable that holds the seed of a single case, to see it fail again.
const SEED: &str = "DEFERRED_AA_SEED";
/// The variable that holds the minutes of a soak.
const MINUTES: &str = "DEFERRED_AA_SOAK";

/// A kind of random case.
struct Campaign {
    /// The name of the campaign and of its test.
    name: &'static str,
    /// The share of a soak's time.
    share: f64,
    /// The number of seeds that the suite runs.
    few: u32,
    /// What a case may take before it counts as hung.
    limit: Duration,
    /// Makes what all cases share, and what runs the case of a seed and returns how many things it checked.
    start: fn() -> Box<dyn FnMut(u32) -> u64>,
}

const CAMPAIGNS: [&Campaign; 5] =
    [&windows::CAMPAIGN, &frames::CAMPAIGN, &rays::CAMPAIGN, &gbuffers::CAMPAIGN, &loader::CAMPAIGN];

/// What a campaign has done.
struct Outcome {
    cases: u64,
    took: Duration,
    slowest: Duration,
}

impl Campaign {
    /// The cases of the suite, or the one of [`SEED`].
    fn run(&self) -> Outcome {
        match env::var(SEED) {
            Ok(seed) => self.run_seeds([seed.parse().expect("a seed is a number")]),
            Err(_) => self.run_seeds(1..=self.few),
        }
    }

    /// Cases of new seeds until the time is up.
    fn run_for(&self, time: Duration) -> Outcome {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).expect("a time after 1970");
        let first = now.as_secs() as u32;
        eprintln!("{}: {:.0} s of seeds from {first}", self.name, time.as_secs_f64());
        let end = Instant::now() + time;
        self.run_seeds((0..).map(|i| first.wrapping_add(i)).take_while(|_| Instant::now() < end))
    }

    fn run_seeds(&self, seeds: impl IntoIterator<Item = u32>) -> Outcome {
        let watch = Watch::start(self);
        let start = Instant::now();
        let mut case = (self.start)();
        let mut outcome = Outcome { cases: 0, took: Duration::ZERO, slowest: Duration::ZERO };
        for seed in seeds {
            let _named = Named { campaign: self.name, seed };
            watch.begins(seed);
            let begun = Instant::now();
            outcome.cases += case(seed);
            outcome.slowest = outcome.slowest.max(begun.elapsed());
        }
        outcome.took = start.elapsed();
        outcome
    }
}

/// Prints how to run a case again if it panics.
struct Named {
    campaign: &'static str,
    seed: u32,
}

impl Named {
    fn command(&self) -> String {
        let soak = if is_soak() { format!("{MINUTES}=1 ") } else { String::new() };
        format!("{soak}{SEED}={} cargo test --test suite campaigns::{}", self.seed, self.campaign)
    }
}

impl Drop for Named {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("to see this again: {}", self.command());
        }
    }
}

/// Ends the process when a case hangs: nothing else could.
struct Watch(std::sync::mpsc::Sender<u32>);

impl Watch {
    fn start(campaign: &Campaign) -> Self {
        let (sender, begun) = channel();
        let (campaign, limit) = (campaign.name, campaign.limit);
        std::thread::spawn(move || {
            // What all cases share may take its time.
            let Ok(mut seed) = begun.recv() else { return };
            loop {
                match begun.recv_timeout(limit) {
                    Ok(next) => seed = next,
                    Err(RecvTimeoutError::Disconnected) => return,
                    Err(RecvTimeoutError::Timeout) => {
                        let named = Named { campaign, seed };
                        eprintln!("{campaign} hangs for {limit:?}; to see this again: {}", named.command());
                        std::process::abort();
                    }
                }
            }
        });
        Self(sender)
    }

    fn begins(&self, seed: u32) {
        self.0.send(seed).expect("the watch waits");
    }
}

/// The resident memory of the process in bytes; `None` where the system does not say.
fn resident() -> Option<u64> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split_whitespace().nth(1)?.parse::<u64>().ok()? * 4096)
}

/// Whether a campaign has the process for itself, so that its memory can be told.
fn is_soak() -> bool {
    env::var(MINUTES).is_ok()
}

#[test]
fn windows() {
    windows::CAMPAIGN.run();
}

#[test]
fn frames() {
    frames::CAMPAIGN.run();
}

#[test]
fn rays() {
    rays::CAMPAIGN.run();
}

#[test]
fn gbuffers() {
    gbuffers::CAMPAIGN.run();
}

#[test]
fn loader() {
    loader::CAMPAIGN.run();
}

/// All campaigns, one after another, and a table of what they did.
#[test]
#[ignore = "takes as long as DEFERRED_AA_SOAK says, in minutes: ./x soak"]
fn soak() {
    let minutes: f64 = env::var(MINUTES).map_or(10.0, |minutes| minutes.parse().expect("a number of minutes"));
    let all: f64 = CAMPAIGNS.iter().map(|campaign| campaign.share).sum();
    let outcomes = CAMPAIGNS.map(|campaign| {
        let time = Duration::from_secs_f64(minutes * 60.0 * campaign.share / all);
        catch_unwind(AssertUnwindSafe(|| campaign.run_for(time))).ok()
    });
    println!("\n{:<10} {:>10} {:>8} {:>10}  result", "campaign", "cases", "seconds", "slowest");
    for (campaign, outcome) in CAMPAIGNS.iter().zip(&outcomes) {
        match outcome {
            Some(Outcome { cases, took, slowest }) => {
                let [took, slowest] = [took, slowest].map(Duration::as_secs_f64);
                println!("{:<10} {cases:>10} {took:>8.0} {slowest:>8.3} s  passed", campaign.name);
            }
            None => println!("{:<10} {:>10} {:>8} {:>10}  FAILED, see above", campaign.name, "", "", ""),
        }
    }
    assert!(outcomes.iter().all(Option::is_some), "a campaign failed");
}
