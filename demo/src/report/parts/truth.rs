//! The truth: a regular grid of many samples in each pixel, all shaded, and their mean.

use crate::host::raster::crop;
use crate::host::{self, Host};
use crate::measure::reference::{self, MovedFrames};
use crate::picture::Picture;
use crate::report::ReportError;
use crate::report::cache::{About, Cache};
use crate::report::schema::TruthInfo;
use crate::report::session::Session;
use deferred_aa::{DeferredAa, Needs, Rect, Settings, Technique};
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
            let picture =
                render(&mut host, session.camera(), side, reference::truth(session.request.base), || session.tick())?;
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
    let descriptor = host::descriptor(m, session.request.textures, session.request.rays, session.request.gbuffer);
    let full = Settings { technique: Technique::Full, ..Default::default() };
    let requirements = DeferredAa::requirements(&session.gpu.adapter, &descriptor);
    let memory = requirements.memory(width, height, &full, &Needs::default());
    let longest = u64::from(width.max(height)) * u64::from(m);
    longest <= u64::from(session.gpu.device.limits().max_texture_dimension_2d)
        && memory.gbuffer + memory.scratch <= MOST_BYTES
}

/// The mean of `side`² samples a pixel on a regular grid: frames of all m² samples, each moved by part of a sample.
/// `tick` is called before each frame and may stop it. `side` is a multiple of the host's m.
///
/// Each sample reads its textures with the footprint of one of m².
pub fn render(
    host: &mut Host,
    camera: deferred_aa::Camera,
    side: u32,
    settings: Settings,
    mut tick: impl FnMut() -> Result<(), ReportError>,
) -> Result<Picture, ReportError> {
    let (width, height) = (host.options.width, host.options.height);
    let mut frames = MovedFrames::new((width, height), side, host.options.m);
    let (_, all) = frames.progress();
    for _ in 0..all {
        tick()?;
        let moved = frames.moved(camera);
        let shot = host.frame_with(moved, settings)?;
        let picture = host.picture();
        refuse_not_finite(host, moved, settings, shot.statistics.not_finite, &picture)?;
        frames.add(&picture);
    }
    Ok(frames.mean())
}

/// An error where a sample was not finite, with its pixel. The node has counted such samples and shaded them black.
fn refuse_not_finite(
    host: &mut Host,
    camera: deferred_aa::Camera,
    settings: Settings,
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
    let pixel = find_not_finite(host, camera, settings, (picture.width, picture.height))?;
    Err(ReportError::NotFinite { what: what(), pixel })
}

/// The pixel of a sample that is not finite: the picture is halved again and again, keeping the half that has one.
fn find_not_finite(
    host: &mut Host,
    camera: deferred_aa::Camera,
    settings: Settings,
    (width, height): (u32, u32),
) -> Result<Option<(u32, u32)>, ReportError> {
    let vector = |x: u32, y: u32| Vec2::new(x as f32, y as f32);
    let mut has_one = |r: Rect| {
        host.resize(r.width, r.height)?;
        let part = crop(camera, vector(width, height), vector(r.x, r.y), vector(r.width, r.height));
        let shot = host.frame_with(part, settings)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::Options;
    use crate::host::gpu::{self, Gpu};
    use crate::host::raster::node_camera;
    use crate::measure::quality;
    use crate::scene::builtin::builtin;
    use crate::scene::{Light, LightKind, Scene};

    use deferred_aa::TextureTier;
    use glam::{Mat4, Vec3};

    const SIZE: (u32, u32) = (64, 36);

    fn host(scene: Scene, m: u32) -> Host {
        let textures = TextureTier::Arrays;
        let (width, height) = SIZE;
        let options = Options { textures, ..Options::new(width, height, m) };
        let gpu = Gpu::new(gpu::choose(None).unwrap(), &options.descriptor()).unwrap();
        Host::new(gpu, scene, options).unwrap()
    }

    fn rendered(m: u32, side: u32) -> Picture {
        let scene = builtin("cornell").unwrap();
        let camera = node_camera(&scene.default_camera(), SIZE.0, SIZE.1);
        render(&mut host(scene, m), camera, side, reference::grid(Settings::default()), || Ok(())).unwrap()
    }

    /// The same places by another way: m = 4, and the moves spelled out in clip space.
    fn brute_force() -> Picture {
        let scene = builtin("cornell").unwrap();
        let still = node_camera(&scene.default_camera(), SIZE.0, SIZE.1);
        let mut host = host(scene, 4);
        let mut sum = vec![[0.0f64; 4]; (SIZE.0 * SIZE.1) as usize];
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            // Place 4a + i of 16 is this far from place a of 4.
            let pixels = |i: i32| (i as f32 + 0.5) / 16.0 - 0.5 / 4.0;
            let clip = Vec3::new(-pixels(i) * 2.0 / SIZE.0 as f32, pixels(j) * 2.0 / SIZE.1 as f32, 0.0);
            let clip_from_view = Mat4::from_translation(clip) * still.clip_from_view;
            host.frame_with(deferred_aa::Camera { clip_from_view, ..still }, reference::grid(Settings::default()))
                .unwrap();
            for (sum, c) in sum.iter_mut().zip(host.picture().rgba) {
                sum.iter_mut().zip(c).for_each(|(s, c)| *s += f64::from(c) / 16.0);
            }
        }
        Picture::new(SIZE.0, SIZE.1, sum.iter().map(|s| s.map(|c| c as f32)).collect()).unwrap()
    }

    #[test]
    fn a_truth_is_the_mean_over_its_grid() {
        let (truth, brute) = (rendered(8, 16), brute_force());
        let finest = rendered(8, 32);
        let grid = rendered(4, 4);
        let to_finest = |p: &Picture| quality::psnr(p, &finest).unwrap();
        let same = quality::psnr(&truth, &brute).unwrap();
        // Rasters of other sizes snap vertices to other places, and the target has halves.
        assert!(same > 55.0, "{same} dB between two ways to the same samples");
        assert!(to_finest(&truth) > to_finest(&grid) + 6.0, "{} and {} dB", to_finest(&truth), to_finest(&grid));
    }

    #[test]
    fn a_sample_that_is_not_finite_is_found() {
        let mut scene = builtin("flat").unwrap();
        let place = Vec3::new(-1.0, 0.7, 0.02);
        // Infinite where it shines, which is in less than a pixel.
        scene.lights.push(Light {
            kind: LightKind::Point,
            position: place,
            direction: Vec3::NEG_Y,
            intensity: Vec3::splat(1e38),
            range: 0.08,
            casts: false,
        });
        let camera = node_camera(&scene.default_camera(), SIZE.0, SIZE.1);
        let view_from_world = camera.world_from_view.inverse();
        let seen = camera.clip_from_view.project_point3(view_from_world.transform_point3(place.with_z(0.0)));
        let expected = ((seen.x + 1.0) * 0.5 * SIZE.0 as f32, (1.0 - seen.y) * 0.5 * SIZE.1 as f32);
        let error =
            render(&mut host(scene, 4), camera, 8, reference::grid(Settings::default()), || Ok(())).unwrap_err();
        let ReportError::NotFinite { pixel: Some((x, y)), .. } = error else { panic!("{error}") };
        let near = |a: u32, b: f32| (a as f32 + 0.5 - b).abs() < 1.0;
        assert!(near(x, expected.0) && near(y, expected.1), "({x}, {y}) for {expected:?}");
        assert!(error.to_string().contains(&format!("({x}, {y})")), "{error}");
    }
}
