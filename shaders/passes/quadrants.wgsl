// quadrants: shades the samples of active quadrants and combines them with the first samples into pixels (Jin et al.
// 2009, sections 4.1.4 and 4.3.3, ExtraSampler). CPU twin: src/reference/selective.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

@group(3) @binding(4) var<storage, read> daa_list: array<u32>;
@group(3) @binding(5) var<storage, read> daa_work: DaaWork;

/// Adds a sample to the mean, weighted by the share of its quadrants that are active.
fn daa_joined(mean: DaaMean, c: vec4f, rank: u32, chosen: u32) -> DaaMean {
    let parts = daa_quadrants(rank);
    let share = f32(countOneBits(parts & chosen)) / f32(max(countOneBits(parts), 1u));
    let one = daa_weighted(DaaMean(), c);
    return DaaMean(mean.sum + one.sum * share, mean.weight + one.weight * share);
}

fn daa_first_at(pixel: vec2i) -> vec4f {
    return textureLoad(daa_first, clamp(pixel, vec2i(0), vec2i(daa_frame.size) - 1), 0);
}

/// The colour of an inactive quadrant: that of its pixel, or interpolated between the pixels at its corner, at the
/// quadrant's centre.
fn daa_inactive_color(pixel: vec2i, own: vec4f, quadrant: u32) -> vec4f {
    if !daa_flag(DAA_FLAG_BILINEAR) {
        return own;
    }
    let x = vec2i(select(-1, 1, (quadrant & 1u) != 0u), 0);
    let y = vec2i(0, select(-1, 1, (quadrant & 2u) != 0u));
    let beside = daa_first_at(pixel + x) + daa_first_at(pixel + y);
    return own * 0.5625 + beside * 0.1875 + daa_first_at(pixel + x + y) * 0.0625;
}

/// Stores a pixel from the samples of its active quadrants and the colours of the others. Each quadrant has a quarter
/// of the weight.
fn daa_store(pixel: vec2u, own: vec4f, samples: DaaMean, chosen: u32) {
    var mean = samples;
    let quarter = f32(daa_frame.selective.samples) * 0.25;
    for (var quadrant = 0u; quadrant < 4u; quadrant++) {
        if ((chosen >> quadrant) & 1u) == 0u {
            let one = daa_weighted(DaaMean(), daa_inactive_color(vec2i(pixel), own, quadrant));
            mean = DaaMean(mean.sum + one.sum * quarter, mean.weight + one.weight * quarter);
        }
    }
    textureStore(daa_color, pixel, daa_mean_finish(mean));
}

fn daa_chosen(slot: u32) -> u32 {
    return daa_plan_quadrants(daa_plan[slot]);
}

/// Shades the pixels with active quadrants, sorted by k. The paper packs a list of samples (section 4.3.3), whose
/// colours would have to be gathered for each pixel.
@compute @workgroup_size(64)
fn daa_quadrants_active(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let draw = daa_draw(daa_work.begin, daa_work.end, group.y * daa_work.groups_x + group.x);
    if !draw.any {
        return;
    }
    let slot = daa_list[draw.begin + lane];
    if slot == DAA_NO_ENTRY {
        return;
    }
    let pixel = daa_slot_pixel(slot);
    let chosen = daa_chosen(slot);
    let own = daa_first_at(vec2i(pixel));
    var mean = daa_joined(DaaMean(), own, 0u, chosen);
    for (var queue = daa_ranks_of(chosen); any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        let rank = daa_least(queue);
        mean = daa_joined(mean, daa_shade_sample(pixel, rank, daa_frame.selective.samples), rank, chosen);
    }
    daa_store(pixel, own, mean, chosen);
}

/// Stores the other pixels, where the colours of inactive quadrants are interpolated.
@compute @workgroup_size(8, 8)
fn daa_quadrants_between(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = daa_tile_index(tile.xy) * 64u + lane;
    if !daa_is_shown(id.xy) || daa_plan_k(daa_plan[slot]) > 1u {
        return;
    }
    let chosen = daa_chosen(slot);
    let own = daa_first_at(vec2i(id.xy));
    daa_store(id.xy, own, daa_joined(DaaMean(), own, 0u, chosen), chosen);
}
