// Lattices of points over the G-buffer: squares, or triangles whose odd rows are shifted by half a pitch (University of
// Alaska Fairbanks thesis on tri-adaptive sampling, section 4.3). Every point is a sample of the G-buffer, and every
// point of a coarse lattice one of the next finer. CPU twin: src/reference/multi_resolution.rs.

const DAA_QUAD: u32 = 0u;
const DAA_TRIANGULAR: u32 = 1u;
const DAA_EQUILATERAL: u32 = 2u;

/// Height of an equilateral triangle of side 1, in 65536ths.
const DAA_EQUILATERAL_ROW: i32 = 56756;

struct DaaLattice {
    /// DAA_QUAD, DAA_TRIANGULAR or DAA_EQUILATERAL.
    kind: u32,
    /// log2 of its pitch in pixels.
    level: u32,
    /// Points of a row. The last few lie beyond the image, on its border's windows.
    width: u32,
    height: u32,
    /// Where its points begin in `daa_points`.
    first: u32,
    /// `Place` of src/lattice.rs.
    place: u32,
    padding: vec2u,
}

/// From one lattice to the next finer.
struct DaaStep {
    points: DaaLattice,
    parents: DaaLattice,
    /// Pitch of the points over that of their parents, and of their rows.
    scale: vec2f,
    /// 1: there are no parents, all points are chosen.
    coarsest: u32,
    /// 1 shadows and 2 reflections and refractions are what it is about; 0: colours.
    rays: u32,
    /// How far behind a point what its rays found lies in `daa_points`: shadow bits, and the code of
    /// shared_exponent.wgsl.
    found: u32,
    padding: u32,
    padding_too: vec2u,
}

/// What is kept of a point: its word, and of its sample the depth, the code of the normal and the identity, which so
/// many look at that another copy beside the word is sooner read. A word: chosen (1 bit), chosen here or on a coarser
/// lattice (1) | place where that was, or its parents' (3 bits from 4) | why (8 bits from 8) | why its neighbourhood is
/// refined (8 bits from 24).
const DAA_CHOSEN: u32 = 1u;
const DAA_HAS_OWN: u32 = 2u;

/// Why.
const DAA_SMOOTH: u32 = 0u;
const DAA_REFINE_COLOR: u32 = 1u;
const DAA_REFINE_POSITION: u32 = 2u;
const DAA_REFINE_EDGE: u32 = 3u;
const DAA_REFINE_SHADOW: u32 = 4u;
const DAA_REFINE_COARSEST: u32 = 5u;

fn daa_point_word(own: u32, level: u32, by: u32) -> u32 {
    return own | (level << 4u) | (by << 8u);
}

/// 1 if the point was chosen here or on a coarser lattice.
fn daa_point_own(word: u32) -> u32 {
    return (word >> 1u) & 1u;
}

/// The lattice that it was chosen on, or its parents'.
fn daa_point_level(word: u32) -> u32 {
    return (word >> 4u) & 7u;
}

/// Why it was chosen: DAA_REFINE_*, or DAA_SMOOTH.
fn daa_point_by(word: u32) -> u32 {
    return (word >> 8u) & 0xffu;
}

/// A sample of the G-buffer.
struct DaaPoint {
    pixel: vec2u,
    rank: u32,
    /// Where the point lies; else its sample stands in for what is beyond the image.
    inside: bool,
}

fn daa_kept_point(word: u32, point: DaaPoint) -> vec4u {
    let at = point.pixel * DAA_M + daa_order(point.rank);
    return vec4u(word, bitcast<u32>(daa_depth_at(at)), textureLoad(daa_gbuffer_surface, at, 0).xy);
}

fn daa_is_shifted(l: DaaLattice, row: i32) -> bool {
    return l.kind != DAA_QUAD && (row & 1) != 0;
}

/// The sample of a point; beyond the image, that at the same place of the border's window.
fn daa_point(l: DaaLattice, at: vec2i) -> DaaPoint {
    let pitch = i32(DAA_M << l.level);
    var place = at * pitch;
    place.x += select(0, pitch / 2, daa_is_shifted(l, at.y));
    if l.kind == DAA_EQUILATERAL {
        place.y = (place.y * DAA_EQUILATERAL_ROW + 32768) >> 16u;
    }
    place += vec2i(daa_order(0u));
    let m = i32(DAA_M);
    let pixel = vec2u(place / m);
    return DaaPoint(min(pixel, daa_frame.size - 1u), daa_rank_at(vec2u(place % m)), all(pixel < daa_frame.size));
}

fn daa_on_lattice(l: DaaLattice, at: vec2i) -> vec2i {
    return clamp(at, vec2i(0), vec2i(i32(l.width), i32(l.height)) - 1);
}

fn daa_point_index(l: DaaLattice, at: vec2i) -> u32 {
    return l.first + u32(at.y) * l.width + u32(at.x);
}

/// The coarser points around a point, and how much of it is each: bilinear, or barycentric in the triangle.
struct DaaParents {
    at: array<vec2i, 4>,
    weight: vec4f,
}

fn daa_parents(step: DaaStep, at: vec2i) -> DaaParents {
    let shift = select(0.0, 0.5, daa_is_shifted(step.points, at.y));
    let x = (f32(at.x) + shift) * step.scale.x;
    let y = f32(at.y) * step.scale.y;
    let row = i32(floor(y));
    let fy = y - floor(y);
    if step.parents.kind == DAA_QUAD {
        let column = i32(floor(x));
        let fx = x - floor(x);
        let corner = vec2i(column, row);
        return DaaParents(
            array<vec2i, 4>(corner, corner + vec2i(1, 0), corner + vec2i(0, 1), corner + vec2i(1, 1)),
            vec4f((1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy),
        );
    }
    // Sheared so that the triangles become halves of squares.
    let shifted = daa_is_shifted(step.parents, row);
    let a = x - select(0.0, 0.5, shifted) - 0.5 * fy;
    let column = i32(floor(a));
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

/// Pairs of neighbours that lie opposite each other: the eight around a point of squares, the six of triangles.
fn daa_pairs(l: DaaLattice) -> i32 {
    return select(4, 3, l.kind != DAA_QUAD);
}

/// The first of pair i and the second, from a point in this row.
fn daa_opposing(l: DaaLattice, row: i32, i: i32) -> vec4i {
    if i == 0 {
        return vec4i(-1, 0, 1, 0);
    }
    if l.kind == DAA_QUAD {
        return select(select(vec4i(-1, 1, 1, -1), vec4i(-1, -1, 1, 1), i == 2), vec4i(0, -1, 0, 1), i == 1);
    }
    let right = row & 1;
    return select(vec4i(right, -1, right - 1, 1), vec4i(right - 1, -1, right, 1), i == 1);
}
