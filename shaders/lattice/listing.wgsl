// Distributes the chosen points of a lattice over lanes. A workgroup has a block of points, of which each lane judges
// every eighth along either side; then the chosen ones are dealt to the lanes in turn, since they lie in clusters. Each
// pass defines its own `daa_wants` and `daa_begin`.

/// The number of points that a lane judges along one side of a block: `BLOCK` of src/passes/lattice/points.rs over 8.
const DAA_LANE_SIDE: u32 = 4u;

/// The chosen points, a bit each: bit l % 32 of word 2 i + l / 32 for the i-th point of lane l.
var<workgroup> daa_chosen: array<atomic<u32>, 32>;
/// The number of chosen points before each of these words, and their number in all.
var<workgroup> daa_before: array<u32, 33>;

/// The i-th point of a lane. Adjacent lanes have adjacent points.
fn daa_lane_point(group: vec2u, lane: u32, i: u32) -> vec2i {
    let place = vec2u(i % DAA_LANE_SIDE, i / DAA_LANE_SIDE);
    return vec2i((group * DAA_LANE_SIDE + place) * 8u + vec2u(lane & 7u, lane >> 3u));
}

/// Finds the points of the workgroup that are chosen and wanted, and returns their number. Every lane calls it.
fn daa_choose_points(step: DaaStep, group: vec2u, lane: u32) -> u32 {
    let l = step.points;
    // With the host's code, workgroup memory is not initialised to 0.
    if lane < 32u {
        atomicStore(&daa_chosen[lane], 0u);
    }
    workgroupBarrier();
    for (var i = 0u; i < DAA_LANE_SIDE * DAA_LANE_SIDE; i++) {
        let at = daa_lane_point(group, lane, i);
        if at.x >= i32(l.width) || at.y >= i32(l.height) {
            continue;
        }
        let index = daa_point_index(l, at);
        var word = daa_points[index].x;
        let point = daa_point(l, at);
        if step.coarsest != 0u {
            word = daa_point_word(DAA_CHOSEN | DAA_HAS_OWN, l.place, DAA_REFINE_COARSEST);
            daa_points[index] = daa_kept_point(word, point);
            daa_begin(index);
        }
        if (word & DAA_CHOSEN) != 0u && daa_wants(point) {
            atomicOr(&daa_chosen[2u * i + (lane >> 5u)], 1u << (lane & 31u));
        }
    }
    workgroupBarrier();
    if lane < 33u {
        var before = 0u;
        for (var i = 0u; i < lane; i++) {
            before += countOneBits(atomicLoad(&daa_chosen[i]));
        }
        daa_before[lane] = before;
    }
    workgroupBarrier();
    return daa_before[32];
}

/// The i-th of these points.
fn daa_chosen_at(group: vec2u, i: u32) -> vec2i {
    // Finds its word by halves.
    var word = 0u;
    for (var half = 16u; half > 0u; half >>= 1u) {
        word += select(0u, half, daa_before[word + half] <= i);
    }
    let bit = daa_nth_bit(atomicLoad(&daa_chosen[word]), i - daa_before[word]);
    return daa_lane_point(group, bit + (word & 1u) * 32u, word >> 1u);
}
