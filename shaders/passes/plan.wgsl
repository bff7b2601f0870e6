// plan: lays out the samples of each tile of 8 × 8 pixels beyond the first ones, applies the tile limit, and counts
// what the frame shades. CPU twin: src/reference/plan.rs.

@group(3) @binding(0) var<storage, read> daa_counts: array<u32>;
@group(3) @binding(1) var<storage, read_write> daa_plan: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_statistics: DaaStatistics;

var<workgroup> daa_group_decided: array<atomic<u32>, 7>;

@compute @workgroup_size(64)
fn daa_plan_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = daa_tile_index(tile.xy);
    let slot = index * 64u + lane;
    let count = daa_counts[slot];
    let wanted = daa_plan_k(count);
    let sum = daa_tile_sum(lane, max(wanted, 1u) - 1u);
    let overflows = sum.y > daa_frame.tile_limit;
    // k is 0 where the tile extends beyond the image.
    let k = select(wanted, min(wanted, 1u), overflows);
    let reason = select(daa_plan_reason(count), DAA_BY_NOTHING, overflows);
    daa_plan[slot] = daa_plan_word(k, reason, 0u, select(sum.x, 0u, overflows));
    if k > 0u {
        atomicAdd(&daa_group_histogram[k - 1u], 1u);
        atomicAdd(&daa_group_decided[select(0u, reason & 15u, k > 1u)], 1u);
    }
    if overflows && lane == 0u {
        atomicAdd(&daa_statistics.overflowed_tiles, 1u);
    }
    workgroupBarrier();
    daa_add_histogram(lane);
    if lane < 7u {
        let decided = atomicLoad(&daa_group_decided[lane]);
        if decided > 0u {
            atomicAdd(&daa_statistics.decided[lane], decided);
        }
    }
}
