//! The entries that the page shows, while the camera moves by less than a pixel a frame.

use super::entries::Shooter;
use super::{cost, truth};
use crate::host::Host;
use crate::measure::reference;
use crate::measure::temporal::{self, Deviation, FRAMES, Flicker, Motion};
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::plan::Planned;
use crate::report::schema::{self, Temporal, TemporalBase};
use crate::report::session::Session;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Of the frames, every so many are taken with --quick: the same movements in larger steps, which is all the same to a
/// standard deviation.
const QUICK_EVERY: u32 = 4;

/// Sets the flicker of the entries that are planned here. Each frame has a truth of its own, which is what takes the
/// time: so the picture is small.
pub fn flicker(
    session: &Session,
    planned: &[Planned],
    entries: &mut [schema::Entry],
) -> Result<TemporalBase, ReportError> {
    let most = match (session.software(), session.request.quick) {
        (true, true) => 1 << 14,
        (true, false) => 1 << 15,
        (false, _) => 1 << 17,
    };
    let (width, height) = cost::at_most(session, most);
    let side = if session.request.quick { 8 } else { 16 };
    let every = if session.request.quick { QUICK_EVERY } else { 1 };
    let base = TemporalBase { width, height, frames: FRAMES / every, samples_per_pixel: side * side };
    let fingerprint = session.fingerprint.with(&("temporal", base, planned)).hex();
    let all: BTreeMap<String, Temporal> = match session.folder.finished(Kind::Part, "temporal", &fingerprint) {
        Some(all) => all,
        None => {
            let all = compute(session, planned, base)?;
            session.folder.keep(Kind::Part, "temporal", &fingerprint, &all)?;
            all
        }
    };
    for entry in entries {
        entry.temporal = all.get(&entry.id).copied();
    }
    Ok(base)
}

fn compute(
    session: &Session,
    planned: &[Planned],
    base: TemporalBase,
) -> Result<BTreeMap<String, Temporal>, ReportError> {
    let side = base.samples_per_pixel.isqrt();
    let host = |m| {
        let mut host = session.host_of(session.scene.clone(), m, (base.width, base.height))?;
        host.set_stall(1);
        Ok::<_, ReportError>(host)
    };
    let mut reference = host(truth::largest_m(session, side, (base.width, base.height)))?;
    let mut shooters = BTreeMap::new();
    for p in planned {
        if let Entry::Vacant(place) = shooters.entry(p.m) {
            place.insert(Shooter::new(host(p.m)?, planned)?);
        }
    }
    let pan = motion(session, Motion::Pan, planned, &mut reference, &mut shooters, base)?;
    let turn = motion(session, Motion::Turn, planned, &mut reference, &mut shooters, base)?;
    let both = planned.iter().zip(pan.into_iter().zip(turn));
    Ok(both.map(|(p, (pan, turn))| (p.id.clone(), Temporal { pan, turn })).collect())
}

fn motion(
    session: &Session,
    motion: Motion,
    planned: &[Planned],
    reference: &mut Host,
    shooters: &mut BTreeMap<u32, Shooter>,
    base: TemporalBase,
) -> Result<Vec<Option<Deviation>>, ReportError> {
    let TemporalBase { width, height, frames, samples_per_pixel } = base;
    let side = samples_per_pixel.isqrt();
    let mut all = vec![Flicker::new((width * height) as usize); planned.len()];
    for frame in (0..FRAMES).step_by((FRAMES / frames) as usize) {
        let camera = temporal::camera(motion, &session.view, frame, width, height);
        let truth = truth::render(reference, camera, side, reference::truth(session.request.base), || session.tick())?;
        for (planned, flicker) in planned.iter().zip(&mut all) {
            let Some(shooter) = shooters.get_mut(&planned.m) else { continue };
            shooter.shoot(planned, camera)?;
            flicker.push(&shooter.picture(planned), &truth)?;
        }
    }
    Ok(all.into_iter().map(Flicker::finish).collect())
}
