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

/// The bit that is set and has n others below it, found by halves.
fn daa_nth_bit(bits: u32, n: u32) -> u32 {
    var left = n;
    var bit = 0u;
    for (var half = 16u; half > 0u; half >>= 1u) {
        let lower = countOneBits((bits >> bit) & ((1u << half) - 1u));
        if left >= lower {
            left -= lower;
            bit += half;
        }
    }
    return bit;
}

/// The rank in the set that has n others below it.
fn daa_nth_rank(ranks: vec2u, n: u32) -> u32 {
    let in_low = countOneBits(ranks.x);
    if n < in_low {
        return daa_nth_bit(ranks.x, n);
    }
    return 32u + daa_nth_bit(ranks.y, n - in_low);
}

fn daa_least(ranks: vec2u) -> u32 {
    return select(firstTrailingBit(ranks.x), firstTrailingBit(ranks.y) + 32u, ranks.x == 0u);
}

fn daa_without_least(ranks: vec2u) -> vec2u {
    return select(vec2u(ranks.x & (ranks.x - 1u), ranks.y), vec2u(0u, ranks.y & (ranks.y - 1u)), ranks.x == 0u);
}
