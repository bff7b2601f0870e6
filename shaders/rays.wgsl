// rays: what a ray and its hit are, whatever traces them, and the watertight test of a triangle.

/// Relative to the camera. Points at `origin + t · direction`, t_min < t < t_max, all finite; the direction need not be of
/// unit length, but not zero.
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
    /// 1 if its vertices are seen counterclockwise in the mesh's own space, whether the instance mirrors it or not; else 0.
    front: u32,
    /// Weights of the second and the third vertex.
    barycentrics: vec2f,
}

const DAA_MISS: u32 = 0xffffffffu;

/// The origin of a ray that leaves a surface: so far along the normal that no rounding of the position reaches back to the
/// surface. `towards` is where the ray goes. In place of the constants of Wächter and Binder 2019, which know one scale of
/// scenes, the step grows with what the position was rounded to: 2⁻¹⁶ of the distance from the camera, and 2⁻²² of the
/// coordinates in the world.
fn daa_ray_origin(relative: vec3f, world: vec3f, normal: vec3f, towards: vec3f) -> vec3f {
    let r = abs(relative);
    let w = abs(world);
    let step = max(max(r.x, r.y), r.z) * 1.52587890625e-5 + max(max(w.x, w.y), w.z) * 2.384185791015625e-7;
    return relative + normal * select(-step, step, dot(normal, towards) >= 0.0);
}
