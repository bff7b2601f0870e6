//! Tables that the papers print of their techniques, and the same rows measured on this scene beside them.
//!
//! A paper is a module that gives its tables as rows of settings, with what it prints for each; all rows of all tables are measured in
//! one run, those with times in turn.

mod jin;
mod thesis;

use super::folder::Kind;
use super::session::Session;
use super::truth::fits;
use super::{ReportError, plan};
use crate::host::{Host, Shot};
use crate::picture::Picture;
use crate::quality;
use crate::scene::Scene;
use crate::stats::{Spread, times};
use deferred_aa::{ObjectImportance, Settings, Technique};
use serde::{Deserialize, Serialize};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Papers {
    /// In the order of the papers.
    pub tables: Vec<Table<Row>>,
}

/// A table or figure of a paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table<R> {
    /// Unique: lower-case letters, digits and dashes.
    pub id: String,
    /// Paper and place in it.
    pub title: String,
    /// What the paper measured and what we do.
    pub note: String,
    /// The id of the row that samples and speeds are over.
    pub over: String,
    /// Its rows have times.
    pub timed: bool,
    /// No row is supersampled: they are held against the one that the table is over, which comes first, and their times
    /// are apart by what they are for.
    #[serde(default)]
    pub sparse: bool,
    /// In the paper's order.
    pub rows: Vec<R>,
}

/// A row before it is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// Unique in its table.
    pub id: String,
    /// For people.
    pub label: String,
    /// The curve that it is a point of, where its table has curves.
    pub series: Option<String>,
    /// Samples along one side of a window: rows of other m have a G-buffer of their own.
    pub m: u32,
    /// That are recorded.
    pub settings: Settings,
    /// What the paper prints, for each of its scenes; none for rows of our own.
    pub printed: Vec<Printed>,
}

/// A paper's own figures of a row on one of its scenes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Printed {
    /// As the paper calls it.
    pub scene: String,
    /// Against its truth.
    pub psnr_db: Option<f64>,
    /// Over those of the row that the table is over.
    pub samples: Option<f64>,
    /// Frames a second.
    pub fps: Option<f64>,
    /// Over the row that the table is over.
    pub speed: Option<f64>,
    /// Samples over those of the first curve at the same PSNR.
    pub same_psnr: Option<f64>,
}

/// A row, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What was measured.
    #[serde(flatten)]
    pub planned: Planned,
    /// Samples a pixel.
    pub mean_k: f64,
    /// Samples over those of the row that the table is over.
    pub samples: Option<f64>,
    /// PSNR against the truth.
    pub truth_db: f64,
    /// PSNR against all samples of the same grid; none at m = 1.
    pub grid_db: Option<f64>,
    /// PSNR against the row that the table is over; none where the table is not sparse.
    #[serde(default)]
    pub over_db: Option<f64>,
    /// By pass, `gbuffer`, `node` and `total` included; empty where the table has no times.
    pub time_ms: BTreeMap<String, Spread>,
    /// Of the node's passes by what they are for: [`PARTS`]; empty where the table is not sparse.
    #[serde(default)]
    pub parts_ms: BTreeMap<String, Spread>,
    /// Median over the rounds of the total of the row that the table is over, in the same round, over this row's.
    pub speed: Option<f64>,
    /// The same of the node's passes alone, without the G-buffer.
    pub node_speed: Option<f64>,
    /// Samples over those of the table's first curve at the same PSNR, between its points; none beyond them and for that curve.
    pub same_psnr: Option<f64>,
}

/// What a frame's passes are for: to cast rays, to decide what is sampled, to shade, and the rest.
pub const PARTS: [&str; 4] = ["rays", "decisions", "shading", "rest"];

/// The part of [`PARTS`] of a pass, by its name.
fn part(pass: &str) -> &'static str {
    match pass.split(' ').next() {
        Some("trace" | "bounce" | "classify") => "rays",
        Some("refine") => "decisions",
        Some("points" | "first" | "shade") => "shading",
        _ => "rest",
    }
}

/// Whether a report of these techniques has tables of papers.
pub fn any(techniques: &[&str]) -> bool {
    !tables(Settings::default(), None, techniques).is_empty()
}

/// The tables of the papers whose techniques are asked for. `focus` says in words what the focused rows are focused on; without it there
/// are none.
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

/// A row of [`Technique::Full`].
fn fixed(base: Settings, m: u32, printed: Vec<Printed>) -> Planned {
    let n = m * m;
    let (id, label) = (format!("fixed-{n}"), format!("Fixed {n}"));
    Planned { id, label, series: None, m, settings: plan::grid(base), printed }
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
    let focus = if focuses && request.focus.is_empty() { in_the_middle(session)? } else { request.focus.clone() };
    let mut stage = Stage { session, truth, focus: &focus, hosts: BTreeMap::new() };
    let mut measured = Vec::new();
    for table in tables(in_words(&session.scene, &focus).as_deref()) {
        let mut over = table.sparse.then_some(None);
        measured.push(table.map(|planned| stage.first(planned, &mut over))?);
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
                self.session.frame(&mut host, plan::grid(self.session.request.base))?;
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

impl<R> Table<R> {
    fn map<S>(self, row: impl FnMut(R) -> Result<S, ReportError>) -> Result<Table<S>, ReportError> {
        let Self { id, title, note, over, timed, sparse, rows } = self;
        Ok(Table { id, title, note, over, timed, sparse, rows: rows.into_iter().map(row).collect::<Result<_, _>>()? })
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
            let sum = sums.iter_mut().find(|(name, _)| *name == part(pass.name))?;
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

/// A curve's name, and its points of PSNR and samples.
type Curve<'a> = Option<(&'a str, Vec<(f64, f64)>)>;

/// Of (series, PSNR, samples): the first series that there is.
fn first_curve<'a>(rows: impl Iterator<Item = (Option<&'a str>, f64, f64)> + Clone) -> Curve<'a> {
    let name = rows.clone().find_map(|(series, ..)| series)?;
    let points = rows.filter(|(series, ..)| *series == Some(name)).map(|(_, db, samples)| (db, samples));
    Some((name, points.collect()))
}

/// Samples of a point of another series over those of the curve at this PSNR, between its neighbouring points by their logarithms.
fn same_psnr(curve: &Curve<'_>, series: Option<&str>, db: f64, samples: f64) -> Option<f64> {
    let (name, points) = curve.as_ref()?;
    series.filter(|s| s != name)?;
    let around = |w: &&[(f64, f64)]| w[0].0 != w[1].0 && (w[0].0 - db) * (w[1].0 - db) <= 0.0;
    let w = points.windows(2).find(around)?;
    let share = (db - w[0].0) / (w[1].0 - w[0].0);
    Some(samples / (w[0].1.ln() + share * (w[1].1 / w[0].1).ln()).exp())
}

/// The object that the picture is of, if it has any: the one with the greatest product of its pixels in the middle ninth and of these
/// over all its pixels, so that no floor or wall is taken for it. The lowest number of several.
fn in_the_middle(session: &Session) -> Result<Vec<u16>, ReportError> {
    let mut host = session.host(1)?;
    session.frame(&mut host, Settings { technique: Technique::Single, ..Settings::default() })?;
    let (width, height) = (session.request.width as usize, session.request.height as usize);
    let is_middle = |at: usize, end: usize| (end / 3..end - end / 3).contains(&at);
    // Pixels in the middle, and all.
    let mut counts = BTreeMap::<u16, [f64; 2]>::new();
    for (i, (surface, depth)) in host.surfaces().into_iter().zip(host.depths()).enumerate() {
        let object = (surface[1] >> 16) as u16;
        // 0 is no object, and a depth of 0 the sky.
        if object > 0 && depth > 0.0 {
            let [middle, all] = counts.entry(object).or_default();
            *middle += f64::from(u8::from(is_middle(i % width, width) && is_middle(i / width, height)));
            *all += 1.0;
        }
    }
    let score = |[middle, all]: [f64; 2]| middle * middle / all;
    let most = counts.into_iter().filter(|(_, c)| score(*c) > 0.0).max_by(|a, b| {
        let order = score(a.1).total_cmp(&score(b.1));
        order.then(b.0.cmp(&a.0))
    });
    Ok(most.map(|(object, _)| object).into_iter().collect())
}

/// The name of the first object, and how many others there are.
fn in_words(scene: &Scene, focus: &[u16]) -> Option<String> {
    let first = focus.first()?;
    let named = scene.instances.iter().find(|i| i.object == *first).map(|i| scene.meshes[i.mesh].name.as_str());
    let name = named.filter(|name| !name.is_empty()).map_or(format!("object {first}"), str::to_owned);
    Some(if focus.len() > 1 { format!("{name} and {} more", focus.len() - 1) } else { name })
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

    #[test]
    fn passes_are_apart_by_what_they_are_for() {
        for (pass, expected) in [
            ("classify", "rays"),
            ("trace 1/4", "rays"),
            ("bounce shifted", "rays"),
            ("refine rays 1/2", "decisions"),
            ("refine", "decisions"),
            ("points 1/8", "shading"),
            ("first", "shading"),
            ("resolve", "rest"),
        ] {
            assert_eq!(part(pass), expected, "{pass}");
        }
    }

    #[test]
    fn curves_compare_at_the_same_psnr() {
        let rows = [(None, 50.0, 16.0), (Some("a"), 40.0, 4.0), (Some("a"), 36.0, 1.0), (Some("b"), 38.0, 1.0)];
        let curve = first_curve(rows.into_iter());
        // In the middle of 1 and 4 by their logarithms is 2.
        assert!((same_psnr(&curve, Some("b"), 38.0, 1.0).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(same_psnr(&curve, Some("b"), 40.0, 4.0), Some(1.0));
        assert_eq!(same_psnr(&curve, Some("b"), 41.0, 4.0), None, "beyond the curve");
        assert_eq!(same_psnr(&curve, Some("a"), 38.0, 2.0), None, "the curve itself");
        assert_eq!(same_psnr(&curve, None, 38.0, 2.0), None);
    }
}
