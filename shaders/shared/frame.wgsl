// The frame's constants, and where pixels and tiles lie in buffers. Rust has the same structs in src/gpu/uniforms/frame.rs and the
// files of the techniques; a test holds them together.

/// `Windowed`'s metrics: 0 switches one off.
struct DaaWindowed {
    depth_scale: f32,
    normal_scale: f32,
    luminance_scale: f32,
    /// Luminance ranges below are not an edge.
    luminance_min: f32,
    /// Luminance ranges below this share of the greatest luminance are not an edge.
    luminance_edge: f32,
    /// k of a window that holds more than one material or object.
    identity_samples: f32,
    /// k of a window whose shadow bits differ from a neighbour's.
    shadow_samples: f32,
    padding: u32,
}

/// Which tiles are audited.
struct DaaAudit {
    /// One tile in so many.
    period: u32,
    /// Which of them.
    phase: u32,
    /// How far below the present effort the audit looks ahead, log2.
    step: f32,
    /// What least_samples would be there.
    least_samples: f32,
}

/// `Reconstructed`'s filter, which the lattices of `MultiResolution` use too.
struct DaaReconstruct {
    /// The first so many ranks are geometric samples.
    samples: u32,
    /// σ of depth.
    depth_scale: f32,
    /// σ of normals.
    normal_scale: f32,
    /// Samples per unit of luminance range.
    contrast_scale: f32,
    /// Luminance ranges below are no contrast.
    contrast_min: f32,
    /// A sample whose weights sum to less is shaded.
    least_weight: f32,
    padding: vec2u,
}

/// `Selective`'s thresholds; above 1: off.
struct DaaSelective {
    /// For objects, normals, shadow and textures.
    primary: vec4f,
    /// For those of what is reflected and refracted.
    secondary: vec4f,
    /// For colours where nothing else disagrees.
    color: f32,
    /// Differences of colour below are none.
    contrast_min: f32,
    /// Normals differ if the cosine between them is less.
    normal_cosine: f32,
    /// Samples of a window's quadrants together.
    samples: u32,
}

/// `MultiResolution`'s thresholds.
struct DaaMultiResolution {
    /// A point is refined where its colour departs from its neighbours' by more.
    color: f32,
    /// A point is refined where its position does, over its distance.
    position: f32,
    padding: vec2u,
}

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
    /// Texture footprint of a shaded sample over that of the samples that it stands for.
    footprint: f32,
    /// The least k of a window that is not all sky.
    least_samples: f32,
    /// Tiles that want more than this many samples beyond the first fall back to k = 1.
    tile_limit: u32,
    /// Lights whose shadows the frame traces.
    casting: u32,
    /// What the debug view shows: `DebugView as u32`.
    view: u32,
    padding: u32,
    padding_too: vec2u,
    windowed: DaaWindowed,
    audit: DaaAudit,
    reconstruct: DaaReconstruct,
    selective: DaaSelective,
    multi_resolution: DaaMultiResolution,
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

@group(0) @binding(0) var<uniform> daa_frame: DaaFrame;

fn daa_flag(bits: u32) -> bool {
    return (daa_frame.flags & bits) != 0u;
}

/// Tiles of 8 × 8 pixels in the frame.
fn daa_tile_count() -> u32 {
    return daa_frame.tiles_x * ((daa_frame.size.y + 7u) >> 3u);
}

/// A tile's place among all, row by row.
fn daa_tile_index(tile: vec2u) -> u32 {
    return tile.y * daa_frame.tiles_x + tile.x;
}

/// A pixel's place in buffers that hold a word for each pixel of each tile, tile by tile.
fn daa_slot(pixel: vec2u) -> u32 {
    return daa_tile_index(pixel >> vec2u(3u)) * 64u + (pixel.y & 7u) * 8u + (pixel.x & 7u);
}

/// The pixel of a slot.
fn daa_slot_pixel(slot: u32) -> vec2u {
    let tile = slot / 64u;
    return vec2u(tile % daa_frame.tiles_x, tile / daa_frame.tiles_x) * 8u + vec2u(slot & 7u, (slot >> 3u) & 7u);
}

/// A lane's pixel in a tile that a workgroup of 64 has.
fn daa_tile_pixel(tile: vec2u, lane: u32) -> vec2u {
    return tile * 8u + vec2u(lane & 7u, lane >> 3u);
}
