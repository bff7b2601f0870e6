// lattice_to_pixels: computes S from the finest lattice, and on request chooses the windows that are refined beyond it:
// to 4 samples, to 16, or to all. CPU twin: src/reference/multi_resolution.rs.

@group(3) @binding(3) var daa_first: texture_storage_2d<rgba32float, write>;
/// The words of windows: in `daa_counts` if windows are refined further and `plan` follows, otherwise in `daa_plan`.
@group(3) @binding(4) var<storage, read_write> daa_counts: array<u32>;
@group(3) @binding(5) var<storage, read_write> daa_plan: array<u32>;

/// Whether a window has more than one material or object. The sky counts as one.
fn daa_holds_edge(pixel: vec2u) -> bool {
    let corner = pixel * DAA_M;
    let identity = daa_seen_identity(corner);
    let n = DAA_M * DAA_M;
    for (var i = 1u; i < n; i++) {
        if any(daa_seen_identity(corner + vec2u(i % DAA_M, i / DAA_M)) != identity) {
            return true;
        }
    }
    return false;
}

/// The number of samples of a window that is refined f times: f halvings of the pitch if m is a multiple of 2^f,
/// otherwise all samples.
fn daa_level_samples(f: u32) -> u32 {
    let n = DAA_M * DAA_M;
    return select(n, min(1u << (2u * f), n), DAA_M % (1u << f) == 0u);
}

/// The reason in a plan for a reason of lattices.
fn daa_decided_by(by: u32) -> u32 {
    switch by {
        case DAA_REFINE_POSITION: { return DAA_BY_DEPTH; }
        case DAA_REFINE_COLOR: { return DAA_BY_LUMINANCE; }
        case DAA_REFINE_EDGE: { return DAA_BY_IDENTITY; }
        case DAA_REFINE_COARSEST: { return DAA_BY_LEAST; }
        case DAA_REFINE_SHADOW: { return DAA_BY_SHADOW; }
        default: { return DAA_BY_NOTHING; }
    }
}

@compute @workgroup_size(64)
fn daa_lattice_to_pixels_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let l = daa_step.points;
    let supersampled = daa_flag(DAA_FLAG_SUPERSAMPLED);
    let pixel = daa_tile_pixel(tile.xy, lane);
    var count = 0u;
    if daa_is_counted(pixel) {
        let at = vec2i(pixel);
        let index = daa_point_index(l, at);
        textureStore(daa_first, pixel, daa_lattice_colors[index]);
        let word = daa_points[index].x;
        let own = daa_point_own(word);
        var k = own;
        var by = daa_decided_by(daa_point_by(word));
        if supersampled {
            let residual = daa_residual(l, at);
            by = daa_decided_by(residual.by);
            // A residual is a second difference: where colour is smooth, it falls to a quarter with each halving of the
            // pitch.
            var f = 0u;
            var level = daa_frame.multi_resolution.color;
            for (; f < 3u && residual.color > level; f++) {
                level *= 4.0;
            }
            k = select(k, daa_level_samples(f), f > 0u);
            if residual.by == DAA_REFINE_POSITION {
                k = DAA_M * DAA_M;
            }
            if daa_flag(DAA_FLAG_VETO) && daa_holds_edge(pixel) {
                k = DAA_M * DAA_M;
                by = DAA_BY_IDENTITY;
            }
        }
        count = daa_count_word(k, daa_lattice_reason(by, daa_point_level(word), own), 0u);
    }
    let slot = daa_tile_index(tile.xy) * 64u + lane;
    if supersampled {
        daa_counts[slot] = count;
    } else {
        daa_plan[slot] = count;
    }
}
