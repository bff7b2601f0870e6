// Packs a fragment into a stored G-buffer. `GBufferTier::pack_wgsl` has octahedral.wgsl, this file, and `DaaGBuffer`
// and `daa_pack` for the channels that are kept. A host joins them with its raster shader and returns
// `daa_pack(fragment)` from its fragment entry point.

/// The surface attributes of a fragment, set by the host's fragment shader.
struct DaaFragment {
    /// Interpolated normal in world space, of any length above 0, on the visible side.
    normal: vec3f,
    /// Index of the material, below 65536.
    material: u32,
    /// Normal of the triangle in world space, of any length above 0, on the visible side.
    geometric_normal: vec3f,
    /// Id of the object, below 65536. Two objects that touch need different ids.
    object: u32,
    /// Tangent in world space; w is the sign of the bitangent. Zero if there is none.
    tangent: vec4f,
    /// Texture coordinates.
    uv: vec2f,
    /// dpdx(uv), the gradient per sample of the G-buffer.
    ddx: vec2f,
    /// dpdy(uv), the gradient per sample of the G-buffer.
    ddy: vec2f,
    /// The host's own 32 bits.
    user: u32,
}

/// Clamps to the range of f16, and replaces infinity and NaN by 0. These are recognised by their bits, since a compiler
/// may assume that they never occur.
fn daa_finite_half(v: vec2f) -> vec2f {
    let bits = bitcast<vec2u>(v) & vec2u(0x7f800000u);
    return select(clamp(v, vec2f(-65504.0), vec2f(65504.0)), vec2f(0.0), bits == vec2u(0x7f800000u));
}

/// Normal (octahedral, 16+16 bits); material (16 bits) and object (16 bits).
fn daa_pack_surface(f: DaaFragment) -> vec2u {
    return vec2u(pack2x16snorm(daa_octahedral_encode(f.normal)), (f.material & 0xffffu) | (f.object << 16u));
}

/// Geometric normal (octahedral, 8+8 bits) and tangent (16 bits); the host's 32 bits.
fn daa_pack_frame(f: DaaFragment, normal: u32) -> vec2u {
    let decoded = daa_octahedral_decode(unpack2x16snorm(normal));
    let geometric = pack4x8snorm(vec4f(daa_octahedral_encode(f.geometric_normal), 0.0, 0.0));
    return vec2u((geometric & 0xffffu) | (daa_tangent_encode(decoded, f.tangent) << 16u), f.user);
}

/// u and v as f32; the gradients as four f16.
fn daa_pack_uv(f: DaaFragment) -> vec4u {
    let no_number = (bitcast<vec2u>(f.uv) & vec2u(0x7f800000u)) == vec2u(0x7f800000u);
    let uv = select(f.uv, vec2f(0.0), no_number);
    return vec4u(
        bitcast<u32>(uv.x),
        bitcast<u32>(uv.y),
        pack2x16float(daa_finite_half(f.ddx)),
        pack2x16float(daa_finite_half(f.ddy)),
    );
}
