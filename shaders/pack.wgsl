// Packs a fragment into the G-buffer. A host joins octahedral.wgsl and this file with its raster shader and returns
// `daa_pack(fragment)` from its fragment entry point.

/// What the host's fragment shader knows.
struct DaaFragment {
    /// Interpolated normal, world space, any length above 0, on the side that is seen.
    normal: vec3f,
    /// Index into the host's materials, below 65536.
    material: u32,
    /// Normal of the triangle, world space, any length above 0, on the side that is seen.
    geometric_normal: vec3f,
    /// Which object this is, below 65536. Two objects that touch need two ids.
    object: u32,
    /// World space; w the sign of the bitangent. Zero if there is none.
    tangent: vec4f,
    uv: vec2f,
    /// dpdx(uv): per sample of the G-buffer.
    ddx: vec2f,
    /// dpdy(uv).
    ddy: vec2f,
    /// The host's own 32 bits.
    user: u32,
}

/// The colour targets of the G-buffer, 32 bytes a sample.
struct DaaGBuffer {
    /// Normal 16+16 bits octahedral; material 16 | object 16.
    @location(0) surface: vec2u,
    /// Geometric normal 8+8 bits octahedral, tangent 16; the host's 32 bits.
    @location(1) frame: vec2u,
    /// u, v as f32; the gradients as four f16.
    @location(2) uv: vec4u,
}

/// Finite and inside f16; infinity and NaN by their bits, since a compiler may assume that they never occur.
fn daa_finite_half(v: vec2f) -> vec2f {
    let bits = bitcast<vec2u>(v) & vec2u(0x7f800000u);
    return select(clamp(v, vec2f(-65504.0), vec2f(65504.0)), vec2f(0.0), bits == vec2u(0x7f800000u));
}

fn daa_pack(f: DaaFragment) -> DaaGBuffer {
    let normal = pack2x16snorm(daa_octahedral_encode(f.normal));
    let decoded = daa_octahedral_decode(unpack2x16snorm(normal));
    let geometric = pack4x8snorm(vec4f(daa_octahedral_encode(f.geometric_normal), 0.0, 0.0));
    let no_number = (bitcast<vec2u>(f.uv) & vec2u(0x7f800000u)) == vec2u(0x7f800000u);
    let uv = select(f.uv, vec2f(0.0), no_number);
    return DaaGBuffer(
        vec2u(normal, (f.material & 0xffffu) | (f.object << 16u)),
        vec2u((geometric & 0xffffu) | (daa_tangent_encode(decoded, f.tangent) << 16u), f.user),
        vec4u(
            bitcast<u32>(uv.x),
            bitcast<u32>(uv.y),
            pack2x16float(daa_finite_half(f.ddx)),
            pack2x16float(daa_finite_half(f.ddy)),
        ),
    );
}
