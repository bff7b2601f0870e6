//! The report on a terminal.

use super::schema::Report;
use super::schema::effects::{Effects, Frames};
use super::schema::papers::{Papers, Printed, Row, Table};
use crate::measure::quality::IDENTICAL_DB;
use crate::pass_kind::PARTS;

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
    if let Some(papers) = &report.papers {
        text += &papers_text(papers);
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
            tiles.reflect,
            tiles.all,
            row.frames.rays,
            ms(&row.frames),
            number(row.relative, 2)
        );
    }
    text
}

fn papers_text(papers: &Papers) -> String {
    let mut text = String::new();
    for table in &papers.tables {
        text += &if table.timed { timed_table(table) } else { curves_table(table) };
        if table.sparse {
            text += &parts_table(table);
        }
    }
    text + "the paper's: dB, samples and speed, or samples at same dB, or frames a second and speed, from its least to its greatest scene; \
            speed: frames a second over those of the row that samples are over; over dB: PSNR against that row; at same dB: samples \
            over those of colour alone there, between its points\n"
}

fn width(table: &Table<Row>) -> usize {
    table.rows.iter().map(|r| r.planned.label.chars().count()).chain([table.title.chars().count()]).max().unwrap_or(0)
}

/// What a table is over, as a column's name.
fn of_row(table: &Table<Row>) -> String {
    let over = table.rows.iter().find(|r| r.planned.id == table.over);
    over.map_or("samples".to_owned(), |r| format!("of {}", r.planned.label))
}

/// Samples, times and speeds, and the paper's over its scenes.
fn timed_table(table: &Table<Row>) -> String {
    let width = width(table);
    let (sparse, over) = (table.sparse, of_row(table));
    let over_width = over.chars().count().max(11) + 2;
    let wide = over_width - 1;
    let mut text = format!(
        "{:<width$}{:>10}{}{over:>over_width$}{:>11}{:>8}{:>8}  the paper's\n",
        table.title,
        "truth dB",
        if sparse { format!("{:>10}", "over dB") } else { String::new() },
        "total ms",
        "speed",
        "node"
    );
    for row in &table.rows {
        text += &format!(
            "{:<width$}{:>10}{}{:>wide$}%{:>11}{:>8}{:>8}",
            row.planned.label,
            decibels(Some(row.truth_db)),
            if sparse { format!("{:>10}", decibels(row.over_db)) } else { String::new() },
            number(row.samples.map(|s| s * 100.0), 1),
            number(row.time_ms.get("total").map(|s| s.median), 1),
            number(row.speed, 2),
            number(row.node_speed, 2),
        );
        let printed = &row.planned.printed;
        if sparse && !printed.is_empty() {
            text += &format!("  {} fps, {}", span(printed, |p| p.fps, 1), span(printed, |p| p.speed, 2));
        } else if !printed.is_empty() {
            let [db, samples] = [span(printed, |p| p.psnr_db, 1), span(printed, |p| Some(p.samples? * 100.0), 1)];
            text += &format!("  {db}, {samples}%, {}", span(printed, |p| p.speed, 2));
        }
        text += "\n";
    }
    text
}

/// Median milliseconds of the node's passes by what they are for.
fn parts_table(table: &Table<Row>) -> String {
    let width = width(table);
    let mut text = format!("{:<width$}", "ms of the node's passes for");
    PARTS.iter().for_each(|part| text += &format!("{part:>11}"));
    text += "\n";
    for row in &table.rows {
        text += &format!("{:<width$}", row.planned.label);
        PARTS.iter().for_each(|part| text += &format!("{:>11}", number(row.parts_ms.get(*part).map(|s| s.median), 2)));
        text += "\n";
    }
    text
}

/// Curves of PSNR over samples, and the paper's.
fn curves_table(table: &Table<Row>) -> String {
    let width = width(table);
    let mut text = format!(
        "{:<width$}{:>10}{:>13}{:>12}{}\n",
        table.title,
        "truth dB",
        of_row(table),
        "at same dB",
        if table.rows.iter().all(|r| r.planned.printed.is_empty()) { "" } else { "  the paper's" }
    );
    for row in &table.rows {
        let printed = row.planned.printed.first();
        let of = |value: fn(&Printed) -> Option<f64>| printed.and_then(value);
        text += &format!(
            "{:<width$}{:>10}{:>12}%{:>12}",
            row.planned.label,
            decibels(Some(row.truth_db)),
            number(row.samples.map(|s| s * 100.0), 1),
            number(row.same_psnr, 2)
        );
        if printed.is_some() {
            let [db, samples] = [number(of(|p| p.psnr_db), 1), number(of(|p| Some(p.samples? * 100.0)), 1)];
            text += &format!("  {db}, {samples}%, {}", number(of(|p| p.same_psnr), 2));
        }
        text += "\n";
    }
    text
}

/// From the least to the greatest.
fn span(printed: &[Printed], value: impl Fn(&Printed) -> Option<f64>, digits: usize) -> String {
    let mut all: Vec<_> = printed.iter().filter_map(value).collect();
    all.sort_by(f64::total_cmp);
    match (all.first(), all.last()) {
        (Some(least), Some(most)) if number(Some(*least), digits) != number(Some(*most), digits) => {
            format!("{least:.digits$} to {most:.digits$}")
        }
        (least, _) => number(least.copied(), digits),
    }
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
