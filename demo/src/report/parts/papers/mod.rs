//! Tables that the papers print of their techniques, and the same rows measured on this scene beside them.
//!
//! A paper is a module that gives its tables as rows of settings, with what it prints for each; all rows of all tables
//! are measured in one run, those with times in turn.

mod curves;
mod focus;
mod jin;
mod thesis;

use super::truth::fits;
use crate::host::{Host, Shot};
use crate::measure::quality;
use crate::measure::reference;
use crate::measure::stats::{Spread, times};
use crate::pass_kind::{PARTS, part};
use crate::picture::Picture;
use crate::report::folder::Kind;
use crate::report::schema::papers::{Papers, Planned, Row, Table};
use crate::report::session::Session;
use crate::report::{ReportError, plan};
use curves::{first_curve, same_psnr};
use deferred_aa::{ObjectImportance, Settings};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// Whether a report of these techniques has tables of papers.
pub fn any(techniques: &[&str]) -> bool {
    !tables(Settings::default(), None, techniques).is_empty()
}

/// The tables of the papers whose techniques are asked for. `focus` says in words what the focused rows are focused on;
/// without it there are none.
fn tables(base: Settings, focus: Option<&str>, techniques: &[&str]) -> Vec<Table<Planned>> {
    let wanted = |names: [&str; 2]| names.iter().all(|name| techniques.contains(name));
    let mut all = Vec::new();
    if wanted(["full", "selective"]) {
        all.extend([jin::table_2(base, focus), jin::figure_7(base), jin::our_figure_7(base)]);
    }
    if wanted(["single", "multiresolution"]) {
        all.push(thesis::table_5_1(base));
    }
    all
}

/// Measures them at the report's size, as the truth has it. `None` where the rows' G-buffers do not fit the device.
pub fn papers(session: &Session, truth: &Picture) -> Result<Option<Papers>, ReportError> {
    let request = &session.request;
    let base = Settings { goal: None, ..request.base };
    let size = (request.width, request.height);
    let tables = |focus: Option<&str>| {
        let mut all = tables(base, focus, &request.techniques);
        for row in all.iter_mut().flat_map(|t| &mut t.rows) {
            row.settings = plan::fitting(row.settings, size);
        }
        all
    };
    let planned = tables(Some(""));
    let depends = (&planned, &request.focus, request.frames, request.stall, request.quick);
    let fingerprint = session.fingerprint.with(&("papers", depends)).hex();
    if let Some(papers) = session.folder.finished(Kind::Part, "papers", &fingerprint) {
        return Ok(Some(papers));
    }
    let ms: BTreeSet<_> = planned.iter().flat_map(|t| &t.rows).map(|r| r.m).collect();
    if !ms.iter().all(|&m| fits(session, m, size)) {
        session.note("the papers' tables are left out: their G-buffers do not fit; choose a smaller --size");
        return Ok(None);
    }
    let focuses = planned.iter().flat_map(|t| &t.rows).any(|r| r.settings.selective.focused);
    let focus =
        if focuses && request.focus.is_empty() { focus::in_the_middle(session)? } else { request.focus.clone() };
    let mut stage = Stage { session, truth, focus: &focus, hosts: BTreeMap::new() };
    let mut measured = Vec::new();
    for table in tables(focus::in_words(&session.scene, &focus).as_deref()) {
        let mut over = table.sparse.then_some(None);
        measured.push(table.try_map(|planned| stage.first(planned, &mut over))?);
    }
    for _ in 0..request.frames {
        for row in measured.iter_mut().filter(|t| t.timed).flat_map(|t| &mut t.rows) {
            let (_, host) = stage.host(row.planned.m)?;
            row.shots.push(session.frame(host, row.planned.settings)?);
        }
    }
    let papers = Papers { tables: measured.into_iter().map(finish).collect() };
    session.folder.keep(Kind::Part, "papers", &fingerprint, &papers)?;
    Ok(Some(papers))
}

/// A row whose picture was compared.
struct Measured {
    planned: Planned,
    mean_k: f64,
    truth_db: f64,
    grid_db: Option<f64>,
    over_db: Option<f64>,
    shots: Vec<Shot>,
}

/// The hosts of all m, side by side, as rows of all of them take turns.
struct Stage<'a> {
    session: &'a Session,
    truth: &'a Picture,
    focus: &'a [u16],
    hosts: BTreeMap<u32, (Picture, Host)>,
}

impl Stage<'_> {
    /// All samples of the grid of this m, and the host.
    fn host(&mut self, m: u32) -> Result<&mut (Picture, Host), ReportError> {
        match self.hosts.entry(m) {
            Entry::Occupied(there) => Ok(there.into_mut()),
            Entry::Vacant(place) => {
                let mut host = self.session.host(m)?;
                let important = |&object: &u16| ObjectImportance { object: object.into(), importance: 1.0 };
                host.importance = self.focus.iter().map(important).collect();
                self.session.frame(&mut host, reference::grid(self.session.request.base))?;
                Ok(place.insert((host.picture(), host)))
            }
        }
    }

    /// The frame that warms a row up, which is its picture too. The first one of a sparse table is kept in `over`.
    fn first(&mut self, planned: Planned, over: &mut Option<Option<Picture>>) -> Result<Measured, ReportError> {
        let (session, truth) = (self.session, self.truth);
        let (grid, host) = self.host(planned.m)?;
        let shot = session.frame(host, planned.settings)?;
        let picture = host.picture();
        let grid_db = (planned.m > 1).then(|| quality::psnr(&picture, grid)).transpose()?;
        let truth_db = quality::psnr(&picture, truth)?;
        let over_db = match over {
            Some(over) => Some(quality::psnr(&picture, over.get_or_insert_with(|| picture.clone()))?),
            None => None,
        };
        Ok(Measured { planned, mean_k: shot.statistics.mean_k, truth_db, grid_db, over_db, shots: Vec::new() })
    }
}

fn finish(table: Table<Measured>) -> Table<Row> {
    let rows = &table.rows;
    let over = rows.iter().find(|r| r.planned.id == table.over);
    let curve = first_curve(rows.iter().map(|r| (r.planned.series.as_deref(), r.truth_db, r.mean_k)));
    let rows = rows.iter().map(|row| {
        let speed = |pass: &str| {
            let ratios = over?.shots.iter().zip(&row.shots).filter_map(|(a, b)| Some(of(a, pass)? / of(b, pass)?));
            Spread::of(ratios.collect()).map(|s| s.median)
        };
        Row {
            planned: row.planned.clone(),
            mean_k: row.mean_k,
            samples: over.map(|o| row.mean_k / o.mean_k),
            truth_db: row.truth_db,
            grid_db: row.grid_db,
            over_db: row.over_db,
            time_ms: times(&row.shots),
            parts_ms: if table.sparse { parts(&row.shots) } else { BTreeMap::new() },
            speed: speed("total"),
            node_speed: speed("node"),
            same_psnr: same_psnr(&curve, row.planned.series.as_deref(), row.truth_db, row.mean_k),
        }
    });
    let rows = rows.collect();
    let Table { id, title, note, over, timed, sparse, .. } = table;
    Table { id, title, note, over, timed, sparse, rows }
}

/// The node's passes by what they are for, each of [`PARTS`]. Empty without timestamps.
fn parts(shots: &[Shot]) -> BTreeMap<String, Spread> {
    let frame = |shot: &Shot| {
        let mut sums = PARTS.map(|name| (name, 0.0));
        for pass in &shot.statistics.passes {
            let sum = sums.iter_mut().find(|(name, _)| *name == part(pass.kind))?;
            sum.1 += pass.milliseconds?;
        }
        Some(sums)
    };
    let frames: Vec<_> = shots.iter().filter_map(frame).collect();
    let spread = |i: usize| Spread::of(frames.iter().map(|sums| sums[i].1).collect());
    PARTS.iter().enumerate().filter_map(|(i, name)| Some(((*name).to_owned(), spread(i)?))).collect()
}

/// Milliseconds of a frame.
fn of(shot: &Shot, pass: &str) -> Option<f64> {
    times(std::slice::from_ref(shot)).get(pass).map(|s| s.median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_sound_and_its_table_has_what_it_is_over() {
        let tables = tables(Settings::default(), Some("the door"), &plan::TECHNIQUES);
        for table in &tables {
            let ids: BTreeSet<_> = table.rows.iter().map(|r| &r.id).collect();
            assert_eq!(ids.len(), table.rows.len(), "{ids:?}");
            assert!(ids.contains(&table.over), "{ids:?}");
            assert!(!table.sparse || table.rows[0].id == table.over, "{ids:?}");
            table.rows.iter().for_each(|r| r.settings.validate().unwrap());
        }
        let ids: BTreeSet<_> = tables.iter().map(|t| &t.id).collect();
        assert_eq!(ids.len(), tables.len());
    }

    #[test]
    fn without_a_focus_no_row_is_focused() {
        let focused = |focus| {
            let tables = tables(Settings::default(), focus, &plan::TECHNIQUES);
            tables.iter().flat_map(|t| &t.rows).filter(|r| r.settings.selective.focused).count()
        };
        assert_eq!((focused(Some("the door")), focused(None)), (1, 0));
    }

    #[test]
    fn papers_come_with_their_techniques() {
        assert!(any(&["full", "selective"]) && any(&["single", "multiresolution"]));
        assert!(!any(&["single", "selective"]) && !any(&["full", "multiresolution"]));
    }
}
