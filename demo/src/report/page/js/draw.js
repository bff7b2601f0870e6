// Nodes, marks, axes, plots of lines. Needs data.js.

const absent = (value) => value === null || value === undefined || value === false;
/** Children are nodes, text, or nothing; text never becomes markup. A function is a listener. */
const builder = (create) => (tag, attributes, ...children) => {
  const node = create(tag);
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (typeof value === "function") node.addEventListener(name, value);
    else if (!absent(value)) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat(4).filter((c) => !absent(c)));
  return node;
};
const el = builder((tag) => document.createElement(tag));
const sv = builder((tag) => document.createElementNS("http://www.w3.org/2000/svg", tag));
const rich = (text) => text.split("**").map((part, i) => (i % 2 ? el("strong", null, part) : part));
const none = (text) => el("p", { class: "none" }, text);
const css = (node, properties) => {
  for (const [name, value] of Object.entries(properties)) node.style.setProperty(name, value);
  return node;
};

const PAPER_WIDTH = 680;
/** Draws now and whenever the width changes, so that text keeps its size on any screen, and for a page of paper. */
function responsive(host, draw) {
  let width = 0;
  const update = () => {
    const now = Math.max(240, Math.round(host.clientWidth || 640));
    if (now !== width) draw((width = now));
  };
  new ResizeObserver(update).observe(host);
  addEventListener("beforeprint", () => width > PAPER_WIDTH && draw(PAPER_WIDTH));
  addEventListener("afterprint", () => draw(width));
  update();
}

/** One of several: {value: text}. */
function choice(title, name, options, value, change) {
  return el("fieldset", null, el("legend", null, title), Object.entries(options).map(([key, text]) => el("label", null,
    el("input", { type: "radio", name, value: key, checked: key === value, change: () => change(key) }), text)));
}

// ---- One entry marked everywhere ----------------------------------------------------------------------------------

let chosen = null;
function showChosen() {
  for (const node of document.querySelectorAll("[data-id]")) {
    node.classList.toggle("chosen", node.dataset.id === chosen);
    (node.querySelector("button") ?? node).setAttribute("aria-pressed", node.dataset.id === chosen);
  }
}
function chooseEntry(id) {
  chosen = chosen === id ? null : id;
  showChosen();
}

// ---- Marks, scales, axes, labels ----------------------------------------------------------------------------------

/** A closed path through `n` points at angles in turns from the top, at the radii in turn. */
const spokes = (n, turn, ...radii) => "M" + Array.from({ length: n }, (_, i) => {
  const angle = (turn + i / n) * 2 * Math.PI, r = radii[i % radii.length];
  return `${(r * Math.sin(angle)).toFixed(2)},${(-r * Math.cos(angle)).toFixed(2)}`;
}).join("L") + "Z";
const block = (x, y) => `M${-x},${-y}H${x}V${y}H${-x}Z`;
const SHAPES = {
  windowed: (r) => `M${-r},0a${r},${r} 0 1 0 ${2 * r},0a${r},${r} 0 1 0 ${-2 * r},0Z`,
  selective: (r) => spokes(8, 0, r * 1.5, r * 0.65),
  multiresolution: (r, s = r * 1.45) => `M${-s},${-s}H${s}L${-s},${s}H${s}Z`,
  surfaces: (r) => spokes(6, 0, r * 1.4, r * 0.8),
  reconstructed: (r) => spokes(5, 0, r * 1.2),
  full: (r) => spokes(4, 0.125, r * 1.25),
  single: (r) => spokes(4, 0, r * 1.3),
  fxaa: (r) => spokes(3, 0, r * 1.35),
  smaa: (r) => spokes(3, 0.5, r * 1.35),
  taa: (r) => spokes(4, 0, r * 1.5, r * 0.6),
  msaa2x: (r) => block(r * 0.75, r * 1.4),
  msaa4x: (r) => block(r * 1.1, r * 1.1),
  msaa8x: (r) => block(r * 1.4, r * 0.75),
  other: (r) => spokes(6, 0, r * 1.1),
  goal: (r) => spokes(10, 0, r * 1.35, r * 0.55),
  cross: (r) => `M${-r},${-r}L${r},${r}M${-r},${r}L${r},${-r}`,
};
const ring = SHAPES.windowed;
const radius = (e) => (e.kind === "single" || e.role === "peer" ? 5.5 : 2.4 + Math.min(e.m ?? 3, 6) * 0.9);
const pair = (p) => p.map((v) => v.toFixed(1)).join();
const move = (p) => `translate(${pair(p)})`;
const mark = (kind, r, place, title) => sv("path",
  { class: "mark", d: SHAPES[kind](r), transform: place && move(place) }, title && sv("title", null, title));
const line = (className, points) => sv("path", { class: className, d: `M${points.map(pair).join("L")}` });
/** An item of a legend. */
const key = (kind, sign, text) => el("li", { class: `k-${kind}` },
  sv("svg", { viewBox: "-9 -7 18 14", "aria-hidden": "true" }, sign), text);
const textWidth = (text) => text.length * 6.9;
const logScale = (low, high, from, to) => (v) => from + (Math.log(v / low) / Math.log(high / low)) * (to - from);

/** [low, high] of positive values, with some air. */
function range(values, air) {
  const some = values.filter((v) => v > 0 && finite(v));
  const [low, high] = some.length ? [Math.min(...some), Math.max(...some)] : [1, 10];
  const factor = Math.max((high / low) ** air, 1.08);
  return [low / factor, high * factor];
}

/** Keeps ticks whose labels do not touch. */
function roomy(ticks, at) {
  let last = -Infinity;
  return ticks.filter((t) => {
    const half = textWidth(tickLabel(t)) / 2, fits = at(t) - half > last + 6;
    if (fits) last = at(t) + half;
    return fits;
  });
}

function axes({ left, right, top, bottom }, x, y, xTicks, yTicks, xName, yName) {
  return sv("g", null,
    xTicks.map((t) => sv("g", { class: "tick" }, sv("line", { x1: x(t), x2: x(t), y1: top, y2: bottom }),
      sv("text", { x: x(t), y: bottom + 16, "text-anchor": "middle" }, tickLabel(t)))),
    yTicks.map((t) => sv("g", { class: "tick" }, sv("line", { x1: left, x2: right, y1: y(t), y2: y(t) }),
      sv("text", { x: left - 6, y: y(t) + 4, "text-anchor": "end" }, tickLabel(t)))),
    sv("line", { class: "axis", x1: left, x2: right, y1: bottom, y2: bottom }),
    sv("text", { class: "name", x: right, y: bottom + 34, "text-anchor": "end" }, xName),
    sv("text", { class: "name", x: Math.max(0, left - 44), y: top - 10 }, yName));
}

/** Puts each {x, y, text} beside its point where it covers no label and no point; leaves out what finds no place. */
function placeLabels(items, box, points) {
  const taken = points.map(({ px, py }) => [px - 7, py - 7, px + 7, py + 7]);
  const free = (r) => r[0] >= box.left && r[2] <= box.right + 8 && r[1] >= box.top && r[3] <= box.bottom &&
    !taken.some((t) => r[0] < t[2] && t[0] < r[2] && r[1] < t[3] && t[1] < r[3]);
  return items.map(({ x, y, text, strong }) => {
    const w = textWidth(text) * (strong ? 1.08 : 1);
    const spots = [12, 22, 34].flatMap((d) => [[d, -7], [-d - w, -7], [-w / 2, -d - 9], [-w / 2, d - 2],
      ...[d * 0.7, -d * 0.7 - w].flatMap((dx) => [[dx, -d - 5], [dx, d * 0.7]])]);
    const rect = spots.map(([dx, dy]) => [x + dx, y + dy, x + dx + w, y + dy + 13]).find(free);
    if (!rect) return null;
    taken.push(rect);
    return sv("text", { x: rect[0], y: rect[1] + 11, class: strong ? "halo strong" : "halo" }, text);
  });
}

// ---- Plots of lines -----------------------------------------------------------------------------------------------

/** series: {kind, name, dashed, points: [[x, y]]}. Ticks stand at the measured x. at: {x, text}, a line across. */
function lineChart(series, { width, height, xName, yName, label, at }) {
  const box = { left: 46, right: width - 12, top: 26, bottom: height - 40 }, all = series.flatMap((s) => s.points);
  const [x0, x1] = range(all.map((p) => p[0]), 0.05), [y0, y1] = range(all.map((p) => p[1]), 0.08);
  const x = logScale(x0, x1, box.left, box.right), y = logScale(y0, y1, box.bottom, box.top);
  const place = (p) => [x(p[0]), y(p[1])], title = (s, p) => `${s.name}: ${ms(p[1])} at ${tickLabel(p[0])}`;
  const xTicks = roomy([...new Set(all.map((p) => p[0]))].sort((a, b) => a - b), x);
  return sv("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label },
    axes(box, x, y, xTicks, logTicks(y0, y1, Math.floor(height / 28)), xName, yName),
    series.map((s) => sv("g", { class: `k-${s.kind}` },
      line(s.dashed ? "line dashed" : "line", s.points.map(place)),
      !s.dashed && s.points.map((p) => mark(s.kind, 4, place(p), title(s, p))))),
    at && at.x >= x0 && at.x <= x1 && acrossLine(x(at.x), at.text, box));
}

function acrossLine(x, text, { top, bottom, right }) {
  const before = x + textWidth(text) + 8 > right, anchor = before ? "end" : "start";
  return sv("g", null, sv("line", { class: "across", x1: x, x2: x, y1: top, y2: bottom }),
    sv("text", { class: "halo strong", x: x + (before ? -6 : 6), y: bottom - 8, "text-anchor": anchor }, text));
}

function seriesFrom(rows, kind, field, name, dashed) {
  const known = sorted(list(rows).filter((r) => r.x > 0 && r[field] > 0), (r) => r.x);
  return { kind, name, dashed, points: known.map((r) => [r.x, r[field]]) };
}

const lineLegend = (series) => el("ul", { class: "legend" }, series.map((s) =>
  key(s.kind, [line(s.dashed ? "line dashed" : "line", [[-9, 0], [9, 0]]), !s.dashed && mark(s.kind, 4)], s.name)));
