// view: writes a debug view into the target in place of resolve, as values in [0, 1]. There is an entry point for each
// resource that views show.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
/// `DaaTileLists` of classify.wgsl, word by word.
@group(3) @binding(2) var<storage, read> daa_tile_lists: array<u32>;
/// As trace.wgsl writes it.
@group(3) @binding(3) var<storage, read> daa_shadows: array<u32>;
/// As reflect.wgsl writes it.
@group(3) @binding(4) var<storage, read> daa_reflections: array<u32>;
@group(3) @binding(5) var<storage, read> daa_surface_masks: array<u32>;

/// A colour scale from black through red and yellow to white.
fn daa_heat(t: f32) -> vec3f {
    return clamp(vec3f(t * 3.0, t * 3.0 - 1.0, t * 3.0 - 2.0), vec3f(0.0), vec3f(1.0));
}

/// A colour for a number that differs from those of its neighbours (PCG hash, Jarzynski and Olano 2020).
fn daa_label(i: u32) -> vec3f {
    let state = i * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return unpack4x8unorm((word >> 22u) ^ word).rgb * 0.8 + 0.1;
}

/// The number of surfaces among the samples of a window.
fn daa_surfaces(pixel: vec2u) -> u32 {
    var identities: array<u32, 64>;
    var different = 0u;
    var sky = 0u;
    for (var rank = 0u; rank < DAA_M * DAA_M; rank++) {
        let at = pixel * DAA_M + daa_order(rank);
        if daa_depth_at(at) <= DAA_SKY_DEPTH {
            sky = 1u;
            continue;
        }
        let identity = daa_identity_at(at);
        var i = 0u;
        while i < different && identities[i] != identity {
            i++;
        }
        if i == different {
            identities[i] = identity;
            different++;
        }
    }
    return different + sky;
}

/// The classes of a pixel's tile, which classify.wgsl writes behind both lists: bit 0 with a surface, bit 1 with a
/// surface that sends rays.
fn daa_tile_classes(pixel: vec2u) -> u32 {
    return daa_tile_lists[8u + 2u * daa_tile_count() + daa_tile_index(pixel >> vec2u(3u))];
}

/// The share of lights that reach a sample with these bits, with the lights assigned to the channels in turn. A single
/// light is white.
fn daa_reached(bits: u32) -> vec3f {
    var lights = vec3f(0.0);
    var reach = vec3f(0.0);
    for (var i = 0u; i < daa_frame.casting; i++) {
        let channel = vec3f(vec3u(i % 3u) == vec3u(0u, 1u, 2u));
        lights += channel;
        reach += channel * f32(1u - ((bits >> i) & 1u));
    }
    let share = reach / max(lights, vec3f(1.0));
    return select(share, share.xxx, daa_frame.casting == 1u);
}

/// The number of rays that the samples of a pixel send. Kinds that this frame does not trace are left out, since an
/// earlier frame may have left its counts.
fn daa_rays_sent(pixel: vec2u) -> u32 {
    let n = DAA_M * DAA_M;
    var rays = 0u;
    let word = daa_plan[daa_slot(pixel)];
    for (var rank = 0u; rank < n; rank++) {
        let kept = rank < daa_frame.results.ranks || (daa_is_planned(word, rank) && daa_has_results(pixel, rank));
        if !kept {
            continue;
        }
        let at = daa_frame.results.words + daa_result_index(pixel, rank);
        if daa_frame.casting > 0u {
            rays += daa_shadows[at];
        }
        if daa_flag(DAA_FLAG_REFLECTS) {
            let sent = daa_reflections[at + 6u * daa_tile_count() * 64u];
            rays += (sent & 0xffffu) + (sent >> 16u);
        }
    }
    return rays;
}

/// The channels of the G-buffer.
@fragment
fn daa_view_gbuffer(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = daa_target_pixel(position);
    let s = daa_fetch(pixel, 0u, 1.0, vec2f(0.0));
    let d = daa_depth_at(pixel * DAA_M + daa_order(0u));
    var c = vec3f(0.0);
    switch daa_frame.view {
        case 4u: { c = vec3f(sqrt(sqrt(clamp(d, 0.0, 1.0)))); } // Depth
        case 5u: { c = s.normal * 0.5 + 0.5; } // Normal
        case 6u: { c = s.geometric_normal * 0.5 + 0.5; } // GeometricNormal
        case 7u: { c = s.tangent.xyz * 0.5 + 0.5; } // Tangent
        case 8u: { c = vec3f(fract(s.uv), 0.0); } // Uv
        case 9u: { // Gradient: log2 of the footprint in uv, 2⁻¹⁶ black, 1 white
            let g = max(dot(s.ddx, s.ddx), dot(s.ddy, s.ddy));
            c = vec3f(clamp(log2(max(g, 1e-20)) / 32.0 + 1.0, 0.0, 1.0));
        }
        case 10u: { c = daa_label(s.material); } // Material
        case 11u: { c = daa_label(s.object + 0x10000u); } // Object
        case 12u: { c = unpack4x8unorm(s.user).rgb; } // User
        default: {}
    }
    // The host may have written what is no number.
    return daa_clean(vec4f(select(c, vec3f(0.0), s.depth == 0.0), 1.0)).color;
}

/// Surfaces: their number in the window, on a logarithmic scale.
@fragment
fn daa_view_surfaces(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let surfaces = daa_surfaces(daa_target_pixel(position));
    return vec4f(daa_heat(log2(f32(surfaces)) / max(log2(f32(DAA_M * DAA_M)), 1.0)), 1.0);
}

/// First: S, as a display would show it without its curve.
@fragment
fn daa_view_first(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = daa_exposed(textureLoad(daa_first, daa_target_pixel(position), 0).rgb);
    return vec4f(first / (1.0 + first), 1.0);
}

fn daa_view_of_plan(plan: u32) -> vec4f {
    let selective = daa_flag(DAA_FLAG_SELECTIVE);
    var c = vec3f(0.0);
    switch daa_frame.view {
        case 1u: { // Count
            c = daa_heat(log2(f32(max(daa_plan_k(plan), 1u))) / max(log2(f32(DAA_M * DAA_M)), 1.0));
        }
        case 2u: { // Decided: black nothing, red depth, green normal, blue luminance, yellow identity, cyan shadow, white user
            var by = daa_plan_by(plan);
            if selective && by > 0u {
                by = daa_metric_of_attribute(by);
            }
            let user = by == DAA_BY_USER;
            let red = by == DAA_BY_DEPTH || by == DAA_BY_IDENTITY || user;
            let green = by == DAA_BY_NORMAL || by == DAA_BY_IDENTITY || by == DAA_BY_SHADOW || user;
            let blue = by == DAA_BY_LUMINANCE || by == DAA_BY_SHADOW || user;
            c = vec3f(f32(red), f32(green), f32(blue));
        }
        case 13u: { // Quadrants: black, red, green, blue, white
            let chosen = countOneBits(daa_plan_quadrants(plan));
            c = select(vec3f(f32(chosen == 1u), f32(chosen == 2u), f32(chosen == 3u)), vec3f(1.0), chosen == 4u);
            c = select(vec3f(0.0), c, selective);
        }
        case 14u: { // Levels: black interpolated, white its own, cyan shifted, green every second, yellow fourth, red eighth pixel
            let own = daa_flag(DAA_FLAG_LATTICE) && daa_plan_own(plan);
            let level = daa_plan_level(plan);
            c = vec3f(f32(level == 0u || level >= 3u), f32(level < 4u), f32(level < 2u)) * f32(own);
        }
        default: {}
    }
    return vec4f(c, 1.0);
}

/// The metric whose colour stands for the attribute of a threshold of `Selective`: colour; object, normal, shadow and
/// texture; and those of reflected and refracted surfaces.
fn daa_metric_of_attribute(by: u32) -> u32 {
    if by == 1u {
        return DAA_BY_LUMINANCE;
    }
    switch by & 3u {
        case 0u: { return DAA_BY_DEPTH; }
        case 1u: { return DAA_BY_LUMINANCE; }
        case 2u: { return DAA_BY_IDENTITY; }
        default: { return DAA_BY_NORMAL; }
    }
}

@fragment
fn daa_view_lit(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let word = daa_surface_masks[daa_slot(daa_target_pixel(position))];
    if daa_surface_lights(word) == 0u {
        return vec4f(0.0, 0.0, 0.35, 1.0);
    }
    return daa_view_of_plan(daa_plan_word(daa_surface_lights(word), 0u, 0u, 0u));
}

/// Taps: their number, on a logarithmic scale.
@fragment
fn daa_view_taps(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let taps = daa_surface_taps(daa_surface_masks[daa_slot(daa_target_pixel(position))]);
    return vec4f(daa_heat(log2(f32(max(taps, 1u))) / log2(f32(2u * DAA_M * DAA_M))), 1.0);
}

@fragment
fn daa_view_plan(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return daa_view_of_plan(daa_plan[daa_slot(daa_target_pixel(position))]);
}

/// For frames without a plan, in which every window has the same k: n, or 1.
@fragment
fn daa_view_unplanned(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return daa_view_of_plan(select(1u, DAA_M * DAA_M, daa_flag(DAA_FLAG_FULL)));
}

/// Tiles: black nothing, blue a surface, yellow one that sends rays.
@fragment
fn daa_view_tiles(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let classes = daa_tile_classes(daa_target_pixel(position));
    let c = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 1.0, 0.0), (classes & 2u) != 0u);
    return vec4f(select(vec3f(0.0), c, classes != 0u), 1.0);
}

/// Shadows: red, green and blue lights in turn.
@fragment
fn daa_view_shadows(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = daa_target_pixel(position);
    let sky = daa_depth_at(pixel * DAA_M + daa_order(0u)) <= DAA_SKY_DEPTH;
    return vec4f(select(daa_reached(daa_shadows[daa_sample_index(pixel, 0u)]), vec3f(0.0), sky), 1.0);
}

/// Rays: the number that the samples of the pixel send, on a logarithmic scale.
@fragment
fn daa_view_rays(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let most = DAA_M * DAA_M * (daa_frame.casting + 2u);
    return vec4f(daa_heat(log2(f32(1u + daa_rays_sent(daa_target_pixel(position)))) / log2(f32(1u + most))), 1.0);
}

/// For views of rays in frames that trace none: black.
@fragment
fn daa_view_nothing() -> @location(0) vec4f {
    return vec4f(0.0, 0.0, 0.0, 1.0);
}
