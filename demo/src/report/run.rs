//! The order of a report.

use super::ReportError;
use super::page::{self, images};
use super::parts::effects::effects;
use super::parts::entries::{self, References};
use super::parts::executions::executions;
use super::parts::papers::{self, papers};
use super::parts::{bounds, cost, fit, flicker, goals, truth, variants};
use super::plan::{self, Planned};
use super::schema::cost::Cost;
use super::schema::effects::Effects;
use super::schema::executions::ExecutionRow;
use super::schema::papers::Papers;
use super::schema::{Crop, Entry, Frontier, GoalRow, Oracle, Report, ReportAdapter, TemporalBase, TruthInfo, VERSION};
use super::session::{Request, Session};
use crate::measure::stats::Adapter;
use crate::picture::Picture;
use std::collections::BTreeSet;

/// What is finished so far.
#[derive(Debug, Default)]
struct Finished {
    truth: Option<(Picture, TruthInfo)>,
    entries: Vec<Entry>,
    oracles: Vec<Oracle>,
    temporal: Option<TemporalBase>,
    executions: Vec<ExecutionRow>,
    goals: Vec<GoalRow>,
    cost: Option<Cost>,
    effects: Option<Effects>,
    papers: Option<Papers>,
}

/// The entries of a request.
pub fn plan_of(request: &Request) -> Vec<Planned> {
    let mut plan = plan::plan(&request.ms, &request.techniques, request.base, request.quick);
    for planned in &mut plan {
        planned.settings = plan::fitting(planned.settings, (request.width, request.height));
    }
    plan
}

/// The parts of work of a plan, in order.
pub fn parts(request: &Request, plan: &[Planned]) -> Vec<String> {
    let mut names = vec!["truth".to_owned()];
    names.extend(sides(plan).into_iter().rev().map(window));
    names.extend(["bounds", "flicker"].map(str::to_owned));
    let wanted = |name: &str| request.techniques.contains(&name);
    if wanted("windowed") && request.ms.iter().any(|&m| m > 1) {
        names.extend(["executions", "goals"].map(str::to_owned));
    }
    let costs = ["full", "single", "windowed"].into_iter().all(wanted);
    if costs {
        names.push("effects".to_owned());
    }
    if papers::any(&request.techniques) {
        names.push("papers".to_owned());
    }
    if costs {
        names.extend(cost::CURVES.map(|(name, _)| cost::part(name)));
    }
    names.push("page".to_owned());
    names
}

/// The part that measures the entries of one m.
fn window(m: u32) -> String {
    format!("m = {m}")
}

/// Bytes of the files that a plan writes, about.
pub fn bytes(request: &Request, plan: &[Planned]) -> u64 {
    // 12 of linear floats and three 8-bit pictures that hardly compress; the truth twice, once in the cache.
    let pixels = u64::from(request.width) * u64::from(request.height);
    pixels * (12 + 9) * (plan.len() as u64 + 2) + (32 << 20)
}

/// Does the work and writes report.json and report.html. Where the user stops it or the device goes away, both hold
/// what is finished, and the error says how to go on.
pub fn run(session: &mut Session) -> Result<Report, ReportError> {
    let plan = plan_of(&session.request);
    let mut finished = Finished::default();
    let stopped = match work(session, &plan, &mut finished) {
        Err(e) if !e.keeps_what_is_finished() => return Err(e),
        result => result.err(),
    };
    let order = |e: &Entry| plan.iter().position(|p| p.id == e.id);
    finished.entries.sort_by_key(order);
    let report = session.part("page", |session| write(session, &plan, finished))?;
    session.done();
    match stopped {
        None => Ok(report),
        Some(why) => Err(ReportError::Unfinished {
            why: why.to_string(),
            kept: report.entries.len(),
            planned: plan.len(),
            folder: session.folder.path().to_owned(),
        }),
    }
}

fn work(session: &mut Session, plan: &[Planned], finished: &mut Finished) -> Result<(), ReportError> {
    let (entries, left) = entries::sort_out(session, plan);
    finished.entries = entries;
    let side = if session.request.quick { 16 } else { 32 };
    let truth = session.part("truth", |session| truth::truth(session, side))?;
    finished.truth = Some(truth.clone());
    let mut references = References { truth: truth.0, edges: None };
    let largest = session.request.ms.iter().copied().max().unwrap_or(1);
    // The largest m first: its edges are everyone's.
    for m in sides(plan).into_iter().rev() {
        let left: Vec<_> = left.iter().filter(|p| p.m == m).cloned().collect();
        session.part(&window(m), |session| {
            if m < largest && !left.is_empty() && references.edges.is_none() {
                references.edges = Some(entries::edges(session, largest)?);
            }
            entries::measure(session, &left, &mut references, |entry| finished.entries.push(entry))
        })?;
    }
    session.part("bounds", |session| {
        for m in sides(plan).into_iter().rev() {
            finished.oracles.extend(bounds::bounds(session, m, &mut finished.entries)?);
        }
        Ok(())
    })?;
    let shown: BTreeSet<_> = images::shown(&finished.entries).into_iter().map(|e| e.id.clone()).collect();
    let shown: Vec<_> = plan.iter().filter(|p| shown.contains(&p.id)).cloned().collect();
    let temporal = session.part("flicker", |session| flicker::flicker(session, &shown, &mut finished.entries))?;
    finished.temporal = Some(temporal);
    if session.wants("executions") {
        finished.executions = session.part("executions", |session| executions(session, largest))?;
        finished.goals = session.part("goals", |session| goals::goals(session, largest))?;
    }
    if session.wants("effects") {
        finished.effects = Some(session.part("effects", |session| effects(session))?);
    }
    if session.wants("papers") {
        finished.papers = session.part("papers", |session| papers(session, &references.truth))?;
    }
    cost::cost(session, &mut finished.cost)
}

/// Of the windows' sides, the rising ones that the plan has.
fn sides(plan: &[Planned]) -> BTreeSet<u32> {
    plan.iter().map(|p| p.m).collect()
}

fn write(session: &mut Session, plan: &[Planned], finished: Finished) -> Result<Report, ReportError> {
    let crops = match (&finished.truth, images::judged(&finished.entries)) {
        (Some((truth, _)), Some(entry)) => images::worst(session, entry, truth)?,
        _ => Vec::new(),
    };
    let report = report(session, plan, finished, crops);
    session.folder.write_json(&session.folder.file("report.json"), &report)?;
    let images = match &report.truth {
        Some(_) => images::images(session, &report.entries, &report.crops)?,
        None => images::Images::default(),
    };
    page::write(&session.folder, &report, &images)?;
    Ok(report)
}

fn report(session: &Session, plan: &[Planned], finished: Finished, crops: Vec<Crop>) -> Report {
    let Finished { truth, entries, oracles, temporal, executions, goals, cost, effects, papers } = finished;
    let Request { ref command, width, height, stall, quick, .. } = session.request;
    let scene = &session.scene;
    let is_there = |p: &&Planned| entries.iter().any(|e| e.id == p.id);
    Report {
        version: VERSION,
        command: command.clone(),
        scene: scene.name.clone(),
        width,
        height,
        stall,
        quick,
        lights: scene.lights.len() as u32 + u32::from(scene.sun.is_some()),
        triangles: variants::triangles(scene),
        adapter: ReportAdapter { adapter: Adapter::of(&session.gpu), software: session.software() },
        truth: truth.map(|(_, info)| info),
        oracles,
        temporal,
        frontier: frontier(&entries),
        executions,
        cost,
        effects,
        papers,
        goals,
        crops,
        unfinished: plan.iter().filter(|p| !is_there(p)).map(|p| p.id.clone()).chain(session.left()).collect(),
        seconds: session.seconds.clone(),
        entries,
    }
}

fn frontier(entries: &[Entry]) -> Frontier {
    let by = |cost: &dyn Fn(&Entry) -> Option<f64>| {
        let there: Vec<_> = entries.iter().filter_map(|e| Some((e, (cost(e)?, e.error()?)))).collect();
        let points: Vec<_> = there.iter().map(|(_, point)| *point).collect();
        fit::frontier(&points).into_iter().map(|i| there[i].0.id.clone()).collect()
    };
    Frontier { time: by(&Entry::total_ms), samples: by(&|e| Some(e.stats.samples.mean_k)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host;
    use crate::host::gpu::{self, Gpu};
    use crate::report::folder::Folder;
    use crate::scene::builtin::builtin;
    use deferred_aa::rays::RayTier;
    use deferred_aa::{GBufferTier, Settings, TextureTier};
    use std::path::Path;

    fn session(path: &Path) -> Session {
        let request = Request {
            command: "a test".to_owned(),
            width: 32,
            height: 18,
            ms: vec![2],
            techniques: vec!["single"],
            stall: 1,
            quick: true,
            frames: 1,
            textures: TextureTier::Arrays,
            rays: RayTier::Software,
            gbuffer: GBufferTier::default(),
            anisotropy: 16,
            focus: Vec::new(),
            base: Settings::default(),
            resume: true,
            cache: Some(path.join("cache")),
        };
        let gpu = Gpu::new(
            gpu::choose(None).unwrap(),
            &host::descriptor(2, request.textures, RayTier::Software, GBufferTier::default()),
        )
        .unwrap();
        let scene = builtin("cornell").unwrap();
        let folder = Folder::open(&path.join("out"), 0, true, &request.subject(&scene), false).unwrap();
        let view = scene.default_camera();
        let parts = parts(&request, &plan_of(&request));
        Session::new(request, gpu, scene, view, folder, parts)
    }

    #[test]
    fn a_lost_device_leaves_what_is_finished() {
        let path = std::env::temp_dir().join(format!("deferred-aa-lost-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        let whole = run(&mut session(&path)).unwrap();
        assert_eq!(whole.entries.len(), 2);

        std::fs::remove_file(path.join("out/entries/single-m1.json")).unwrap();
        std::fs::remove_file(path.join("out/report.json")).unwrap();
        let mut lost = session(&path);
        lost.gpu.device.destroy();
        let error = run(&mut lost).unwrap_err();
        assert!(matches!(error, ReportError::Unfinished { kept: 1, planned: 2, .. }), "{error}");
        let message = error.to_string();
        assert!(message.contains("device was lost") && message.contains("1 of 2 entries"), "{message}");
        assert!(message.contains("--resume") && message.lines().count() == 1, "{message}");
        let read =
            || -> Report { serde_json::from_slice(&std::fs::read(path.join("out/report.json")).unwrap()).unwrap() };
        assert_eq!(
            (read().entries.len(), read().unfinished),
            (1, ["single-m1", "bounds", "flicker"].map(str::to_owned).to_vec())
        );
        assert!(path.join("out/report.html").is_file());

        let resumed = run(&mut session(&path)).unwrap();
        assert!(resumed.entries.len() == 2 && resumed.unfinished.is_empty());
        assert!(resumed.entries[0].stats == whole.entries[0].stats, "measured again");
        std::fs::remove_dir_all(&path).unwrap();
    }
}
