// Sets of the ranks of a window, as 64 bits. Declares no bindings.

fn daa_with(ranks: vec2u, rank: u32) -> vec2u {
    let bit = 1u << (rank & 31u);
    return ranks | select(vec2u(0u, bit), vec2u(bit, 0u), rank < 32u);
}

fn daa_has(ranks: vec2u, rank: u32) -> bool {
    return ((select(ranks.y, ranks.x, rank < 32u) >> (rank & 31u)) & 1u) != 0u;
}

fn daa_rank_count(ranks: vec2u) -> u32 {
    return countOneBits(ranks.x) + countOneBits(ranks.y);
}

/// The number of ranks in the set below this one.
fn daa_rank_count_below(ranks: vec2u, rank: u32) -> u32 {
    let below = (1u << (rank & 31u)) - 1u;
    return select(countOneBits(ranks.x) + countOneBits(ranks.y & below), countOneBits(ranks.x & below), rank < 32u);
}

fn daa_least(ranks: vec2u) -> u32 {
    return select(firstTrailingBit(ranks.x), firstTrailingBit(ranks.y) + 32u, ranks.x == 0u);
}

fn daa_without_least(ranks: vec2u) -> vec2u {
    return select(vec2u(ranks.x & (ranks.x - 1u), ranks.y), vec2u(0u, ranks.y & (ranks.y - 1u)), ranks.x == 0u);
}
