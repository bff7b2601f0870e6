//! How few samples could have done: the oracle at each m, and how far above it the entries lie.

use super::truth::fits;
use crate::host::raster::node_camera;
use crate::measure::oracle::{Windows, exact_coverage};
use crate::measure::reference;
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::schema::{Entry, EntryOracle, MeanOfK, Oracle};
use crate::report::session::Session;
use deferred_aa::{Settings, Technique};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Points of the curve.
const POINTS: usize = 32;

/// What one m has to say, as it is kept.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Bounds {
    oracle: Oracle,
    entries: BTreeMap<String, EntryOracle>,
}

/// The bounds at one m, which are also set in its entries of Windowed and Surfaces. `None` where m = 1, which has nothing to choose,
/// and where a picture of single samples does not fit the device.
pub fn bounds(session: &Session, m: u32, entries: &mut [Entry]) -> Result<Option<Oracle>, ReportError> {
    let (width, height) = (session.request.width * m, session.request.height * m);
    if m == 1 || !fits(session, 1, (width, height)) {
        return Ok(None);
    }
    let bounded = [Technique::Windowed, Technique::Surfaces];
    let ours = |e: &&mut Entry| e.stats.m == m && bounded.contains(&e.stats.settings.technique);
    let mut ours: Vec<_> = entries.iter_mut().filter(ours).collect();
    ours.sort_by(|a, b| a.id.cmp(&b.id));
    let measured: Vec<_> = ours.iter().map(|e| (e.id.clone(), e.grid_error(), e.stats.samples.ratio)).collect();
    let name = format!("oracle-m{m}");
    let fingerprint = session.fingerprint.with(&(&name, &measured)).hex();
    let bounds = match session.folder.finished(Kind::Part, &name, &fingerprint) {
        Some(bounds) => bounds,
        None => {
            let bounds = compute(session, m, (width, height), &measured)?;
            session.folder.keep(Kind::Part, &name, &fingerprint, &bounds)?;
            bounds
        }
    };
    for entry in &mut ours {
        entry.oracle = bounds.entries.get(&entry.id).cloned();
    }
    Ok(Some(bounds.oracle))
}

/// From a picture of m = 1 whose pixels are the samples. `measured`: ids with their error against the grid and ratio.
fn compute(
    session: &Session,
    m: u32,
    (width, height): (u32, u32),
    measured: &[(String, Option<f64>, f64)],
) -> Result<Bounds, ReportError> {
    let mut host = session.host_of(session.scene.clone(), 1, (width, height))?;
    // The stall changes no colour.
    host.set_stall(1);
    session.frame(&mut host, reference::grid(Settings::default()))?;
    let windows = Windows::new(&host.picture(), m)?;
    let coverage = exact_coverage(&host, &node_camera(&session.view, width, height), m)?;
    let entry = |&(ref id, error, ratio): &(String, Option<f64>, f64)| {
        let oracle = error.and_then(|e| windows.neyman(e));
        let mean_of_k = oracle.map(|o| MeanOfK { ratio: o.ratio, achieved_over_oracle: ratio / o.ratio });
        (id.clone(), EntryOracle { mean_of_k, exact_coverage: Some(coverage) })
    };
    let oracle = Oracle { m, curve: windows.curve(POINTS), exact_coverage: Some(coverage) };
    Ok(Bounds { oracle, entries: measured.iter().map(entry).collect() })
}
