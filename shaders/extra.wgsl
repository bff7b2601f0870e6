// extra: shades the samples of active quadrants and puts pixels together from them and from the first samples (Jin et al. 2009,
// sections 4.1.4 and 4.3.3, ExtraSampler). CPU twin: src/reference/selective.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

var<workgroup> daa_lengths: array<u32, 64>;
var<workgroup> daa_total: u32;
/// What a round shades, a sample each lane: window (6 bits) | rank (6 bits). And what became of it.
var<workgroup> daa_round: array<u32, 64>;
var<workgroup> daa_round_colors: array<vec4f, 64>;

/// A sample joins as much as it lies in active quadrants.
fn daa_joined(mean: DaaMean, c: vec4f, rank: u32, chosen: u32) -> DaaMean {
    let parts = daa_quadrants(rank);
    let share = f32(countOneBits(parts & chosen)) / f32(max(countOneBits(parts), 1u));
    let one = daa_weighted(DaaMean(), c);
    return DaaMean(mean.sum + one.sum * share, mean.weight + one.weight * share);
}

fn daa_first_at(pixel: vec2i) -> vec4f {
    return textureLoad(daa_first, clamp(pixel, vec2i(0), vec2i(daa_frame.size) - 1), 0);
}

/// The colour of a quadrant that is not active: its pixel's, or that between the pixels at its corner, at its middle.
fn daa_inactive_color(pixel: vec2i, own: vec4f, quadrant: u32) -> vec4f {
    if (daa_frame.flags & DAA_FLAG_BILINEAR) == 0u {
        return own;
    }
    let x = vec2i(select(-1, 1, (quadrant & 1u) != 0u), 0);
    let y = vec2i(0, select(-1, 1, (quadrant & 2u) != 0u));
    let beside = daa_first_at(pixel + x) + daa_first_at(pixel + y);
    return own * 0.5625 + beside * 0.1875 + daa_first_at(pixel + x + y) * 0.0625;
}

@compute @workgroup_size(64)
fn daa_extra_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = tile.xy * 8u + vec2u(lane & 7u, lane >> 3u);
    let chosen = (daa_plan[(tile.y * daa_frame.tiles_x + tile.x) * 64u + lane] >> 16u) & 15u;
    var queue = vec2u(0u);
    if chosen != 0u {
        for (var rank = 1u; rank < DAA_M * DAA_M; rank++) {
            if (daa_quadrants(rank) & chosen) != 0u {
                queue = daa_with(queue, rank);
            }
        }
    }
    let own = daa_first_at(vec2i(pixel));
    var mean = daa_joined(DaaMean(), own, 0u, chosen);

    // The tile's samples end to end, a window's own beside one another in the order of ranks, 64 a round: the paper's packed list
    // (section 4.3.3), whose chunks hold whole pixels too, without the memory for it.
    let count = countOneBits(queue.x) + countOneBits(queue.y);
    daa_lengths[lane] = count;
    workgroupBarrier();
    var next = 0u;
    for (var i = 0u; i < lane; i++) {
        next += daa_lengths[i];
    }
    if lane == 63u {
        daa_total = next + count;
    }
    let total = workgroupUniformLoad(&daa_total);
    for (var done = 0u; done < total; done += 64u) {
        var queued = queue;
        for (var at = next; at < done + 64u && any(queued != vec2u(0u)); at++) {
            daa_round[at - done] = lane | (daa_least(queued) << 6u);
            queued = daa_without_least(queued);
        }
        workgroupBarrier();
        if done + lane < total {
            let entry = daa_round[lane];
            let window = tile.xy * 8u + vec2u(entry & 7u, (entry >> 3u) & 7u);
            daa_round_colors[lane] = daa_shade_sample(window, entry >> 6u, daa_frame.selective_samples);
        }
        workgroupBarrier();
        for (; next < done + 64u && any(queue != vec2u(0u)); next++) {
            mean = daa_joined(mean, daa_round_colors[next - done], daa_least(queue), chosen);
            queue = daa_without_least(queue);
        }
    }
    if any(pixel >= daa_frame.size) {
        return;
    }
    // A quadrant weighs a quarter of all.
    let quarter = f32(daa_frame.selective_samples) * 0.25;
    for (var quadrant = 0u; quadrant < 4u; quadrant++) {
        if ((chosen >> quadrant) & 1u) == 0u {
            let one = daa_weighted(DaaMean(), daa_inactive_color(vec2i(pixel), own, quadrant));
            mean = DaaMean(mean.sum + one.sum * quarter, mean.weight + one.weight * quarter);
        }
    }
    textureStore(daa_color, pixel, daa_mean_finish(mean));
}
