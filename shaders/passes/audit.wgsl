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
    daa_store_errors(group.xy, groups.x, lane, errors);
}
