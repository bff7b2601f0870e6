// Distributes the chosen points of a lattice over lanes. A workgroup has a block of points, of which each lane has
// every eighth along either side. Adjacent lanes have adjacent points, so that clusters of chosen points are spread
// evenly. Each pass defines its own `daa_wants` and `daa_begin`.

/// The number of a lane's points along one side of a block: `BLOCK` of src/passes/lattice/points.rs over 8.
const DAA_LANE_SIDE: u32 = 4u;

/// The i-th point of a lane. In each block of 2 × 2 points one belongs to the coarser lattice and is not chosen again;
/// the order gives each lane an equal share of all four.
fn daa_lane_point(lane: vec2u, i: u32) -> vec2i {
    let place = vec2u(i % DAA_LANE_SIDE, i / DAA_LANE_SIDE);
    return vec2i(((lane >> vec2u(3u)) * DAA_LANE_SIDE + place) * 8u + ((lane & vec2u(7u)) ^ (place & vec2u(1u))));
}

/// A bit for each of a lane's points that is chosen and wanted. `lane` is the lane's position among all workgroups.
fn daa_chosen_points(step: DaaStep, lane: vec2u) -> u32 {
    let l = step.points;
    var chosen = 0u;
    for (var i = 0u; i < DAA_LANE_SIDE * DAA_LANE_SIDE; i++) {
        let at = daa_lane_point(lane, i);
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
            chosen |= 1u << i;
        }
    }
    return chosen;
}

/// The i-th of these points.
fn daa_chosen_at(lane: vec2u, chosen: u32, i: u32) -> vec2i {
    var left = chosen;
    for (var passed = 0u; passed < i; passed++) {
        left &= left - 1u;
    }
    return daa_lane_point(lane, firstTrailingBit(left));
}
