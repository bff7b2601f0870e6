//! The entries that the page shows, in motion: how much they flicker while the camera moves by less than a pixel a
//! frame, and how far moving frames are from the truth, which is where a history shows what it costs.

use super::shooter::{Shooter, has_history};
use super::{cost, truth};
use crate::host::Host;
use crate::host::raster::node_camera;
use crate::measure::quality;
use crate::measure::reference;
use crate::measure::temporal::{self, Deviation, FRAMES, Flicker, FrameErrors, Motion, UNCOVERING_FRAMES};
use crate::picture::Picture;
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::plan::Planned;
use crate::report::schema::{self, MovingErrors, Temporal, TemporalBase};
use crate::report::session::Session;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Of the frames, every so many are measured with --quick, which is all the same to a standard deviation. A history
/// sees all of them.
const QUICK_EVERY: u32 = 4;

/// Sets what the entries that are planned here do in motion. Each frame has a truth of its own, which is what takes the
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
    // Both movements begin at the view itself, and the frames without a use for a history end there: one truth for all.
    let camera = node_camera(&session.view, base.width, base.height);
    let settings = reference::truth(session.request.base);
    let still = truth::render(&mut reference, camera, side, settings, || session.tick())?;
    let pan = motion(session, Motion::Pan, planned, (&mut reference, &still), &mut shooters, base)?;
    let turn = motion(session, Motion::Turn, planned, (&mut reference, &still), &mut shooters, base)?;
    let mut all = BTreeMap::new();
    for (planned, (pan, turn)) in planned.iter().zip(pan.into_iter().zip(turn)) {
        let Some(shooter) = shooters.get_mut(&planned.m) else { continue };
        let [cut_db, uncovering_db] = without_use_of_history(session, planned, shooter, &still)?;
        let errors = pan.errors.zip(turn.errors);
        let errors = errors.map(|(pan, turn)| MovingErrors { pan, turn, cut_db, uncovering_db });
        all.insert(planned.id.clone(), Temporal { pan: pan.flicker, turn: turn.flicker, errors });
    }
    Ok(all)
}

/// One entry in one movement.
#[derive(Debug)]
struct Moved {
    flicker: Option<Deviation>,
    errors: Option<FrameErrors>,
}

/// `still` is the truth of the first frame.
fn motion(
    session: &Session,
    motion: Motion,
    planned: &[Planned],
    (reference, still): (&mut Host, &Picture),
    shooters: &mut BTreeMap<u32, Shooter>,
    base: TemporalBase,
) -> Result<Vec<Moved>, ReportError> {
    let TemporalBase { width, height, frames, samples_per_pixel } = base;
    let side = samples_per_pixel.isqrt();
    let every = FRAMES / frames;
    let camera = |frame| temporal::camera(motion, &session.view, frame, width, height);
    let mut all = vec![(Flicker::new((width * height) as usize), Vec::new()); planned.len()];
    for planned in planned.iter().filter(|p| has_history(p)) {
        let Some(shooter) = shooters.get_mut(&planned.m) else { continue };
        shooter.settle(planned, camera(0), || session.tick())?;
    }
    for frame in 0..FRAMES {
        let camera = camera(frame);
        let truth = match frame {
            0 => Some(still.clone()),
            _ if frame % every == 0 => {
                let settings = reference::truth(session.request.base);
                Some(truth::render(reference, camera, side, settings, || session.tick())?)
            }
            _ => None,
        };
        for (planned, (flicker, errors)) in planned.iter().zip(&mut all) {
            let Some(shooter) = shooters.get_mut(&planned.m) else { continue };
            if truth.is_some() || has_history(planned) {
                shooter.shoot(planned, camera)?;
            }
            if let Some(truth) = &truth {
                let picture = shooter.picture(planned);
                flicker.push(&picture, truth)?;
                errors.push(quality::psnr(&picture, truth)?);
            }
        }
    }
    let finish =
        |(flicker, errors): (Flicker, Vec<f64>)| Moved { flicker: flicker.finish(), errors: FrameErrors::of(&errors) };
    Ok(all.into_iter().map(finish).collect())
}

/// The PSNR of the first frame after a cut to the view, and of one in a movement that ends there and uncovers what was
/// hidden.
fn without_use_of_history(
    session: &Session,
    planned: &Planned,
    shooter: &mut Shooter,
    still: &Picture,
) -> Result<[f64; 2], ReportError> {
    let camera = |left| temporal::uncovering(&session.view, left, still.width, still.height);
    shooter.cut(planned);
    shooter.shoot(planned, camera(0))?;
    let cut = quality::psnr(&shooter.picture(planned), still)?;
    if !has_history(planned) {
        return Ok([cut; 2]);
    }
    shooter.settle(planned, camera(UNCOVERING_FRAMES), || session.tick())?;
    for left in (0..UNCOVERING_FRAMES).rev() {
        shooter.shoot(planned, camera(left))?;
    }
    Ok([cut, quality::psnr(&shooter.picture(planned), still)?])
}
