// The last script: tables, pictures, and the order of the page. Needs all others.

// ---- Tables -------------------------------------------------------------------------------------------------------

/**
 * Columns are {name, text(item), class, cell(item): its class, title(item)}; the first heads its row. Text may be
 * a node. heads: <th>s of one's own. row(item): attributes of a row.
 */
function table(caption, columns, items, { tall, heads, row } = {}) {
  const head = (c, i) => heads?.[i] ?? el("th", { scope: "col", class: i ? c.class : "text" }, c.name);
  const body = (item) => columns.map((c, i) => el(i ? "td" : "th",
    { scope: !i && "row", class: c.cell?.(item) ?? c.class, title: c.title?.(item) }, c.text(item)));
  return el("div", { class: tall ? "box tall" : "box", role: "region", "aria-label": caption, tabindex: 0 },
    el("table", null, el("thead", null, el("tr", null, columns.map(head))),
      el("tbody", null, items.map((item) => el("tr", row?.(item), body(item))))));
}

const spreadText = (t) => (t ? `${number(t.min)} to ${ms(t.p95)}` : null);
const timeColumn = (name, field) => ({ name, value: (e) => e[field], text: (e) => number(e[field]),
  title: (e) => spreadText(e.raw.time_ms?.[field]) });
const qualityColumn = (name, to, field, text) => ({ name, value: (e) => e.quality[to][field],
  text: (e) => text(e.quality[to][field]) });
const COLUMNS = [
  { name: "m", value: (e) => e.m, text: (e) => plain(e.m) },
  timeColumn("Total, ms", "total"),
  timeColumn("Node, ms", "node"),
  { name: "Samples a pixel", value: (e) => e.perPixel, text: (e) => number(e.perPixel) },
  { name: "Sample ratio", value: (e) => e.ratio, text: (e) => percent(e.ratio) },
  qualityColumn("PSNR to truth", "truth", "psnr_db", decibels),
  qualityColumn("Edge PSNR to truth", "truth", "edge_psnr_db", decibels),
  qualityColumn("PSNR to grid", "grid", "psnr_db", decibels),
  qualityColumn("Edge PSNR to grid", "grid", "edge_psnr_db", decibels),
  qualityColumn("FLIP to truth", "truth", "flip_mean", number),
  qualityColumn("SSIM to truth", "truth", "ssim", (x) => fixed(x, 4)),
  qualityColumn("Linear rMSE", "truth", "rmse_linear", number),
  { name: "G-buffer", value: (e) => e.raw.memory_bytes?.gbuffer, text: (e) => megabytes(e.raw.memory_bytes?.gbuffer) },
];

function drawTable(host, model) {
  if (!model.entries.length) return host.append(none("No entry was finished."));
  const entryName = { name: "Entry", value: (e) => e.name, text: (e) => el("button",
    { type: "button", "aria-pressed": "false", title: differences(model, e).join(", ") || null }, e.name) };
  const columns = [entryName, ...COLUMNS], faint = beaten(model);
  const heads = columns.map((c, i) => el("th", { scope: "col", class: i ? null : "text", "aria-sort": "none" },
    el("button", { type: "button", click: () => sortBy(c) }, c.name)));
  const row = (e) => ({ "data-id": e.id, class: faint.has(e) && "dominated", click: () => chooseEntry(e.id) });
  const box = table("All entries", columns, model.entries, { tall: true, heads, row });
  const body = box.querySelector("tbody"), rows = new Map(model.entries.map((e, i) => [e, body.children[i]]));
  const sortBy = (column) => {
    const head = heads[columns.indexOf(column)], descending = head.getAttribute("aria-sort") === "ascending";
    for (const h of heads) h.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", descending ? "descending" : "ascending");
    body.append(...sorted(model.entries, column.value, descending).map((e) => rows.get(e)));
  };
  sortBy(columns.find((c) => c.name === (model.timed ? "Total, ms" : "Samples a pixel")));
  host.append(box, faint.size ? el("p", { class: "fine" }, `Grey: beaten in both ${model.costWord} and error.`) : "");
}

/** The entries that could be chosen and are on no frontier. */
function beaten(model) {
  const points = model.candidates.map((entry) => ({ entry, x: model.cost(entry), y: model.error(entry) }));
  const cost = model.timed ? "time" : "samples", state = { measure: "rmse", against: model.against };
  const best = new Set(frontiers(model, points, cost, state).flat().map((p) => p.entry));
  return new Set(model.candidates.filter((e) => !best.has(e)));
}

function drawOracle(host, model) {
  const shown = sorted(model.entries.filter((e) => finite(e.aboveOracle)), (e) => e.aboveOracle);
  if (!shown.length) return host.append(none("No oracle was computed."));
  const exact = list(model.report.oracles).filter((o) => o.exact_coverage).map(({ m, exact_coverage: bound }) => (
    `${percent(bound.ratio)} of the samples for ${decibels(bound.psnr_db)} at m${NBSP}=${NBSP}${plain(m)}`));
  const groups = shown.some((e) => finite(e.aboveGroups)) ? [
    { name: "Groups", text: (e) => percent(e.raw.oracle.groups?.ratio) },
    { name: "Over groups", text: (e) => times(e.aboveGroups) },
  ] : [];
  host.append(table("Achieved over the oracle", [
    { name: "Entry", text: (e) => e.name },
    { name: "Samples", text: (e) => percent(e.ratio) },
    { name: "Oracle", text: (e) => percent(e.raw.oracle.mean_of_k.ratio) },
    { name: "Over oracle", text: (e) => times(e.aboveOracle) },
    ...groups,
  ], shown, { tall: true }), el("p", { class: "fine" }, exact.length ? `Exact coverage: ${join(exact)}.` : ""));
}

function drawExecutions(host, { report }) {
  const rows = sorted(sorted(list(report.executions), (r) => r.relative_to_loop), (r) => r.stall);
  if (!rows.length) return host.append(none("The executions were not measured."));
  const ends = rows.flatMap((r) => [r.relative_to_loop, finding(r.execution)[1]]).filter(finite);
  const end = 1.05 * Math.max(1.25, ...ends), same = (r) => rows.find((o) => o.execution === r.execution);
  host.append(table("Executions", [
    { name: "Execution", text: (r) => capital(words(r.execution)) },
    { name: "m", text: (r) => plain(r.m) },
    { name: "stall", text: (r) => plain(r.stall) },
    { name: "Node time over Loop's", class: "text",
      text: (r) => meter(r.relative_to_loop, finding(r.execution)[1], end) },
    { name: "", text: (r) => ratioText(r.relative_to_loop) },
    { name: "Node, ms", text: (r) => number(r.node_ms?.median), title: (r) => spreadText(r.node_ms) },
    { name: "β", text: (r) => fixed(r.beta, 2) },
    { name: "Sample ratio", text: (r) => percent(r.samples_ratio) },
    { name: "Greatest difference", text: (r) => (r.max_difference === 0 ? "none" : number(r.max_difference)) },
    { name: "The paper's finding", class: "wide", text: (r) => (same(r) === r ? finding(r.execution)[0] : "as above") },
  ], rows, { row: (r) => ({ class: rows[0] !== r && rows[rows.indexOf(r) - 1].stall !== r.stall && "first" }) }));
}

/* What an effect costs, who traces, and what a corner costs beside a whole. */
function drawEffects(host, { report }) {
  const effects = report.effects;
  if (!effects) return host.append(none("The effects were not measured."));
  const time = (f) => number(f.total_ms?.median), spread = (f) => spreadText(f.total_ms);
  const base = effects.base, where = `${base.width} × ${base.height}, m = ${base.m}`;
  host.append(table(`Effects, ${where}`, [
    { name: "Effect", text: (r) => capital(r.effect) },
    { name: "This scene", text: (r) => (r.needed ? "calls for it" : "does not pay for it") },
    { name: "On, ms", text: (r) => time(r.on), title: (r) => spread(r.on) },
    { name: "Off, ms", text: (r) => time(r.off), title: (r) => spread(r.off) },
    { name: "Rays", text: (r) => plain(r.on.rays) },
    { name: "Memory on", text: (r) => megabytes(r.on.ray_bytes) },
    { name: "Memory off", text: (r) => megabytes(r.off.ray_bytes) },
    { name: "Passes that it adds", class: "wide",
      text: (r) => r.on.passes.filter((p) => !r.off.passes.includes(p)).join(", ") },
  ], effects.rows));
  if (effects.tiers.length) host.append(table("Who traces: shadow rays from the first samples", [
    { name: "Traversal", text: (r) => (r.tier === "query" ? "the adapter's ray query" : "WGSL") },
    { name: "Rays a second", text: (r) => (finite(r.rays_per_second) ? `${fixed(r.rays_per_second / 1e6, 2)} M` : "–") },
    { name: "Triangles", text: (r) => plain(r.triangles) },
    { name: "Bytes a triangle, vertices apart",
      text: (r) => (finite(r.bytes_per_triangle) ? fixed(r.bytes_per_triangle, 1) : "the adapter's own") },
    { name: "Build, ms", text: (r) => number(r.build_ms) },
  ], effects.tiers));
  host.append(table("A made wall of 64 squares, some of them mirrors", [
    { name: "Mirrors", text: (r) => plain(r.mirrors) },
    { name: "Tiles with rays", text: (r) => `${plain(r.frames.tiles.reflect)} of ${plain(r.frames.tiles.all)}` },
    { name: "Rays", text: (r) => plain(r.frames.rays) },
    { name: "Frame, ms", text: (r) => time(r.frames), title: (r) => spread(r.frames) },
    { name: "Over none", text: (r) => ratioText(r.relative) },
  ], effects.mirrors));
}

function meter(value, paper, end) {
  const at = (v, tag, className) => finite(v) && v > 0 && css(el(tag, { class: className }), { "--at": v / end });
  return el("span", { class: "meter", "aria-hidden": "true" }, at(value, "i"), at(1, "b"), at(paper, "b", "paper"));
}
const ratioText = (x) => (finite(x) ? `${x.toFixed(2)}×` : MISSING);

function drawPaper(host, model) {
  host.append(table("The paper's Table 1 and ours", [
    { name: "Table 1", text: (r) => r.name },
    { name: "ms", text: (r) => fixed(r.ms, 2) },
    { name: "stalled ms", text: (r) => fixed(r.stalled, 2) },
    { name: "time ratio", text: (r) => ratioText(r.ratio) },
    { name: "stalled ratio", text: (r) => ratioText(r.stalledRatio) },
    { name: `ours, stall ${plain(model.report.stall)}`, class: "ours", text: (r) => ratioText(r.ourRatio) },
    { name: "MSE, 10⁻⁵", text: (r) => fixed(r.mse, 2) },
    { name: "dB, printed", text: (r) => fixed(r.printed, 2) },
    { name: "dB, consistent", text: (r) => fixed(r.db, 2) },
    { name: "ours, to grid", class: "ours", text: (r) => decibels(r.ourDb) },
    { name: "samples", text: (r) => percent(r.samples) },
    { name: "ours", class: "ours", text: (r) => percent(r.ourSamples) },
    { name: "Our entry", class: "text", text: (r) => r.entry?.name ?? "not measured" },
  ], TABLE_1.map((row) => besidePaper(model, row))));
}

function drawGoals(host, { report }) {
  const goals = list(report.goals), value = (x, g) => (g.unit === "ms" ? ms(x) : number(x));
  if (!goals.length) return host.append(none("No goal was asked for."));
  const off = ({ achieved, target }) => (quotient(achieved, target) ?? NaN) * 100 - 100;
  host.append(table("Goals", [
    { name: "Goal", text: (g) => words(g.goal) },
    { name: "Target", text: (g) => value(g.target, g) },
    { name: "Achieved", text: (g) => value(g.achieved, g) },
    { name: "Off by", text: (g) => unit((off(g) > 0 ? "+" : "") + fixed(off(g), 1), "%") },
    { name: "Frames to settle", text: (g) => plain(g.frames) },
    { name: "Met", class: "text", cell: (g) => (g.met ? "text met" : "text missed"),
      text: (g) => ({ true: "yes", false: "no" })[g.met] ?? MISSING },
  ], goals));
}

function drawMotion(host, { entries }) {
  const shown = sorted(entries.filter((e) => e.raw.temporal), (e) => e.raw.temporal.pan?.mean);
  if (!shown.length) return host.append(none("Nothing was measured in motion."));
  const entry = { name: "Entry", text: (e) => e.name };
  const motions = (columns) => ["pan", "turn"].flatMap((motion) => columns(motion, capital(motion)));
  const flicker = motions((motion, name) => [
    { name: `${name}, mean`, text: (e) => number(e.raw.temporal[motion]?.mean) },
    { name: `${name}, 99th percentile`, text: (e) => number(e.raw.temporal[motion]?.p99) }]);
  host.append(el("h3", null, "What shimmers"), table("Flicker", [entry, ...flicker], shown));
  const moving = shown.filter((e) => e.raw.temporal.errors);
  if (!moving.length) return;
  const of = (e) => e.raw.temporal.errors;
  const errors = motions((motion, name) => [
    { name: `${name}, PSNR`, text: (e) => decibels(of(e)[motion]?.psnr_db) },
    { name: `${name}, worst frame`, text: (e) => decibels(of(e)[motion]?.worst_db) }]);
  host.append(el("h3", null, "How wrong moving frames are"), table("Errors of moving frames", [entry, ...errors,
    { name: "First after a cut", text: (e) => decibels(of(e).cut_db) },
    { name: "Uncovering", text: (e) => decibels(of(e).uncovering_db) }],
    sorted(moving, (e) => of(e).uncovering_db, true)));
}

// ---- Pictures -----------------------------------------------------------------------------------------------------

const LAYERS = { image: "picture", samples: "samples (k)", error: "error" };
const LAYER_NOTES = {
  image: "As displayed. The frames are the crops below.",
  samples: "Samples shaded in each pixel: black 1, through red and yellow to m². Only adaptive techniques have it.",
  error: "Difference to the truth: the brighter, the greater.",
};

/** Every shown picture, truth first: {id, name, kind, image, samples, error}. */
function shownPictures({ images, byId }) {
  const entries = Object.entries(images.entries ?? {}).filter(([, p]) => p?.image);
  const all = entries.map(([id, p]) => ({ ...p, id, name: byId.get(id)?.name ?? id, kind: byId.get(id)?.kind }));
  return images.truth ? [{ id: "truth", name: "Truth", image: images.truth }, ...all] : all;
}

function drawPictures(host, model) {
  const shown = shownPictures(model), crops = list(model.images.crops);
  if (!shown.length) return host.append(none("This page holds no pictures; those that were made lie in its folder."));
  const view = compareView(model, shown);
  const note = crops.length ? "Whole, then enlarged where they differ most. A circle follows the pointer through a " +
    "row. A click shows a crop's frame above, or compares a map." : "A click compares it above.";
  const head = [el("h3", null, "Side by side"), el("p", { class: "fine" }, note)];
  host.append(...view.nodes, ...head, strips(shown, crops, view));
}

/** Two entries over each other, with a line to move between them. */
function compareView(model, shown) {
  const find = (...ids) => ids.map((id) => shown.find((p) => p.id === id)).find(Boolean);
  const state = { layer: "image", left: shown.find((p) => p.kind === "single") ?? shown[0],
    right: find(model.pick?.id, model.baseline?.id) ?? shown[shown.length - 1] };
  const { width, height } = model.report, size = [width || 16, height || 9];
  const view = css(el("div", { class: "wipe" }), { "aspect-ratio": size.join(" / "), "--wipe": "50%" });
  const frames = sv("svg", { viewBox: `0 0 ${size.join(" ")}`, preserveAspectRatio: "none", "aria-hidden": "true" },
    list(model.images.crops).map((c) => sv("rect", { x: c.x, y: c.y, width: c.size, height: c.size })));
  const fine = el("p", { class: "fine" });
  const side = (place) => {
    const { name, [state.layer]: source } = state[place];
    return [source && el("img", { src: source, class: place, alt: `${name}, ${LAYERS[state.layer]}` }),
      el("span", { class: `side ${place}` }, source ? name : `${name}: no such map`)];
  };
  const draw = () => {
    view.replaceChildren(...[...side("left"), ...side("right")].filter(Boolean), frames);
    view.classList.toggle("whole", !state.left[state.layer]);
    fine.textContent = LAYER_NOTES[state.layer];
  };
  const set = (change) => { Object.assign(state, change); draw(); };
  const select = (place) => el("select", { change: (e) => set({ [place]: find(e.target.value) }) },
    shown.map((p) => el("option", { value: p.id, selected: p === state[place] }, p.name)));
  const right = select("right"), layers = choice("Show", "layer", LAYERS, state.layer, (layer) => set({ layer }));
  const compare = (picture, layer) => {
    right.value = picture.id;
    layers.querySelector(`[value=${layer}]`).checked = true;
    set({ right: picture, layer });
    view.scrollIntoView({ block: "nearest" });
  };
  const frame = (index) => {
    [...frames.children].forEach((rect, i) => rect.classList.toggle("chosen", i === index));
    view.scrollIntoView({ block: "nearest" });
  };
  draw();
  const controls = el("div", { class: "controls" }, el("label", null, "left ", select("left")),
    el("label", null, "right ", right), layers);
  return { nodes: [controls, view, wipeSlider(view), fine], compare, frame };
}

const wipeSlider = (view) => el("input", { type: "range", class: "slider", min: 0, max: 100, value: 50,
  "aria-label": "Where the left picture ends, percent", input: (e) => css(view, { "--wipe": `${e.target.value}%` }) });

/** A column for each picture; a row for each whole map and for each crop. */
function strips(shown, crops, view) {
  const button = (source, alt, className, click) => (source ? el("button", { type: "button", class: className, click },
    el("img", { src: source, alt })) : MISSING);
  const known = Object.keys(LAYERS).filter((layer) => shown.some((p) => p[layer]));
  const layers = known.map((layer) => ({ name: LAYERS[layer],
    of: (p) => button(p[layer], `${p.name}, ${LAYERS[layer]}`, "thumb", () => view.compare(p, layer)) }));
  const source = (crop, p) => (p.id === "truth" ? crop.truth : crop.entries?.[p.id]);
  const places = crops.map((crop, i) => ({ name: `crop ${i + 1}`, crop,
    of: (p) => button(source(crop, p), `${p.name}, crop ${i + 1}`, "crop", () => chooseCrop(i)) }));
  const columns = shown.map((p) => ({ name: p.name, text: (r) => r.of(p), class: p.id === "truth" ? "truth" : null }));
  const leave = (event) => css(event.currentTarget, { "--seen": "hidden" });
  const box = table("Pictures side by side", [{ name: "", text: (r) => r.name }, ...columns], [...layers, ...places],
    { row: (r) => r.crop && { pointermove: follow, pointerleave: leave } });
  const chooseCrop = (index) => {
    view.frame(index);
    box.querySelectorAll("tbody tr").forEach((row, i) => row.classList.toggle("chosen", i === layers.length + index));
  };
  box.classList.add("strip");
  return box;
}

/** The same place in every crop of the row. */
function follow(event) {
  const area = event.target.closest?.(".crop")?.getBoundingClientRect();
  css(event.currentTarget, area ? { "--seen": "visible", "--x": (event.clientX - area.left) / area.width,
    "--y": (event.clientY - area.top) / area.height } : { "--seen": "hidden" });
}

// ---- The rest, and the order of the page --------------------------------------------------------------------------

const some = (parts, between) => parts.filter(Boolean).join(between);

function drawHeader({ report, software }) {
  const { scene, width, height, stall, adapter } = report;
  const size = finite(width) && finite(height) && `${width}×${height}`;
  const gpu = adapter?.name && some([adapter.name, software && "software"], ", ");
  if (scene) document.title = `What accuracy costs in ${scene}`;
  document.getElementById("scene").textContent = scene ? `in ${scene}` : "";
  document.getElementById("subject").textContent = some([size, finite(stall) && `stall ${stall}`, gpu], " · ");
  const missing = list(report.unfinished).length, were = missing === 1 ? "entry was" : "entries were";
  const notices = [
    missing > 0 && `Unfinished: ${missing} planned ${were} not measured. The same command with --resume goes on.`,
    software && "Software adapter: only ratios of times count."].filter(Boolean);
  document.getElementById("notices").append(...notices.map((text) => el("p", { class: "notice" }, text)));
}

function drawSentences(host, model) {
  host.append(...sentences(model).map(([title, text, kind]) =>
    el("li", kind ? { class: kind } : null, el("h2", null, title), rich(text))));
}

function truthText(truth) {
  if (!truth) return "none yet";
  const { samples_per_pixel: samples, cached, seconds, file } = truth;
  const how = cached === true ? "from the cache" : finite(seconds) && `rendered in ${number(seconds)}${NBSP}s`;
  return some([finite(samples) && `${samples} samples a pixel`, how, file], ", ");
}

function drawMeasured(host, { report, entries }) {
  const { command, scene, triangles, lights, adapter } = report;
  const content = [scene, finite(triangles) && `${number(triangles)} triangles`, finite(lights) && `${lights} light${lights === 1 ? "" : "s"}`];
  const rows = [
    ["Command", command && el("code", null, command)],
    ["Adapter", some([adapter?.name, adapter?.driver, adapter?.backend], ", ")],
    ["Truth", truthText(report.truth)],
    ["Scene", some(content, ", ")],
    ["Times", "GPU timestamps, all entries in turn in every round; the median is shown, the spread as a line through the point"],
    ["Entries", `${entries.length} measured`],
    ["Unfinished", list(report.unfinished).join(", ") || "nothing"],
  ];
  host.append(...rows.flatMap(([term, text]) => [el("dt", null, term), el("dd", null, text || MISSING)]));
}

function drawTime(host, model) {
  scatter(host, model, { name: "time", title: "Error against time", xName: "GPU time with the G-buffer, ms",
    costName: "a time", cost: (e) => e.total, spread: (e) => e.spread, frontier: "time", state: { measure: "rmse", against: model.against },
    bounds: () => NO_BOUNDS });
}

function drawSamples(host, model) {
  scatter(host, model, { name: "samples", title: "Error against samples", xName: "shaded samples a pixel",
    costName: "samples", cost: (e) => e.perPixel, frontier: "samples",
    state: { measure: "rmse", against: model.againstSamples }, bounds: (state) => oracleBounds(model, state) });
}

/** Paper has no way to open what is closed. */
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));

const DRAW = {
  time: drawTime, sentences: drawSentences, samples: drawSamples, oracle: drawOracle, table: drawTable,
  pictures: drawPictures, passes: drawPasses, stall: drawStall, multiples: drawMultiples,
  executions: drawExecutions, effects: drawEffects, paper: drawPaper,
  papers: drawPapers, goals: drawGoals, motion: drawMotion, measured: drawMeasured,
};

/** For tests: <html data-ready> says "ok" once all is drawn, or "error: .." for good. */
const root = document.documentElement;
const problem = (text) => { root.dataset.ready = `error: ${text}`; };
addEventListener("error", (event) => problem(event.message));

function main() {
  const read = (id) => JSON.parse(document.getElementById(id).textContent) ?? {};
  const model = { ...readReport(read("report")), images: read("images") };
  drawHeader(model);
  for (const host of document.querySelectorAll("[data-draw]")) {
    try {
      DRAW[host.dataset.draw](host, model);
    } catch (error) {
      host.append(none("This part could not be drawn."));
      problem(`${host.dataset.draw}: ${error.message}`);
    }
  }
  root.dataset.ready ??= "ok";
}

try { main(); } catch (error) { problem(error.message); }
