// The residual of a point: its difference to the interpolation between opposite neighbours (the thesis, section 4.2.2,
// Algorithm 1), as the mean L1 norm of colour, channel by channel, and of position. CPU twin: `residual` of
// src/reference/multi_resolution.rs.

/// The values of a point that are compared.
struct DaaJudged {
    /// Exposed colour, on request on the display curve.
    shown: vec3f,
    /// Shadow bits.
    bits: u32,
    /// Position relative to the camera.
    position: vec3f,
    /// Distance to the camera; 0 for the sky.
    distance: f32,
}

/// The difference of position between the sky and a surface, greater than any other.
const DAA_APART: f32 = 1e9;

/// The values of a point; beyond the lattice, those of its border.
fn daa_judged(l: DaaLattice, at: vec2i) -> DaaJudged {
    let place = daa_on_lattice(l, at);
    let point = daa_point(l, place);
    let index = daa_point_index(l, place);
    let d = bitcast<f32>(daa_points[index].y);
    let valid = d > DAA_SKY_DEPTH;
    let xy = point.pixel * DAA_M + daa_order(point.rank);
    let position = daa_relative_position(vec2f(xy) + 0.5, select(1.0, d, valid));
    let value = daa_value(index, point);
    return DaaJudged(daa_shown(value.rgb), daa_bits(index), position, select(0.0, length(position), valid));
}

struct DaaResidual {
    /// The greatest residual of the three channels.
    color: f32,
    /// The reason to refine: DAA_REFINE_*, or DAA_SMOOTH.
    by: u32,
}

fn daa_residual(l: DaaLattice, at: vec2i) -> DaaResidual {
    let own = daa_judged(l, at);
    var color = vec3f(0.0);
    var position = 0.0;
    var shadow = false;
    // The bound is not a constant, so that compilers do not unroll the loop: copies take drivers seconds to compile and
    // run no faster.
    let pairs = min(daa_pairs(l), i32(daa_frame.size.x) + 3);
    for (var i = 0; i < pairs; i++) {
        let apart = daa_opposing(l, at.y, i);
        let a = daa_judged(l, at + apart.xy);
        let b = daa_judged(l, at + apart.zw);
        color += abs(own.shown - 0.5 * (a.shown + b.shown));
        let skies = u32(own.distance == 0.0) + u32(a.distance == 0.0) + u32(b.distance == 0.0);
        let off = length(own.position - 0.5 * (a.position + b.position)) / max(own.distance, 1e-30);
        position += select(select(off, DAA_APART, skies != 0u), 0.0, skies == 3u);
        shadow = shadow || a.bits != own.bits || b.bits != own.bits;
    }
    // Both points of a pair count as neighbours.
    let neighbours = f32(2 * pairs);
    let greatest = max(max(color.r, color.g), color.b) / neighbours;
    var by = select(DAA_SMOOTH, DAA_REFINE_SHADOW, shadow);
    by = select(by, DAA_REFINE_POSITION, position / neighbours > daa_frame.multi_resolution.position);
    by = select(by, DAA_REFINE_COLOR, greatest > daa_frame.multi_resolution.color);
    return DaaResidual(greatest, by);
}
