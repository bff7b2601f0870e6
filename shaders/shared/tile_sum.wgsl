// The sums of numbers over the lanes of a workgroup of 64, one lane for each pixel of a tile.

var<workgroup> daa_numbers: array<u32, 64>;
var<workgroup> daa_row_sums: array<u32, 8>;

/// The sum of all lanes' numbers in y, and of those of the lanes before this one in x. Every lane calls it.
fn daa_tile_sum(lane: u32, number: u32) -> vec2u {
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
    var all = 0u;
    for (var i = 0u; i < 8u; i++) {
        before += select(0u, daa_row_sums[i], i < row);
        all += daa_row_sums[i];
    }
    return vec2u(before, all);
}
