//! What a scene does not pay for: each effect on and off, who traces, and what a corner costs beside a whole.

use super::cost::base;
use crate::host::gpu::Gpu;
use crate::host::rays;
use crate::host::{self, Host, Options};
use crate::measure::stats::{Spread, Stats, times};
use crate::report::ReportError;
use crate::report::folder::Kind;
use crate::report::schema::cost::Base;
use crate::report::schema::effects::{EffectRow, Effects, Frames, MirrorRow, TierRow};
use crate::report::session::Session;
use crate::scene::Camera;
use crate::scene::builtin::{self, SQUARES};
use deferred_aa::rays::RayTier;
use deferred_aa::{Effect, PassKind, Settings, Technique};

/// Measures them. Small, as the curves of the cost are.
pub fn effects(session: &Session) -> Result<Effects, ReportError> {
    let base = base(session);
    let fingerprint = session.fingerprint.with(&("effects", base, session.request.base)).hex();
    if let Some(effects) = session.folder.finished(Kind::Part, "effects", &fingerprint) {
        return Ok(effects);
    }
    let effects =
        Effects { base, rows: rows(session, base)?, tiers: tiers(session, base)?, mirrors: mirrors(session, base)? };
    session.folder.keep(Kind::Part, "effects", &fingerprint, &effects)?;
    Ok(effects)
}

fn rows(session: &Session, base: Base) -> Result<Vec<EffectRow>, ReportError> {
    let scene = &session.scene;
    let sent = rays::reflective(scene);
    let called_for = [
        !rays::casting_lights(scene, scene.sun.is_some_and(|s| s.casts)).is_empty(),
        !sent.is_empty(),
        sent.iter().any(|&i| scene.materials[i as usize].transmission > 0.0),
    ];
    let (on, off) = (Effect::On, Effect::Off);
    let switches = [[off, off, off], [on, off, off], [off, on, off], [off, off, on]];
    let mut variants = Vec::new();
    for [shadows, reflections, refraction] in switches {
        // A host each: buffers stay once they are there.
        let host = session.host_of(scene.clone(), base.m, (base.width, base.height))?;
        let technique = Technique::Windowed;
        variants.push((host, Settings { technique, shadows, reflections, refraction, ..session.request.base }));
    }
    let mut all = frames(session, base.frames, &session.view, &mut variants)?.into_iter().map(|(frames, _)| frames);
    let Some(off) = all.next() else { return Ok(Vec::new()) };
    let names = ["shadows", "reflections", "refraction"];
    let rows = names.into_iter().zip(called_for).zip(all).map(|((effect, needed), on)| EffectRow {
        effect: effect.to_owned(),
        needed,
        on,
        off: off.clone(),
    });
    Ok(rows.collect())
}

fn mirrors(session: &Session, base: Base) -> Result<Vec<MirrorRow>, ReportError> {
    let side = if session.software() { 256 } else { 1024 };
    let counts = [0, 1, SQUARES];
    let mut variants = Vec::new();
    for count in counts {
        let host = session.host_of(builtin::mirrored(count), base.m, (side, side))?;
        variants.push((host, Settings { technique: Technique::Windowed, ..session.request.base }));
    }
    let view = builtin::mirrored(0).default_camera();
    let all = frames(session, base.frames, &view, &mut variants)?;
    let without = all.first().map(|(_, totals)| totals.clone()).unwrap_or_default();
    let rows = counts.into_iter().zip(all).map(|(mirrors, (frames, totals))| {
        let ratios = totals.iter().zip(&without).map(|(with, without)| with / without);
        MirrorRow { mirrors, frames, relative: Spread::of(ratios.collect()).map(|s| s.median) }
    });
    Ok(rows.collect())
}

/// One frame of each that warms up, then rounds in which they alternate. Also the times of the rounds.
fn frames(
    session: &Session,
    rounds: u32,
    view: &Camera,
    variants: &mut [(Host, Settings)],
) -> Result<Vec<(Frames, Vec<f64>)>, ReportError> {
    let mut shots = vec![Vec::new(); variants.len()];
    for round in 0..=rounds {
        for ((host, settings), shots) in variants.iter_mut().zip(&mut shots) {
            session.tick()?;
            let shot = host.frame(view, *settings)?;
            if round > 0 {
                shots.push(shot);
            }
        }
    }
    let all = variants.iter().zip(&shots).filter_map(|((host, settings), shots)| {
        let stats = Stats::new(host, *settings, shots, None)?;
        let totals = shots.iter().filter_map(|shot| times(std::slice::from_ref(shot)).get("total").map(|s| s.median));
        let frames = Frames {
            total_ms: stats.time_ms.get("total").copied(),
            ray_bytes: stats.memory_bytes.rays,
            rays: stats.rays.shadow + stats.rays.reflection + stats.rays.refraction,
            passes: stats.passes.clone(),
            tiles: stats.tiles,
        };
        Some((frames, totals.collect()))
    });
    Ok(all.collect())
}

/// Shadow rays from the first samples, which all lights that can cast are asked for.
fn tiers(session: &Session, base: Base) -> Result<Vec<TierRow>, ReportError> {
    let request = &session.request;
    let mut rows = Vec::new();
    for (tier, name) in [(RayTier::Software, "software"), (RayTier::Query, "query")] {
        let gpu = if tier == request.rays {
            Ok(session.gpu.clone())
        } else {
            Gpu::new(session.gpu.adapter.clone(), &host::descriptor(1, request.textures, tier, request.gbuffer))
        };
        // An adapter without ray query has no row for it.
        let Ok(gpu) = gpu else { continue };
        let options = Options {
            width: base.width,
            height: base.height,
            m: 1,
            textures: request.textures,
            stall: 1,
            anisotropy: request.anisotropy,
            rays: tier,
            traces: true,
            gbuffer: request.gbuffer,
        };
        let mut host = Host::new(gpu, session.scene.clone(), options)?;
        let settings = Settings { technique: Technique::Single, shadows: Effect::On, ..Settings::default() };
        session.frame(&mut host, settings)?;
        let mut speeds = Vec::new();
        for _ in 0..base.frames {
            let shot = session.frame(&mut host, settings)?;
            let trace = shot.statistics.passes.iter().find(|p| p.kind == PassKind::Trace).and_then(|p| p.milliseconds);
            speeds.extend(trace.map(|ms| f64::from(shot.statistics.shadow_rays) / (ms * 1e-3)));
        }
        let Some(scene) = &host.rays else { continue };
        rows.push(TierRow {
            tier: name.to_owned(),
            rays_per_second: Spread::of(speeds).map(|s| s.median).filter(|&s| s > 0.0),
            triangles: scene.triangles,
            bytes_per_triangle: (tier == RayTier::Software && scene.triangles > 0)
                .then(|| scene.bytes as f64 / scene.triangles as f64),
            build_ms: scene.built_in.as_secs_f64() * 1e3,
        });
    }
    Ok(rows)
}
