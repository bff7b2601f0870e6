//! The entries: all of one m interleaved, so that a drifting machine moves all alike.

use super::shooter::Shooter;
use crate::host::{Host, Shot};
use crate::measure::quality::{self, Quality, QualityError};
use crate::measure::reference;
use crate::measure::stats::{self, Against, Stats};
use crate::picture::{self, Picture};
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::page::images;
use crate::report::plan::Planned;
use crate::report::schema::{Entry, Files};
use crate::report::session::Session;
use deferred_aa::{Settings, Technique};

/// The references that entries are held against.
#[derive(Debug)]
pub struct References {
    /// The picture of many samples.
    pub truth: Picture,
    /// The pixels where the largest m sees an edge: one mask for all entries, so that their edge errors against the
    /// truth compare.
    pub edges: Option<Vec<bool>>,
}

/// The entries of the plan that were measured before, and those that are left to do.
pub fn sort_out(session: &Session, plan: &[Planned]) -> (Vec<Entry>, Vec<Planned>) {
    let mut finished = Vec::new();
    let mut left = Vec::new();
    for planned in plan {
        match session.folder.finished::<Entry>(Kind::Entry, &planned.id, &fingerprint(session, planned)) {
            Some(entry) if files_are_there(session, &entry.files) => finished.push(entry),
            _ => left.push(planned.clone()),
        }
    }
    (finished, left)
}

/// Measures entries of one m and keeps them. `done` is called with each.
pub fn measure(
    session: &mut Session,
    entries: &[Planned],
    references: &mut References,
    mut done: impl FnMut(Entry),
) -> Result<(), ReportError> {
    let Some(m) = entries.first().map(|e| e.m) else { return Ok(()) };
    let mut host = session.host(m)?;
    let grid = grid(session, &mut host)?;
    let mask = host.edge_mask();
    if references.edges.is_none() {
        references.edges = Some(show_edges(session, mask.clone())?);
    }
    let mut shooter = Shooter::new(host, entries)?;
    let mut shown = Vec::new();
    for planned in entries {
        // The frame that warms up is the picture too: the same frame twice is the same bits.
        shooter.settle(planned, session.camera(), || session.tick())?;
        let image = shooter.picture(planned);
        let adaptive = !matches!(planned.settings.technique, Technique::Full | Technique::Single);
        let counts = adaptive.then(|| shooter.host.sample_map(session.camera(), planned.settings)).transpose()?;
        let files = write_files(session, planned, &image, counts.as_deref(), &references.truth)?;
        let quality = compare(&image, grid.as_ref().map(|g| (g, mask.as_slice())), references)?;
        shown.push((files, quality));
    }
    let mut shots = vec![Vec::new(); entries.len()];
    for _ in 0..session.request.frames {
        for (planned, shots) in entries.iter().zip(&mut shots) {
            session.tick()?;
            shots.push(shooter.shoot(planned, session.camera())?);
        }
    }
    // More of those whose times waver, until their medians rest or there is no hope.
    for _ in 0..2 * session.request.frames {
        let wavering: Vec<_> = (0..entries.len()).filter(|&i| wavers(&shots[i])).collect();
        if wavering.is_empty() {
            break;
        }
        for i in wavering {
            session.tick()?;
            shots[i].push(shooter.shoot(&entries[i], session.camera())?);
        }
    }
    for ((planned, shots), (files, quality)) in entries.iter().zip(&shots).zip(shown) {
        let Some(mut stats) = Stats::new(&shooter.host, planned.settings, shots, None) else { continue };
        stats.quality = quality;
        stats = shooter.complete(planned, stats);
        let Planned { id, label, role, preset, .. } = planned.clone();
        let preset = preset.map(str::to_owned);
        let entry = Entry { id, label, role, preset, stats, files, oracle: None, temporal: None };
        session.folder.keep(Kind::Entry, &entry.id, &fingerprint(session, planned), &entry)?;
        done(entry);
    }
    Ok(())
}

/// Whether the middle half of an entry's times lies more than a tenth apart.
fn wavers(shots: &[Shot]) -> bool {
    let mut totals: Vec<f64> = shots
        .iter()
        .filter_map(|shot| stats::times(std::slice::from_ref(shot)).get("total").map(|total| total.median))
        .collect();
    totals.sort_by(f64::total_cmp);
    let at = |part: usize| totals.get(totals.len() * part / 4).copied();
    at(1).zip(at(3)).is_some_and(|(first, third)| third > 1.1 * first)
}

/// The pixels where a window of this m holds an edge. They are also written to the folder, as edges.png.
pub fn edges(session: &Session, m: u32) -> Result<Vec<bool>, ReportError> {
    let mut host = session.host(m)?;
    session.frame(&mut host, Settings { technique: Technique::Single, ..Settings::default() })?;
    show_edges(session, host.edge_mask())
}

fn show_edges(session: &Session, mask: Vec<bool>) -> Result<Vec<bool>, ReportError> {
    picture::write_png(&images::mask(&mask, session.request.width)?, &session.folder.file("edges.png"))?;
    Ok(mask)
}

/// All samples of the host's grid. `None` at m = 1, where a grid of one sample is no reference.
fn grid(session: &Session, host: &mut Host) -> Result<Option<Picture>, ReportError> {
    if host.options.m == 1 {
        return Ok(None);
    }
    let shot = session.frame(host, reference::grid(session.request.base))?;
    if shot.statistics.not_finite > 0 {
        // The truth was finite: one sample of this grid, that it has not, is not.
        return Err(ReportError::NotFinite { what: format!("grid reference of m = {}", host.options.m), pixel: None });
    }
    Ok(Some(host.picture()))
}

fn write_files(
    session: &Session,
    planned: &Planned,
    image: &Picture,
    counts: Option<&[u32]>,
    truth: &Picture,
) -> Result<Files, ReportError> {
    let id = &planned.id;
    let folder = &session.folder;
    let files = Files {
        png: format!("{id}.png"),
        exr: format!("{id}.exr"),
        samples: counts.map(|_| format!("{id}-samples.png")),
        error: Some(format!("{id}-error.png")),
    };
    image.write_png(&folder.file(&files.png))?;
    image.write_exr(&folder.file(&files.exr))?;
    if let (Some(counts), Some(name)) = (counts, &files.samples) {
        let map = picture::heat_map(counts, image.width, image.height, planned.m * planned.m)?;
        picture::write_png(&map, &folder.file(name))?;
    }
    if let Some(name) = &files.error {
        picture::write_png(&images::error_map(image, truth)?, &folder.file(name))?;
    }
    Ok(files)
}

/// Compares with both references, each on a thread of its own.
fn compare(
    image: &Picture,
    grid: Option<(&Picture, &[bool])>,
    references: &References,
) -> Result<Against, QualityError> {
    let (grid, truth) = std::thread::scope(|threads| {
        let grid = grid.map(|(grid, mask)| threads.spawn(move || quality::compare(image, grid, Some(mask))));
        let truth = quality::compare(image, &references.truth, references.edges.as_deref());
        // A panic goes on.
        let grid = grid.map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        (grid, truth)
    });
    let grid: Option<Quality> = grid.transpose()?;
    Ok(Against { grid, truth: Some(truth?) })
}

fn fingerprint(session: &Session, planned: &Planned) -> String {
    let request = &session.request;
    let largest = request.ms.iter().max();
    session.fingerprint.with(&(planned, request.stall, request.frames, request.quick, largest)).hex()
}

fn files_are_there(session: &Session, files: &Files) -> bool {
    let names = [Some(&files.png), Some(&files.exr), files.samples.as_ref(), files.error.as_ref()];
    names.into_iter().flatten().all(|name| session.folder.file(name).is_file())
}
