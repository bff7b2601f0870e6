// The contract between deferred-aa and a host's shading code: everything that this code reads or returns. Names that
// begin with daa_, Daa or DAA_ belong to the crate.

/// The number of samples along one side of a pixel's window; n = m².
override DAA_M: u32 = 1u;

/// `DaaSample::texel` of what has none.
const DAA_NO_TEXEL: vec2u = vec2u(0xffffffffu);

/// One sample of the G-buffer: the argument of `shade`, `material`, `sky` and `reflection`.
struct DaaSample {
    /// Position in world space.
    position: vec3f,
    /// Distance along the view direction of the camera in world units; 0 for the sky.
    depth: f32,
    /// Position relative to the camera, in world space. Precise even where world coordinates are large.
    relative_position: vec3f,
    /// Index of the material.
    material: u32,
    /// Unit vector from the sample to the camera.
    view: vec3f,
    /// Id of the object.
    object: u32,
    /// Unit normal of the triangle, on the visible side (8+8 bits where it is stored: accurate within 1°).
    geometric_normal: vec3f,
    /// The host's own 32 bits.
    user: u32,
    /// Unit interpolated normal (16+16 bits where it is stored: accurate within 0.004°).
    normal: vec3f,
    /// Shadow bits: bit i is set if light i does not reach the sample.
    shadow: u32,
    /// Unit tangent, and the sign of the bitangent: B = w (N × T).
    tangent: vec4f,
    /// Texture coordinates.
    uv: vec2f,
    /// Gradient of uv along x, over the area that the sample stands for: about √(n/k) times the sample's own.
    ddx: vec2f,
    /// Gradient of uv along y, likewise.
    ddy: vec2f,
    /// The pixel of the image, whether or not that is rendered in bands.
    pixel: vec2u,
    /// The texel of the G-buffer that holds the sample, for textures of the host's own that are rendered beside it. What
    /// a ray hits has none: `DAA_NO_TEXEL`.
    texel: vec2u,
    /// Radiance from reflection and refraction rays, to be added to the result unchanged. 0 where the crate adds it
    /// itself.
    reflected: vec3f,
    /// The sample's position in the order of its window.
    rank: u32,
    /// 1 if reflections and refractions were traced. If 0, the host may substitute an approximation.
    traced: u32,
}

/// A piece of surface under one pixel, as `light` sees it: a single sample, or the centroid of several.
struct DaaSurface {
    /// Position in world space.
    position: vec3f,
    /// Distance along the view direction of the camera in world units.
    depth: f32,
    /// Position relative to the camera, in world space.
    relative_position: vec3f,
    /// Index of the material.
    material: u32,
    /// Unit vector to the camera.
    view: vec3f,
    /// Id of the object.
    object: u32,
    /// Unit normal of the triangle.
    geometric_normal: vec3f,
    /// The host's own 32 bits.
    user: u32,
    /// Unit interpolated normal, before normal maps.
    normal: vec3f,
    /// Shadow bits: bit i is set if light i does not reach the surface.
    shadow: u32,
    /// Radiance from reflection and refraction rays, to be added to the result unchanged. 0 where the crate adds it
    /// itself.
    reflected: vec3f,
    /// The share of the window that the surface stands for, above 0 and at most 1.
    coverage: f32,
    /// The output pixel.
    pixel: vec2u,
    /// 1 if reflections and refractions were traced. If 0, the host may substitute an approximation.
    traced: u32,
}

/// What a surface reflects and refracts: the result of the host's `reflection`.
struct DaaReflection {
    /// Weight of the radiance along the reflected ray; 0: no ray is traced.
    reflection: vec3f,
    /// Index of refraction inside the object over that outside; 1: the ray is not bent.
    ior: f32,
    /// Weight of the radiance along the refracted ray; 0: no ray is traced.
    refraction: vec3f,
    /// Unit normal in world space, about which the rays are mirrored and refracted.
    normal: vec3f,
}

/// The material of a sample, read from textures: the result of `material`. The crate may average it over several
/// samples of one surface, so each field must be meaningful when averaged. The `user` fields are the host's own.
struct DaaMaterial {
    /// Linear base colour and alpha.
    base_color: vec4f,
    /// Linear emitted radiance.
    emissive: vec3f,
    /// Perceptual roughness, 0 to 1.
    roughness: f32,
    /// Normal in world space after normal mapping. An average may be shorter than 1.
    normal: vec3f,
    /// Metalness: 0 for a dielectric, 1 for a metal.
    metallic: f32,
    user0: vec4f,
    user1: vec4f,
    /// Ambient visibility, 0 to 1: 1 where nothing is occluded.
    occlusion: f32,
}

/// Light in two parts: what `light` may return in place of the radiance, so that pixels of one surface can share their
/// light and keep their colours. The crate adds what the material emits.
struct DaaLight {
    /// What the base colour is multiplied by: diffuse light before the albedo, and whatever else is in proportion to it.
    diffuse: vec3f,
    /// The radiance that depends on neither the base colour nor emission, and alpha.
    rest: vec4f,
}

/// The radiance of a material in that light.
fn daa_radiance(l: DaaLight, m: DaaMaterial) -> vec4f {
    return vec4f(l.diffuse * m.base_color.rgb + l.rest.rgb + m.emissive, l.rest.a);
}

/// What decides whether two samples of a surface may share their light: the result of the host's `spread`. Without that
/// function the crate computes it from the normal, the colours and the roughness.
struct DaaSpread {
    /// What light depends on in more than proportion, scaled so that a difference of 1 is seen: by default the normal
    /// times √(F/α + 1.5 D), where F and D are the luminances of what is mirrored towards the camera and of the diffuse
    /// colour and α is the square of the roughness, and 0.3 times the roughness.
    shape: vec4f,
    /// What light is multiplied by. It weighs less where samples share their light, since mean colours times mean light
    /// come close, and as much where the number of samples is decided: by default √(F + D + E) of each channel, where E
    /// is emission up to 1, and 1.5 times metalness.
    tint: vec4f,
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
    f.reflected = s.reflected;
    f.coverage = coverage;
    f.pixel = s.pixel;
    f.traced = s.traced;
    return f;
}

/// Transforms a tangent-space normal (x and y in [−1, 1] along tangent and bitangent) to world space; unit length.
fn daa_apply_normal_map(s: DaaSample, n: vec3f) -> vec3f {
    let bitangent = cross(s.normal, s.tangent.xyz) * s.tangent.w;
    let world = s.tangent.xyz * n.x + bitangent * n.y + s.normal * n.z;
    return world * inverseSqrt(max(dot(world, world), 1e-20));
}

/// Rec. 709 luminance of linear RGB.
fn daa_luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}
