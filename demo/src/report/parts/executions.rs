//! One image, its samples run in each way that there is.

use crate::host::HostError;
use crate::measure::reference;
use crate::measure::stats::{SHADE, Spread, Stats};
use crate::picture::Picture;
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::schema::executions::ExecutionRow;
use crate::report::session::Session;
use deferred_aa::{Execution, RecordError, Settings, Technique};

/// Windowed with the request's settings at this m, by every execution, and Full among them for β. One whose lists do
/// not fit the device is left out.
pub fn executions(session: &Session, m: u32) -> Result<Vec<ExecutionRow>, ReportError> {
    let request = &session.request;
    let settings = Settings { technique: Technique::Windowed, ..request.base };
    let mut all: Vec<_> = Execution::ALL.iter().map(|&execution| Settings { execution, ..settings }).collect();
    let fingerprint = session.fingerprint.with(&("executions", m, request.stall, request.frames, &all)).hex();
    if let Some(rows) = session.folder.finished(Kind::Part, "executions", &fingerprint) {
        return Ok(rows);
    }
    let mut host = session.host(m)?;
    let mut pictures = Vec::new();
    let mut left_out = Vec::new();
    for &settings in &all {
        match session.frame(&mut host, settings) {
            Ok(_) => pictures.push(host.picture()),
            Err(ReportError::Host(HostError::Record(e @ RecordError::List { .. }))) => {
                session.note(&e.to_string());
                left_out.push(settings);
            }
            Err(e) => return Err(e),
        }
    }
    all.retain(|settings| !left_out.contains(settings));
    let full = reference::grid(request.base);
    session.frame(&mut host, full)?;
    let (mut shots, mut full_shots) = (vec![Vec::new(); all.len()], Vec::new());
    for _ in 0..request.frames {
        for (&settings, shots) in all.iter().zip(&mut shots) {
            shots.push(session.frame(&mut host, settings)?);
        }
        full_shots.push(session.frame(&mut host, full)?);
    }
    let full = Stats::new(&host, full, &full_shots, None);
    let pixels = u64::from(request.width) * u64::from(request.height);
    let nodes: Vec<Vec<Option<f64>>> = shots.iter().map(|s| s.iter().map(node_ms).collect()).collect();
    let mut rows = Vec::new();
    for (i, (&settings, shots)) in all.iter().zip(&shots).enumerate() {
        let Some(stats) = Stats::new(&host, settings, shots, None) else { continue };
        let ratios = nodes[i].iter().zip(&nodes[0]).filter_map(|(a, b)| Some(a.as_ref()? / b.as_ref()?));
        rows.push(ExecutionRow {
            execution: settings.execution,
            m,
            stall: request.stall,
            samples_ratio: stats.samples.ratio,
            node_ms: stats.time_ms.get("node").copied(),
            shade_ms: stats.time_ms.get(SHADE).copied(),
            beta: full.as_ref().and_then(|full| stats.beta(full, pixels)),
            relative_to_loop: Spread::of(ratios.collect()).map(|s| s.median),
            max_difference: difference(&pictures[i], &pictures[0]),
        });
    }
    session.folder.keep(Kind::Part, "executions", &fingerprint, &rows)?;
    Ok(rows)
}

fn node_ms(shot: &crate::host::Shot) -> Option<f64> {
    shot.statistics.passes.iter().map(|p| p.milliseconds).sum()
}

/// Greatest difference of any channel as shown.
fn difference(a: &Picture, b: &Picture) -> f64 {
    let (a, b) = (a.to_srgb8(), b.to_srgb8());
    let most = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a.abs_diff(*b)).max();
    f64::from(most.unwrap_or(0)) / 255.0
}
