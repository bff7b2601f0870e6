// The sums of numbers over the lanes of a workgroup of 64, one lane for each pixel of a tile.

var<workgroup> daa_numbers: array<u32, 64>;
var<workgroup> daa_row_sums: array<u32, 8>;

/// The sum of the numbers of the lanes before this one. Every lane calls it, once.
fn daa_tile_sum_before(lane: u32, number: u32) -> u32 {
    daa_numbers[lane] = number;
    workgroupBarrier();
    let row = lane >> 3u;
    var before = 0u;
    for (var i = row * 8u; i < lane; i++) {
        before += daa_numbers[i];
    }
    if (lane & 7u) == 7u {
        daa_row_sums[row] = before + number;
    }
    workgroupBarrier();
    for (var i = 0u; i < row; i++) {
        before += daa_row_sums[i];
    }
    return before;
}
