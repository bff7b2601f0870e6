// metrics: how many samples each window is worth, and which metric said so (Holländer et al. 2013, section 3.1).
// CPU twin: src/reference/metrics.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read_write> daa_counts: array<u32>;

const DAA_BY_NOTHING: u32 = 0u;
const DAA_BY_DEPTH: u32 = 1u;
const DAA_BY_NORMAL: u32 = 2u;
const DAA_BY_LUMINANCE: u32 = 3u;
const DAA_BY_IDENTITY: u32 = 4u;

fn daa_depth_at(at: vec2i) -> f32 {
    let last = vec2i(daa_frame.size * DAA_M) - 1;
    let d = textureLoad(daa_gbuffer_depth, clamp(at, vec2i(0), last), 0);
    return select(0.0, d, d > DAA_SKY_DEPTH);
}

/// The variance of the window's depths over their squared mean. Shifted by the first depth, since E[d²] − E[d]²
/// cancels far from zero (Chan, Golub, LeVeque 1983). Depth is the reversed-z buffer's, linear in screen space.
fn daa_depth_variance(corner: vec2i) -> f32 {
    let shift = daa_depth_at(corner);
    var sum = 0.0;
    var sum_of_squares = 0.0;
    for (var y = 0; y < i32(DAA_M); y++) {
        for (var x = 0; x < i32(DAA_M); x++) {
            let v = daa_depth_at(corner + vec2i(x, y)) - shift;
            sum += v;
            sum_of_squares += v * v;
        }
    }
    let mean = sum / f32(DAA_M * DAA_M);
    let variance = max(sum_of_squares / f32(DAA_M * DAA_M) - mean * mean, 0.0);
    let reference = shift + mean;
    // In two steps: the square of a small depth may be a denormal.
    return select(0.0, variance / reference / reference, reference > DAA_SKY_DEPTH);
}

/// How far two neighbours (b, c) are from one plane, over the nearer one's depth. Reversed-z depth is linear in screen
/// space on a plane, so each side is extrapolated to the other; where either fits there is no step between the two,
/// however slanted the plane, and a step outside of the pair is not seen.
fn daa_depth_step(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let step = min(abs((c - b) - (b - a)), abs((c - b) - (d - c)));
    let nearer = max(b, c);
    return select(0.0, step / nearer, nearer > 0.0);
}

/// The greatest step between neighbours in the window.
fn daa_depth_discontinuity(corner: vec2i) -> f32 {
    var greatest = 0.0;
    for (var i = 0; i < i32(DAA_M); i++) {
        // Four depths in a row, then in a column, moved along one by one.
        var row = vec4f(
            0.0,
            daa_depth_at(corner + vec2i(-1, i)),
            daa_depth_at(corner + vec2i(0, i)),
            daa_depth_at(corner + vec2i(1, i)),
        );
        var column = vec4f(
            0.0,
            daa_depth_at(corner + vec2i(i, -1)),
            daa_depth_at(corner + vec2i(i, 0)),
            daa_depth_at(corner + vec2i(i, 1)),
        );
        for (var j = 0; j < i32(DAA_M) - 1; j++) {
            row = vec4f(row.yzw, daa_depth_at(corner + vec2i(j + 2, i)));
            column = vec4f(column.yzw, daa_depth_at(corner + vec2i(i, j + 2)));
            greatest = max(greatest, daa_depth_step(row.x, row.y, row.z, row.w));
            greatest = max(greatest, daa_depth_step(column.x, column.y, column.z, column.w));
        }
    }
    return greatest;
}

/// √(1 − min n̄·n) over the window's normals, as a chord: 1 − n̄·n = |n̄ − n|²/2 keeps its digits at small angles.
/// Normals that cancel span the full cone: 2, more than any cone. The sky has no normal.
fn daa_normal_cone(corner: vec2u) -> f32 {
    var sum = vec3f(0.0);
    var count = 0.0;
    var code = 0u;
    var alike = true;
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let at = corner + vec2u(x, y);
            if textureLoad(daa_gbuffer_depth, at, 0) > DAA_SKY_DEPTH {
                let here = textureLoad(daa_gbuffer_surface, at, 0).x;
                alike = alike && (count == 0.0 || here == code);
                code = here;
                sum += daa_octahedral_decode(unpack2x16snorm(here));
                count += 1.0;
            }
        }
    }
    if alike {
        return 0.0;
    }
    let length_of_mean = length(sum) / count;
    if length_of_mean < 1e-3 {
        return 2.0;
    }
    let mean = sum / (length_of_mean * count);
    let two_sided = (daa_frame.flags & DAA_FLAG_TWO_SIDED) != 0u;
    var greatest = 0.0;
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let at = corner + vec2u(x, y);
            if textureLoad(daa_gbuffer_depth, at, 0) > DAA_SKY_DEPTH {
                let n = daa_octahedral_decode(unpack2x16snorm(textureLoad(daa_gbuffer_surface, at, 0).x));
                let apart = mean - n;
                let other = mean + n;
                let squared = dot(apart, apart);
                greatest = max(greatest, select(squared, min(squared, dot(other, other)), two_sided));
            }
        }
    }
    return sqrt(greatest * 0.5);
}

/// Whether the window holds more than one material or object, the sky counted as one.
fn daa_mixed_identity(corner: vec2u) -> bool {
    let identity = textureLoad(daa_gbuffer_surface, corner, 0).y;
    let sky = textureLoad(daa_gbuffer_depth, corner, 0) > DAA_SKY_DEPTH;
    var mixed = false;
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let at = corner + vec2u(x, y);
            mixed = mixed || textureLoad(daa_gbuffer_surface, at, 0).y != identity;
            mixed = mixed || (textureLoad(daa_gbuffer_depth, at, 0) > DAA_SKY_DEPTH) != sky;
        }
    }
    return mixed;
}

/// Luminance as the luminance metric sees it: exposed, and on request on a curve like a display's, x/(1+x) and a
/// square root.
fn daa_metric_luminance(pixel: vec2i) -> f32 {
    let last = vec2i(daa_frame.size) - 1;
    let c = textureLoad(daa_first, clamp(pixel, vec2i(0), last), 0).rgb;
    let l = daa_luminance(c) * daa_frame.exposure;
    return select(l, sqrt(l / (1.0 + l)), (daa_frame.flags & DAA_FLAG_LUMINANCE_PERCEPTUAL) != 0u);
}

/// The range of luminance over the four direct neighbours (and the pixel itself), 0 below both thresholds.
fn daa_luminance_range(pixel: vec2i) -> f32 {
    let a = daa_metric_luminance(pixel + vec2i(-1, 0));
    let b = daa_metric_luminance(pixel + vec2i(1, 0));
    let c = daa_metric_luminance(pixel + vec2i(0, -1));
    let d = daa_metric_luminance(pixel + vec2i(0, 1));
    let centre = select(a, daa_metric_luminance(pixel), (daa_frame.flags & DAA_FLAG_LUMINANCE_CENTRE) != 0u);
    let greatest = max(max(max(a, b), max(c, d)), centre);
    let least = min(min(min(a, b), min(c, d)), centre);
    let range = greatest - least;
    let threshold = max(daa_frame.luminance_min, greatest * daa_frame.luminance_edge);
    return select(range, 0.0, range < threshold);
}

@compute @workgroup_size(8, 8)
fn daa_metrics_main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = (tile.y * daa_frame.tiles_x + tile.x) * 64u + lane;
    if any(id.xy >= daa_frame.size) {
        daa_counts[slot] = 0u;
        return;
    }
    let n = f32(DAA_M * DAA_M);
    let corner = id.xy * DAA_M;
    var k = 1.0;
    var by = DAA_BY_NOTHING;
    if daa_frame.depth_scale > 0.0 {
        var depth = 0.0;
        if (daa_frame.flags & DAA_FLAG_DEPTH_PLANE) != 0u {
            depth = daa_depth_discontinuity(vec2i(corner));
        } else {
            depth = daa_depth_variance(vec2i(corner));
        }
        let wanted = daa_frame.depth_scale * depth;
        by = select(by, DAA_BY_DEPTH, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.normal_scale > 0.0 {
        let cone = daa_normal_cone(corner);
        let wanted = select(daa_frame.normal_scale * cone, n, cone > 1.9);
        by = select(by, DAA_BY_NORMAL, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.luminance_scale > 0.0 {
        let wanted = daa_frame.luminance_scale * daa_luminance_range(vec2i(id.xy));
        by = select(by, DAA_BY_LUMINANCE, wanted > k);
        k = max(k, wanted);
    }
    if daa_frame.identity_samples > 0.0 && daa_mixed_identity(corner) {
        let wanted = daa_frame.identity_samples;
        by = select(by, DAA_BY_IDENTITY, wanted > k);
        k = max(k, wanted);
    }
    let count = u32(round(min(k, n)));
    daa_counts[slot] = count | (select(by, DAA_BY_NOTHING, count == 1u) << 8u);
}
