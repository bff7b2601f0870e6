// plan: where each window's samples beyond the first lie in its tile's list, and what the frame will shade.
// A tile is 8 × 8 pixels. CPU twin: src/reference/plan.rs.

@group(3) @binding(0) var<storage, read> daa_counts: array<u32>;
/// k (8 bits) | deciding metric (8 bits) | samples of the tile before this window's (16 bits).
@group(3) @binding(1) var<storage, read_write> daa_plan: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_statistics: DaaStatistics;

var<workgroup> daa_extra: array<u32, 64>;
var<workgroup> daa_tile_histogram: array<atomic<u32>, 64>;
var<workgroup> daa_tile_decided: array<atomic<u32>, 5>;

@compute @workgroup_size(64)
fn daa_plan_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = (tile.y * daa_frame.tiles_x + tile.x) * 64u + lane;
    let count = daa_counts[slot];
    // 0: the tile reaches over the image's edge here.
    var k = count & 0xffu;
    var by = count >> 8u;
    daa_extra[lane] = max(k, 1u) - 1u;
    workgroupBarrier();

    // At most 64 · 63, so 16 bits hold it.
    var before = 0u;
    var total = 0u;
    for (var i = 0u; i < 64u; i++) {
        before += select(0u, daa_extra[i], i < lane);
        total += daa_extra[i];
    }
    if total > daa_frame.tile_limit {
        k = min(k, 1u);
        by = 0u;
        before = 0u;
        if lane == 0u {
            atomicAdd(&daa_statistics.overflowed_tiles, 1u);
        }
    }
    daa_plan[slot] = k | (by << 8u) | (before << 16u);

    if k > 0u {
        atomicAdd(&daa_tile_histogram[k - 1u], 1u);
        atomicAdd(&daa_tile_decided[min(by, 4u)], 1u);
    }
    workgroupBarrier();
    let windows = atomicLoad(&daa_tile_histogram[lane]);
    if windows > 0u {
        atomicAdd(&daa_statistics.histogram[lane], windows);
    }
    if lane < 5u {
        let decided = atomicLoad(&daa_tile_decided[lane]);
        if decided > 0u {
            atomicAdd(&daa_statistics.decided[lane], decided);
        }
    }
}
