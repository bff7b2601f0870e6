// Stands in for textured.wgsl in scenes without textures, whose G-buffer needs no texture coordinates and no tangents.

fn textured(plain: DaaMaterial, s: DaaSample, index: u32) -> DaaMaterial {
    return plain;
}
