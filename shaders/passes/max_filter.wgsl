// max_filter: gives every pixel the greatest k of its block of 6 × 6 pixels (Holländer et al. 2013, section 4.2, figure
// 6c). CPU twin: src/reference/max_filter.rs.

@group(3) @binding(0) var<storage, read_write> daa_counts: array<u32>;

const DAA_BLOCK: u32 = 6u;

/// Each lane processes one block.
@compute @workgroup_size(8, 8)
fn daa_max_filter_main(@builtin(global_invocation_id) id: vec3u) {
    let corner = id.xy * DAA_BLOCK;
    if any(corner >= daa_frame.size) {
        return;
    }
    let end = min(corner + DAA_BLOCK, daa_frame.size);
    // The word with the greatest k also holds the reason for it.
    var k = 0u;
    var word = 0u;
    for (var y = corner.y; y < end.y; y++) {
        for (var x = corner.x; x < end.x; x++) {
            let count = daa_counts[daa_slot(vec2u(x, y))];
            if daa_plan_k(count) > k {
                k = daa_plan_k(count);
                word = count;
            }
        }
    }
    for (var y = corner.y; y < end.y; y++) {
        for (var x = corner.x; x < end.x; x++) {
            daa_counts[daa_slot(vec2u(x, y))] = word;
        }
    }
}
