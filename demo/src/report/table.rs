//! The report on a terminal.

use super::effects::{Effects, Frames};
use super::schema::Report;
use crate::quality::IDENTICAL_DB;

/// A line an entry, in the order of the plan, and how long it all took.
pub fn table(report: &Report) -> String {
    let width = report.entries.iter().map(|e| e.label.chars().count()).max().unwrap_or(0).max(8);
    let mut text = format!(
        "{:<width$}{:>8}{:>9}{:>10}{:>10}{:>10}{:>9}{:>11}{:>11}  frontier\n",
        "", "k", "ratio", "grid dB", "truth dB", "edges dB", "FLIP", "node ms", "total ms"
    );
    for e in &report.entries {
        let (grid, truth) = (e.stats.quality.grid, e.stats.quality.truth);
        let samples = &e.stats.samples;
        text += &format!(
            "{:<width$}{:>8.2}{:>8.1}%{:>10}{:>10}{:>10}{:>9}{:>11}{:>11}  {}\n",
            e.label,
            samples.mean_k,
            samples.ratio * 100.0,
            decibels(grid.and_then(|q| q.psnr_db)),
            decibels(truth.and_then(|q| q.psnr_db)),
            decibels(truth.and_then(|q| q.edge_psnr_db)),
            number(truth.and_then(|q| q.flip_mean), 4),
            number(e.stats.node_ms(), 1),
            number(e.total_ms(), 1),
            frontier(report, &e.id),
        );
    }
    text += "k: samples a pixel; edges: PSNR against the truth where the largest m sees an edge; times: medians\n";
    for row in &report.executions {
        let (beta, relative) = (number(row.beta, 2), number(row.relative_to_loop, 2));
        text += &format!(
            "{:<14} m = {}  {:>5.1} %  node {:>8} ms  {relative} of loop  β {beta}\n",
            format!("{:?}", row.execution),
            row.m,
            row.samples_ratio * 100.0,
            number(row.node_ms.map(|s| s.median), 1)
        );
    }
    if let Some(effects) = &report.effects {
        text += &effects_table(effects);
    }
    let seconds: Vec<_> = report.seconds.iter().map(|(name, s)| format!("{name} {s:.0}")).collect();
    text + &format!("seconds: {}\n", seconds.join(", "))
}

fn effects_table(effects: &Effects) -> String {
    let ms = |frames: &Frames| number(frames.total_ms.map(|s| s.median), 1);
    let mut text = String::new();
    for row in &effects.rows {
        let bytes = row.on.ray_bytes as f64 / f64::from(1 << 20);
        let called_for = if row.needed { "called for" } else { "not paid for" };
        text += &format!(
            "{:<14} {called_for:<13} on {:>8} ms, {bytes:.1} MiB, {} rays; off {:>8} ms, {} bytes\n",
            row.effect,
            ms(&row.on),
            row.on.rays,
            ms(&row.off),
            row.off.ray_bytes
        );
    }
    for row in &effects.tiers {
        let (speed, bytes) = (number(row.rays_per_second.map(|r| r * 1e-6), 2), number(row.bytes_per_triangle, 1));
        let (triangles, built) = (row.triangles, row.build_ms);
        text += &format!(
            "{:<14} {speed} million rays/s, {triangles} triangles built in {built:.0} ms, {bytes} bytes each without vertices\n",
            row.tier
        );
    }
    for row in &effects.mirrors {
        let tiles = row.frames.tiles;
        text += &format!(
            "{:>2} of 64 squares mirror: {} of {} tiles, {} rays, {} ms, {} of none\n",
            row.mirrors,
            tiles.bounce,
            tiles.all,
            row.frames.rays,
            ms(&row.frames),
            number(row.relative, 2)
        );
    }
    text
}

fn frontier(report: &Report, id: &String) -> &'static str {
    match (report.frontier.time.contains(id), report.frontier.samples.contains(id)) {
        (true, true) => "time, samples",
        (true, false) => "time",
        (false, true) => "samples",
        (false, false) => "",
    }
}

fn decibels(db: Option<f64>) -> String {
    match db {
        Some(db) if db >= IDENTICAL_DB => "same".to_owned(),
        db => number(db, 2),
    }
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.digits$}"))
}
