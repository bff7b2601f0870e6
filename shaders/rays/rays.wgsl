// rays: a ray and its hit, for every way of tracing.

/// A ray relative to the camera: the points `origin + t · direction` with t_min < t < t_max, all finite. The direction
/// may have any length above 0.
struct DaaRay {
    origin: vec3f,
    t_min: f32,
    direction: vec3f,
    t_max: f32,
}

struct DaaHit {
    /// Distance in lengths of the ray's direction; the ray's t_max if it hit nothing.
    t: f32,
    /// Index of the instance in the frame; DAA_MISS if the ray hit nothing.
    instance: u32,
    /// Index of the triangle in its mesh.
    triangle: u32,
    /// 1 if the vertices appear counterclockwise in the mesh's own space, whether or not the instance mirrors it;
    /// otherwise 0.
    front: u32,
    /// Weights of the second and the third vertex.
    barycentrics: vec2f,
    /// Index of the instance's record in daa_ray_top.
    record: u32,
    /// Index of the triangle in daa_ray_meshes.
    corners: u32,
}

const DAA_MISS: u32 = 0xffffffffu;

/// Flags of a ray, which may be joined. The first hit that is found will do, and need not be the nearest.
const DAA_RAY_ANY: u32 = 1u;
/// Back faces of instances that are culled do not stop it.
const DAA_RAY_CULL: u32 = 2u;
/// Instances that cast no shadow do not stop it.
const DAA_RAY_SHADOW: u32 = 4u;

/// Flags of an instance, in the last word of its record. `daa_ray_solid` is called for its hits.
const DAA_INSTANCE_MASKED: u32 = 1u;
/// Its back faces are not drawn.
const DAA_INSTANCE_CULLED: u32 = 2u;
/// It casts no shadow.
const DAA_INSTANCE_CLEAR: u32 = 4u;

/// The interpolated uv of a hit. `attributes` are the indices of its vertices' attributes.
fn daa_ray_uv(attributes: vec3u, barycentrics: vec2f) -> vec2f {
    let a = bitcast<vec2f>(daa_ray_meshes[attributes.x].zw);
    let b = bitcast<vec2f>(daa_ray_meshes[attributes.y].zw);
    let c = bitcast<vec2f>(daa_ray_meshes[attributes.z].zw);
    return a + (b - a) * barycentrics.x + (c - a) * barycentrics.y;
}

/// The host's 32 bits at a hit.
fn daa_ray_user(corners: vec3u, barycentrics: vec2f) -> u32 {
    let user = vec3u(daa_ray_meshes[corners.x].w, daa_ray_meshes[corners.y].w, daa_ray_meshes[corners.z].w);
    return daa_user_between(user, vec3f(1.0 - barycentrics.x - barycentrics.y, barycentrics));
}

/// What decides whether a triangle stops a ray: the ray's flags, and the object whose back faces it passes through.
struct DaaPassing {
    flags: u32,
    through: u32,
}

/// Whether a triangle that a ray meets stops it. `names` and `more` are the last two vec4s of its instance's record.
fn daa_ray_stops(names: vec4u, more: vec4u, corners: vec3u, barycentrics: vec2f, front: bool, passing: DaaPassing) -> bool {
    let culled = (passing.flags & DAA_RAY_CULL) != 0u && (more.w & DAA_INSTANCE_CULLED) != 0u;
    if !front && (more.y == passing.through || culled) {
        return false;
    }
    if (passing.flags & DAA_RAY_SHADOW) != 0u && (more.w & DAA_INSTANCE_CLEAR) != 0u {
        return false;
    }
    if (more.w & DAA_INSTANCE_MASKED) == 0u {
        return true;
    }
    return daa_ray_solid(more.x, daa_ray_uv(corners + names.w, barycentrics), daa_ray_user(corners, barycentrics));
}
