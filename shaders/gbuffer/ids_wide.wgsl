/// Index of the instance + 1, 0 where nothing is drawn, and index of the triangle.
fn daa_ids_at(at: vec2u) -> vec2u {
    return textureLoad(daa_gbuffer_ids, at, 0).xy;
}
