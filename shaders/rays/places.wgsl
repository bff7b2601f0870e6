// places: counts the planned samples before each tile, which says where the results of their rays lie. CPU twin:
// src/reference/rays/places.rs.

/// The words of all slots, then, for each tile, the number of planned samples before its own, without first ones.
@group(3) @binding(0) var<storage, read_write> daa_plan: array<u32>;
@group(3) @binding(1) var<storage, read_write> daa_statistics: DaaStatistics;

fn daa_samples_of_tile(tile: u32) -> u32 {
    let last = daa_plan[tile * 64u + 63u];
    return daa_plan_before(last) + max(daa_plan_k(last), 1u) - 1u;
}

/// Each lane counts a run of tiles, and adds the counts of the runs before it.
@compute @workgroup_size(256)
fn daa_places_main(@builtin(local_invocation_index) lane: u32) {
    let tiles = daa_tile_count();
    let run = (tiles + 255u) / 256u;
    let begin = min(lane * run, tiles);
    let end = min(begin + run, tiles);
    var sum = 0u;
    for (var tile = begin; tile < end; tile++) {
        sum += daa_samples_of_tile(tile);
    }
    var before = daa_sum_before(lane, sum);
    for (var tile = begin; tile < end; tile++) {
        daa_plan[tiles * 64u + tile] = before;
        before += daa_samples_of_tile(tile);
    }
    if lane == 255u && daa_frame.results.ranks == 1u && before > daa_frame.results.planned {
        atomicAdd(&daa_statistics.without_rays, before - daa_frame.results.planned);
    }
}
