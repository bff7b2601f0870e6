// The chosen points of a lattice: a lane has those of a cell of 2 × 2. Joined with lattice.wgsl; `daa_wants` and `daa_begin` are the pass's own.

/// A bit for each that is chosen and wanted.
fn daa_chosen_points(step: DaaStep, cell: vec2u) -> u32 {
    let l = step.points;
    var chosen = 0u;
    for (var i = 0u; i < 4u; i++) {
        let at = vec2i(cell * 2u + vec2u(i & 1u, i >> 1u));
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

/// The i-th of them.
fn daa_chosen_at(cell: vec2u, chosen: u32, i: u32) -> vec2i {
    var left = chosen;
    for (var passed = 0u; passed < i; passed++) {
        left &= left - 1u;
    }
    let place = firstTrailingBit(left);
    return vec2i(cell * 2u + vec2u(place & 1u, place >> 1u));
}
