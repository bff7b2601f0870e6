// refine: chooses the points of a lattice that get their own sample, and interpolates the others from the coarser
// points around them (the thesis, section 4.2, Algorithm 1, on nested lattices). CPU twin:
// src/reference/multi_resolution.rs.

/// The least sum of weights for which a point is interpolated.
const DAA_LEAST_WEIGHT: f32 = 0.5;

/// Computes for each coarser point whether its neighbourhood is refined.
@compute @workgroup_size(8, 8)
fn daa_refine_judge(@builtin(global_invocation_id) id: vec3u) {
    let l = daa_step.parents;
    if id.x >= l.width || id.y >= l.height {
        return;
    }
    let index = daa_point_index(l, vec2i(id.xy));
    daa_points[index].x = (daa_points[index].x & 0xffffffu) | (daa_residual(l, vec2i(id.xy)).by << 24u);
}

/// A coarser point.
struct DaaParent {
    geometry: DaaGeometry,
    value: vec4f,
    bits: u32,
    kept: vec4u,
    point: DaaPoint,
    index: u32,
}

fn daa_parent(at: vec2i) -> DaaParent {
    let place = daa_on_lattice(daa_step.parents, at);
    let index = daa_point_index(daa_step.parents, place);
    let point = daa_point(daa_step.parents, place);
    let kept = daa_points[index];
    let geometry = daa_geometry_of(point.pixel, point.rank, bitcast<f32>(kept.y), kept.zw);
    let bits = select(0u, daa_shadow_at(index, point), geometry.depth != 0.0);
    return DaaParent(geometry, daa_value(index, point), bits, kept, point, index);
}

/// The interpolation of a point from its parents so far, or the reason against it.
struct DaaMix {
    sum: vec4f,
    total: f32,
    by: u32,
    shadow: u32,
    met: bool,
}

fn daa_mixed(mix: DaaMix, of_own: DaaGeometry, parent: DaaParent, share: f32) -> DaaMix {
    if share <= 0.0 {
        return mix;
    }
    var own = of_own;
    var by = mix.by;
    if daa_step.rays != 0u {
        // The point's own shadow is not known yet.
        own.shadow = parent.geometry.shadow;
        by = select(by, DAA_REFINE_SHADOW, by == DAA_SMOOTH && mix.met && parent.bits != mix.shadow);
    }
    if daa_flag(DAA_FLAG_VETO) {
        let apart = parent.geometry.identity != own.identity || (parent.geometry.depth == 0.0) != (own.depth == 0.0);
        by = select(by, DAA_REFINE_SHADOW, by == DAA_SMOOTH && parent.geometry.shadow != own.shadow);
        by = select(by, DAA_REFINE_EDGE, by == DAA_SMOOTH && apart);
    }
    by = select(by, parent.kept.x >> 24u, by == DAA_SMOOTH);
    var weight = share;
    if daa_flag(DAA_FLAG_WEIGHTED) {
        weight *= daa_reconstruct_weight(own, parent.geometry);
    }
    return DaaMix(mix.sum + parent.value * weight, mix.total + weight, by, parent.bits, true);
}

fn daa_refine_point(at: vec2i, weight: vec4f, a: DaaParent, b: DaaParent, c: DaaParent, d: DaaParent) {
    let l = daa_step.points;
    if at.x < 0 || at.x >= i32(l.width) || at.y >= i32(l.height) {
        return;
    }
    let index = daa_point_index(l, at);
    let point = daa_point(l, at);
    if weight.x > 0.999 && all(a.point.pixel == point.pixel) && a.point.rank == point.rank {
        daa_points[index] = vec4u(a.kept.x & 0xfffeu, a.kept.yzw);
        daa_keep(index, a.index);
        return;
    }
    var kept = daa_kept_point(0u, point);
    let own = daa_geometry_of(point.pixel, point.rank, bitcast<f32>(kept.y), kept.zw);
    var mix = daa_mixed(DaaMix(), own, a, weight.x);
    mix = daa_mixed(mix, own, b, weight.y);
    mix = daa_mixed(mix, own, c, weight.z);
    mix = daa_mixed(mix, own, d, weight.w);
    let by = select(mix.by, DAA_REFINE_EDGE, mix.by == DAA_SMOOTH && mix.total < DAA_LEAST_WEIGHT);
    if daa_step.rays != 0u && own.depth == 0.0 {
        // No rays start from the sky.
        kept.x = daa_point_word(DAA_HAS_OWN, l.place, DAA_SMOOTH);
        daa_put(index, point, vec4f(0.0), 0u);
    } else if by == DAA_SMOOTH {
        kept.x = daa_point_word(0u, daa_step.parents.place, by);
        daa_put(index, point, mix.sum / mix.total, mix.shadow);
    } else {
        kept.x = daa_point_word(DAA_CHOSEN | DAA_HAS_OWN, l.place, by);
        daa_leave(index);
    }
    daa_points[index] = kept;
}

/// If the lattices are of the same kind, a lane refines the four points in the cell of a coarser point, otherwise a
/// single point.
@compute @workgroup_size(8, 8)
fn daa_refine_main(@builtin(global_invocation_id) id: vec3u) {
    let l = daa_step.points;
    let quad = daa_step.parents.kind == DAA_QUAD;
    let nested = l.kind == daa_step.parents.kind && daa_step.scale.x == 0.5;
    var cell = vec2i(id.xy);
    var around = daa_parents(daa_step, cell);
    if nested {
        // The cell of the left half of the first shifted triangle lies beyond the border.
        cell.x -= select(1, 0, quad);
        let right = select(0, 1, daa_is_shifted(daa_step.parents, cell.y));
        let above = cell + vec2i(right, 1);
        around.at = array<vec2i, 4>(
            cell, cell + vec2i(1, 0), select(above, cell + vec2i(0, 1), quad), select(above, cell + 1, quad),
        );
    }
    let end = select(1u, min(4u, daa_frame.size.x + 3u), nested);
    let first = cell * 2 + vec2i(select(0, 1, daa_is_shifted(daa_step.parents, cell.y)), 0);
    if nested && (first.x >= i32(l.width) || first.y >= i32(l.height)) {
        return;
    }
    let a = daa_parent(around.at[0]);
    let b = daa_parent(around.at[1]);
    let c = daa_parent(around.at[2]);
    let d = daa_parent(around.at[3]);
    for (var i = 0u; i < end; i++) {
        let step = vec2i(vec2u(i & 1u, i >> 1u));
        if !nested {
            daa_refine_point(cell, around.weight, a, b, c, d);
        } else if quad {
            let f = vec2f(step) * 0.5;
            let weight = vec4f((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
            daa_refine_point(first + step, weight, a, b, c, d);
        } else {
            // The point itself, and the midpoints of the triangle's sides. Its other corners are the point to the right
            // and the one above both.
            let right = f32(step.x) * 0.5;
            let above = f32(step.y) * 0.5;
            let weight = vec4f(select(1.0 - right, 0.5 - right, step.y != 0), right, above, 0.0);
            daa_refine_point(first + step, weight, a, b, c, d);
        }
    }
}
