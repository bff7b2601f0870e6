"use strict";
// The first of the page's scripts: pure functions of report.json. Nothing here touches the document.

const MISSING = "–";
const NBSP = "\u00a0";
const IDENTICAL_DB = 199.99;
const CLOSE = 1.1; // as accurate as Full: an error at most this much greater
const GRID_GOOD = 0.01; // 40 dB: good enough where there is no truth
const EQUAL_TIME = 1.05;
const STEADY = 1.3; // a time whose slowest frames take more than this over its fastest bears no advice
const EXPLAINED = 0.9; // a fit of a lower r² bears none either
const PASS_ORDER = ["gbuffer", "classify", "trace first", "reflect first", "refine rays", "refine", "points", "lattice_to_pixels", "first",
  "metrics", "plan", "select", "cover", "list", "trace", "reflect", "shade", "quadrants", "reconstruct", "light", "resolve", "fxaa", "smaa", "taa",
  "msaa2x", "msaa4x", "msaa8x"];
const KINDS = { windowed: "Windowed", selective: "Selective", multiresolution: "MultiResolution", surfaces: "Surfaces",
  reconstructed: "Reconstructed", full: "Full", single: "Single", fxaa: "FXAA", smaa: "SMAA", taa: "TAA",
  msaa2x: "MSAA 2x", msaa4x: "MSAA 4x", msaa8x: "MSAA 8x", other: "other" };
const MEASURES = {
  rmse: { name: "rMSE", of: (q) => fromDb(q.psnr_db) },
  edge: { name: "rMSE on edges", of: (q) => fromDb(q.edge_psnr_db) },
  flip: { name: "FLIP", of: (q) => q.flip_mean },
  ssim: { name: "1 − SSIM", of: (q) => (finite(q.ssim) ? Math.max(0, 1 - q.ssim) : null) },
};
const AGAINST = { truth: "the truth", grid: "the grid of the same m" };

const finite = Number.isFinite;
const list = (value) => (Array.isArray(value) ? value : []);
const join = (parts) => [parts.slice(0, -1).join(", "), parts[parts.length - 1]].filter(Boolean).join(" and ");
const fromDb = (db) => (!finite(db) ? null : db >= IDENTICAL_DB ? 0 : 10 ** (-db / 20));
const least = (items, key) => items.reduce((best, e) => (best && key(best) <= key(e) ? best : e), null);
const quotient = (a, b) => (finite(a) && finite(b) && b > 0 ? a / b : null);

/** Three significant digits; no exponent from 0.0001 to a billion. */
function number(x) {
  if (!finite(x)) return MISSING;
  const size = Math.abs(x), sign = x < 0 ? "−" : "";
  if (size === 0) return "0";
  if (size < 1e-4 || size >= 1e9) return sign + powerOfTen(size);
  if (size < 100) return sign + size.toPrecision(3);
  return sign + String(Math.round(size)).replace(/\B(?=(\d{3})+$)/g, size >= 1e4 ? "\u202f" : "");
}

function powerOfTen(size) {
  const power = Math.floor(Math.log10(size));
  const raised = [...String(power)].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("");
  return `${(size / 10 ** power).toFixed(1)}·10${raised}`;
}

/** For axes: no digit that says nothing. */
function tickLabel(x) {
  if (x >= 1e6) return `${Number((x / 1e6).toPrecision(3))}M`;
  if (x >= 1e4) return `${Number((x / 1e3).toPrecision(3))}k`;
  return x === 0 || x >= 1e-4 ? String(Number(x.toPrecision(3))) : powerOfTen(x).replace("1.0·", "");
}

const unit = (text, name) => (text === MISSING ? text : text + NBSP + name);
const fixed = (x, digits) => (finite(x) ? x.toFixed(digits).replace(/^-(0\.?0*)$/, "$1").replace("-", "−") : MISSING);
const ms = (x) => unit(number(x), "ms");
const percent = (ratio) => (finite(ratio) ? unit(fixed(ratio * 100, 1), "%") : MISSING);
const decibels = (db) => (db >= IDENTICAL_DB ? "identical" : unit(fixed(db, 1), "dB"));
const megabytes = (bytes) => (finite(bytes) ? unit(number(bytes / 1e6), "MB") : MISSING);
const plain = (x) => (finite(x) ? String(x) : MISSING);
const words = (value) => String(value ?? "").replaceAll("_", " ");
const capital = (text) => text.replace(/^./, (c) => c.toUpperCase());

/** A ratio near 1 needs its second decimal; one far from it does not. */
function times(x) {
  if (!finite(x)) return MISSING;
  return `${x < 0.1 ? x.toPrecision(2) : x < 2 ? x.toFixed(2) : x < 10 ? x.toFixed(1) : Math.round(x)}×`;
}

/** An entry of the report with what the page asks of it. */
function readEntry(raw, index) {
  const m = finite(raw.m) ? raw.m : null;
  const label = raw.label || raw.id || "entry";
  const sized = m && raw.technique !== "single" && raw.role !== "peer" && !/\bm\s*=/.test(label);
  const ratio = raw.samples?.ratio ?? null;
  return {
    raw, m, label, ratio, id: String(raw.id ?? `entry-${index}`), role: raw.role, preset: raw.preset ?? null,
    name: sized ? `${label} (m${NBSP}=${NBSP}${m})` : label,
    kind: raw.role === "goal" ? "goal" : raw.technique in KINDS ? raw.technique : "other",
    total: raw.time_ms?.total?.median ?? null,
    node: raw.time_ms?.node?.median ?? null,
    spread: raw.time_ms?.total ?? null,
    wavers: quotient(raw.time_ms?.total?.p95, raw.time_ms?.total?.min) ?? 1,
    passes: passTimes(raw.time_ms),
    perPixel: raw.samples?.mean_k ?? (finite(ratio) && m ? ratio * m * m : null),
    quality: { truth: raw.quality?.truth ?? {}, grid: raw.quality?.grid ?? {} },
    aboveOracle: raw.oracle?.mean_of_k?.achieved_over_oracle ?? null,
    aboveGroups: raw.oracle?.groups?.achieved_over_oracle ?? null,
  };
}

/** Medians by pass; those of all lattices together. */
function passTimes(spreads) {
  const all = {};
  for (const [name, spread] of Object.entries(spreads ?? {})) {
    const pass = name.replace(/ (1\/\d|shifted)$/, "");
    if (pass !== "node" && pass !== "total") all[pass] = (all[pass] ?? 0) + (spread?.median ?? 0);
  }
  return all;
}

const errorOf = (e, { measure, against }) => MEASURES[measure].of(e.quality[against]) ?? null;
const isAdaptive = (e) => e.role === "technique" && e.kind !== "full" && e.kind !== "single";

function readReport(report) {
  const entries = list(report.entries).map(readEntry);
  const measured = (against) => entries.some((e) => finite(errorOf(e, { measure: "rmse", against })));
  const model = {
    report, entries,
    byId: new Map(entries.map((e) => [e.id, e])),
    software: Boolean(report.adapter?.software),
    against: measured("truth") || !measured("grid") ? "truth" : "grid",
    againstSamples: measured("grid") ? "grid" : "truth",
    timed: entries.some((e) => finite(e.total)),
  };
  const windowed = entries.filter((e) => e.kind === "windowed");
  model.baseline = windowed.find((e) => e.preset === "balanced") ?? windowed[0] ?? null;
  model.cost = (e) => (model.timed ? e.total : e.perPixel);
  model.costWord = model.timed ? "time" : "samples";
  model.error = (e) => errorOf(e, { measure: "rmse", against: model.against });
  return Object.assign(model, choose(model));
}

// ---- Frontier and choice ------------------------------------------------------------------------------------------

/** Of {entry, x, y}: those that no other is below in one and not above in the other. Goals are not choices. */
function frontier(points) {
  const rivals = points.filter((p) => p.entry.role !== "goal");
  const beaten = (p) => rivals.some((o) => o.x <= p.x && o.y <= p.y && (o.x < p.x || o.y < p.y));
  return byCost(rivals.filter((p) => !beaten(p)));
}
const byCost = (points) => [...points].sort((a, b) => a.x - b.x || b.y - a.y);

/**
 * The frontiers of a plot. Against the truth there is one: the program's own where it has one for this plot, so that
 * page and report.json never differ. Grids of different m are different references: each m has its own frontier.
 */
function frontiers(model, points, cost, { measure, against }) {
  if (against === "grid") {
    const sizes = [...new Set(points.map((p) => p.entry.m))];
    return sizes.map((m) => frontier(points.filter((p) => p.entry.m === m)));
  }
  const given = new Set(list(model.report.frontier?.[cost]));
  const known = points.filter((p) => given.has(p.entry.id));
  return [measure === "rmse" && known.length ? byCost(known) : frontier(points)];
}

/** Of a frontier, the inner point furthest below the straight line between its ends, all logarithmic. */
function knee(points) {
  const at = points.map((p) => ({ p, x: Math.log(p.x), y: Math.log(Math.max(p.y, 1e-6)) }));
  const first = at[0], last = at[at.length - 1];
  if (at.length < 3) return first?.p ?? null;
  const slope = (last.y - first.y) / (last.x - first.x);
  return least(at.slice(1, -1), (q) => q.y - first.y - slope * (q.x - first.x)).p;
}

/**
 * candidates: what can be compared. best: the most accurate Full. pick: the cheapest that is about as accurate, best
 * itself if nothing is. trade: the knee of what is cheaper than best. Without a truth only the greatest m is compared,
 * with its grid.
 */
function choose({ entries, cost, error, against }) {
  const whole = entries.filter((e) => e.role !== "goal" && cost(e) > 0 && finite(error(e)));
  const m = Math.max(...whole.map((e) => e.m ?? 0));
  const candidates = whole.filter((e) => against === "truth" || e.m === m || e.kind === "single" || e.role === "peer");
  const best = least(candidates.filter((e) => e.kind === "full"), error);
  const limit = against === "grid" ? GRID_GOOD : best && error(best) * CLOSE;
  const points = frontier(candidates.map((entry) => ({ entry, x: cost(entry), y: error(entry) })));
  const trade = knee(points.filter((p) => !best || p.x <= cost(best)))?.entry ?? null;
  const pick = best ? least(candidates.filter((e) => error(e) <= limit), cost) : trade;
  return { candidates, best, pick, trade: trade === best ? null : trade };
}

// ---- The three sentences: [heading, text], with **strong** parts --------------------------------------------------

function sentences(model) {
  const all = [
    ["Choose, at equal error", chooseSentence(model)],
    ["At equal time", equalTimeSentence(model)],
    ["Against the peers", peersSentence(model)],
    ["Where adaptive pays", `${crossoverText(model)} ${oracleText(model)}`.trim()],
  ];
  const loose = wavering(model);
  if (!loose.length) return all;
  const worst = least(loose, (e) => -e.wavers), others = loose.length - 1;
  const warning = `The slowest frames of ${worst.name} took ${times(worst.wavers)} as long as its fastest` +
    (others ? `, and ${others} more of the entries below wavered by over ${STEADY}×` : "") +
    ". What follows is no advice: close what else runs and measure again, with more --frames.";
  return [["Unsteady times", warning, "loose"], ...all.map(([title, text]) => [title, text.replaceAll("**", "")])];
}

/** The entries that the sentences rest on and whose times waver. */
function wavering({ timed, best, pick, trade, candidates }) {
  const basis = candidates.filter((e) => [best, pick, trade].includes(e) || e.role === "peer" || e.kind === "single");
  return timed ? basis.filter((e) => e.wavers > STEADY) : [];
}

/** The best that is to be had in the time of the next smaller supersampling. */
function equalTimeSentence(model) {
  const { candidates, best, cost, error, timed, costWord } = model;
  const full = candidates.filter((e) => e.kind === "full" && e !== best && (!best || cost(e) < cost(best)));
  const budget = least(full, (e) => -cost(e));
  if (!budget) return `Full of a second m was not measured: there is no ${costWord} to compare at.`;
  const rival = least(candidates.filter((e) => isAdaptive(e) && cost(e) <= EQUAL_TIME * cost(budget)), error);
  const within = `In the ${costWord} of ${budget.name}${timed && !model.software ? ` (${ms(cost(budget))})` : ""}`;
  if (!rival) return `${within} nothing adaptive ends.`;
  const errors = `${number(error(rival))} against ${number(error(budget))}`;
  return error(rival) < error(budget) ? `${within} **${rival.name} has the lower error**: ${errors}.` :
    `${within} **it is the best**: the nearest adaptive entry, ${rival.name}, has an error of ${errors}.`;
}

function chooseSentence(model) {
  const { best, pick, trade, cost, costWord, error, against, candidates } = model;
  if (!candidates.length) return `Nothing yet: no entry has both ${model.timed ? "a time" : "samples"} and an error.`;
  const reference = against === "truth" ? "the truth" : "its grid";
  if (!best) {
    return `Full was not measured. The best trade is **${pick.name}**: an error of ${number(error(pick))} ` +
      `against ${reference}.`;
  }
  if (pick !== best) {
    const saved = model.software || !model.timed ? "" : ` (${ms(cost(pick))} instead of ${ms(cost(best))})`;
    return `**${pick.name}**: an error of ${number(error(pick))} against ${reference}, ${besideBest(model)}, for ` +
      `**${times(cost(pick) / cost(best))} its ${costWord}**${saved}.`;
  }
  const reach = against === "grid" ? `has an error against its grid under ${GRID_GOOD}` :
    `comes within 10${NBSP}% of its error of ${number(error(best))}`;
  const other = trade ? ` Cheapest sensible step down: **${trade.name}**, ${shownDb(error(trade))} for ` +
    `${times(cost(trade) / cost(best))} its ${costWord}.` : "";
  return `Most accurate: **${best.name}** (${shownDb(error(best))}); nothing that takes less ${costWord} ${reach}.${other}`;
}

const shownDb = (error) => decibels(error > 0 ? -20 * Math.log10(error) : IDENTICAL_DB);

function besideBest({ against, best, pick, error }) {
  if (against === "grid") return `which ${best.name} computes in full`;
  const more = Math.round((error(pick) / error(best) - 1) * 100);
  return more === 0 ? `that of ${best.name}` : `${Math.abs(more)}${NBSP}% ${more > 0 ? "above" : "below"} ${best.name}`;
}

function peersSentence(model) {
  const peers = model.candidates.filter((e) => e.role === "peer");
  if (!peers.length) return "No peer was measured here.";
  const single = least(model.candidates.filter((e) => e.kind === "single"), model.cost);
  if (!model.timed) return `Without times nothing can be compared at equal time. ${peerErrors(model, peers, single)}.`;
  const found = peers.map((peer) => ({ peer, ...verdict(model, peer, single) }));
  const kinds = [...new Set(found.map((f) => f.kind))];
  const still = peers.some((p) => p.kind === "taa") ? " TAA's error is that of a camera that stands still: see Motion." : "";
  return kinds.map((kind) => VERDICTS[kind](model, found.filter((f) => f.kind === kind), single)).join(" ") + still;
}

/** What the best adaptive entry in the peer's time does against it, overall and on edges. */
function verdict(model, peer, single) {
  const edge = (e) => errorOf(e, { measure: "edge", against: model.against });
  const inTime = model.candidates.filter((e) => isAdaptive(e) && model.cost(e) <= EQUAL_TIME * model.cost(peer));
  const rival = least(inTime, model.error);
  const overall = Boolean(rival) && model.error(rival) < model.error(peer);
  const known = Boolean(rival) && finite(edge(rival)) && finite(edge(peer));
  const edges = known ? edge(rival) < edge(peer) : overall;
  const useless = single && model.error(peer) >= model.error(single);
  const kind = overall && edges ? "won" : overall || edges ? "split" : useless ? "useless" : "lost";
  return { kind, rival, overall, known };
}

const peerNames = (found) => join(found.map((f) => f.peer.name));

function peerErrors(model, peers, single) {
  const errors = `${join(peers.map((p) => p.name))} ${peers.length > 1 ? "have errors" : "has an error"} of ` +
    join(peers.map((p) => number(model.error(p))));
  return single ? `${errors}, Single ${number(model.error(single))}` : errors;
}

const VERDICTS = {
  won: (model, found) => {
    const rivals = [...new Set(found.map((f) => f.rival))], have = rivals.length > 1 ? "have" : "has";
    const where = found.every((f) => f.known) ? ", overall and on edges" : "";
    const errors = (entries) => join(entries.map((e) => number(model.error(e))));
    const winners = join(rivals.map((r) => r.name));
    return `In the time of ${peerNames(found)} **${winners} ${have} the lower error${where}**: ` +
      `${errors(rivals)} against ${errors(found.map((f) => f.peer))}.`;
  },
  split: (model, found) => found.map(({ peer, rival, overall }) => {
    const [ours, theirs] = overall ? ["overall", "on edges"] : ["on edges", "overall"];
    const errors = `${number(model.error(rival))} against ${number(model.error(peer))}`;
    return `In ${peer.name}'s time ${rival.name} has the lower error ${ours}, ` +
      `**but ${peer.name} is better ${theirs}** (overall ${errors}).`;
  }).join(" "),
  lost: (model, found, single) => {
    const peers = found.map((f) => f.peer), [are, their] = peers.length > 1 ? ["are", "their"] : ["is", "its"];
    return `**${peerNames(found)} ${are} better in ${their} time**: ${peerErrors(model, peers, single)}. ` +
      firstBetter(model, peers);
  },
  useless: (model, found, single) => {
    const peers = found.map((f) => f.peer), buy = peers.length > 1 ? "buy" : "buys";
    const cost = join(peers.map((p) => times(model.cost(p) / model.cost(single))));
    const errors = peerErrors(model, peers, single);
    return `**${peerNames(found)} ${buy} nothing here**: ${errors}, at ${cost} Single's time.`;
  },
};

/** The cheapest adaptive entry with a lower error than all these peers. */
function firstBetter(model, peers) {
  const limit = Math.min(...peers.map(model.error)), dearest = least(peers, (p) => -model.cost(p));
  const first = least(model.candidates.filter((e) => isAdaptive(e) && model.error(e) < limit), model.cost);
  if (!first) return "No adaptive entry has a lower error at any time.";
  const below = { 1: "that", 2: "both" }[peers.length] ?? "all of them";
  return `The first adaptive entry below ${below}, ${first.name} with ${number(model.error(first))}, ` +
    `takes ${times(model.cost(first) / model.cost(dearest))} ${dearest.name}'s time.`;
}

const loops = (n) => `${n} light loop${String(n) === "1" ? "" : "s"}`;

function crossoverText({ report }) {
  const rows = list(report.cost?.stall).filter((r) => finite(r.x) && r.windowed_total_ms > 0 && r.full_total_ms > 0);
  if (!rows.length) return "Cost against shading weight was not measured.";
  const ratio = (row) => row.windowed_total_ms / row.full_total_ms, at = report.cost.crossover_stall;
  const first = least(rows, (r) => r.x), last = least(rows, (r) => -r.x), lowest = least(rows, ratio);
  if (!finite(at)) {
    return `**Up to ${loops(last.x)} a sample it does not**: Windowed takes at best ${times(ratio(lowest))} Full's ` +
      `time, with ${loops(lowest.x)}.`;
  }
  const fits = report.cost.fits?.stall ?? {}, r2 = ["windowed_total_ms", "full_total_ms"].map((t) => fits[t]?.r2 ?? 1);
  if (Math.min(...r2) < EXPLAINED) {
    return "The times against shading weight scatter too much to say from where on Windowed pays: measure again, with " +
      "more --frames.";
  }
  const from = at <= first.x ? `**At every shading weight measured**, ${first.x} to ${loops(last.x)} a sample` :
    `**From ${loops(Number(at.toPrecision(2)))} a sample on**`;
  return `${from}: Windowed takes ${times(ratio(first))} Full's time with ${loops(first.x)} and ` +
    `${times(ratio(last))} with ${last.x}.`;
}

function oracleText({ pick, trade, baseline, entries }) {
  const shown = [pick, trade, baseline, ...entries].find((e) => finite(e?.aboveOracle));
  return shown ? `${shown.name} shades **${times(shown.aboveOracle)} the samples** of the bound for its error.` : "";
}

/** The passes that any entry was timed in, in the order of a frame. */
function passesOf(entries) {
  const names = new Set(entries.flatMap((e) => Object.keys(e.passes)));
  const place = (name) => (PASS_ORDER.indexOf(name) + 1 || PASS_ORDER.length + 1);
  return [...names].sort((a, b) => place(a) - place(b) || a.localeCompare(b));
}

// ---- Settings, order, ticks ---------------------------------------------------------------------------------------

/** [path, value] of the settings that act on the entry's technique. */
function settingsOf({ technique, settings }) {
  const flat = (value, path) => (value && typeof value === "object" && !Array.isArray(value) ?
    Object.entries(value).flatMap(([k, v]) => flat(v, [...path, k])) : [[path.join("."), value]]);
  const techniques = ["windowed", "selective", "reconstructed", "multi_resolution"];
  const others = ["technique", "view", ...techniques.filter((t) => t.replace("_", "") !== technique)];
  return flat(settings ?? {}, []).filter(([path]) => !others.includes(path.split(".")[0]));
}

/** The settings of an entry that differ from the default entry's, as text. */
function differences(model, entry) {
  if (!model.baseline || entry.kind === "full" || entry.kind === "single" || entry.role === "peer") return [];
  const base = new Map(settingsOf(model.baseline.raw));
  return settingsOf(entry.raw).filter(([path, v]) => base.has(path) && base.get(path) !== v)
    .map(([path, v]) => `${words(path.split(".").pop())} ${typeof v === "number" ? number(v) : words(v)}`);
}

/** Sorted copy; what is missing stays last either way. */
function sorted(items, value, descending) {
  const absent = (e) => value(e) === null || value(e) === undefined || Number.isNaN(value(e));
  const up = (a, b) => (typeof a === "string" ? a.localeCompare(b, "en", { numeric: true }) : a - b);
  const compare = (a, b) => (descending ? up(b, a) : up(a, b));
  return [...items].sort((a, b) => absent(a) - absent(b) || (absent(a) ? 0 : compare(value(a), value(b))));
}

/** Ticks at 1, 2 and 5 of each decade, more or fewer as there is room; even steps where the range is short. */
function logTicks(low, high, room) {
  const decades = [];
  for (let d = Math.floor(Math.log10(low)); d <= Math.ceil(Math.log10(high)); d++) decades.push(d);
  const within = (steps, every = 1) => decades.filter((d) => d % every === 0)
    .flatMap((d) => steps.map((s) => Number(`${s}e${d}`))).filter((v) => v >= low * 0.999 && v <= high * 1.001);
  const enough = [within([1, 2, 5]), within([1, 5]), within([1]), within([1], 2), within([1], 3),
    within([1, 1.5, 2, 3, 4, 5, 7])].find((ticks) => ticks.length <= room && ticks.length >= 3);
  if (enough) return enough;
  const power = 10 ** Math.floor(Math.log10((high - low) / room));
  const step = [1, 2, 5, 10].map((s) => s * power).find((s) => (high - low) / s <= room);
  const even = Array.from({ length: room + 1 }, (_, i) => Number(((Math.ceil(low / step) + i) * step).toPrecision(6)));
  return even.filter((v) => v > 0 && v <= high);
}

// Outside of a page: for tests.
if (typeof module !== "undefined") {
  module.exports = { readReport, sentences, frontiers, logTicks, number, times, sorted, differences };
}
