// metrics: computes how many samples of each window are shaded, and which metric decided it (Holländer et al. 2013,
// section 3.1). CPU twin: src/reference/metrics.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read_write> daa_counts: array<u32>;

/// The depths of the window and of a border of one sample around it, (m + 2)² in reading order; 0 for the sky. They are
/// read once, for three metrics.
var<private> daa_depths: array<f32, 100>;

fn daa_read_depths(corner: vec2i) {
    let last = vec2i(daa_frame.size * DAA_M) - 1;
    for (var y = 0; y < i32(DAA_M) + 2; y++) {
        for (var x = 0; x < i32(DAA_M) + 2; x++) {
            let at = clamp(corner + vec2i(x, y) - 1, vec2i(0), last);
            let d = daa_depth_at(vec2u(at));
            daa_depths[y * (i32(DAA_M) + 2) + x] = select(0.0, d, d > DAA_SKY_DEPTH);
        }
    }
}

/// The depth of a sample, −1 ≤ x, y ≤ m.
fn daa_depth(x: i32, y: i32) -> f32 {
    return daa_depths[(y + 1) * (i32(DAA_M) + 2) + x + 1];
}

/// Whether no sample of the window has a surface.
fn daa_all_sky() -> bool {
    var nearest = 0.0;
    for (var y = 0; y < i32(DAA_M); y++) {
        for (var x = 0; x < i32(DAA_M); x++) {
            nearest = max(nearest, daa_depth(x, y));
        }
    }
    return nearest == 0.0;
}

/// The variance of the window's depths over their squared mean. Depths are shifted by the first one, since E[d²] −
/// E[d]² cancels far from zero (Chan, Golub, LeVeque 1983). They are those of the reversed-z buffer, which are linear
/// in screen space.
fn daa_depth_variance() -> f32 {
    let shift = daa_depth(0, 0);
    var sum = 0.0;
    var sum_of_squares = 0.0;
    for (var y = 0; y < i32(DAA_M); y++) {
        for (var x = 0; x < i32(DAA_M); x++) {
            let v = daa_depth(x, y) - shift;
            sum += v;
            sum_of_squares += v * v;
        }
    }
    let mean = sum / f32(DAA_M * DAA_M);
    let variance = max(sum_of_squares / f32(DAA_M * DAA_M) - mean * mean, 0.0);
    let reference = shift + mean;
    // Divided twice, since the square of a small depth may be a denormal.
    return select(0.0, variance / reference / reference, reference > DAA_SKY_DEPTH);
}

/// The depth step between two neighbours (b, c) that the plane on neither side explains, over the depth of the nearer
/// one. Reversed-z depth is linear in screen space on a plane, so each side is extrapolated to the other. If either
/// extrapolation fits, there is no step, however slanted the plane is. A step outside the pair is not seen.
fn daa_depth_step(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let step = min(abs((c - b) - (b - a)), abs((c - b) - (d - c)));
    let nearer = max(b, c);
    return select(0.0, step / nearer, nearer > 0.0);
}

/// The greatest depth step between neighbours in the window.
fn daa_depth_discontinuity() -> f32 {
    var greatest = 0.0;
    for (var i = 0; i < i32(DAA_M); i++) {
        for (var j = 0; j < i32(DAA_M) - 1; j++) {
            let row = daa_depth_step(daa_depth(j - 1, i), daa_depth(j, i), daa_depth(j + 1, i), daa_depth(j + 2, i));
            let column = daa_depth_step(daa_depth(i, j - 1), daa_depth(i, j), daa_depth(i, j + 1), daa_depth(i, j + 2));
            greatest = max(greatest, max(row, column));
        }
    }
    return greatest;
}

/// The normals of the window; zero for the sky.
var<private> daa_normals: array<vec3f, 64>;

/// √(1 − min n̄·n) over the window's normals. It is computed by chords, 1 − n̄·n = |n̄ − n|²/2, which is precise at
/// small angles. For normals that cancel it is 2, more than any cone. The sky has no normal.
fn daa_normal_cone(corner: vec2u) -> f32 {
    var sum = vec3f(0.0);
    var count = 0.0;
    var least = 0xffffffffu;
    var most = 0u;
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let code = daa_surface_at(corner + vec2u(x, y)).x;
            let valid = daa_depth(i32(x), i32(y)) > 0.0;
            let n = select(vec3f(0.0), daa_octahedral_decode(unpack2x16snorm(code)), valid);
            least = select(least, min(least, code), valid);
            most = select(most, max(most, code), valid);
            daa_normals[y * DAA_M + x] = n;
            sum += n;
            count += f32(valid);
        }
    }
    if least >= most {
        return 0.0;
    }
    let length_of_mean = length(sum) / count;
    if length_of_mean < 1e-3 {
        return 2.0;
    }
    let mean = sum / (length_of_mean * count);
    let two_sided = daa_flag(DAA_FLAG_TWO_SIDED);
    var greatest = 0.0;
    for (var i = 0u; i < DAA_M * DAA_M; i++) {
        let n = daa_normals[i];
        let apart = mean - n;
        let other = mean + n;
        let squared = select(dot(apart, apart), min(dot(apart, apart), dot(other, other)), two_sided);
        greatest = max(greatest, select(squared, 0.0, all(n == vec3f(0.0))));
    }
    return sqrt(greatest * 0.5);
}

/// Whether the window has more than one material or object. The sky counts as one.
fn daa_mixed_identity(corner: vec2u) -> bool {
    let identity = daa_identity_at(corner);
    let sky = daa_depth(0, 0) > 0.0;
    var mixed = false;
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            mixed = mixed || daa_identity_at(corner + vec2u(x, y)) != identity;
            mixed = mixed || (daa_depth(i32(x), i32(y)) > 0.0) != sky;
        }
    }
    return mixed;
}

/// Whether the window's first sample has other shadow bits than that of a direct neighbour. The sky is ignored.
fn daa_mixed_shadow(pixel: vec2i) -> bool {
    let last = vec2i(daa_frame.size) - 1;
    let bits = daa_shadow_bits(vec2u(pixel), 0u);
    var mixed = false;
    for (var i = 0; i < 4; i++) {
        let step = select(vec2i(i - 2, 0), vec2i(0, i - 1), (i & 1) == 0);
        let at = vec2u(clamp(pixel + step, vec2i(0), last));
        let surface = daa_depth_at(at * DAA_M + daa_order(0u)) > DAA_SKY_DEPTH;
        mixed = mixed || (surface && daa_shadow_bits(at, 0u) != bits);
    }
    return mixed && daa_depth_at(vec2u(pixel) * DAA_M + daa_order(0u)) > DAA_SKY_DEPTH;
}

/// Luminance as the luminance metric sees it: exposed, and on request on the display curve.
fn daa_metric_luminance(pixel: vec2i) -> f32 {
    let last = vec2i(daa_frame.size) - 1;
    let c = textureLoad(daa_first, clamp(pixel, vec2i(0), last), 0).rgb;
    return daa_shown(vec3f(daa_luminance(c))).x;
}

/// The range of luminance over the four direct neighbours, and on request the pixel itself. 0 if it is below the
/// greater of the two thresholds.
fn daa_luminance_range(pixel: vec2i) -> f32 {
    let a = daa_metric_luminance(pixel + vec2i(-1, 0));
    let b = daa_metric_luminance(pixel + vec2i(1, 0));
    let c = daa_metric_luminance(pixel + vec2i(0, -1));
    let d = daa_metric_luminance(pixel + vec2i(0, 1));
    let centre = select(a, daa_metric_luminance(pixel), daa_flag(DAA_FLAG_LUMINANCE_CENTRE));
    let greatest = max(max(max(a, b), max(c, d)), centre);
    let least = min(min(min(a, b), min(c, d)), centre);
    let range = greatest - least;
    let threshold = max(daa_frame.windowed.luminance_min, greatest * daa_frame.windowed.luminance_edge);
    return select(range, 0.0, range < threshold);
}

@compute @workgroup_size(8, 8)
fn daa_metrics_main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = daa_tile_index(tile.xy) * 64u + lane;
    if !daa_is_counted(id.xy) {
        daa_counts[slot] = 0u;
        return;
    }
    let n = f32(DAA_M * DAA_M);
    let corner = id.xy * DAA_M;
    var k = 1.0;
    var by = DAA_BY_NOTHING;
    daa_read_depths(vec2i(corner));
    if daa_frame.windowed.depth_scale > 0.0 {
        var depth = 0.0;
        if daa_flag(DAA_FLAG_DEPTH_PLANE) {
            depth = daa_depth_discontinuity();
        } else {
            depth = daa_depth_variance();
        }
        let wanted = daa_frame.windowed.depth_scale * depth;
        by = select(by, DAA_BY_DEPTH, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.normal_scale > 0.0 {
        let cone = daa_normal_cone(corner);
        let wanted = select(daa_frame.windowed.normal_scale * cone, n, cone > 1.9);
        by = select(by, DAA_BY_NORMAL, wanted > k);
        k = max(k, wanted);
    }
    // A window of nothing but sky has no edge, however steep its gradient is.
    let all_sky = daa_all_sky();
    if daa_frame.windowed.luminance_scale > 0.0 && !all_sky {
        let wanted = daa_frame.windowed.luminance_scale * daa_luminance_range(vec2i(id.xy));
        by = select(by, DAA_BY_LUMINANCE, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.identity_samples > 0.0 && daa_mixed_identity(corner) {
        let wanted = daa_frame.windowed.identity_samples;
        by = select(by, DAA_BY_IDENTITY, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.shadow_samples > 0.0 && daa_mixed_shadow(vec2i(id.xy)) {
        let wanted = daa_frame.windowed.shadow_samples;
        by = select(by, DAA_BY_SHADOW, wanted > k);
        k = max(k, wanted);
    }
    if !all_sky {
        by = select(by, DAA_BY_LEAST, daa_frame.least_samples > k);
        k = max(k, daa_frame.least_samples);
    }
    let count = u32(round(min(k, n)));
    daa_counts[slot] = daa_plan_word(count, select(by, DAA_BY_NOTHING, count == 1u), daa_wanted_code(k));
}
