// The windows of a workgroup of 64 lanes by k, which become one addition to the frame's counter of each k.

var<workgroup> daa_group_histogram: array<atomic<u32>, 64>;

/// Adds the counts of the workgroup to those of the frame. Every lane calls it, after a barrier.
fn daa_add_histogram(lane: u32) {
    let windows = atomicLoad(&daa_group_histogram[lane]);
    if windows > 0u {
        atomicAdd(&daa_statistics.histogram[lane], windows);
    }
}
