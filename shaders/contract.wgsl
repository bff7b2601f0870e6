// The contract between deferred-aa and a host's shading code: all that a host reads or writes.
// Joined after the host's source in every module that shades. Names of the crate begin with daa_, Daa or DAA_.

/// Samples along one side of a pixel's window; n = m².
override DAA_M: u32 = 1u;

/// One sample of the G-buffer, as `material`, `shade` and `sky` see it.
struct DaaSample {
    /// World space.
    position: vec3f,
    /// Distance along the view direction of the camera, world units. 0 for the sky.
    depth: f32,
    /// From the camera; exact where world coordinates are large.
    relative_position: vec3f,
    material: u32,
    /// Unit vector from the sample to the camera.
    view: vec3f,
    object: u32,
    /// Unit normal of the triangle, on the side that is seen (8+8 bits: within 1°).
    geometric_normal: vec3f,
    /// The host's own 32 bits.
    user: u32,
    /// Unit interpolated normal (16+16 bits: within 0.004°).
    normal: vec3f,
    /// Bit i set: light i does not reach the sample.
    shadow: u32,
    /// Unit tangent and the sign of the bitangent: B = w (N × T).
    tangent: vec4f,
    uv: vec2f,
    /// The footprint that this sample stands for, along x: about √(n/k) times its own.
    ddx: vec2f,
    /// Along y.
    ddy: vec2f,
    /// The output pixel.
    pixel: vec2u,
    /// Radiance from reflection and refraction rays, to be added as it is. 0 where the crate adds it to every sample itself.
    secondary: vec3f,
    /// The sample's place in the order of its window.
    rank: u32,
    /// 1 if reflections and refractions were traced; 0 if the host had better stand in for them.
    traced: u32,
}

/// A piece of surface under one pixel, as `light` sees it: a sample, or the centroid of several.
struct DaaSurface {
    /// World space.
    position: vec3f,
    /// Distance along the view direction of the camera, world units.
    depth: f32,
    /// From the camera.
    relative_position: vec3f,
    material: u32,
    /// Unit vector to the camera.
    view: vec3f,
    object: u32,
    /// Unit normal of the triangle.
    geometric_normal: vec3f,
    /// The host's own 32 bits.
    user: u32,
    /// Unit interpolated normal, before normal maps.
    normal: vec3f,
    /// Bit i set: light i does not reach the surface.
    shadow: u32,
    /// Radiance from reflection and refraction rays, to be added as it is. 0 where the crate adds it to every sample itself.
    secondary: vec3f,
    /// Its share of the window, above 0, at most 1.
    coverage: f32,
    /// The output pixel.
    pixel: vec2u,
    /// 1 if reflections and refractions were traced; 0 if the host had better stand in for them.
    traced: u32,
}

/// What a surface reflects and refracts: the host's `bounce` says it.
struct DaaBounce {
    /// Weight of the radiance that the mirrored ray meets; 0: none is traced.
    reflection: vec3f,
    /// Index of refraction of the object's inside over its outside; 1: the ray goes straight on.
    ior: f32,
    /// Weight of what the refracted ray meets; 0: none is traced.
    refraction: vec3f,
    /// World space, unit length: both are taken about it.
    normal: vec3f,
}

/// What textures say about a sample. The crate may average it over several samples of one surface, so every
/// field must mean something when averaged; `user` fields are the host's own.
struct DaaMaterial {
    /// Linear, with alpha.
    base_color: vec4f,
    /// Linear radiance.
    emissive: vec3f,
    /// Perceptual roughness, 0 to 1.
    roughness: f32,
    /// World space, after normal maps. An average may be shorter than 1.
    normal: vec3f,
    /// 0 dielectric, 1 metal.
    metallic: f32,
    user0: vec4f,
    user1: vec4f,
    /// Ambient visibility, 0 to 1.
    occlusion: f32,
}

/// The surface that a single sample stands for.
fn daa_surface(s: DaaSample, coverage: f32) -> DaaSurface {
    var f: DaaSurface;
    f.position = s.position;
    f.depth = s.depth;
    f.relative_position = s.relative_position;
    f.material = s.material;
    f.view = s.view;
    f.object = s.object;
    f.geometric_normal = s.geometric_normal;
    f.user = s.user;
    f.normal = s.normal;
    f.shadow = s.shadow;
    f.secondary = s.secondary;
    f.coverage = coverage;
    f.pixel = s.pixel;
    f.traced = s.traced;
    return f;
}

/// A tangent-space normal (x, y in [−1, 1] along tangent and bitangent) in world space, unit length.
fn daa_apply_normal_map(s: DaaSample, n: vec3f) -> vec3f {
    let bitangent = cross(s.normal, s.tangent.xyz) * s.tangent.w;
    let world = s.tangent.xyz * n.x + bitangent * n.y + s.normal * n.z;
    return world * inverseSqrt(max(dot(world, world), 1e-20));
}

/// Rec. 709 luminance of linear RGB.
fn daa_luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}
