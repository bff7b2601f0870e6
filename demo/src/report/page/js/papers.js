// Tables of the papers, and the same rows measured here. Needs data.js, draw.js and sections.js.

const printedOn = (row, scene) => list(row.printed).find((p) => p.scene === scene);
const scenesOf = ({ rows }) => [...new Set(rows.flatMap((r) => list(r.printed).map((p) => p.scene)))];
const overName = ({ rows, over }) => rows.find((r) => r.id === over)?.label ?? MISSING;

function drawPapers(host, { report }) {
  const tables = list(report.papers?.tables);
  if (!tables.length) return host.append(none("The papers' tables were not measured."));
  for (const paper of tables) {
    host.append(el("h3", null, paper.title), el("p", null, paper.note));
    (paper.timed ? drawTimed : drawCurves)(host, paper);
  }
}

/** Ours, then a column for each scene of the paper; and of what is sparse the times apart. */
function drawTimed(host, paper) {
  const over = overName(paper);
  const printed = (scene) => ({ name: `${scene}, printed`, text: (r) => printedLines(paper, r, scene) });
  host.append(table(paper.title, [
    { name: "Row", text: (r) => r.label },
    { name: "PSNR to truth", class: "ours", text: (r) => decibels(r.truth_db) },
    { name: "PSNR to grid", class: "ours", text: (r) => (finite(r.grid_db) ? decibels(r.grid_db) : MISSING) },
    ...(paper.sparse ? [{ name: `PSNR to ${over}`, class: "ours", text: (r) => decibels(r.over_db) }] : []),
    { name: `Samples of ${over}`, class: "ours", text: (r) => percent(r.samples) },
    { name: "Total, ms", class: "ours", text: (r) => number(r.time_ms?.total?.median), title: (r) => spreadText(r.time_ms?.total) },
    { name: `Speed over ${over}`, class: "ours", text: (r) => ratioText(r.speed) },
    { name: "Speed of the node", class: "ours", text: (r) => ratioText(r.node_speed) },
    ...scenesOf(paper).map(printed),
  ], paper.rows));
  if (paper.sparse) drawParts(host, paper);
}

function printedLines({ sparse }, row, scene) {
  const p = printedOn(row, scene);
  if (!p) return MISSING;
  if (sparse) return [unit(fixed(p.fps, 1), "fps"), el("br"), ratioText(p.speed)];
  return [decibels(p.psnr_db), el("br"), percent(p.samples), el("br"), ratioText(p.speed)];
}

const PARTS = { rays: "Rays, ms", decisions: "Decisions, ms", shading: "Shading, ms", rest: "Rest, ms" };

/** Times of the node's passes by what they are for. */
function drawParts(host, { title, rows }) {
  const part = ([key, name]) => ({ name, class: "ours", text: (r) => number(r.parts_ms?.[key]?.median),
    title: (r) => spreadText(r.parts_ms?.[key]) });
  host.append(el("p", null, "What the node's passes are for, as medians: to cast rays, to decide where the next finer lattice is " +
    "sampled, to shade, and the rest. The G-buffer is left out."));
  host.append(table(`${title}: passes`, [
    { name: "Row", text: (r) => r.label },
    ...Object.entries(PARTS).map(part),
    { name: "Node, ms", class: "ours", text: (r) => number(r.time_ms?.node?.median), title: (r) => spreadText(r.time_ms?.node) },
  ], rows));
}

/** A plot of PSNR over samples, ours and the paper's, and its points. */
function drawCurves(host, paper) {
  const [scene] = scenesOf(paper), printed = (r) => printedOn(r, scene) ?? {}, over = overName(paper);
  const plot = el("div", { class: "plot" }), series = curvesOf(paper, printed);
  const box = table(paper.title, [
    { name: "Row", text: (r) => r.label },
    { name: "PSNR to truth", class: "ours", text: (r) => decibels(r.truth_db) },
    { name: `Samples of ${over}`, class: "ours", text: (r) => percent(r.samples) },
    { name: "At the same PSNR", class: "ours", text: (r) => ratioText(r.same_psnr) },
    ...(scene ? [
      { name: "PSNR, printed", text: (r) => (finite(printed(r).psnr_db) ? decibels(printed(r).psnr_db) : MISSING) },
      { name: "Samples, printed", text: (r) => percent(printed(r).samples) },
      { name: "At the same PSNR, printed", text: (r) => ratioText(printed(r).same_psnr) },
    ] : []),
  ], paper.rows);
  const figure = el("figure", null, plot, lineLegend(series));
  const note = `At the same PSNR: samples over those of ${series[0]?.first ?? "the first curve"} there, between its points.`;
  host.append(el("div", { class: "columns" }, figure, el("div", null, box, el("p", { class: "fine" }, note))));
  responsive(figure, (width) => plot.replaceChildren(curveChart(series, width, paper.title)));
}

const CURVE_KINDS = ["single", "selective", "windowed", "reconstructed"];

/** {kind, name, dashed, first, points: [[samples in percent, dB]]}: ours, and dashed the paper's. */
function curvesOf({ rows }, printed) {
  const names = [...new Set(rows.map((r) => r.series).filter(Boolean))];
  return names.flatMap((name, i) => {
    const own = rows.filter((r) => r.series === name), kind = CURVE_KINDS[i % CURVE_KINDS.length];
    const points = (samples, db) => own.map((r) => [samples(r) * 100, db(r)]).filter(([x, y]) => x > 0 && finite(y));
    const both = [{ kind, name: `${name}, ours`, points: points((r) => r.samples, (r) => r.truth_db) },
      { kind, name: `${name}, printed`, dashed: true, points: points((r) => printed(r).samples, (r) => printed(r).psnr_db) }];
    return both.filter((s) => s.points.length).map((s) => ({ ...s, first: names[0] }));
  });
}

/** Samples by their logarithm, PSNR evenly. */
function curveChart(series, width, label) {
  const height = Math.round(Math.min(380, Math.max(260, width * 0.6))), all = series.flatMap((s) => s.points);
  const box = { left: 46, right: width - 12, top: 28, bottom: height - 40 };
  const [x0, x1] = range(all.map((p) => p[0]), 0.08), dbs = all.map((p) => p[1]);
  const y0 = Math.floor(Math.min(...dbs) - 0.5), y1 = Math.ceil(Math.max(...dbs) + 0.5);
  const x = logScale(x0, x1, box.left, box.right), y = (v) => box.bottom - ((v - y0) / (y1 - y0)) * (box.bottom - box.top);
  const step = [1, 2, 5, 10].find((s) => (y1 - y0) / s <= height / 34) ?? 20;
  const yTicks = Array.from({ length: Math.floor((y1 - y0) / step) + 1 }, (_, i) => y0 + i * step);
  const xTicks = roomy(logTicks(x0, x1, Math.floor(width / 46)), x), place = (p) => [x(p[0]), y(p[1])];
  const title = (s, p) => `${s.name}: ${decibels(p[1])} at ${percent(p[0] / 100)}`;
  return sv("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${label}: PSNR against samples` },
    axes(box, x, y, xTicks, yTicks, "samples, percent", "PSNR, dB; higher is better"),
    series.map((s) => sv("g", { class: `k-${s.kind}` }, line(s.dashed ? "line dashed" : "line", s.points.map(place)),
      s.points.map((p) => mark(s.dashed ? "other" : s.kind, s.dashed ? 2.5 : 4, place(p), title(s, p))))));
}
