//! The figures on a terminal.

use super::schema::{Bench, Measured, OVER, Row};
use crate::measure::quality::IDENTICAL_DB;
use std::fmt::Write as _;

/// What it ran on.
pub fn heading(bench: &Bench) -> String {
    let adapter = &bench.adapter;
    let (width, height) = bench.size;
    let kind = if bench.software { "; a CPU stands in for a GPU: only ratios of times count" } else { "" };
    format!(
        "{} ({}, {}), {}, {width}×{height}, deferred-aa {}{kind}",
        adapter.name, adapter.driver, adapter.backend, bench.system, bench.version
    )
}

/// A line for each entry of the cell that was measured last; `plain` is over the frame of m = 1.
pub fn table(bench: &Bench) -> String {
    let Some(measured) = bench.measured.last() else { return String::new() };
    let plain = bench.plain(measured).and_then(|row| row.ms("total"));
    let mut text = format!("\n{} ({} G-buffer)\n", measured.cell.name(), measured.gbuffer);
    let _ = writeln!(
        text,
        "{:<20}{:>7}{:>8}{:>7}{:>8}{:>10}{:>9}{:>9}{:>8}{:>8}{:>8}  passes, ms",
        "", "k", "lit", "taps", "PSNR", "gbuffer", "node", "frame", "plain", "MB", "Mrays/s"
    );
    for row in &measured.rows {
        let times = plain.zip(row.ms("total")).map(|(plain, total)| total / plain);
        let _ = writeln!(
            text,
            "{:<20}{:>7.2}{:>7.1}%{:>7.1}{:>8}{:>10}{:>9}{:>9}{:>8}{:>8.0}{:>8}  {}{}",
            row.label,
            row.k,
            row.ratio * 100.0,
            row.taps,
            decibels(row.psnr_db),
            number(row.ms("gbuffer"), 2),
            number(row.ms("node"), 2),
            number(row.ms("total"), 2),
            times.map_or("-".to_owned(), |t| format!("×{t:.2}")),
            (row.gbuffer_bytes + row.other_bytes) as f64 * 1e-6,
            number(row.rays_per_second.map(|s| s * 1e-6), 1),
            passes(row),
            row.doubts().map(|doubt| format!("  {doubt}")).collect::<String>(),
        );
    }
    text
}

/// What the times mean, once, and the ratios that decide.
pub fn ratios(bench: &Bench) -> String {
    let mut text =
        "\nk: lit samples a pixel; lit: of all m²; taps: material evaluations a pixel; PSNR: to Full of the \
                    same m; times: medians of GPU milliseconds;\nframe: G-buffer and node; plain: frame over that of \
                    m = 1; passes under 2 % are in the file alone;\nUNSTEADY: the slowest frames take over 1.3 times the \
                    fastest; FEW FRAMES: less than three; run it again with nothing beside it, or with more --minutes;\nSHARED RAYS: \
                    more samples were planned than Settings::ray_samples has room for\n\n"
            .to_owned();
    let _ = writeln!(
        text,
        "{:<44}{:>11}{:>11}{:>11}{:>11}{:>13}",
        "over Full of the same m", "windowed", "surfaces", "windowed", "surfaces", "G-buffer's"
    );
    let _ = writeln!(
        text,
        "{:<44}{:>11}{:>11}{:>11}{:>11}{:>13}",
        "(balanced)", "node", "node", "frame", "frame", "share, Full"
    );
    for measured in &bench.measured {
        let Some(full) = measured.row("Full") else { continue };
        let of = |label: &str, name: &str| Some(measured.row(label)?.ms(name)? / full.ms(name)?);
        let share = full.ms("gbuffer").zip(full.ms("total")).map(|(gbuffer, total)| gbuffer / total);
        let percent = |share: Option<f64>| share.map_or("-".to_owned(), |s| format!("{:.0} %", s * 100.0));
        let _ = writeln!(
            text,
            "{:<44}{:>11}{:>11}{:>11}{:>11}{:>13}",
            measured.cell.name(),
            percent(of("Windowed, balanced", "node")),
            percent(of("Surfaces, balanced", "node")),
            percent(of("Windowed, balanced", "total")),
            percent(of("Surfaces, balanced", "total")),
            percent(share),
        );
    }
    let (late, others): (Vec<_>, Vec<_>) = bench.left_out.iter().partition(|left| left.why == OVER);
    for left in others {
        let _ = writeln!(text, "not measured: {} ({})", left.cell.name(), left.why);
    }
    if let Some(first) = late.first() {
        let of = bench.measured.len() + bench.left_out.len();
        let _ = writeln!(
            text,
            "not measured for lack of time: {} of {of}, from '{}' on; allow more --minutes",
            late.len(),
            first.cell.name()
        );
    }
    text
}

impl Bench {
    /// One sample a pixel on the scene and light loop of a cell, without supersampling.
    fn plain(&self, of: &Measured) -> Option<&Row> {
        let cell = &of.cell;
        let same = |m: &&Measured| m.cell.m == 1 && m.cell.scene == cell.scene && m.cell.stall == cell.stall;
        self.measured.iter().find(same)?.rows.first()
    }
}

fn decibels(psnr_db: Option<f64>) -> String {
    number(psnr_db.filter(|&db| db < IDENTICAL_DB), 1)
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.digits$}"))
}

/// The node's passes by their time, the longest first.
fn passes(row: &Row) -> String {
    let is_sum = |name: &str| ["gbuffer", "node", "total"].contains(&name);
    let mut all: Vec<_> = row.time_ms.iter().filter(|(name, _)| !is_sum(name)).collect();
    let least = row.ms("node").unwrap_or(0.0) * 0.02;
    all.retain(|(_, spread)| spread.median >= least);
    all.sort_by(|a, b| b.1.median.total_cmp(&a.1.median));
    let texts: Vec<_> = all.iter().map(|(name, spread)| format!("{name} {:.2}", spread.median)).collect();
    texts.join(", ")
}
