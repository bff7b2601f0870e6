// rays: what a ray and its hit are, whatever traces them.

/// Relative to the camera. Points at `origin + t · direction`, t_min < t < t_max, all finite; the direction need not be
/// of unit length, but not zero.
struct DaaRay {
    origin: vec3f,
    t_min: f32,
    direction: vec3f,
    t_max: f32,
}

struct DaaHit {
    /// In lengths of the ray's direction; the ray's t_max if it hit nothing.
    t: f32,
    /// The place of the instance among the frame's, DAA_MISS if it hit nothing.
    instance: u32,
    /// Of the mesh.
    triangle: u32,
    /// 1 if its vertices are seen counterclockwise in the mesh's own space, whether the instance mirrors it or not;
    /// else 0.
    front: u32,
    /// Weights of the second and the third vertex.
    barycentrics: vec2f,
    /// Where the instance's record begins in daa_ray_top.
    record: u32,
    /// Where the triangle's lies in daa_ray_geometry.
    corners: u32,
}

const DAA_MISS: u32 = 0xffffffffu;

/// Of an instance's flags: `daa_ray_solid` is asked.
const DAA_RAY_MASKED: u32 = 1u;

/// Where a triangle's interpolated uv is.
fn daa_ray_uv(attributes: vec3u, barycentrics: vec2f) -> vec2f {
    let a = bitcast<vec2f>(daa_ray_geometry[attributes.x].zw);
    let b = bitcast<vec2f>(daa_ray_geometry[attributes.y].zw);
    let c = bitcast<vec2f>(daa_ray_geometry[attributes.z].zw);
    return a + (b - a) * barycentrics.x + (c - a) * barycentrics.y;
}

/// Whether a triangle that a ray meets stops it. `names` and `more` are the last two vec4s of its instance's record.
fn daa_ray_stops(names: vec4u, more: vec4u, corners: vec3u, barycentrics: vec2f, front: bool, through: u32) -> bool {
    if !front && more.y == through {
        return false;
    }
    if (more.w & DAA_RAY_MASKED) == 0u {
        return true;
    }
    return daa_ray_solid(more.x, daa_ray_uv(corners + names.w, barycentrics));
}
