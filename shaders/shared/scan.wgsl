// The sums of numbers over the lanes of a workgroup of 256.

var<workgroup> daa_parts: array<u32, 256>;
var<workgroup> daa_sixteenths: array<u32, 16>;

/// The sum of the numbers of the lanes before this one. Every lane calls it, once.
fn daa_sum_before(lane: u32, number: u32) -> u32 {
    daa_parts[lane] = number;
    workgroupBarrier();
    var before = 0u;
    for (var i = lane & ~15u; i < lane; i++) {
        before += daa_parts[i];
    }
    if (lane & 15u) == 15u {
        daa_sixteenths[lane >> 4u] = before + number;
    }
    workgroupBarrier();
    for (var i = 0u; i < (lane >> 4u); i++) {
        before += daa_sixteenths[i];
    }
    return before;
}
