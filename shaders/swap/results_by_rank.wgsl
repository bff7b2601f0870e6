// Where the results of a sample's rays lie, for passes that only read ranks which have a word for each slot.

fn daa_result_index(pixel: vec2u, rank: u32) -> u32 {
    return daa_sample_index(pixel, rank);
}
