// The plots of error against a cost. Needs data.js and draw.js.

const NO_BOUNDS = { curves: [], crosses: [] };
/** The curves of an oracle by their field in report.json. */
const BOUNDS = {
  curve: { name: "oracle", style: "oracle", legend: "oracle, mean of k" },
  groups: { name: "groups", style: "oracle groups", legend: "groups at equal error" },
};
const MEASURE_NAMES = { rmse: "rMSE", edge: "edges", flip: "FLIP", ssim: "1 − SSIM" };
const errorName = ({ measure, against }) => `${MEASURES[measure].name} against ${AGAINST[against]}`;

/**
 * spec: name, title, xName, costName; cost(entry); frontier: which of the report's; state: {measure, against};
 * bounds(state): {curves: [{m, points, name, style}], crosses: [point]}.
 */
function scatter(host, model, spec) {
  if (!model.entries.some((e) => spec.cost(e) > 0 && finite(model.error(e)))) {
    return host.append(none(`No plot yet: no entry has both ${spec.costName} and an error.`));
  }
  const plot = el("div", { class: "plot" }), notes = el("div"), { state, name } = spec;
  let width = 0;
  const draw = () => {
    const points = pointsOf(model, spec), bounds = spec.bounds(state);
    plot.replaceChildren(...(points.length ? drawScatter(model, spec, points, bounds, width) :
      [none(`Nothing measured: ${errorName(state)}.`)]));
    notes.replaceChildren(...scatterNotes(model, spec, points, bounds));
    showChosen();
  };
  const set = (field) => (value) => { state[field] = value; draw(); };
  const controls = [choice("Error", `${name}-measure`, MEASURE_NAMES, state.measure, set("measure")),
    choice("against", `${name}-against`, { truth: "truth", grid: "grid" }, state.against, set("against"))];
  host.append(el("div", { class: "controls" }, controls), plot, notes);
  responsive(host, (now) => { width = now; draw(); });
}

function pointsOf(model, { cost, state }) {
  const points = model.entries.map((entry) => ({ entry, x: cost(entry), y: errorOf(entry, state) }));
  return byCost(points.filter((p) => p.x > 0 && finite(p.x) && finite(p.y) && p.y >= 0));
}

function drawScatter(model, spec, points, bounds, width) {
  const { x, y, box, ...frame } = scatterFrame(points, bounds, width), at = (p) => [x(p.x), y(p.y)];
  for (const p of [...points, ...bounds.crosses]) [p.px, p.py] = at(p);
  const fronts = frontiers(model, points, spec.frontier, spec.state), best = new Set(fronts.flat().map((p) => p.entry));
  const series = seriesOf(points), marks = points.map((p, i) => pointMark(model, spec, p, best.has(p.entry), i === 0));
  const labels = scatterLabels(model, points, series, bounds, best, at);
  const tip = el("div", { class: "tip", hidden: true });
  const help = `${spec.title}: ${points.length} points by rising cost. Arrow keys go to the next, Enter marks it.`;
  const svg = sv("svg", { viewBox: `0 0 ${width} ${frame.height}`, role: "group", "aria-label": help },
    axes(box, x, y, frame.xTicks, frame.yTicks, spec.xName, `${errorName(spec.state)}; lower is better`), frame.zero,
    fronts.filter((f) => f.length > 1).map((f) => line("frontier", f.map(at))),
    bounds.curves.map((c) => line(c.style, c.points.map(at))),
    bounds.crosses.map((c) => sv("path", { class: "cross", d: SHAPES.cross(5), transform: move(at(c)) })),
    series.map((s) => sv("g", { class: `k-${s.kind}` }, line("line", s.front.map(at)))),
    points.map((p) => whisker(spec.spread?.(p.entry), p, x, box)), marks,
    placeLabels(labels, box, [...points, ...bounds.crosses]));
  const area = el("div", null, svg);
  handlePointer(model, spec, area, points, marks, tip, width);
  return [area, tip];
}

/** From the fastest to nearly the slowest frame of a point. */
function whisker(spread, { entry, py }, x, { left, right }) {
  if (!(spread?.min > 0 && spread.p95 > spread.min)) return null;
  const [from, to] = [x(spread.min), x(spread.p95)].map((v) => Math.min(Math.max(v, left), right));
  const wavers = entry.wavers > STEADY;
  return sv("line", { class: wavers ? "spread loose" : "spread", x1: from, x2: to, y1: py, y2: py },
    sv("title", null, `${entry.name}: ${spreadText(spread)}`));
}

/** Scales. An error of 0, of an entry that is its own reference, lies on a line under the logarithmic part. */
function scatterFrame(points, { curves, crosses }, width) {
  const height = Math.round(Math.min(470, Math.max(320, width * 0.66))), zeros = points.some((p) => p.y === 0);
  const box = { left: 46, right: width - 12, top: 28, bottom: height - 40 }, floor = box.bottom - (zeros ? 26 : 0);
  const all = [...points, ...curves.flatMap((c) => c.points), ...crosses];
  const [x0, x1] = range(all.map((p) => p.x), 0.06), [y0, y1] = range(all.map((p) => p.y), 0.06);
  const x = logScale(x0, x1, box.left, box.right), above = logScale(y0, y1, floor, box.top);
  const zero = zeros && sv("g", { class: "tick" },
    sv("line", { class: "axis", x1: box.left, x2: box.right, y1: floor, y2: floor, "stroke-dasharray": "2 3" }),
    sv("text", { x: box.left - 6, y: box.bottom - 6, "text-anchor": "end" }, "0"));
  return { x, y: (v) => (v > 0 ? above(v) : box.bottom - 10), box, height, zero,
    xTicks: roomy(logTicks(x0, x1, Math.floor(width / 46)), x), yTicks: logTicks(y0, y1, Math.floor(height / 28)) };
}

/** Full, and each m of an adaptive technique: its points that no other of them beats, to be joined by a line. */
function seriesOf(points) {
  const groups = new Map();
  for (const p of points.filter(({ entry, y }) => y > 0 && (isAdaptive(entry) || entry.kind === "full"))) {
    const { technique, m } = p.entry.raw;
    const name = p.entry.kind === "full" ? "Full" : `${KINDS[technique] ?? words(technique)} m=${plain(m)}`;
    groups.set(name, [...(groups.get(name) ?? []), p]);
  }
  const all = [...groups].map(([name, own]) => ({ name, kind: own[0].entry.kind, front: frontier(own) }));
  return all.filter((s) => s.front.length > 1);
}

/** The most important first: later ones may find no place. */
function scatterLabels(model, points, series, bounds, best, at) {
  const of = (test, text, strong) => points.filter((p) => test(p.entry))
    .map((p) => ({ x: p.px, y: p.py, text: text(p.entry), strong }));
  const beside = (point, text) => { const [x, y] = at(point); return { x, y, text }; };
  const bare = (e) => e.label.replace(/,\s*m\s*=\s*\d+$/, "").replace(/^windowed,\s*/i, "");
  const short = (e) => capital(bare(e)) + (e.m ? ` m=${e.m}` : "");
  return [
    ...of((e) => e === model.pick, short, true),
    ...of((e) => e.kind === "single" || e.role === "peer", (e) => e.label),
    ...of((e) => e.kind === "full" && e !== model.pick, short),
    ...series.filter((s) => s.kind !== "full").map((s) => beside(s.front.find((p) => p.entry === model.baseline) ??
      s.front.find((p) => p.entry.preset === "balanced") ?? s.front[0], s.name)),
    ...bounds.curves.map((c) => beside(c.points[c.points.length - 1], `${c.name} m=${c.m}`)),
    ...of((e) => e.preset && e !== model.pick && best.has(e), short),
  ];
}

function pointMark(model, spec, point, best, first) {
  const { entry, px, py } = point, r = radius(entry);
  const faint = !best && entry.role !== "goal";
  const classes = ["pt", `k-${entry.kind}`, faint && "dominated", entry === model.pick && "pick"];
  return sv("g", { class: classes.filter(Boolean).join(" "), role: "button", tabindex: first ? 0 : -1,
    "data-plot": spec.name, "data-id": entry.id, transform: move([px, py]),
    "aria-label": [entry.name, ...pointFigures(point, spec.state).map((f) => f.join(" "))].join(", ") },
    sv("path", { class: "ring", d: ring(r + 3.5) }), mark(entry.kind, r));
}

function pointFigures({ entry, y }, { measure, against }) {
  return [["Total", ms(entry.total)], ["Node", ms(entry.node)], ["Samples a pixel", number(entry.perPixel)],
    [`${MEASURES[measure].name} to ${against}`, y === 0 ? "0, identical" : number(y)],
    ["PSNR to truth", decibels(entry.quality.truth.psnr_db)], ["PSNR to grid", decibels(entry.quality.grid.psnr_db)]];
}

function fillTip(tip, model, point, spec, width) {
  const { entry, px, py } = point, changed = differences(model, entry).join(", ");
  const figures = pointFigures(point, spec.state).map(([name, value]) => [el("dt", null, name), el("dd", null, value)]);
  tip.replaceChildren(el("strong", null, entry.name), el("dl", null, figures),
    el("p", null, changed || (entry === model.baseline ? "The default settings" : "")));
  tip.hidden = false;
  const [left, top] = tipPlace(px, py, tip.offsetWidth, tip.offsetHeight, width);
  css(tip, { left: `${left}px`, top: `${top}px` });
}

/** Beside the point where the plot is wide enough, else over or under it. */
function tipPlace(px, py, w, h, width) {
  const beside = px + 16 + w <= width ? px + 16 : px - 16 - w;
  if (beside >= 0) return [beside, Math.max(0, py - h / 2)];
  return [Math.min(Math.max(0, px - w / 2), width - w), py > h + 14 ? py - h - 14 : py + 14];
}

/**
 * The nearest point answers to a pointer, as a finger can't hit a mark; keys go from mark to mark. `area` is not the
 * <svg>: with listeners of its own the tab key would stop at it.
 */
function handlePointer(model, spec, area, points, marks, tip, width) {
  const show = (point) => {
    marks.forEach((m, i) => m.classList.toggle("hot", points[i] === point));
    tip.hidden = true;
    if (point) fillTip(tip, model, point, spec, width);
  };
  const near = (event) => {
    const box = area.getBoundingClientRect(), scale = width / box.width;
    const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    const far = (p) => Math.hypot(x - p.px, y - p.py), nearest = least(points, far);
    return far(nearest) < 26 ? nearest : null;
  };
  area.addEventListener("pointermove", (event) => show(near(event)));
  area.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && show(null));
  area.addEventListener("click", (event) => {
    const point = near(event);
    show(point);
    if (point) chooseEntry(point.entry.id);
  });
  area.addEventListener("focusin", ({ target }) => {
    if (target.matches(":focus-visible")) show(points[marks.indexOf(target)]);
  });
  area.addEventListener("focusout", () => show(null));
  area.addEventListener("keydown", (event) => pointKey(event, marks));
}

function pointKey(event, marks) {
  const at = marks.indexOf(event.target), step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
  if (at < 0 || (!step && event.key !== "Enter" && event.key !== " ")) return;
  event.preventDefault();
  if (!step) return chooseEntry(marks[at].dataset.id);
  const next = marks[(at + step + marks.length) % marks.length];
  marks[at].setAttribute("tabindex", -1);
  next.setAttribute("tabindex", 0);
  next.focus();
}

function scatterNotes(model, spec, points, bounds) {
  const names = { ...KINDS, goal: "set by a goal" }, missing = model.entries.length - points.length;
  const kinds = Object.keys(names).filter((kind) => points.some((p) => p.entry.kind === kind));
  const legend = el("ul", { class: "legend" }, kinds.map((kind) => key(kind, mark(kind, 5), names[kind])),
    key("none", line("frontier", [[-7, 0], [7, 0]]), "frontier; faint: beaten; larger: greater m"),
    model.pick && key("none", sv("path", { class: "picked", d: ring(5.5) }), "recommended"),
    spec.spread && points.some((p) => p.entry.wavers > STEADY) && key("none", sv("line", { class: "spread loose", x1: -7, x2: 7 }),
      `times of frames, over ${STEADY}× apart`),
    ...Object.values(BOUNDS).map(({ name, style, legend: text }) => (
      bounds.curves.some((c) => c.name === name) && key("none", line(style, [[-9, 0], [9, 0]]), text))),
    bounds.crosses.length > 0 && key("none", sv("path", { class: "cross", d: SHAPES.cross(4) }), "exact coverage"));
  const text = `Not drawn, for want of a figure: ${missing} of ${model.entries.length} entries.`;
  return missing ? [legend, el("p", { class: "fine" }, text)] : [legend];
}

/** The oracles' curves and exact coverage, as samples a pixel: bounds on the displayed error against the grid. */
function oracleBounds({ report }, state) {
  if (state.against !== "grid" || state.measure !== "rmse") return NO_BOUNDS;
  const point = (m, p) => ({ x: p.ratio * m * m, y: fromDb(p.psnr_db), m }), drawn = (p) => p.x > 0 && p.y > 0;
  const oracles = list(report.oracles).filter((o) => finite(o.m));
  const curves = ({ m, ...fields }) => Object.entries(BOUNDS).map(([field, { name, style }]) => (
    { m, name, style, points: byCost(list(fields[field]).map((p) => point(m, p)).filter(drawn)) }));
  return { curves: oracles.flatMap(curves).filter((c) => c.points.length > 1),
    crosses: oracles.filter((o) => o.exact_coverage).map((o) => point(o.m, o.exact_coverage)).filter(drawn) };
}
