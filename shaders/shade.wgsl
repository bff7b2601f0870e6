// shade: the samples beyond the first, and their mean with it (Holländer et al. 2013, listing 1, ShadeRestAdaptively).
// Windows with k = 1 are left alone: their mean is S.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

fn daa_weighted(mean: DaaMean, c: vec4f) -> DaaMean {
    let by_luminance = (daa_frame.flags & DAA_FLAG_WEIGHT_LUMINANCE) != 0u;
    return daa_mean_add(mean, c, daa_weight(c, by_luminance, daa_frame.exposure));
}

/// √(n/k): the footprint of a sample that stands for n/k of the window's.
fn daa_footprint(k: u32) -> f32 {
    return f32(DAA_M) / sqrt(f32(k));
}

/// `Full`: every sample, the grid reference.
@compute @workgroup_size(8, 8)
fn daa_shade_full(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= daa_frame.size) {
        return;
    }
    var mean = DaaMean();
    for (var rank = 0u; rank < DAA_M * DAA_M; rank++) {
        mean = daa_weighted(mean, daa_shade_sample(id.xy, rank, 1.0, vec2f(0.0)));
    }
    textureStore(daa_color, id.xy, daa_mean_finish(mean));
}

/// `Loop`: each pixel shades its own samples (section 4.2, the paper's best).
@compute @workgroup_size(8, 8)
fn daa_shade_loop(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let k = daa_plan[(tile.y * daa_frame.tiles_x + tile.x) * 64u + lane] & 0xffu;
    if k < 2u {
        return;
    }
    let footprint = daa_footprint(k);
    let centre = daa_centre(k);
    var mean = daa_weighted(DaaMean(), textureLoad(daa_first, id.xy, 0));
    for (var rank = 1u; rank < k; rank++) {
        mean = daa_weighted(mean, daa_shade_sample(id.xy, rank, footprint, centre));
    }
    textureStore(daa_color, id.xy, daa_mean_finish(mean));
}

/// Radiance of one batch of the tile's list.
var<workgroup> daa_batch: array<vec4f, 256>;

/// `Tiled`: a workgroup lays its tile's samples end to end and shades them with every lane busy (section 6 names
/// tiles as future work). Each pixel then adds its own in rank order, as the loop does.
@compute @workgroup_size(64)
fn daa_shade_tiled(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let first_slot = (tile.y * daa_frame.tiles_x + tile.x) * 64u;
    let last = daa_plan[first_slot + 63u];
    let total = (last >> 16u) + max(last & 0xffu, 1u) - 1u;
    if total == 0u {
        return;
    }
    let mine = daa_plan[first_slot + lane];
    let k = mine & 0xffu;
    let begin = mine >> 16u;
    let end = begin + max(k, 1u) - 1u;
    let pixel = tile.xy * 8u + vec2u(lane & 7u, lane >> 3u);
    var mean = DaaMean();
    if k > 1u {
        mean = daa_weighted(mean, textureLoad(daa_first, pixel, 0));
    }
    for (var base = 0u; base < total; base += 256u) {
        let limit = min(base + 256u, total);
        for (var entry = base + lane; entry < limit; entry += 64u) {
            // The last window whose samples begin at or before this entry.
            var window = 0u;
            for (var stride = 32u; stride > 0u; stride >>= 1u) {
                window += select(0u, stride, (daa_plan[first_slot + window + stride] >> 16u) <= entry);
            }
            let word = daa_plan[first_slot + window];
            let count = word & 0xffu;
            let at = tile.xy * 8u + vec2u(window & 7u, window >> 3u);
            let rank = entry - (word >> 16u) + 1u;
            daa_batch[entry - base] = daa_shade_sample(at, rank, daa_footprint(count), daa_centre(count));
        }
        workgroupBarrier();
        for (var entry = max(begin, base); entry < min(end, limit); entry++) {
            mean = daa_weighted(mean, daa_batch[entry - base]);
        }
        workgroupBarrier();
    }
    if k > 1u {
        textureStore(daa_color, pixel, daa_mean_finish(mean));
    }
}
