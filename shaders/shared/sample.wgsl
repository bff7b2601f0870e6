// Reads the G-buffer into the `DaaSample` of a pixel and a rank. The files of shaders/gbuffer read what lies there.

// GLSL can't load from `texture_depth_2d`.
@group(0) @binding(1) var daa_gbuffer_depth: texture_2d<f32>;

/// Depths below this are the sky. It lies above every denormal, so that flushing denormals to 0 changes nothing.
const DAA_SKY_DEPTH: f32 = 1e-30;

/// The depth of the sample there: 1 is near, 0 far.
fn daa_depth_at(at: vec2u) -> f32 {
    return textureLoad(daa_gbuffer_depth, at, 0).x;
}

/// The attributes of a sample of the G-buffer, which `daa_attributes_at` reads.
struct DaaAttributes {
    /// Position relative to the camera. The sky has no distance, so it lies on the near plane.
    relative_position: vec3f,
    normal: vec3f,
    /// material | object << 16.
    identity: u32,
    geometric_normal: vec3f,
    user: u32,
    tangent: vec4f,
    uv: vec2f,
    /// Gradients of uv per sample of the G-buffer.
    ddx: vec2f,
    ddy: vec2f,
    /// Whether the normal was never written.
    normal_unset: bool,
    geometric_normal_unset: bool,
}

/// The index of a sample among all samples, rank by rank and tile by tile.
fn daa_sample_index(pixel: vec2u, rank: u32) -> u32 {
    return rank * daa_tile_count() * 64u + daa_slot(pixel);
}

/// The tile of the image that a workgroup may audit: it is audited if its first pixel is shown. Each row is shifted by
/// 11 against the last, so that no column is left out for long. x may lie beyond the end of the row.
fn daa_audited_tile(group: vec2u) -> vec2u {
    let period = daa_frame.audit.period;
    let row = group.y + daa_frame.origin.y / 8u;
    let phase = (daa_frame.audit.phase + 11u * (period - row % period)) % period;
    return vec2u(group.x * period + phase, row);
}

/// A tile of the image as a tile of the G-buffer's part. Those before the part get indices so large that their pixels
/// are not shown.
fn daa_tile_of_image(tile: vec2u) -> vec2u {
    return tile - daa_frame.origin / 8u;
}

/// The position of a rank in its window.
fn daa_order(rank: u32) -> vec2u {
    let code = daa_frame.order[rank >> 2u][rank & 3u];
    return vec2u(code & 15u, (code >> 4u) & 15u);
}

/// The quadrants of the window that use the sample of a rank, a bit each.
fn daa_quadrants(rank: u32) -> u32 {
    return (daa_frame.order[rank >> 2u][rank & 3u] >> 8u) & 15u;
}

/// The ranks beyond the first that any of these quadrants uses, as in ranks.wgsl.
fn daa_ranks_of(quadrants: u32) -> vec2u {
    let a = daa_frame.selective.ranks[0];
    let b = daa_frame.selective.ranks[1];
    var ranks = select(vec2u(0u), a.xy, (quadrants & 1u) != 0u) | select(vec2u(0u), a.zw, (quadrants & 2u) != 0u);
    ranks |= select(vec2u(0u), b.xy, (quadrants & 4u) != 0u) | select(vec2u(0u), b.zw, (quadrants & 8u) != 0u);
    return ranks;
}

/// The rank of a position in the window.
fn daa_rank_at(place: vec2u) -> u32 {
    let i = place.y * DAA_M + place.x;
    return daa_frame.order[i >> 2u][i & 3u] >> 16u;
}

/// Normalised device coordinates of the G-buffer coordinates `xy` (in samples, y down).
fn daa_ndc(xy: vec2f) -> vec2f {
    // Both are multiples of a half, so the sum is exact, and the same for every part of the image.
    let of_image = xy + vec2f(daa_frame.origin * DAA_M);
    return of_image / vec2f(daa_frame.image * DAA_M) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
}

/// The step of normalised device coordinates from a sample to the next.
fn daa_sample_ndc() -> vec2f {
    return vec2f(2.0, -2.0) / vec2f(daa_frame.image * DAA_M);
}

/// The position, relative to the camera, of the point at the G-buffer coordinates `xy` (in samples, y down) and depth
/// `d`.
fn daa_relative_position(xy: vec2f, d: f32) -> vec3f {
    let p = daa_frame.relative_from_clip * vec4f(daa_ndc(xy), d, 1.0);
    return p.xyz / p.w;
}

/// material | object << 16 of what a sample shows, and whether that is the sky, which has one identity.
fn daa_seen_identity(at: vec2u) -> vec2u {
    let sky = daa_depth_at(at) <= DAA_SKY_DEPTH;
    return vec2u(select(daa_identity_at(at), 0u, sky), u32(sky));
}

/// Reads a sample. `footprint` scales the uv gradients; `offset` shifts the texture lookup along the surface, in
/// samples.
fn daa_fetch(pixel: vec2u, rank: u32, footprint: f32, offset: vec2f) -> DaaSample {
    let at = pixel * DAA_M + daa_order(rank);
    let d = daa_depth_at(at);
    let a = daa_attributes_at(at, d);
    let valid = d > DAA_SKY_DEPTH;

    var s: DaaSample;
    s.pixel = pixel + daa_frame.origin;
    s.rank = rank;
    s.texel = at;
    let relative = a.relative_position;
    let towards = select(-relative, -daa_frame.camera_forward, daa_frame.orthographic != 0u);
    s.view = towards * inverseSqrt(max(dot(towards, towards), 1e-30));
    s.relative_position = relative;
    s.position = relative + daa_frame.camera_position;
    s.depth = select(0.0, dot(relative, daa_frame.camera_forward), valid);
    s.normal = a.normal;
    s.geometric_normal = a.geometric_normal;
    s.tangent = a.tangent;
    s.material = a.identity & 0xffffu;
    s.object = a.identity >> 16u;
    s.user = a.user;
    s.uv = a.uv + a.ddx * offset.x + a.ddy * offset.y;
    s.ddx = a.ddx * footprint;
    s.ddy = a.ddy * footprint;
    // Tiles with nothing but sky are not traced, and hold no bits.
    s.shadow = select(0u, daa_shadow_bits(pixel, rank), valid);
    let code = daa_reflection_code(pixel, rank);
    let apart = daa_flag(DAA_FLAG_REFLECTIONS_APART);
    s.reflected = select(daa_radiance_decode(code), vec3f(0.0), apart);
    s.traced = u32(code != 0u);
    return s;
}
