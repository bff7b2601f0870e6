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

/// The rank in the set that has n others below it.
fn daa_nth_rank(ranks: vec2u, n: u32) -> u32 {
    let in_low = countOneBits(ranks.x);
    let high = n >= in_low;
    let bits = select(ranks.x, ranks.y, high);
    var left = select(n, n - in_low, high);
    var bit = 0u;
    for (var half = 16u; half > 0u; half >>= 1u) {
        let lower = countOneBits((bits >> bit) & ((1u << half) - 1u));
        if left >= lower {
            left -= lower;
            bit += half;
        }
    }
    return bit + select(0u, 32u, high);
}

fn daa_least(ranks: vec2u) -> u32 {
    return select(firstTrailingBit(ranks.x), firstTrailingBit(ranks.y) + 32u, ranks.x == 0u);
}

fn daa_without_least(ranks: vec2u) -> vec2u {
    return select(vec2u(ranks.x & (ranks.x - 1u), ranks.y), vec2u(0u, ranks.y & (ranks.y - 1u)), ranks.x == 0u);
}
