// audit: measures the error of the finished image in some tiles by shading all of their samples. It does not change the
// image. CPU twin: src/reference/audit.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var daa_color: texture_2d<f32>;
@group(3) @binding(2) var<storage, read> daa_plan: array<u32>;
/// Counters of the audit's own: audited samples are not counted among the frame's.
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;
/// The squared displayed error of each audited tile, summed over its pixels: at the frame's effort, and a step below
/// it. -1 for a tile beyond the end of its row.
@group(3) @binding(4) var<storage, read_write> daa_audits: array<vec2f>;
@group(3) @binding(5) var<storage, read> daa_counts: array<u32>;

var<workgroup> daa_errors: array<vec2f, 64>;

/// The displayed colour: x/(1+x), then the transfer function of sRGB (IEC 61966-2-1).
fn daa_display(c: vec3f) -> vec3f {
    let exposed = min(max(c * daa_frame.exposure, vec3f(0.0)), vec3f(1e30));
    let x = exposed / (1.0 + exposed);
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}

fn daa_squared_distance(a: vec4f, b: vec4f) -> f32 {
    let apart = daa_display(a.rgb) - daa_display(b.rgb);
    return dot(apart, apart) / 3.0;
}

/// The k of a window at a step less of effort.
fn daa_k_below(count: u32) -> u32 {
    let by_least = daa_plan_reason(count) == DAA_BY_LEAST;
    let wanted = select(exp2(daa_wanted_log2(count) - daa_frame.audit.step), 1.0, by_least);
    return u32(round(clamp(max(wanted, daa_frame.audit.least_samples), 1.0, f32(DAA_M * DAA_M))));
}

fn daa_squared_errors(pixel: vec2u, k: u32, k_below: u32) -> vec2f {
    let n = DAA_M * DAA_M;
    var mean = DaaMean();
    var below = DaaMean();
    for (var rank = 0u; rank < n; rank++) {
        mean = daa_weighted(mean, daa_shade_sample(pixel, rank, n));
        if rank + 1u == k_below {
            below = mean;
        }
    }
    var c: vec4f;
    if k > 1u {
        c = textureLoad(daa_color, pixel, 0);
    } else {
        c = textureLoad(daa_first, pixel, 0);
    }
    let all = daa_mean_finish(mean);
    let error = daa_squared_distance(c, all);
    if k_below >= k {
        return vec2f(error);
    }
    return vec2f(error, max(error, daa_squared_distance(daa_mean_finish(below), all)));
}

/// A workgroup audits one tile of each period of its row.
@compute @workgroup_size(64)
fn daa_audit_main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let tile = daa_audited_tile(group.xy);
    let of_part = daa_tile_of_image(tile);
    let pixel = daa_tile_pixel(of_part, lane);
    var errors = vec2f(0.0);
    if daa_is_shown(pixel) {
        let slot = daa_tile_index(of_part) * 64u + lane;
        errors = daa_squared_errors(pixel, daa_plan_k(daa_plan[slot]), daa_k_below(daa_counts[slot]));
    }
    daa_errors[lane] = errors;
    workgroupBarrier();
    if lane == 0u {
        var sum = vec2f(0.0);
        for (var i = 0u; i < 64u; i++) {
            sum += daa_errors[i];
        }
        // Each part of the image writes the tiles that it shows, and what lies beyond the end of their rows.
        let exists = tile.x * 8u < daa_frame.image.x;
        if daa_is_shown(select(vec2u(daa_frame.shown.x, pixel.y), pixel, exists)) {
            daa_audits[tile.y * groups.x + group.x] = select(vec2f(-1.0), sum, exists);
        }
    }
}
