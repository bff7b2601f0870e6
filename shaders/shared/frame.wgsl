// The frame's constants, and the indices of pixels and tiles in buffers. src/gpu/uniforms/frame.rs and the files of the
// techniques have the same structs in Rust; a test compares their layouts.

/// The metrics of `Windowed`. A scale of 0 switches a metric off.
struct DaaWindowed {
    depth_scale: f32,
    normal_scale: f32,
    luminance_scale: f32,
    /// Range of luminance, or of a channel, below which there is no edge.
    luminance_min: f32,
    /// Share of the greatest value; a range below it is no edge.
    luminance_edge: f32,
    /// The k of a window with more than one material or object.
    identity_samples: f32,
    /// The k of a window whose shadow bits differ from a neighbour's.
    shadow_samples: f32,
    /// Samples per unit of the range of the host's bytes.
    user_scale: f32,
}

/// The choice of the audited tiles.
struct DaaAudit {
    /// Number of tiles of which one is audited.
    period: u32,
    /// Index of the audited tile within a period.
    phase: u32,
    /// Step of effort, log2, below the frame's effort at which the error is also measured.
    step: f32,
    /// The setting `least_samples` at that lower effort.
    least_samples: f32,
}

/// The filter of `Reconstructed`, which the lattices of `MultiResolution` use, too.
struct DaaReconstruct {
    /// Number of geometric samples of a window: the first ranks.
    samples: u32,
    /// σ of depth.
    depth_scale: f32,
    /// σ of normals.
    normal_scale: f32,
    /// Samples per unit of the range of a channel.
    contrast_scale: f32,
    /// Range of a channel below which there is no contrast.
    contrast_min: f32,
    /// Sum of weights below which a sample is shaded.
    least_weight: f32,
    padding: vec2u,
}

/// The thresholds of `Selective`. A threshold above 1 is off.
struct DaaSelective {
    /// Thresholds for objects, normals, shadows and textures.
    primary: vec4f,
    /// The same thresholds for reflected and refracted surfaces.
    reflected: vec4f,
    /// Threshold for colour where no attribute disagrees.
    color: f32,
    /// Difference of colour below which there is no contrast.
    contrast_min: f32,
    /// Cosine of the angle between two normals below which they differ.
    normal_cosine: f32,
    /// Number of samples in the four quadrants of a window together.
    samples: u32,
    /// The ranks beyond the first that each quadrant uses: a bit each, 64 bits a quadrant.
    ranks: array<vec4u, 2>,
}

/// The thresholds of `MultiResolution`.
struct DaaMultiResolution {
    /// Residual of colour above which a point's neighbourhood is refined.
    color: f32,
    /// Residual of position, over the distance to the camera, above which a point's neighbourhood is refined.
    position: f32,
    padding: vec2u,
}

/// The thresholds of `Surfaces`.
struct DaaSurfaces {
    /// Cosine of the angle between two normals below which they are of two surfaces.
    normal_cosine: f32,
    /// Distance of a sample from a surface's plane, over that to the camera, above which it is of another surface.
    plane: f32,
    /// The most surfaces of a window.
    most: u32,
    /// The most taps of a surface.
    taps: u32,
    /// The taps of a window of one surface before their spread asks for more.
    first_taps: u32,
    /// The most groups of a surface, each of which is lit once.
    most_groups: u32,
    /// The spread above which all taps are read.
    tap_spread: f32,
    /// The spread above which taps do not share their light.
    spread: f32,
    /// How much the length that a mean normal loses widens the lobe.
    widening: f32,
    /// The squared distance of features up to which a window takes its light from the corners of its block. 0: none does.
    block_spread: f32,
    /// The difference of a displayed channel between the corners up to which it does.
    block_contrast: f32,
    /// How far around a change of shadow `probe` looks for shadows that first samples miss, in pixels, for `Windowed`, too.
    /// 0: it does not run.
    shadow_reach: u32,
}

/// Where the results of a sample's rays lie. The results of the first ranks go rank by rank, with a word for each slot.
/// Those of other planned samples follow, packed, then those of all samples of audited tiles.
struct DaaResults {
    /// Number of ranks that have a word for each slot.
    ranks: u32,
    /// Number of words for other planned samples.
    planned: u32,
    /// Number of audited tiles in a row of tiles, 0 if no tile is audited.
    audited: u32,
    /// Number of all words.
    words: u32,
}

struct DaaFrame {
    /// Transform from clip space (reversed z: near 1, far 0) to positions relative to the camera.
    relative_from_clip: mat4x4f,
    /// Position of the camera in world space.
    camera_position: vec3f,
    /// Factor on radiance for the metrics and the luminance weight.
    exposure: f32,
    /// Unit view direction in world space.
    camera_forward: vec3f,
    /// 1 if all view directions are parallel, otherwise 0.
    orthographic: u32,
    /// Size in pixels of the G-buffer's part of the image: of the whole image, or of a band with its apron. Pixels are
    /// counted from this part's first one, except where they are said to be of the image or the target.
    size: vec2u,
    /// Number of tiles of 8 × 8 pixels along x, in that part.
    tiles_x: u32,
    /// Set of DAA_FLAG_* bits.
    flags: u32,
    /// Scale of the texture footprint of shaded samples.
    footprint: f32,
    /// The least k of a window that is not all sky.
    least_samples: f32,
    /// Number of samples beyond the first; a tile that asks for more falls back to k = 1.
    tile_limit: u32,
    /// Number of lights whose shadows are traced.
    casting: u32,
    /// The debug view: `DebugView as u32`.
    view: u32,
    /// Number of pixels around `shown` in which k is also computed, for neighbours.
    around: u32,
    /// The pixel of the image at which the part begins, a multiple of 8.
    origin: vec2u,
    /// Size of the image in pixels.
    image: vec2u,
    /// The pixel of the target at which the part would begin.
    target_origin: vec2u,
    /// The pixels that are written to the target: their first one, and the one after the last.
    shown: vec4u,
    results: DaaResults,
    windowed: DaaWindowed,
    audit: DaaAudit,
    reconstruct: DaaReconstruct,
    selective: DaaSelective,
    multi_resolution: DaaMultiResolution,
    surfaces: DaaSurfaces,
    /// Rank → position in the window: x | y << 4 | quadrants << 8 (a bit each), four ranks to a vector. And y m + x →
    /// rank << 16.
    order: array<vec4u, 16>,
    /// k − 1 → offset from the mean position of the first k samples to the window's centre in samples, two to a vector.
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
const DAA_FLAG_REFLECTIONS_APART: u32 = 32768u;
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
const DAA_FLAG_REFLECTS: u32 = 0x4000000u;
const DAA_FLAG_SURFACES: u32 = 0x8000000u;
const DAA_FLAG_LUMINANCE_CHANNELS: u32 = 0x10000000u;
const DAA_FLAG_WHOLE_HOOK: u32 = 0x20000000u;

@group(0) @binding(0) var<uniform> daa_frame: DaaFrame;

fn daa_flag(bits: u32) -> bool {
    return (daa_frame.flags & bits) != 0u;
}

/// Whether `probe` has run.
fn daa_shadow_probed() -> bool {
    return daa_frame.casting > 0u && daa_frame.surfaces.shadow_reach > 0u;
}

/// Whether a pixel is written to the target. Others are only there for their neighbours.
fn daa_is_shown(pixel: vec2u) -> bool {
    return all(pixel >= daa_frame.shown.xy) && all(pixel < daa_frame.shown.zw);
}

/// Whether k of a pixel is computed.
fn daa_is_counted(pixel: vec2u) -> bool {
    let near = all(pixel + daa_frame.around >= daa_frame.shown.xy) && all(pixel < daa_frame.shown.zw + daa_frame.around);
    return near && all(pixel < daa_frame.size);
}

/// The pixel at a position in the target.
fn daa_target_pixel(position: vec4f) -> vec2u {
    return vec2u(position.xy) - daa_frame.target_origin;
}

/// The number of tiles in the frame.
fn daa_tile_count() -> u32 {
    return daa_frame.tiles_x * ((daa_frame.size.y + 7u) >> 3u);
}

/// The index of a tile, row by row.
fn daa_tile_index(tile: vec2u) -> u32 {
    return tile.y * daa_frame.tiles_x + tile.x;
}

/// The index of a pixel in buffers with a word for each pixel of each tile, tile by tile.
fn daa_slot(pixel: vec2u) -> u32 {
    return daa_tile_index(pixel >> vec2u(3u)) * 64u + (pixel.y & 7u) * 8u + (pixel.x & 7u);
}

/// The pixel of such an index.
fn daa_slot_pixel(slot: u32) -> vec2u {
    let tile = slot / 64u;
    return vec2u(tile % daa_frame.tiles_x, tile / daa_frame.tiles_x) * 8u + vec2u(slot & 7u, (slot >> 3u) & 7u);
}

/// The pixel of a lane in a workgroup of 64 that covers a tile.
fn daa_tile_pixel(tile: vec2u, lane: u32) -> vec2u {
    return tile * 8u + vec2u(lane & 7u, lane >> 3u);
}
