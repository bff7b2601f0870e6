// Encodes radiance in 32 bits: three mantissas of 9 bits and a common exponent of 5 (EXT_texture_shared_exponent). The
// code 0 means that nothing was traced; black has a code of its own. CPU twin: src/reference/rays/shared_exponent.rs.

const DAA_TRACED_BLACK: u32 = 0x08000000u;

fn daa_radiance_encode(c: vec3f) -> u32 {
    let v = clamp(c, vec3f(0.0), vec3f(65408.0));
    let greatest = max(max(v.x, v.y), v.z);
    // The exponent of the greatest component, from its bits. The least that can be encoded is 2⁻¹⁵.
    var e = max(i32(bitcast<u32>(greatest) >> 23u) - 127, -16) + 16;
    var scale = exp2(f32(24 - e));
    if round(greatest * scale) >= 512.0 {
        e += 1;
        scale *= 0.5;
    }
    let m = vec3u(round(v * scale));
    let code = m.x | (m.y << 9u) | (m.z << 18u) | (u32(e) << 27u);
    return select(code, DAA_TRACED_BLACK, all(m == vec3u(0u)));
}

fn daa_radiance_decode(code: u32) -> vec3f {
    let scale = exp2(f32(code >> 27u) - 24.0);
    return vec3f(vec3u(code, code >> 9u, code >> 18u) & vec3u(511u)) * scale;
}
