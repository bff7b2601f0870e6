// The contract between deferred-aa and a host's shading code: all that a host reads or writes.
// Joined after the host's source in every module that shades. Names of the crate begin with daa_, Daa or DAA_.

/// Samples along one side of a pixel's window; n = m².
override DAA_M: u32 = 1u;

/// The frame's constants. Held against `deferred_aa::frame::FrameUniform` by a test.
struct DaaFrame {
    /// Position relative to the camera, from clip space (reversed z: near 1, far 0).
    relative_from_clip: mat4x4f,
    /// World space.
    camera_position: vec3f,
    /// Radiance × exposure is what the metrics and the tonemap weight see.
    exposure: f32,
    /// Unit vector along the view, world space.
    camera_forward: vec3f,
    /// 1 if all view directions are parallel, else 0.
    orthographic: u32,
    /// Pixels of the output.
    size: vec2u,
    /// Tiles of 8 × 8 pixels along x.
    tiles_x: u32,
    /// Bits of DAA_FLAG_*.
    flags: u32,
    /// c of the depth metric; 0 switches it off.
    depth_scale: f32,
    /// c of the normal metric.
    normal_scale: f32,
    /// c of the luminance metric.
    luminance_scale: f32,
    /// Luminance ranges below are not an edge.
    luminance_min: f32,
    /// Luminance ranges below this share of the greatest luminance are not an edge.
    luminance_edge: f32,
    /// k of a window that holds more than one material or object; 0 switches it off.
    identity_samples: f32,
    /// k of a window whose shadow bits differ from a neighbour's; 0 switches it off.
    shadow_samples: f32,
    /// Tiles that want more than this many samples beyond the first fall back to k = 1.
    tile_limit: u32,
    /// Texture footprint of a shaded sample over that of the samples that it stands for.
    footprint: f32,
    /// What the debug view shows (`DebugView as u32`).
    view: u32,
    /// The least k of a window that is not all sky.
    least_samples: f32,
    /// One tile in so many is audited.
    audit_period: u32,
    /// Which.
    audit_phase: u32,
    /// How far below the present effort the audit looks ahead, log2.
    audit_step: f32,
    /// What least_samples would be there.
    audit_least: f32,
    /// The first so many ranks are geometric samples of `reconstruct`.
    geometry: u32,
    /// Its σ of depth.
    reconstruct_depth: f32,
    /// Its σ of normals.
    reconstruct_normal: f32,
    /// Samples per unit of its luminance range.
    reconstruct_contrast: f32,
    /// Ranges below are none.
    reconstruct_contrast_min: f32,
    /// Samples for which the weights sum to less are shaded.
    reconstruct_least: f32,
    /// A point of a lattice is refined where its colour departs from its neighbours' by more.
    lattice_color: f32,
    /// Where its position does, over its distance.
    lattice_position: f32,
    /// Lights whose shadows the frame traces.
    casting: u32,
    /// Thresholds of `select` for objects, normals, shadow and textures; above 1: off.
    selective_primary: vec4f,
    /// For those of what is reflected and refracted.
    selective_secondary: vec4f,
    /// For colours where nothing else disagrees.
    selective_color: f32,
    /// Differences of its colours below are none.
    selective_floor: f32,
    /// Normals differ if the cosine between them is less.
    selective_normal: f32,
    /// Samples of a window's quadrants together.
    selective_samples: u32,
    /// Rank → place in the window, x | y << 4 | quadrants << 8 (a bit each), four to a vector; and y m + x → rank << 16.
    order: array<vec4u, 16>,
    /// k − 1 → from the mean place of the first k samples to the window's centre, in samples; two to a vector.
    centres: array<vec4f, 32>,
}

const DAA_FLAG_DEPTH_PLANE: u32 = 1u;
const DAA_FLAG_TWO_SIDED: u32 = 2u;
const DAA_FLAG_LUMINANCE_PERCEPTUAL: u32 = 4u;
const DAA_FLAG_LUMINANCE_CENTRE: u32 = 8u;
const DAA_FLAG_WEIGHT_LUMINANCE: u32 = 16u;
const DAA_FLAG_FULL: u32 = 32u;
const DAA_FLAG_PLANNED: u32 = 64u;
const DAA_FLAG_EDGE_AWARE_FIRST: u32 = 128u;
const DAA_FLAG_PLANES: u32 = 256u;
const DAA_FLAG_CUT_IDENTITY: u32 = 512u;
const DAA_FLAG_CUT_SHADOW: u32 = 1024u;
const DAA_FLAG_OWN_FIRST: u32 = 2048u;
const DAA_FLAG_TRACE_ALL: u32 = 4096u;
const DAA_FLAG_REFLECTIONS: u32 = 8192u;
const DAA_FLAG_REFRACTIONS: u32 = 16384u;
const DAA_FLAG_SECONDARY_APART: u32 = 32768u;
const DAA_FLAG_SELECTIVE: u32 = 0x10000u;
const DAA_FLAG_SHADOW_LIGHTS: u32 = 0x20000u;
const DAA_FLAG_BILINEAR: u32 = 0x40000u;
const DAA_FLAG_FOCUSED: u32 = 0x80000u;
const DAA_FLAG_BY_LUMINANCE: u32 = 0x100000u;
const DAA_FLAG_BY_GRADIENT: u32 = 0x200000u;
const DAA_FLAG_VETO: u32 = 0x400000u;
const DAA_FLAG_WEIGHTED: u32 = 0x800000u;
const DAA_FLAG_SUPERSAMPLED: u32 = 0x1000000u;
const DAA_FLAG_LATTICE: u32 = 0x2000000u;
const DAA_FLAG_BOUNCES: u32 = 0x4000000u;

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
