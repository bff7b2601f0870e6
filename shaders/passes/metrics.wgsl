// metrics: computes how many samples of each window are shaded, and which metric decided it (Holländer et al. 2013,
// section 3.1). CPU twin: src/reference/metrics.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read_write> daa_counts: array<u32>;
/// What `probe` has found, in the place of the plan.
@group(3) @binding(2) var<storage, read> daa_probed: array<u32>;

/// The depth of a sample, beyond the image that of its border; 0 for the sky.
fn daa_depth(at: vec2i) -> f32 {
    let last = vec2i(daa_frame.size * DAA_M) - 1;
    let d = daa_depth_at(vec2u(clamp(at, vec2i(0), last)));
    return select(0.0, d, d > DAA_SKY_DEPTH);
}

/// The depth step between two neighbours (b, c) that the plane on neither side explains, over the depth of the nearer
/// one. Reversed-z depth is linear in screen space on a plane, so each side is extrapolated to the other. If either
/// extrapolation fits, there is no step, however slanted the plane is. A step outside the pair is not seen.
fn daa_depth_step(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let step = min(abs((c - b) - (b - a)), abs((c - b) - (d - c)));
    let nearer = max(b, c);
    return select(0.0, step / nearer, nearer > 0.0);
}

/// The values that one walk over the window's samples, in reading order, adds up. No sample is kept in a private array:
/// GPUs hold those that are indexed at run time in slow memory, so that it is faster to read a few texels twice.
struct DaaWindow {
    /// Number of samples with a surface.
    covered: f32,
    /// The first depth, and the sum of all depths' differences to it.
    depth: f32,
    sum: f32,
    /// The greatest depth step between neighbours in a row.
    step: f32,
    /// Sum of the normals. The sky has none.
    normals: vec3f,
    /// The least and the greatest code of a normal.
    codes: vec2u,
    /// The least and the greatest identity. The sky has none.
    identities: vec2u,
}

fn daa_window(corner: vec2i, lane: u32) -> DaaWindow {
    var w: DaaWindow;
    w.depth = daa_depth(corner);
    w.codes = vec2u(0xffffffffu, 0u);
    w.identities = vec2u(0xffffffffu, 0u);
    for (var y = 0; y < i32(DAA_M); y++) {
        var a = daa_depth(corner + vec2i(-1, y));
        var b = daa_depth(corner + vec2i(0, y));
        var c = daa_depth(corner + vec2i(1, y));
        for (var x = 0; x < i32(DAA_M); x++) {
            let valid = b > 0.0;
            w.covered += f32(valid);
            w.sum += b - w.depth;
            let surface = daa_surface_at(vec2u(corner + vec2i(x, y)));
            daa_keep_code(lane, u32(y * i32(DAA_M) + x), surface.x);
            w.normals += select(vec3f(0.0), daa_octahedral_decode(unpack2x16snorm(surface.x)), valid);
            w.codes.x = select(w.codes.x, min(w.codes.x, surface.x), valid);
            w.codes.y = select(w.codes.y, max(w.codes.y, surface.x), valid);
            w.identities.x = select(w.identities.x, min(w.identities.x, surface.y), valid);
            w.identities.y = select(w.identities.y, max(w.identities.y, surface.y), valid);
            if x < i32(DAA_M) - 1 {
                let d = daa_depth(corner + vec2i(x + 2, y));
                w.step = max(w.step, daa_depth_step(a, b, c, d));
                a = b;
                b = c;
                c = d;
            }
        }
    }
    return w;
}

/// The greatest depth step between neighbours in the window.
fn daa_depth_discontinuity(corner: vec2i, w: DaaWindow) -> f32 {
    var greatest = w.step;
    for (var x = 0; x < i32(DAA_M); x++) {
        var a = daa_depth(corner + vec2i(x, -1));
        var b = daa_depth(corner + vec2i(x, 0));
        var c = daa_depth(corner + vec2i(x, 1));
        for (var y = 2; y < i32(DAA_M) + 1; y++) {
            let d = daa_depth(corner + vec2i(x, y));
            greatest = max(greatest, daa_depth_step(a, b, c, d));
            a = b;
            b = c;
            c = d;
        }
    }
    return greatest;
}

/// The variance of the window's depths over their squared mean. It is computed in two passes, since E[d²] − E[d]²
/// cancels far from zero (Chan, Golub, LeVeque 1983); their correction for the rounding of the mean is below 1e-14, and no
/// scale makes a sample of that. Differences are divided by the mean before they are squared: the square of a small depth
/// is a denormal. Depths are those of the reversed-z buffer, which are linear in screen space.
fn daa_depth_variance(corner: vec2i, w: DaaWindow) -> f32 {
    let n = f32(DAA_M * DAA_M);
    let mean = w.depth + w.sum / n;
    if mean <= 0.0 {
        return 0.0;
    }
    var sum_of_squares = 0.0;
    for (var y = 0; y < i32(DAA_M); y++) {
        for (var x = 0; x < i32(DAA_M); x++) {
            let off = (daa_depth(corner + vec2i(x, y)) - mean) / mean;
            sum_of_squares += off * off;
        }
    }
    return sum_of_squares / n;
}

/// √(1 − min n̄·n) over the window's normals. It is computed by chords, 1 − n̄·n = |n̄ − n|²/2, which is precise at
/// small angles. For normals that cancel it is 2, more than any cone.
fn daa_normal_cone(corner: vec2u, w: DaaWindow, lane: u32) -> f32 {
    if w.codes.x >= w.codes.y {
        return 0.0;
    }
    let length_of_mean = length(w.normals) / w.covered;
    if length_of_mean < 1e-3 {
        return 2.0;
    }
    let mean = w.normals / (length_of_mean * w.covered);
    let two_sided = daa_flag(DAA_FLAG_TWO_SIDED);
    var greatest = 0.0;
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let at = corner + vec2u(x, y);
            if w.covered < f32(DAA_M * DAA_M) && daa_depth_at(at) <= DAA_SKY_DEPTH {
                continue;
            }
            let code = daa_kept_code(lane, y * DAA_M + x, at);
            let n = daa_octahedral_decode(unpack2x16snorm(code));
            let apart = mean - n;
            let other = mean + n;
            let squared = select(dot(apart, apart), min(dot(apart, apart), dot(other, other)), two_sided);
            greatest = max(greatest, squared);
        }
    }
    return sqrt(greatest * 0.5);
}

/// Whether the window has more than one material or object. The sky counts as one.
fn daa_mixed_identity(w: DaaWindow) -> bool {
    return w.covered > 0.0 && (w.identities.x != w.identities.y || w.covered < f32(DAA_M * DAA_M));
}

/// Whether an edge of a shadow may cross the window: `probe` has found one, or the first sample has other shadow bits
/// than that of a direct neighbour. The sky is ignored.
fn daa_mixed_shadow(pixel: vec2i, slot: u32) -> bool {
    let last = vec2i(daa_frame.size) - 1;
    let bits = daa_shadow_bits(vec2u(pixel), 0u);
    var mixed = daa_shadow_probed() && daa_probed[slot] != 0u;
    for (var i = 0; i < 4; i++) {
        let step = select(vec2i(i - 2, 0), vec2i(0, i - 1), (i & 1) == 0);
        let at = vec2u(clamp(pixel + step, vec2i(0), last));
        let surface = daa_depth_at(at * DAA_M + daa_order(0u)) > DAA_SKY_DEPTH;
        mixed = mixed || (surface && daa_shadow_bits(at, 0u) != bits);
    }
    return mixed && daa_depth_at(vec2u(pixel) * DAA_M + daa_order(0u)) > DAA_SKY_DEPTH;
}

/// The first sample as the luminance metric sees it: exposed, and on request on the display curve. Without channels of
/// its own it is grey.
fn daa_metric_color(pixel: vec2i) -> vec3f {
    let last = vec2i(daa_frame.size) - 1;
    let c = textureLoad(daa_first, clamp(pixel, vec2i(0), last), 0).rgb;
    return daa_shown(select(vec3f(daa_luminance(c)), c, daa_flag(DAA_FLAG_LUMINANCE_CHANNELS)));
}

/// The greatest range of a channel over the four direct neighbours, and on request the pixel itself. A range below the
/// greater of the two thresholds is 0.
fn daa_luminance_range(pixel: vec2i) -> f32 {
    let a = daa_metric_color(pixel + vec2i(-1, 0));
    let b = daa_metric_color(pixel + vec2i(1, 0));
    let c = daa_metric_color(pixel + vec2i(0, -1));
    let d = daa_metric_color(pixel + vec2i(0, 1));
    let centre = select(a, daa_metric_color(pixel), daa_flag(DAA_FLAG_LUMINANCE_CENTRE));
    let greatest = max(max(max(a, b), max(c, d)), centre);
    let least = min(min(min(a, b), min(c, d)), centre);
    let range = greatest - least;
    let threshold = max(vec3f(daa_frame.windowed.luminance_min), greatest * daa_frame.windowed.luminance_edge);
    return daa_greatest_channel(select(range, vec3f(0.0), range < threshold));
}

/// The greatest range of one of the host's four bytes, each 0 to 1, over the window's samples. The sky has none.
fn daa_user_range(corner: vec2u) -> f32 {
    var least = vec4f(1.0);
    var greatest = vec4f(0.0);
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let at = corner + vec2u(x, y);
            if daa_depth_at(at) > DAA_SKY_DEPTH {
                let bytes = unpack4x8unorm(daa_user_at(at));
                least = min(least, bytes);
                greatest = max(greatest, bytes);
            }
        }
    }
    let range = greatest - least;
    return max(max(range.x, range.y), max(range.z, range.w));
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
    let window = daa_window(vec2i(corner), lane);
    if daa_frame.windowed.depth_scale > 0.0 {
        var depth = 0.0;
        if daa_flag(DAA_FLAG_DEPTH_PLANE) {
            depth = daa_depth_discontinuity(vec2i(corner), window);
        } else {
            depth = daa_depth_variance(vec2i(corner), window);
        }
        let wanted = daa_frame.windowed.depth_scale * depth;
        by = select(by, DAA_BY_DEPTH, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.normal_scale > 0.0 {
        let cone = daa_normal_cone(corner, window, lane);
        let wanted = select(daa_frame.windowed.normal_scale * cone, n, cone > 1.9);
        by = select(by, DAA_BY_NORMAL, wanted > k);
        k = max(k, wanted);
    }
    // A window of nothing but sky has no edge, however steep its gradient is.
    let all_sky = window.covered == 0.0;
    if daa_frame.windowed.luminance_scale > 0.0 && !all_sky {
        let wanted = daa_frame.windowed.luminance_scale * daa_luminance_range(vec2i(id.xy));
        by = select(by, DAA_BY_LUMINANCE, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.identity_samples > 0.0 && daa_mixed_identity(window) {
        let wanted = daa_frame.windowed.identity_samples;
        by = select(by, DAA_BY_IDENTITY, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.shadow_samples > 0.0 && daa_mixed_shadow(vec2i(id.xy), slot) {
        let wanted = daa_frame.windowed.shadow_samples;
        by = select(by, DAA_BY_SHADOW, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.windowed.user_scale > 0.0 {
        let wanted = daa_frame.windowed.user_scale * daa_user_range(corner);
        by = select(by, DAA_BY_USER, wanted > k);
        k = max(k, wanted);
    }
    if !all_sky {
        by = select(by, DAA_BY_LEAST, daa_frame.least_samples > k);
        k = max(k, daa_frame.least_samples);
    }
    let count = u32(round(min(k, n)));
    daa_counts[slot] = daa_count_word(count, select(by, DAA_BY_NOTHING, count == 1u), daa_wanted_code(k));
}
