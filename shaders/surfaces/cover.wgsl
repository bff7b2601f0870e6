// cover: gathers the samples of each window into surfaces: samples of one material and object whose normals and planes
// agree. The share of the window that a surface covers is then counted instead of estimated. CPU twin:
// src/reference/surfaces/cover.rs.

@group(3) @binding(0) var<storage, read_write> daa_surfaces: array<u32>;
@group(3) @binding(1) var<storage, read_write> daa_counts: array<u32>;
/// What `probe` has found, in the place of the plan.
@group(3) @binding(2) var<storage, read> daa_probed: array<u32>;

/// What a sample shows.
struct DaaSeen {
    relative_position: vec3f,
    identity: u32,
    normal: vec3f,
    sky: bool,
}

fn daa_seen(pixel: vec2u, rank: u32) -> DaaSeen {
    let at = pixel * DAA_M + daa_order(rank);
    let d = daa_depth_at(at);
    if d <= DAA_SKY_DEPTH {
        return DaaSeen(vec3f(0.0), 0u, vec3f(0.0), true);
    }
    let surface = daa_surface_at(at);
    let normal = daa_octahedral_decode(unpack2x16snorm(surface.x));
    return DaaSeen(daa_relative_position(vec2f(at) + 0.5, d), surface.y, normal, false);
}

/// Whether a sample lies on the surface of another one. Written so that NaN does not.
fn daa_is_same_surface(a: DaaSeen, b: DaaSeen) -> bool {
    if a.sky || b.sky {
        return a.sky && b.sky;
    }
    let off = abs(dot(a.normal, b.relative_position - a.relative_position));
    let near = off <= daa_frame.surfaces.plane * abs(dot(a.relative_position, daa_frame.camera_forward));
    return a.identity == b.identity && near && dot(a.normal, b.normal) >= daa_frame.surfaces.normal_cosine;
}

/// The ranks of a window that are known to show the triangle of one of them, itself included. They are judged together.
fn daa_of_triangle(pixel: vec2u, rank: u32) -> vec2u {
    let corner = pixel * DAA_M;
    let triangle = daa_triangle_at(corner + daa_order(rank));
    var ranks = vec2u(0u);
    // All of them, as compilers unroll that.
    for (var other = 0u; other < DAA_M * DAA_M; other++) {
        let same = u32(all(daa_triangle_at(corner + daa_order(other)) == triangle)) << (other & 31u);
        ranks |= select(vec2u(0u, same), vec2u(same, 0u), other < 32u);
    }
    return ranks;
}

/// The difference of a displayed channel above which all samples reflect. A quarter of it gives four.
const DAA_SEEN_CONTRAST: f32 = 0.02;

/// The nearest pixel of the G-buffer.
fn daa_nearest_pixel(pixel: vec2i) -> vec2u {
    return vec2u(clamp(pixel, vec2i(0), vec2i(daa_frame.size) - 1));
}

/// What the first sample reflects and refracts, exposed, on the curve c/(1+c).
fn daa_reflected_color(pixel: vec2u) -> vec3f {
    let c = daa_exposed(daa_radiance_decode(daa_reflection_code(pixel, 0u)));
    return c / (1.0 + c);
}

/// Whether `probe` has found an edge of a shadow in the window or one beside it: it may also pass between what was probed.
fn daa_near_edge(pixel: vec2u) -> bool {
    var is_near = false;
    for (var i = 0u; i < 9u && daa_shadow_probed(); i++) {
        let beside = daa_nearest_pixel(vec2i(pixel) + vec2i(i32(i % 3u), i32(i / 3u)) - 1);
        // Nothing is probed where there is no surface.
        let is_surface = daa_depth_at(beside * DAA_M + daa_order(0u)) > DAA_SKY_DEPTH;
        is_near = is_near || (is_surface && daa_probed[daa_slot(beside)] != 0u);
    }
    return is_near;
}

/// The number of ranks up to the last tap of a surface. All, if all may be read: a host that shades samples as a whole
/// may have any of them shaded.
fn daa_ranks_tapped(ranks: vec2u) -> u32 {
    let n = DAA_M * DAA_M;
    let taps = daa_frame.surfaces.taps;
    if taps >= min(n, DAA_MOST_TAPS) || daa_flag(DAA_FLAG_WHOLE_HOOK) {
        return n;
    }
    return daa_nth_rank(ranks, min(taps, daa_rank_count(ranks)) - 1u) + 1u;
}

/// How many of the window's samples cast rays, and why. Of several surfaces, those do that are read. Where one surface fills
/// the window, `probe` has found no edge of a shadow near it, and the windows beside it reflect alike, the first sample
/// speaks for all. Where only what is reflected differs, its shadow bits hold for all.
fn daa_rays_wanted(pixel: vec2u, surfaces: u32, tapped: u32) -> u32 {
    let n = DAA_M * DAA_M;
    if surfaces > 1u {
        return daa_count_word(tapped, DAA_BY_IDENTITY, 0u);
    }
    if daa_near_edge(pixel) {
        return daa_count_word(n, DAA_BY_SHADOW, 0u);
    }
    let reflected = daa_reflected_color(pixel);
    var contrast = 0.0;
    for (var i = 0u; i < 9u; i++) {
        let beside = daa_nearest_pixel(vec2i(pixel) + vec2i(i32(i % 3u), i32(i / 3u)) - 1);
        contrast = max(contrast, daa_greatest_channel(abs(daa_reflected_color(beside) - reflected)));
    }
    if contrast > DAA_SEEN_CONTRAST {
        return daa_count_word(n, DAA_BY_LUMINANCE, 0u);
    }
    if contrast > 0.25 * DAA_SEEN_CONTRAST {
        return daa_count_word(min(n, 4u), DAA_BY_LUMINANCE, 0u);
    }
    return daa_count_word(1u, DAA_BY_NOTHING, 0u);
}

@compute @workgroup_size(8, 8)
fn daa_cover_main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = id.xy;
    let slot = daa_tile_index(tile.xy) * 64u + lane;
    if !daa_is_shown(pixel) {
        daa_surfaces[slot] = 0u;
        daa_counts[slot] = 0u;
        return;
    }
    let most = daa_frame.surfaces.most;
    var left = daa_all_ranks();
    var low = vec2u(0u);
    var middle = vec2u(0u);
    var high = vec2u(0u);
    var surfaces = 0u;
    var merged = false;
    var tapped = 0u;
    while any(left != vec2u(0u)) {
        let first = daa_least(left);
        var same = left & daa_of_triangle(pixel, first);
        var others = left & ~same;
        if any(others != vec2u(0u)) {
            let seen = daa_seen(pixel, first);
            while any(others != vec2u(0u)) {
                let rank = daa_least(others);
                let ranks = others & daa_of_triangle(pixel, rank);
                same |= select(vec2u(0u), ranks, daa_is_same_surface(seen, daa_seen(pixel, rank)));
                others &= ~ranks;
            }
        }
        if surfaces + 1u == most {
            merged = any(same != left);
            same = left;
        }
        low |= select(vec2u(0u), same, (surfaces & 1u) != 0u);
        middle |= select(vec2u(0u), same, (surfaces & 2u) != 0u);
        high |= select(vec2u(0u), same, (surfaces & 4u) != 0u);
        left &= ~same;
        surfaces += 1u;
        tapped = max(tapped, daa_ranks_tapped(same));
    }
    daa_surfaces[slot] = daa_surface_word(surfaces, merged);
    daa_counts[slot] = daa_rays_wanted(pixel, surfaces, tapped);
    if surfaces == 1u {
        return;
    }
    daa_surfaces[daa_label_index(slot, 0u)] = low.x;
    daa_surfaces[daa_label_index(slot, 1u)] = middle.x;
    daa_surfaces[daa_label_index(slot, 2u)] = high.x;
    if DAA_M > 5u {
        let slots = daa_tile_count() * 64u;
        daa_surfaces[daa_label_index(slot, 0u) + slots] = low.y;
        daa_surfaces[daa_label_index(slot, 1u) + slots] = middle.y;
        daa_surfaces[daa_label_index(slot, 2u) + slots] = high.y;
    }
}
