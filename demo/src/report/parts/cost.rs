//! What a frame costs, against what makes frames costly, for Full, Single and Windowed.

use super::fit;
use super::variants;
use crate::host::Host;
use crate::measure::stats::times;
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::schema::cost::{Base, Cost, Fit, Point};
use crate::report::session::Session;
use deferred_aa::{Settings, Technique};
use std::collections::BTreeMap;

/// Measures a curve.
type Run = fn(&Session, Base) -> Result<Vec<Point>, ReportError>;

/// All curves, in the order in which they are measured.
pub const CURVES: [(&str, Run); 5] =
    [("stall", stall), ("resolution", resolution), ("m", window), ("lights", lights), ("triangles", triangles)];

/// The name of the part of work that measures a curve.
pub fn part(curve: &str) -> String {
    format!("cost: {curve}")
}

/// Most triangles of the finest meshes.
const MOST_TRIANGLES: u64 = 4_000_000;

/// Most triangles that a software driver draws in a frame, where it is not the scene's own number.
const MOST_DRAWN: u64 = 1_500_000;

/// All curves that the session wants, with Windowed as the request has it. What is finished is in `so_far`.
pub fn cost(session: &mut Session, so_far: &mut Option<Cost>) -> Result<(), ReportError> {
    let base = base(session);
    let mut curves = [const { Vec::new() }; CURVES.len()];
    for (i, (name, run)) in CURVES.into_iter().enumerate() {
        if !session.wants(&part(name)) {
            continue;
        }
        curves[i] = session.part(&part(name), |session| kept(session, name, base, run))?;
        *so_far = Some(curves_so_far(base, &curves));
    }
    Ok(())
}

/// The cost by these curves, which are in the order of [`CURVES`].
fn curves_so_far(base: Base, curves: &[Vec<Point>; CURVES.len()]) -> Cost {
    let [stall, resolution, m, lights, triangles] = curves.clone();
    let totals: Option<Vec<_>> = stall.iter().map(|p| Some((p.x, p.windowed_total_ms?, p.full_total_ms?))).collect();
    let fits = CURVES.iter().zip(curves).map(|((name, _), curve)| ((*name).to_owned(), fits(curve))).collect();
    let crossover_stall = totals.and_then(|t| fit::crossover(&t));
    Cost { base, stall, crossover_stall, resolution, m, lights, triangles, fits }
}

/// Where what depends on many frames is measured: smaller than the report on a software driver.
pub fn base(session: &Session) -> Base {
    let r = &session.request;
    let most = match (session.software(), r.quick) {
        (true, true) => 1 << 16,
        (true, false) => 1 << 17,
        (false, true) => 1 << 19,
        (false, false) => u64::MAX,
    };
    let (width, height) = at_most(session, most);
    Base { width, height, m: r.ms.iter().copied().max().unwrap_or(1), stall: r.stall, frames: r.frames.min(3) }
}

/// The request's size, made smaller to have about this many pixels at most.
pub fn at_most(session: &Session, pixels: u64) -> (u32, u32) {
    let size = (session.request.width, session.request.height);
    scaled(size, (pixels as f64 / (f64::from(size.0) * f64::from(size.1))).sqrt().min(1.0))
}

fn scaled((width, height): (u32, u32), scale: f64) -> (u32, u32) {
    let of = |side: u32| ((f64::from(side) * scale).round() as u32).max(1);
    (of(width), of(height))
}

/// The curve of an earlier run, or a new one.
fn kept(session: &Session, name: &str, base: Base, run: Run) -> Result<Vec<Point>, ReportError> {
    let name = format!("cost-{name}");
    let fingerprint = session.fingerprint.with(&(&name, base, session.request.base, session.request.quick)).hex();
    if let Some(points) = session.folder.finished(Kind::Part, &name, &fingerprint) {
        return Ok(points);
    }
    let points = run(session, base)?;
    session.folder.keep(Kind::Part, &name, &fingerprint, &points)?;
    Ok(points)
}

fn stall(session: &Session, base: Base) -> Result<Vec<Point>, ReportError> {
    let mut host = session.host_of(session.scene.clone(), base.m, (base.width, base.height))?;
    let stalls = [1, 2, 4, 8, 16, 32];
    stalls
        .into_iter()
        .map(|stall| {
            host.set_stall(stall);
            point(session, &mut host, base, f64::from(stall))
        })
        .collect()
}

fn resolution(session: &Session, base: Base) -> Result<Vec<Point>, ReportError> {
    let mut host = session.host_of(session.scene.clone(), base.m, (base.width, base.height))?;
    let scales = [0.125f64, 0.25, 0.5, 1.0];
    scales
        .into_iter()
        .map(|share| {
            let (width, height) = scaled((base.width, base.height), share.sqrt());
            host.resize(width, height)?;
            point(session, &mut host, base, f64::from(width) * f64::from(height))
        })
        .collect()
}

fn window(session: &Session, base: Base) -> Result<Vec<Point>, ReportError> {
    (1..=base.m.max(4))
        .map(|m| {
            let mut host = session.host_of(session.scene.clone(), m, (base.width, base.height))?;
            point(session, &mut host, base, f64::from(m))
        })
        .collect()
}

fn lights(session: &Session, base: Base) -> Result<Vec<Point>, ReportError> {
    let counts = [0, 1, 4, 16, 64];
    let scene = variants::with_lights(&session.scene, 64);
    let mut host = session.host_of(scene, base.m, (base.width, base.height))?;
    counts
        .into_iter()
        .map(|count| {
            host.set_light_count(count);
            point(session, &mut host, base, f64::from(count))
        })
        .collect()
}

/// Points that would not fit in memory, or take minutes, are left out.
fn triangles(session: &Session, base: Base) -> Result<Vec<Point>, ReportError> {
    let drawn = |times: u32| variants::triangles(&session.scene) * 4u64.pow(times);
    let slow = |times: u32| times > 0 && session.software() && drawn(times) > MOST_DRAWN;
    let all = (0..3).filter(|&times| !slow(times));
    all.filter_map(|times| variants::subdivided(&session.scene, times, MOST_TRIANGLES))
        .filter(|scene| variants::triangles(scene) > 0)
        .map(|scene| {
            let count = variants::triangles(&scene) as f64;
            let mut host = session.host_of(scene, base.m, (base.width, base.height))?;
            point(session, &mut host, base, count)
        })
        .collect()
}

/// The three techniques interleaved, after a round that warms up.
fn point(session: &Session, host: &mut Host, base: Base, x: f64) -> Result<Point, ReportError> {
    let techniques = [Technique::Full, Technique::Single, Technique::Windowed];
    let mut shots = [const { Vec::new() }; 3];
    for round in 0..=base.frames {
        for (technique, shots) in techniques.into_iter().zip(&mut shots) {
            let shot = session.frame(host, Settings { technique, ..session.request.base })?;
            if round > 0 {
                shots.push(shot);
            }
        }
    }
    let times = shots.map(|s| times(&s));
    let of = |i: usize, name: &str| times[i].get(name).map(|s| s.median);
    Ok(Point {
        x,
        full_ms: of(0, "node"),
        single_ms: of(1, "node"),
        windowed_ms: of(2, "node"),
        full_total_ms: of(0, "total"),
        single_total_ms: of(1, "total"),
        windowed_total_ms: of(2, "total"),
    })
}

/// A time of a point.
type Time = fn(&Point) -> Option<f64>;

fn fits(curve: &[Point]) -> BTreeMap<String, Fit> {
    let times: [(&str, Time); 6] = [
        ("full_ms", |p| p.full_ms),
        ("single_ms", |p| p.single_ms),
        ("windowed_ms", |p| p.windowed_ms),
        ("full_total_ms", |p| p.full_total_ms),
        ("single_total_ms", |p| p.single_total_ms),
        ("windowed_total_ms", |p| p.windowed_total_ms),
    ];
    let fit = |time: Time| {
        let points: Vec<_> = curve.iter().filter_map(|p| Some((p.x, time(p)?))).collect();
        fit::power_law(&points)
    };
    times.into_iter().filter_map(|(name, time)| Some((name.to_owned(), fit(time)?))).collect()
}
