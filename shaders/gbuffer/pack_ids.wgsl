// Packs the ids of a triangle into a visibility buffer. A host joins this file with its raster shader and returns
// `daa_pack(instance, triangle)` from its fragment entry point; a masked fragment is discarded before.

/// The colour target of the G-buffer.
struct DaaGBuffer {
    /// Index of the instance + 1, and index of the triangle in its mesh.
    @location(0) ids: vec2u,
}

fn daa_pack(instance: u32, triangle: u32) -> DaaGBuffer {
    return DaaGBuffer(vec2u(instance + 1u, triangle));
}
