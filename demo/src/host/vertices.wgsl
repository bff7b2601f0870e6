// The vertices of the scene's instances: what the G-buffer is rendered from, and what is blended over the image.

struct View {
    clip_from_relative: mat4x4f,
    /// 1 if all view directions are parallel.
    orthographic: vec4f,
}

struct Instance {
    /// Camera-relative from mesh space, in rows.
    rows: array<vec4f, 3>,
    material: u32,
    object: u32,
    /// −1 if the matrix mirrors.
    handedness: f32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> instances: array<Instance>;

struct Vertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec2f,
    @location(4) color: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) relative: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec2f,
    @location(4) color: vec4f,
    @location(5) @interpolate(flat) instance: u32,
}

@vertex
fn raster_vertex(v: Vertex, @builtin(instance_index) index: u32) -> Varying {
    let i = instances[index];
    let p = vec4f(v.position, 1.0);
    let relative = vec3f(dot(i.rows[0], p), dot(i.rows[1], p), dot(i.rows[2], p));
    // Normals go with the cofactors, which also hold where the matrix is singular.
    let r0 = i.rows[0].xyz;
    let r1 = i.rows[1].xyz;
    let r2 = i.rows[2].xyz;
    let normal = vec3f(dot(cross(r1, r2), v.normal), dot(cross(r2, r0), v.normal), dot(cross(r0, r1), v.normal));
    let tangent = vec3f(dot(r0, v.tangent.xyz), dot(r1, v.tangent.xyz), dot(r2, v.tangent.xyz));
    var out: Varying;
    out.clip = view.clip_from_relative * vec4f(relative, 1.0);
    out.relative = relative;
    out.normal = normal * (i.handedness * inverseSqrt(max(dot(normal, normal), 1e-36)));
    out.tangent = vec4f(tangent * inverseSqrt(max(dot(tangent, tangent), 1e-36)), v.tangent.w * i.handedness);
    out.uv = v.uv;
    out.color = v.color;
    out.instance = index;
    return out;
}

/// The directions of a surface on the side that is seen.
struct Facing {
    normal: vec3f,
    geometric_normal: vec3f,
    tangent: vec4f,
}

/// A vector to the camera, of any length.
fn towards_camera(relative: vec3f) -> vec3f {
    return select(-relative, view.orthographic.xyz, view.orthographic.w != 0.0);
}

/// A vector of moderate length, so that products of it neither overflow nor vanish.
fn moderate(v: vec3f) -> vec3f {
    let greatest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return v / max(greatest, 1e-37);
}

/// `across` and `down` are the steps of the relative position from pixel to pixel.
fn facing(v: Varying, front: bool, across: vec3f, down: vec3f) -> Facing {
    // Towards the eye, whichever way the triangle winds.
    let towards = towards_camera(v.relative);
    let plane = cross(moderate(across), moderate(down));
    let side = select(-1.0, 1.0, front);
    let normal = v.normal * side;
    let seen = select(plane, -plane, dot(plane, towards) < 0.0);
    var f: Facing;
    f.normal = select(vec3f(0.0, 1.0, 0.0), normal, dot(normal, normal) > 1e-12);
    f.geometric_normal = select(f.normal, seen, dot(plane, plane) > 1e-12);
    f.tangent = vec4f(v.tangent.xyz, v.tangent.w * side);
    return f;
}
