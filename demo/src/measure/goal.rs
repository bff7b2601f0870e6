//! Goals: read from the command line, and rendered until the search rests.

use crate::host::Shot;
use deferred_aa::{Goal, GoalProgress, GoalState};

/// error=E or time=MS.
pub fn parse(text: &str) -> Result<Goal, String> {
    let cure = || format!("'{text}' is no goal: write error=0.01 or time=8");
    let (kind, value) = text.split_once('=').ok_or_else(cure)?;
    let value = value.parse().map_err(|_| cure())?;
    match kind {
        "error" => Ok(Goal::Error(value)),
        "time" => Ok(Goal::Time(value)),
        _ => Err(cure()),
    }
}

/// Most frames until a search rests.
const MOST_FRAMES: u32 = 200;
/// Frames without a change after which it does.
const REST: u32 = 40;

/// Renders frames until the goal's effort has not changed for some of them. Frames until the last change, and the end.
pub fn seek<E>(mut frame: impl FnMut() -> Result<Shot, E>) -> Result<(u32, Option<GoalProgress>), E> {
    let mut last: Option<GoalProgress> = None;
    let mut changed = 0;
    for i in 0..MOST_FRAMES {
        let progress = frame()?.statistics.goal;
        if progress.map(|p| p.effort) != last.map(|p| p.effort) {
            changed = i;
        }
        last = progress;
        let rests = last.is_some_and(|p| p.state != GoalState::Seeking);
        if rests && i - changed >= REST {
            break;
        }
    }
    Ok((changed, last))
}

/// In one line, how the search ended.
pub fn ended(goal: Goal, frames: u32, progress: Option<GoalProgress>) -> String {
    let Some(progress) = progress else { return "the goal has no statistics".to_owned() };
    let state = match progress.state {
        GoalState::Met => "is kept",
        GoalState::Missed => "can't be kept",
        GoalState::Seeking => "is not reached yet",
    };
    let (wanted, estimate) = match goal {
        Goal::Error(error) => {
            (format!("error {error}"), progress.error.map_or(String::new(), |e| format!(", measured {e:.5}")))
        }
        Goal::Time(milliseconds) => (format!("time {milliseconds} ms"), String::new()),
    };
    format!("goal {wanted} {state}{estimate}: effort {:.3} since frame {frames}", progress.effort)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_read() {
        assert_eq!(parse("error=0.01"), Ok(Goal::Error(0.01)));
        assert_eq!(parse("time=8"), Ok(Goal::Time(8.0)));
        for wrong in ["", "error", "error=", "fps=60", "time=8ms"] {
            assert!(parse(wrong).unwrap_err().contains("write error=0.01 or time=8"), "{wrong}");
        }
    }
}
