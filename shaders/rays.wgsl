// rays: what a ray and its hit are, whatever traces them.

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
