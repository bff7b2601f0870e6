// The bilateral weight between two samples in subpixel reconstruction (Chajdas, McGuire, Luebke 2011; WSCG 2012,
// section 3.1). CPU twin: `weight` of src/reference/reconstruct.rs.

/// The attributes of a sample that the weight depends on.
struct DaaGeometry {
    /// Position relative to the camera.
    position: vec3f,
    /// Depth along the view direction; 0 for the sky.
    depth: f32,
    normal: vec3f,
    identity: u32,
    shadow: u32,
}

fn daa_geometry(pixel: vec2u, rank: u32) -> DaaGeometry {
    let at = pixel * DAA_M + daa_order(rank);
    let surface = daa_surface_at(at);
    return daa_geometry_of(pixel, rank, daa_depth_at(at), surface);
}

/// The geometry of a sample whose depth and surface target are already read.
fn daa_geometry_of(pixel: vec2u, rank: u32, d: f32, surface: vec2u) -> DaaGeometry {
    let at = pixel * DAA_M + daa_order(rank);
    let valid = d > DAA_SKY_DEPTH;
    let position = daa_relative_position(vec2f(at) + 0.5, select(1.0, d, valid));
    let depth = select(0.0, dot(position, daa_frame.camera_forward), valid);
    let normal = daa_octahedral_decode(unpack2x16snorm(surface.x));
    return DaaGeometry(position, depth, normal, select(0u, surface.y, valid), select(0u, daa_shadow_bits(pixel, rank), valid));
}

/// The weight of a shaded sample j for a geometric sample i, 0 to 1.
fn daa_reconstruct_weight(i: DaaGeometry, j: DaaGeometry) -> f32 {
    if i.depth == 0.0 || j.depth == 0.0 {
        return f32(i.depth == j.depth);
    }
    if (daa_flag(DAA_FLAG_CUT_IDENTITY) && i.identity != j.identity) || (daa_flag(DAA_FLAG_CUT_SHADOW) && i.shadow != j.shadow) {
        return 0.0;
    }
    // As in the paper, G(σz (zj − zi)) and G(σn (1 − sat(nj · ni))), with depths relative to the sample's own.
    var apart = (j.depth - i.depth) / i.depth;
    var bent = 1.0 - clamp(dot(i.normal, j.normal), 0.0, 1.0);
    if daa_flag(DAA_FLAG_PLANES) {
        // The sine of the angle at which j rises from i's plane, which is 0 on one plane however slanted it is, and the
        // chord between the normals.
        let way = j.position - i.position;
        // Two ways of computing one position differ by rounding, whose direction means nothing.
        let least = 1e-6 * i.depth;
        apart = dot(way, i.normal) * inverseSqrt(max(dot(way, way), max(least * least, 1e-30)));
        let chord = j.normal - i.normal;
        bent = sqrt(dot(chord, chord));
    }
    let z = daa_frame.reconstruct.depth_scale * apart;
    let n = daa_frame.reconstruct.normal_scale * bent;
    return exp2(-1.44269504 * min(z * z + n * n, 80.0));
}
