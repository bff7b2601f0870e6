// The attributes of a point of a triangle, in the space of its mesh: what a ray hits, and what a visibility buffer
// shows. CPU twin: src/reference/triangle.rs.

/// The attributes of the three vertices.
struct DaaTriangle {
    normal_a: vec3f,
    normal_b: vec3f,
    normal_c: vec3f,
    /// Codes of the normals.
    normals: vec3u,
    /// Codes of the tangents.
    tangents: vec3u,
    uv_a: vec2f,
    /// From the first vertex to the second and the third.
    uv_ab: vec2f,
    uv_ac: vec2f,
    user: vec3u,
}

/// `a`, `b` and `c` are the attributes as src/rays/attributes.rs packs them.
fn daa_triangle_attributes(a: vec4u, b: vec4u, c: vec4u, user: vec3u) -> DaaTriangle {
    var t: DaaTriangle;
    t.normal_a = daa_octahedral_decode(unpack2x16snorm(a.x));
    t.normal_b = daa_octahedral_decode(unpack2x16snorm(b.x));
    t.normal_c = daa_octahedral_decode(unpack2x16snorm(c.x));
    t.normals = vec3u(a.x, b.x, c.x);
    t.tangents = vec3u(a.y, b.y, c.y);
    t.uv_a = bitcast<vec2f>(a.zw);
    t.uv_ab = bitcast<vec2f>(b.zw) - t.uv_a;
    t.uv_ac = bitcast<vec2f>(c.zw) - t.uv_a;
    t.user = user;
    return t;
}

/// The interpolated normal, of any length. `w` are the weights of the vertices.
fn daa_triangle_normal(t: DaaTriangle, w: vec3f) -> vec3f {
    return t.normal_a * w.x + t.normal_b * w.y + t.normal_c * w.z;
}

/// A vertex's tangent from its code: 15 bits of the way around the diamond |x| + |y| = 1 about the normal, which takes
/// no sine. The side of the basis follows from the code of the normal: n.z may round to either side of 0.
fn daa_vertex_tangent(n: vec3f, normal: u32, code: u32) -> vec3f {
    let way = f32(code & 0x7fffu) * (4.0 / 32768.0);
    let along = vec2f(abs(way - 2.0) - 1.0, select(1.0 - abs(way - 1.0), abs(way - 3.0) - 1.0, way >= 2.0));
    let e = abs(vec2i(i32(normal << 16u) >> 16u, i32(normal) >> 16u));
    let s = select(-1.0, 1.0, e.x + e.y <= 32767);
    let k = -1.0 / (s + n.z);
    let x = vec3f(1.0 + s * n.x * n.x * k, s * n.x * n.y * k, -s * n.x);
    return (along.x * x + along.y * cross(n, x)) * inverseSqrt(dot(along, along));
}

/// The interpolated tangent, of any length, and the sign of the bitangent.
fn daa_triangle_tangent(t: DaaTriangle, w: vec3f) -> vec4f {
    let a = daa_vertex_tangent(t.normal_a, t.normals.x, t.tangents.x);
    let b = daa_vertex_tangent(t.normal_b, t.normals.y, t.tangents.y);
    let c = daa_vertex_tangent(t.normal_c, t.normals.z, t.tangents.z);
    return vec4f(a * w.x + b * w.y + c * w.z, select(1.0, -1.0, (t.tangents.x & 0x8000u) != 0u));
}

fn daa_triangle_uv(t: DaaTriangle, w: vec3f) -> vec2f {
    return t.uv_a + t.uv_ab * w.y + t.uv_ac * w.z;
}

fn daa_triangle_user(t: DaaTriangle, w: vec3f) -> u32 {
    return daa_user_between(t.user, w);
}
