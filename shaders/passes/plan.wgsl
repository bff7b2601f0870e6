// plan: lays out the samples of each tile of 8 × 8 pixels beyond the first ones, applies the tile limit, and counts
// what the frame shades. CPU twin: src/reference/plan.rs.

@group(3) @binding(0) var<storage, read> daa_counts: array<u32>;
@group(3) @binding(1) var<storage, read_write> daa_plan: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_statistics: DaaStatistics;

var<workgroup> daa_group_decided: array<atomic<u32>, DAA_REASONS>;

/// One lane plans a whole tile. A lane for each pixel would need barriers, which software drivers pay dearly, and most
/// tiles have few samples to add.
@compute @workgroup_size(64)
fn daa_plan_main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    if id.x < daa_tile_count() {
        let first_slot = id.x * 64u;
        var total = 0u;
        for (var i = 0u; i < 64u; i++) {
            total += max(daa_plan_k(daa_counts[first_slot + i]), 1u) - 1u;
        }
        let overflows = total > daa_frame.tile_limit;
        if overflows {
            atomicAdd(&daa_statistics.overflowed_tiles, 1u);
        }
        // This is at most 64 · 63, and fits in 12 bits.
        var before = 0u;
        // Most windows have k = 1. They are counted here first, so that lanes do not contend for one counter.
        var ones = 0u;
        for (var i = 0u; i < 64u; i++) {
            let count = daa_counts[first_slot + i];
            // k is 0 where the tile extends beyond the image.
            let k = select(daa_plan_k(count), min(daa_plan_k(count), 1u), overflows);
            let reason = select(daa_plan_reason(count), DAA_BY_NOTHING, overflows);
            daa_plan[first_slot + i] = daa_plan_word(k, reason, 0u, before);
            if k == 1u {
                ones += 1u;
            } else if k > 1u {
                before += k - 1u;
                atomicAdd(&daa_group_histogram[k - 1u], 1u);
                atomicAdd(&daa_group_decided[reason & 15u], 1u);
            }
        }
        atomicAdd(&daa_group_histogram[0], ones);
        atomicAdd(&daa_group_decided[0], ones);
    }
    if daa_flag(DAA_FLAG_SURFACES) {
        // This plan is of rays alone.
        return;
    }
    workgroupBarrier();
    daa_add_histogram(lane);
    if lane < DAA_REASONS {
        let decided = atomicLoad(&daa_group_decided[lane]);
        if decided > 0u {
            atomicAdd(&daa_statistics.decided[lane], decided);
        }
    }
}
