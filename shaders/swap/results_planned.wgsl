// Where the results of a sample's rays lie, for passes that also read those of other planned samples, and have
// `daa_plan`. CPU twin: `Traced::place` of src/host/traced.rs.

/// Whether the plan has a sample beyond the first.
fn daa_is_planned(word: u32, rank: u32) -> bool {
    if daa_flag(DAA_FLAG_SELECTIVE) {
        return (daa_quadrants(rank) & daa_plan_quadrants(word)) != 0u;
    }
    return rank < daa_plan_k(word);
}

/// The index of a sample's results. If there is no room for its own, it is that of the first sample.
fn daa_result_index(pixel: vec2u, rank: u32) -> u32 {
    let results = daa_frame.results;
    let slot = daa_slot(pixel);
    let slots = daa_tile_count() * 64u;
    if rank < results.ranks {
        return rank * slots + slot;
    }
    let word = daa_plan[slot];
    if daa_is_planned(word, rank) {
        var place = rank - 1u;
        if daa_flag(DAA_FLAG_SELECTIVE) {
            place = daa_rank_count_below(daa_ranks_of(daa_plan_quadrants(word)), rank);
        }
        // places.wgsl writes the numbers of samples before each tile's behind the words of all slots.
        place += daa_plan[slots + slot / 64u] + daa_plan_before(word);
        return select(slot, results.ranks * slots + place, place < results.planned);
    }
    if results.audited == 0u {
        return slot;
    }
    let tile = pixel / 8u;
    let audited = tile.y * results.audited + (tile.x + daa_frame.origin.x / 8u) / daa_frame.audit.period;
    let n = DAA_M * DAA_M;
    return results.ranks * slots + results.planned + (audited * 64u + slot % 64u) * n + rank;
}

/// Whether a sample has results of its own.
fn daa_has_results(pixel: vec2u, rank: u32) -> bool {
    return rank == 0u || daa_result_index(pixel, rank) != daa_slot(pixel);
}
