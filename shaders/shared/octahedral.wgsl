// Encodes unit vectors as two numbers (Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit
// Vectors"), and tangents as an angle about the normal. sign(0) = +1, so that −0 and the axes have one code each.

fn daa_sign(v: vec2f) -> vec2f {
    return select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

/// Encodes a vector of any length above 0 in [−1, 1]².
fn daa_octahedral_encode(v: vec3f) -> vec2f {
    let p = v.xy / max(abs(v.x) + abs(v.y) + abs(v.z), 1e-30);
    return select((1.0 - abs(p.yx)) * daa_sign(p), p, v.z >= 0.0);
}

/// Decodes a point in [−1, 1]² to a unit vector.
fn daa_octahedral_decode(e: vec2f) -> vec3f {
    let z = 1.0 - abs(e.x) - abs(e.y);
    let folded = (1.0 - abs(e.yx)) * daa_sign(e);
    return normalize(vec3f(select(folded, e, z >= 0.0), z));
}

/// The first axis of a right-handed basis around n, without a branch (Duff et al. 2017, listing 3).
fn daa_basis_x(n: vec3f) -> vec3f {
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    return vec3f(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
}

/// Encodes a tangent as 15 bits of angle and the bitangent's sign. `n` must be the decoded normal.
fn daa_tangent_encode(n: vec3f, tangent: vec4f) -> u32 {
    let x = daa_basis_x(n);
    let a = dot(tangent.xyz, x);
    let b = dot(tangent.xyz, cross(n, x));
    // Without a tangent, or with one along the normal, the angle is 0.
    let angle = select(atan2(b, a), 0.0, a * a + b * b < 1e-20);
    let code = u32(round((angle / 6.28318530718 + 1.0) * 32768.0)) & 0x7fffu;
    return code | select(0u, 0x8000u, tangent.w < 0.0);
}

fn daa_tangent_decode(n: vec3f, code: u32) -> vec4f {
    let x = daa_basis_x(n);
    let angle = f32(code & 0x7fffu) * (6.28318530718 / 32768.0);
    return vec4f(cos(angle) * x + sin(angle) * cross(n, x), select(1.0, -1.0, (code & 0x8000u) != 0u));
}
