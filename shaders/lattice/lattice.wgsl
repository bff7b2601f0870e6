// Lattices of points over the G-buffer: squares, or triangles whose odd rows are shifted by half a pitch (University of
// Alaska Fairbanks thesis on tri-adaptive sampling, section 4.3). Every point is a sample of the G-buffer, and every
// point of a coarse lattice is also a point of the next finer one. CPU twin: src/reference/multi_resolution.rs.

const DAA_QUAD: u32 = 0u;
const DAA_TRIANGULAR: u32 = 1u;
const DAA_EQUILATERAL: u32 = 2u;

/// The height of an equilateral triangle of side 1, in 65536ths.
const DAA_EQUILATERAL_ROW: u32 = 56756u;

struct DaaLattice {
    /// DAA_QUAD, DAA_TRIANGULAR or DAA_EQUILATERAL.
    kind: u32,
    /// Base-2 logarithm of the pitch in pixels.
    level: u32,
    /// Number of points in a row. The last few lie beyond the image and use the samples of border windows.
    width: u32,
    /// Number of rows, likewise.
    height: u32,
    /// Index in `daa_points` of its first point.
    first: u32,
    /// Position among the lattices: `Level` of src/gpu/uniforms/lattice.rs.
    place: u32,
    /// Column and row of its first point in the lattice of the whole image.
    origin: vec2u,
}

/// The step from one lattice to the next finer one.
struct DaaStep {
    points: DaaLattice,
    parents: DaaLattice,
    /// Pitch of the points over that of their parents, and the same for their rows.
    scale: vec2f,
    /// 1 if there are no parents, and all points are chosen.
    coarsest: u32,
    /// What the lattice's values are: 0 colours, otherwise bit 0 shadows and bit 1 reflections and refractions.
    rays: u32,
    /// Offset in `daa_points` from a point to its ray results: the shadow bits and the code of shared_exponent.wgsl.
    found: u32,
    padding: u32,
    padding_too: vec2u,
}

/// `daa_points` holds for each point its word, and the depth, the code of the normal and the identity of its sample.
/// These are copies from the G-buffer: they are read so often that it is faster to keep them beside the word. A word
/// has these fields: bit 0, chosen on this lattice; bit 1, chosen on this or a coarser lattice; bits 4 to 6, the
/// lattice on which it, or its parents, was chosen; bits 8 to 15, the reason; bits 24 to 31, the reason to refine its
/// neighbourhood.
const DAA_CHOSEN: u32 = 1u;
const DAA_HAS_OWN: u32 = 2u;

/// The reasons for choosing a point.
const DAA_SMOOTH: u32 = 0u;
const DAA_REFINE_COLOR: u32 = 1u;
const DAA_REFINE_POSITION: u32 = 2u;
const DAA_REFINE_EDGE: u32 = 3u;
const DAA_REFINE_SHADOW: u32 = 4u;
const DAA_REFINE_COARSEST: u32 = 5u;

fn daa_point_word(own: u32, level: u32, by: u32) -> u32 {
    return own | (level << 4u) | (by << 8u);
}

/// 1 if the point was chosen on this or a coarser lattice.
fn daa_point_own(word: u32) -> u32 {
    return (word >> 1u) & 1u;
}

/// The lattice on which the point, or its parents, was chosen.
fn daa_point_level(word: u32) -> u32 {
    return (word >> 4u) & 7u;
}

/// The reason for choosing it: DAA_REFINE_*, or DAA_SMOOTH.
fn daa_point_by(word: u32) -> u32 {
    return (word >> 8u) & 0xffu;
}

/// The sample of a point.
struct DaaPoint {
    pixel: vec2u,
    rank: u32,
    /// Whether the point lies in the image. If it does not, a sample of a border window stands in for it.
    inside: bool,
}

fn daa_kept_point(word: u32, point: DaaPoint) -> vec4u {
    let at = point.pixel * DAA_M + daa_order(point.rank);
    return vec4u(word, bitcast<u32>(daa_depth_at(at)), daa_surface_at(at));
}

fn daa_is_shifted(l: DaaLattice, row: i32) -> bool {
    return l.kind != DAA_QUAD && ((row + i32(l.origin.y)) & 1) != 0;
}

/// The sample of a point. Beyond the image it is the one at the same position of the border's window.
fn daa_point(l: DaaLattice, at: vec2i) -> DaaPoint {
    let m = i32(DAA_M);
    let pitch = m << l.level;
    var place = (at + vec2i(l.origin)) * pitch;
    place.x += select(0, pitch / 2, daa_is_shifted(l, at.y));
    if l.kind == DAA_EQUILATERAL {
        place.y = i32((u32(place.y) * DAA_EQUILATERAL_ROW + 32768u) >> 16u);
    }
    // Rows of equilateral triangles may begin before this part of the image.
    place += vec2i(daa_order(0u)) - vec2i(daa_frame.origin) * m;
    let pixel = vec2u(max(place, vec2i(0)) / m);
    let inside = place.y >= 0 && all(pixel < daa_frame.size);
    return DaaPoint(min(pixel, daa_frame.size - 1u), daa_rank_at(vec2u(max(place, vec2i(0)) % m)), inside);
}

fn daa_on_lattice(l: DaaLattice, at: vec2i) -> vec2i {
    return clamp(at, vec2i(0), vec2i(i32(l.width), i32(l.height)) - 1);
}

fn daa_point_index(l: DaaLattice, at: vec2i) -> u32 {
    return l.first + u32(at.y) * l.width + u32(at.x);
}

/// The coarser points around a point, with bilinear weights, or barycentric weights in the triangle.
struct DaaParents {
    at: array<vec2i, 4>,
    weight: vec4f,
}

fn daa_parents(step: DaaStep, at: vec2i) -> DaaParents {
    let shift = select(0.0, 0.5, daa_is_shifted(step.points, at.y));
    // In coordinates of the whole image, so that weights round the same in each of its parts.
    let of_image = at + vec2i(step.points.origin);
    let x = (f32(of_image.x) + shift) * step.scale.x;
    let y = f32(of_image.y) * step.scale.y;
    let first = vec2i(step.parents.origin);
    let row = i32(floor(y)) - first.y;
    let fy = y - floor(y);
    if step.parents.kind == DAA_QUAD {
        let column = i32(floor(x)) - first.x;
        let fx = x - floor(x);
        let corner = vec2i(column, row);
        return DaaParents(
            array<vec2i, 4>(corner, corner + vec2i(1, 0), corner + vec2i(0, 1), corner + vec2i(1, 1)),
            vec4f((1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy),
        );
    }
    // Shears the lattice so that its triangles become halves of squares.
    let shifted = daa_is_shifted(step.parents, row);
    let a = x - select(0.0, 0.5, shifted) - 0.5 * fy;
    let column = i32(floor(a)) - first.x;
    let fa = a - floor(a);
    let lower = vec2i(column, row);
    let upper = vec2i(column + select(0, 1, shifted), row + 1);
    let right = vec2i(1, 0);
    if fa + fy <= 1.0 {
        return DaaParents(array<vec2i, 4>(lower, lower + right, upper, upper), vec4f(1.0 - fa - fy, fa, fy, 0.0));
    }
    return DaaParents(
        array<vec2i, 4>(lower + right, upper, upper + right, upper),
        vec4f(1.0 - fy, 1.0 - fa, fa + fy - 1.0, 0.0),
    );
}

/// The number of pairs of opposite neighbours: of the eight around a point of squares, or the six of triangles.
fn daa_pairs(l: DaaLattice) -> i32 {
    return select(4, 3, l.kind != DAA_QUAD);
}

/// The offsets from a point in this row to the first and to the second neighbour of pair i.
fn daa_opposing(l: DaaLattice, row: i32, i: i32) -> vec4i {
    if i == 0 {
        return vec4i(-1, 0, 1, 0);
    }
    if l.kind == DAA_QUAD {
        return select(select(vec4i(-1, 1, 1, -1), vec4i(-1, -1, 1, 1), i == 2), vec4i(0, -1, 0, 1), i == 1);
    }
    let right = (row + i32(l.origin.y)) & 1;
    return select(vec4i(right, -1, right - 1, 1), vec4i(right - 1, -1, right, 1), i == 1);
}
