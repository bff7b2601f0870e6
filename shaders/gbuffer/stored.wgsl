// Reads a stored G-buffer: the attributes of each sample, as pack.wgsl wrote them.

@group(0) @binding(2) var daa_gbuffer_surface: texture_2d<u32>;

/// The code of the normal, and material | object << 16. Both are 0 where the host has drawn nothing.
fn daa_surface_at(at: vec2u) -> vec2u {
    return textureLoad(daa_gbuffer_surface, at, 0).xy;
}

/// What two samples share that are known to show one triangle: here nothing is known.
fn daa_triangle_at(at: vec2u) -> vec2u {
    return at;
}

/// material | object << 16.
fn daa_identity_at(at: vec2u) -> u32 {
    return textureLoad(daa_gbuffer_surface, at, 0).y;
}

/// The codes of normals are read again where they are needed again.
fn daa_keep_code(lane: u32, i: u32, code: u32) {}

fn daa_kept_code(lane: u32, i: u32, at: vec2u) -> u32 {
    return daa_surface_at(at).x;
}

fn daa_uv_at(at: vec2u) -> vec2f {
    return bitcast<vec2f>(daa_stored_uv(at).xy);
}

/// The host's 32 bits.
fn daa_user_at(at: vec2u) -> u32 {
    return daa_stored_frame(at).y;
}

/// `d` is the sample's depth.
fn daa_attributes_at(at: vec2u, d: f32) -> DaaAttributes {
    let surface = daa_surface_at(at);
    let frame = daa_stored_frame(at);
    let uv = daa_stored_uv(at);
    var a: DaaAttributes;
    a.relative_position = daa_relative_position(vec2f(at) + 0.5, select(1.0, d, d > DAA_SKY_DEPTH));
    a.normal = daa_octahedral_decode(unpack2x16snorm(surface.x));
    a.identity = surface.y;
    a.geometric_normal = daa_octahedral_decode(unpack4x8snorm(frame.x).xy);
    a.user = frame.y;
    a.tangent = daa_tangent_decode(a.normal, frame.x >> 16u);
    a.uv = bitcast<vec2f>(uv.xy);
    a.ddx = unpack2x16float(uv.z);
    a.ddy = unpack2x16float(uv.w);
    a.normal_unset = surface.x == 0u;
    a.geometric_normal_unset = (frame.x & 0xffffu) == 0u;
    return a;
}
