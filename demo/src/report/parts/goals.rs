//! Settings given as goals: what the search settles on, and how soon.

use super::cost::at_most;
use crate::measure::goal::seek;
use crate::measure::quality;
use crate::measure::reference;
use crate::measure::stats::times;
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::schema::GoalRow;
use crate::report::session::Session;
use deferred_aa::{Goal, GoalState, Settings, Technique};

/// Errors to keep to: 34 and 46 dB.
const ERRORS: [f32; 2] = [0.02, 0.005];
/// Frames whose median time counts at the end.
const MEASURED: usize = 5;

/// Two errors, and a time half way between Single's and Full's, from the request's settings at this m. On a software
/// driver at a smaller size, as each search takes dozens of frames.
pub fn goals(session: &Session, m: u32) -> Result<Vec<GoalRow>, ReportError> {
    let size = at_most(session, if session.software() { 1 << 15 } else { u64::MAX });
    let windowed = Settings { technique: Technique::Windowed, ..session.request.base };
    let fingerprint = session.fingerprint.with(&("goals", m, size, session.request.stall, windowed)).hex();
    if let Some(rows) = session.folder.finished(Kind::Part, "goals", &fingerprint) {
        return Ok(rows);
    }
    let mut host = session.host_of(session.scene.clone(), m, size)?;
    let mut node = |settings| -> Result<Option<f64>, ReportError> {
        let shots = (0..=MEASURED).map(|_| session.frame(&mut host, settings)).collect::<Result<Vec<_>, _>>()?;
        Ok(times(&shots[1..]).get("node").map(|s| s.median))
    };
    let single = node(Settings { technique: Technique::Single, ..windowed })?;
    let full = node(reference::grid(windowed))?;
    let reference = host.picture();

    let mut rows = Vec::new();
    let time = single.zip(full).map(|(single, full)| Goal::Time((single * full).sqrt() as f32));
    for goal in ERRORS.map(Goal::Error).into_iter().chain(time) {
        let settings = Settings { goal: Some(goal), ..windowed };
        let (frames, end) = seek(|| session.frame(&mut host, settings))?;
        let shots = (0..MEASURED).map(|_| session.frame(&mut host, settings)).collect::<Result<Vec<_>, _>>()?;
        let met = end.is_some_and(|p| p.state == GoalState::Met);
        let (name, target, unit, achieved) = match goal {
            Goal::Error(error) => {
                let db = quality::psnr(&host.picture(), &reference)?;
                let rmse = if db >= quality::IDENTICAL_DB { 0.0 } else { 10f64.powf(-db / 20.0) };
                ("error", error, "rmse", Some(rmse))
            }
            Goal::Time(ms) => ("time", ms, "ms", times(&shots).get("node").map(|s| s.median)),
        };
        let Some(achieved) = achieved else { continue };
        let goal = format!("{name}={target}");
        rows.push(GoalRow { goal, target: f64::from(target), unit: unit.to_owned(), achieved, met, frames });
    }
    session.folder.keep(Kind::Part, "goals", &fingerprint, &rows)?;
    Ok(rows)
}
