//! How few samples could have done: the oracles at each m, and how far above them the entries lie.

use super::truth::fits;
use crate::host::raster::node_camera;
use crate::measure::oracle::{Bound, Groups, Windows, exact_coverage};
use crate::measure::reference;
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::schema::{Entry, EntryOracle, EqualError, Oracle};
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

/// What an entry is held against the bounds by.
#[derive(Debug)]
struct Measured {
    id: String,
    technique: Technique,
    /// Against the grid.
    error: Option<f64>,
    /// Samples, or lights, over n · w · h.
    ratio: f64,
}

/// The bounds at one m, which are also set in its entries of Windowed and Surfaces. `None` where m = 1, which has
/// nothing to choose, and where a picture of single samples does not fit the device.
pub fn bounds(session: &Session, m: u32, entries: &mut [Entry]) -> Result<Option<Oracle>, ReportError> {
    let (width, height) = (session.request.width * m, session.request.height * m);
    if m == 1 || !fits(session, 1, (width, height)) {
        return Ok(None);
    }
    let bounded = [Technique::Windowed, Technique::Surfaces];
    let ours = |e: &&mut Entry| e.stats.m == m && bounded.contains(&e.stats.settings.technique);
    let mut ours: Vec<_> = entries.iter_mut().filter(ours).collect();
    ours.sort_by(|a, b| a.id.cmp(&b.id));
    let measured = |e: &&mut Entry| Measured {
        id: e.id.clone(),
        technique: e.stats.settings.technique,
        error: e.grid_error(),
        ratio: e.stats.samples.ratio,
    };
    let measured: Vec<_> = ours.iter().map(measured).collect();
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

/// From a picture of m = 1 whose pixels are the samples.
fn compute(
    session: &Session,
    m: u32,
    (width, height): (u32, u32),
    measured: &[Measured],
) -> Result<Bounds, ReportError> {
    let mut host = session.host_of(session.scene.clone(), 1, (width, height))?;
    // The stall changes no colour.
    host.set_stall(1);
    session.frame(&mut host, reference::grid(Settings::default()))?;
    let camera = node_camera(&session.view, width, height);
    let windows = Windows::new(&host.picture(), m)?;
    let lit_in_groups = |e: &Measured| e.technique == Technique::Surfaces;
    let groups = measured.iter().any(lit_in_groups).then(|| Groups::new(&host, &camera, m)).transpose()?;
    let coverage = exact_coverage(&host, &camera, m)?;
    let entry = |e: &Measured| {
        let over = |b: Bound| EqualError { ratio: b.ratio, achieved_over_oracle: e.ratio / b.ratio };
        let mean_of_k = e.error.and_then(|error| windows.neyman(error)).map(over);
        let of_groups = groups.as_ref().filter(|_| lit_in_groups(e));
        let groups = of_groups.and_then(|groups| groups.at(e.error?)).map(over);
        (e.id.clone(), EntryOracle { mean_of_k, groups, exact_coverage: Some(coverage) })
    };
    let oracle = Oracle {
        m,
        curve: windows.curve(POINTS),
        groups: groups.as_ref().map_or(Vec::new(), |groups| groups.curve(POINTS)),
        exact_coverage: Some(coverage),
    };
    Ok(Bounds { oracle, entries: measured.iter().map(entry).collect() })
}
