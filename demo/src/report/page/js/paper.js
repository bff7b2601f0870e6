// What Holländer, Boubekeur, Eisemann, "Adaptive Supersampling for Deferred Anti-Aliasing" (JCGT 2013) report, and our
// entries beside it. Needs data.js.

/** What section 4.2 and the outlook say of an execution, and its time over Loop's where that is given. */
const FINDINGS = {
  loop: ["Its choice: each pixel loops over its own samples.", null],
  bucketed: ["A pass for each count, by depth or stencil test: 20 % slower. Buckets by a histogram: future work.", 1.2],
  sorted: ["Pixels sorted by count: three times slower.", 3],
  maxfiltered: ["Greatest count of 6×6 pixels: drastically more samples; sorted too, about three times slower.", null],
  tiled: ["Future work: tiles, against the divergence of threads.", null],
  packed: ["Not tried. The packed list is that of Jin et al., HPG 2009.", null],
};
const finding = (execution) => FINDINGS[String(execution).toLowerCase().replace(/[^a-z]/g, "")] ?? [MISSING, null];

/** Table 1 as printed, with the PSNR that follows from its MSE. */
const TABLE_1 = [
  { name: "1×1", kind: "single", ms: 12.91, stalled: 28.91 },
  { name: "FXAA", kind: "fxaa", ms: 13.28, stalled: 29.24 },
  { name: "2×2 reference", kind: "full", m: 2, ms: 26.0, stalled: 78.7 },
  { name: "2×2 adaptive", kind: "windowed", m: 2, ms: 22.9, stalled: 72.2,
    mse: 5.0, printed: 91.14, db: 43.01, samples: 0.578 },
  { name: "3×3 reference", kind: "full", m: 3, ms: 34.9, stalled: 158.36 },
  { name: "3×3 adaptive", kind: "windowed", m: 3, ms: 30.69, stalled: 143.77,
    mse: 3.08, printed: 93.24, db: 45.11, samples: 0.534 },
  { name: "4×4 reference", kind: "full", m: 4, ms: 57.48, stalled: 317.76 },
  { name: "4×4 adaptive", kind: "windowed", m: 4, ms: 51.68, stalled: 268.35,
    mse: 3.79, printed: 92.34, db: 44.21, samples: 0.5314 },
];

/** A row of Table 1 beside our entry for it. Ratios: adaptive over the reference of its m, all others over 1×1. */
function besidePaper(model, row) {
  const of = (kind, m) => model.entries.filter((e) => e.kind === kind && (!m || e.m === m));
  const adaptive = row.kind === "windowed", baseKind = adaptive ? "full" : "single", m = adaptive ? row.m : null;
  const base = TABLE_1.find((r) => r.kind === baseKind && (!m || r.m === m)), first = base === row;
  const far = (e) => Math.abs((e.quality.grid.psnr_db ?? 0) - row.db);
  const ours = adaptive ? least(of("windowed", m), far) : of(row.kind, row.m)[0];
  const over = (a, b) => (first ? null : quotient(a, b));
  return {
    ...row, entry: ours ?? null, ratio: over(row.ms, base.ms), stalledRatio: over(row.stalled, base.stalled),
    ourRatio: over(ours?.total, of(baseKind, m)[0]?.total), ourDb: adaptive ? ours?.quality.grid.psnr_db : null,
    ourSamples: adaptive ? ours?.ratio ?? null : null,
  };
}
