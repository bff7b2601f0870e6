// Time per pass, and cost against what it depends on. Needs data.js and draw.js.

// ---- Time per pass ------------------------------------------------------------------------------------------------

// Light enough for dark text on them, and apart for every kind of colour vision (after P. Tol's "light" scheme).
const PASS_COLOURS = ["#b8bec6", "#77aadd", "#eedd88", "#ffaabb", "#99ddff", "#ee8866", "#bbcc33", "#44bb99",
  "#d6b3e6", "#c9ad93", "#9fb0a0", "#e6c9a8"];
const MANY_ENTRIES = 14;

/** Hues by the golden angle, so that no two passes share one. */
const further = (i) => `hsl(${Math.round((i * 137.5) % 360)}deg 42% ${i % 2 ? 68 : 80}%)`;

function drawPasses(host, model) {
  const timed = sorted(model.entries.filter((e) => finite(e.total)), (e) => e.total), passes = passesOf(timed);
  if (!timed.length) return host.append(none("No times: the adapter gives no timestamps, or no entry was finished."));
  const notable = (e) => e.kind === "single" || e.kind === "full" || e.role === "peer" || e.preset || e === model.pick;
  const many = timed.length > MANY_ENTRIES, few = many ? timed.filter(notable) : timed;
  const colour = new Map(passes.map((p, i) => [p, PASS_COLOURS[i] ?? further(i)]));
  const plot = el("div", { class: "plot" });
  let shown = few, width = 0;
  const draw = () => plot.replaceChildren(passBars(shown, passes, colour, width));
  const toggle = el("input", { type: "checkbox", change: (e) => { shown = e.target.checked ? timed : few; draw(); } });
  const swatch = (p) => css(el("span", { class: "swatch" }), { background: colour.get(p) });
  host.append(many ? el("div", { class: "controls" }, el("label", null, toggle, " all entries")) : "",
    el("ul", { class: "legend" }, passes.map((p) => el("li", null, swatch(p), words(p)))), plot);
  responsive(host, (now) => { width = now; draw(); });
}

/** A row an entry; its name beside the bar, or above it where the page is narrow. */
function passBars(entries, passes, colour, width) {
  const beside = width >= 620, left = beside ? 250 : 0, step = beside ? 30 : 44;
  const time = (e, pass) => e.passes[pass] ?? 0;
  const sum = (e) => passes.reduce((all, pass) => all + time(e, pass), 0);
  const scale = (width - left - 62) / Math.max(...entries.map(sum), 1e-9);
  const bars = entries.map((e, row) => {
    const y = row * step + (beside ? 6 : 20);
    const name = beside ? { x: left - 10, y: y + 14, "text-anchor": "end" } : { x: 0, y: y - 5 };
    let x = left;
    const parts = passes.filter((p) => time(e, p) > 0).map((p) => {
      const from = x;
      x += time(e, p) * scale;
      return passPart(p, time(e, p), from, y, x - from, colour.get(p));
    });
    const total = sv("text", { class: "strong", x: x + 6, y: y + 14 }, number(e.total));
    return sv("g", null, sv("text", name, e.name), parts, total);
  });
  return sv("svg", { viewBox: `0 0 ${width} ${entries.length * step + 8}`, role: "img",
    "aria-label": "Median milliseconds of each pass, stacked, a row for each entry" }, bars);
}

function passPart(pass, time, x, y, width, fill) {
  const text = number(time), fits = width > textWidth(text) + 4;
  const title = sv("title", null, `${words(pass)} ${ms(time)}`);
  return [sv("rect", { x, y, width: Math.max(width - 0.75, 0.4), height: 20, fill }, title),
    fits && sv("text", { class: "bar-text", x: x + width / 2, y: y + 14, "text-anchor": "middle" }, text)];
}

// ---- Cost ---------------------------------------------------------------------------------------------------------

const NODE_TIMES = [["full", "full_ms", "Full"], ["windowed", "windowed_ms", "Windowed"],
  ["single", "single_ms", "Single"]];
const MULTIPLES = [["resolution", "Resolution", "pixels"], ["m", "m", "m"], ["lights", "Lights", "lights"],
  ["triangles", "Triangles", "triangles"]];

/** A line for each fitted series: Full: time ∝ pixels^0.97, r² 0.999. */
function fitLines(fits, name) {
  return NODE_TIMES.filter(([, field]) => finite(fits?.[field]?.exponent)).map(([, field, series]) => {
    const { exponent, r2 } = fits[field], certain = finite(r2) && `, r² ${fixed(r2, 3)}`;
    return el("p", { class: "fit" }, `${series}: time ∝ ${name}`, el("sup", null, fixed(exponent, 2)), certain);
  });
}

function drawStall(host, { report }) {
  const rows = report.cost?.stall, cross = report.cost?.crossover_stall, nodes = NODE_TIMES
    .map(([kind, field, name]) => seriesFrom(rows, kind, field, `${name}, node`, true));
  const series = [seriesFrom(rows, "full", "full_total_ms", "Full, total"),
    seriesFrom(rows, "windowed", "windowed_total_ms", "Windowed, total"), ...nodes].filter((s) => s.points.length);
  if (!series.length) return host.append(none("Cost against shading weight was not measured."));
  const first = Math.min(...series.flatMap((s) => s.points.map((p) => p[0])));
  const text = cross <= first ? "pays from here at the latest" : `pays from stall ${tickLabel(cross ?? 0)}`;
  const at = finite(cross) && { x: Math.max(cross, first), text }, plot = el("div", { class: "plot" });
  const never = at ? "" : el("p", { class: "fit" }, "Windowed's total is nowhere below Full's.");
  host.append(plot, lineLegend(series), never, ...fitLines(report.cost.fits?.stall, "stall"));
  const names = { xName: "stall: light loops a sample", yName: "GPU time, ms", label: "GPU time against stall" };
  responsive(host, (width) => plot.replaceChildren(
    lineChart(series, { ...names, width, height: Math.round(Math.min(400, Math.max(300, width * 0.5))), at })));
}

function drawMultiples(host, { report }) {
  for (const [field, title, name] of MULTIPLES) {
    const series = NODE_TIMES.map(([kind, time, label]) => seriesFrom(report.cost?.[field], kind, time, label))
      .filter((s) => s.points.length);
    const plot = el("div", { class: "plot" }), panel = el("div", null, el("h4", null, title));
    host.append(panel);
    if (!series.length) { panel.append(none(`Cost against ${name} was not measured.`)); continue; }
    panel.append(plot, lineLegend(series), ...fitLines(report.cost.fits?.[field], name));
    const names = { xName: name, yName: "node, ms", label: `Time of the node against ${name}` };
    responsive(panel, (width) => plot.replaceChildren(lineChart(series, { ...names, width, height: 230 })));
  }
}
