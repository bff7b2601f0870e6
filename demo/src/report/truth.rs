//! The truth: a regular grid of many samples in each pixel, all shaded, and their mean.

use super::cache::{About, Cache};
use super::schema::TruthInfo;
use super::session::Session;
use super::{ReportError, plan};
use crate::host::{self, Host};
use crate::picture::{Picture, Rect};
use crate::raster::crop;
use deferred_aa::{DeferredAa, Settings};
use glam::Vec2;
use std::time::Instant;

/// Name of the truth's linear image in the folder.
pub const FILE: &str = "truth.exr";

/// Most bytes of a node that renders a reference.
const MOST_BYTES: u64 = 3_000_000_000;

/// The truth of the session's view, with `side`² samples a pixel, from the cache if it is there. Also in the folder, as
/// truth.png and truth.exr.
pub fn truth(session: &Session, side: u32) -> Result<(Picture, TruthInfo), ReportError> {
    let request = &session.request;
    let cache = Cache::new(request.cache.as_deref());
    let samples_per_pixel = side * side;
    let m = largest_m(session, side, (request.width, request.height));
    let key = session.fingerprint.with(&("truth", side, m)).hex();
    let found = cache.load(&key, request.width, request.height).unwrap_or_else(|why| {
        session.note(&why);
        None
    });
    let (picture, seconds, cached) = match found {
        Some(hit) => (hit.picture, hit.seconds, true),
        None => {
            let start = Instant::now();
            let mut host = session.host(m)?;
            host.set_stall(1);
            let picture = render(&mut host, session.camera(), side, || session.tick())?;
            let seconds = start.elapsed().as_secs_f64();
            // A cache that can't be written costs time the next time, and nothing now.
            if let Err(e) =
                cache.store(&key, &picture, About { scene: &session.scene.name, samples_per_pixel, seconds })
            {
                session.note(&format!("the truth is not cached: {e}"));
            }
            (picture, seconds, false)
        }
    };
    picture.write_png(&session.folder.file("truth.png"))?;
    picture.write_exr(&session.folder.file(FILE))?;
    Ok((picture, TruthInfo { samples_per_pixel, cached, seconds, file: FILE.to_owned() }))
}

/// The largest window that divides the grid and fits the device.
pub fn largest_m(session: &Session, side: u32, size: (u32, u32)) -> u32 {
    [8, 4, 2].into_iter().find(|&m| side.is_multiple_of(m) && fits(session, m, size)).unwrap_or(1)
}

/// Whether a host of this m and size is within the device's limits, and not too large to keep the machine usable.
pub fn fits(session: &Session, m: u32, (width, height): (u32, u32)) -> bool {
    let descriptor = host::descriptor(m, session.request.textures);
    let memory = DeferredAa::requirements(&session.gpu.adapter, &descriptor).memory(width, height);
    let longest = u64::from(width.max(height)) * u64::from(m);
    longest <= u64::from(session.gpu.device.limits().max_texture_dimension_2d)
        && memory.gbuffer + memory.scratch <= MOST_BYTES
}

/// The mean of `side`² samples a pixel on a regular grid: frames of all m² samples, each moved by part of a sample. `tick`
/// is called before each frame and may stop it. `side` is a multiple of the host's m.
///
/// Each sample reads its textures with the footprint of one of m².
pub fn render(
    host: &mut Host,
    camera: deferred_aa::Camera,
    side: u32,
    mut tick: impl FnMut() -> Result<(), ReportError>,
) -> Result<Picture, ReportError> {
    let (width, height) = (host.options.width, host.options.height);
    let steps = (side / host.options.m).max(1);
    let full = Vec2::new(width as f32, height as f32);
    let mut sum = vec![[0.0f64; 3]; (width * height) as usize];
    for step in 0..steps * steps {
        tick()?;
        // In pixels, so that the means of all moves is no move.
        let place = Vec2::new((step % steps) as f32, (step / steps) as f32);
        let at = (place + 0.5 - steps as f32 * 0.5) / side as f32;
        let moved = crop(camera, full, at, full);
        let shot = host.frame_with(moved, plan::grid(Settings::default()))?;
        let picture = host.picture();
        refuse_not_finite(host, moved, shot.statistics.not_finite, &picture)?;
        for (sum, c) in sum.iter_mut().zip(&picture.rgba) {
            (0..3).for_each(|i| sum[i] += f64::from(c[i]));
        }
    }
    let frames = f64::from(steps * steps);
    let rgba = sum.iter().map(|s| [0, 1, 2].map(|i| (s[i] / frames) as f32)).map(|[r, g, b]| [r, g, b, 1.0]);
    Ok(Picture { width, height, rgba: rgba.collect() })
}

/// An error where a sample was not finite, with its pixel. The node has counted such samples and shaded them black.
fn refuse_not_finite(
    host: &mut Host,
    camera: deferred_aa::Camera,
    samples: u32,
    picture: &Picture,
) -> Result<(), ReportError> {
    let what = || "truth".to_owned();
    let infinite = picture.rgba.iter().position(|c| c[..3].iter().any(|c| !c.is_finite()));
    if let Some(at) = infinite {
        let at = at as u32;
        return Err(ReportError::NotFinite { what: what(), pixel: Some((at % picture.width, at / picture.width)) });
    }
    if samples == 0 {
        return Ok(());
    }
    let pixel = find_not_finite(host, camera, (picture.width, picture.height))?;
    Err(ReportError::NotFinite { what: what(), pixel })
}

/// The pixel of a sample that is not finite: the picture is halved again and again, keeping the half that has one.
fn find_not_finite(
    host: &mut Host,
    camera: deferred_aa::Camera,
    (width, height): (u32, u32),
) -> Result<Option<(u32, u32)>, ReportError> {
    let vector = |x: u32, y: u32| Vec2::new(x as f32, y as f32);
    let mut has_one = |r: Rect| {
        host.resize(r.width, r.height)?;
        let part = crop(camera, vector(width, height), vector(r.x, r.y), vector(r.width, r.height));
        let shot = host.frame_with(part, plan::grid(Settings::default()))?;
        Ok::<_, ReportError>(shot.statistics.not_finite > 0)
    };
    let mut rect = Rect { x: 0, y: 0, width, height };
    while rect.width > 1 || rect.height > 1 {
        let [first, second] = halves(rect);
        rect = if has_one(first)? { first } else { second };
    }
    Ok(has_one(rect)?.then_some((rect.x, rect.y)))
}

/// Of the longer side.
fn halves(r: Rect) -> [Rect; 2] {
    if r.width >= r.height {
        let half = r.width / 2;
        [Rect { width: half, ..r }, Rect { x: r.x + half, width: r.width - half, ..r }]
    } else {
        let half = r.height / 2;
        [Rect { height: half, ..r }, Rect { y: r.y + half, height: r.height - half, ..r }]
    }
}
