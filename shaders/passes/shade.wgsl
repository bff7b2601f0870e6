// shade: shades the samples beyond the first, and stores their mean with the first (Holländer et al. 2013, listing 1,
// ShadeRestAdaptively). Windows with k = 1 are skipped: S is their image.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

/// Stores the mean of the first sample and the others.
fn daa_store(pixel: vec2u, others: DaaMean) {
    let first = daa_weighted(DaaMean(), textureLoad(daa_first, pixel, 0));
    let mean = DaaMean(first.sum + others.sum, first.weight + others.weight);
    textureStore(daa_color, pixel, daa_mean_finish(mean));
}

/// `Full`: shades every sample.
@compute @workgroup_size(8, 8)
fn daa_shade_full(@builtin(global_invocation_id) id: vec3u) {
    if !daa_is_shown(id.xy) {
        return;
    }
    var mean = DaaMean();
    for (var rank = 0u; rank < DAA_M * DAA_M; rank++) {
        mean = daa_weighted(mean, daa_shade_sample(id.xy, rank, DAA_M * DAA_M));
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
    let k = daa_plan_k(daa_plan[daa_tile_index(tile.xy) * 64u + lane]);
    if k < 2u {
        return;
    }
    var others = DaaMean();
    for (var rank = 1u; rank < k; rank++) {
        others = daa_weighted(others, daa_shade_sample(id.xy, rank, k));
    }
    daa_store(id.xy, others);
}

/// The sums of samples beyond the first. 0 to 63: the sum of each window, from the lane in whose part the window
/// begins. 64 to 127: the sum, by lane, of samples whose window began in an earlier part.
var<workgroup> daa_sums: array<vec4f, 128>;
var<workgroup> daa_weights: array<f32, 128>;

/// A window of the tile: k, and the range of its samples in the tile's list.
struct DaaTileWindow {
    k: u32,
    begin: u32,
    end: u32,
}

fn daa_tile_window(word: u32) -> DaaTileWindow {
    let k = daa_plan_k(word);
    let begin = daa_plan_before(word);
    return DaaTileWindow(k, begin, begin + max(k, 1u) - 1u);
}

/// `Tiled`: the tile's samples are laid end to end and cut into equal parts, one for each lane, so that all lanes are
/// busy equally long (section 6 names tiles as future work). The parts are combined in workgroup memory after the only
/// barrier.
@compute @workgroup_size(64)
fn daa_shade_tiled(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let first_slot = daa_tile_index(tile.xy) * 64u;
    let total = daa_tile_window(daa_plan[first_slot + 63u]).end;
    if total == 0u {
        return;
    }
    let part = (total + 63u) / 64u;
    let part_begin = min(lane * part, total);
    let part_end = min(part_begin + part, total);

    // The last window whose samples begin at or before this part.
    var index = 0u;
    for (var stride = 32u; stride > 0u; stride >>= 1u) {
        index += select(0u, stride, daa_plan_before(daa_plan[first_slot + index + stride]) <= part_begin);
    }
    var window = daa_tile_window(daa_plan[first_slot + index]);
    var mean = DaaMean();
    for (var entry = part_begin; entry < part_end; entry++) {
        // Advances to the next window with samples. There is one, since the list goes on.
        if entry == window.end {
            mean = DaaMean();
            while entry == window.end {
                index += 1u;
                window = daa_tile_window(daa_plan[first_slot + index]);
            }
        }
        let pixel = tile.xy * 8u + vec2u(index & 7u, index >> 3u);
        let rank = entry - window.begin + 1u;
        mean = daa_weighted(mean, daa_shade_sample(pixel, rank, window.k));
        let slot = select(index, 64u + lane, window.begin < part_begin);
        daa_sums[slot] = mean.sum;
        daa_weights[slot] = mean.weight;
    }
    workgroupBarrier();

    let mine = daa_tile_window(daa_plan[first_slot + lane]);
    if mine.k > 1u {
        var others = DaaMean(daa_sums[lane], daa_weights[lane]);
        for (var i = mine.begin / part + 1u; i <= (mine.end - 1u) / part; i++) {
            others = DaaMean(others.sum + daa_sums[64u + i], others.weight + daa_weights[64u + i]);
        }
        daa_store(daa_tile_pixel(tile.xy, lane), others);
    }
}
