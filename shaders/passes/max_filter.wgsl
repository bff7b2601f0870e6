// max_filter: gives every pixel the greatest k of its block of 6 × 6 pixels (Holländer et al. 2013, section 4.2, figure
// 6c). CPU twin: src/reference/max_filter.rs.

@group(3) @binding(0) var<storage, read_write> daa_counts: array<u32>;

const DAA_BLOCK: u32 = 6u;

/// Each lane processes one block.
@compute @workgroup_size(8, 8)
fn daa_max_filter_main(@builtin(global_invocation_id) id: vec3u) {
    // Blocks are those of the image; the first may begin before this part of it.
    let before = daa_frame.origin % DAA_BLOCK;
    let corner = max(id.xy * DAA_BLOCK, before) - before;
    if any(corner >= daa_frame.size) {
        return;
    }
    let end = min((id.xy + 1u) * DAA_BLOCK - before, daa_frame.size);
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
            daa_counts[daa_slot(vec2u(x, y))] = select(0u, word, daa_is_shown(vec2u(x, y)));
        }
    }
}
