// view: a look at what the frame is made from, in place of resolve. Displayable values in [0, 1].

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
/// `DaaTileLists` of classify.wgsl, word by word. Nothing but zeros, as the next, unless what it holds is shown.
@group(3) @binding(2) var<storage, read> daa_tile_lists: array<u32>;
/// Of trace.wgsl.
@group(3) @binding(3) var<storage, read> daa_shadows: array<u32>;
/// Of bounce.wgsl.
@group(3) @binding(4) var<storage, read> daa_secondary: array<u32>;

@vertex
fn daa_view_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

/// Black through red and yellow to white.
fn daa_heat(t: f32) -> vec3f {
    return clamp(vec3f(t * 3.0, t * 3.0 - 1.0, t * 3.0 - 2.0), vec3f(0.0), vec3f(1.0));
}

/// A colour for a number, far from its neighbours' (PCG hash, Jarzynski and Olano 2020).
fn daa_label(i: u32) -> vec3f {
    let state = i * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return unpack4x8unorm((word >> 22u) ^ word).rgb * 0.8 + 0.1;
}

/// Surfaces among the samples of a window.
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
        let identity = textureLoad(daa_gbuffer_surface, at, 0).y;
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

/// Where classify.wgsl writes down the classes of a pixel's tile, behind both lists: 1 with a surface, 2 with one that sends rays.
fn daa_tile_classes(pixel: vec2u) -> u32 {
    let all_tiles = daa_frame.tiles_x * ((daa_frame.size.y + 7u) >> 3u);
    return daa_tile_lists[8u + 2u * all_tiles + (pixel.y >> 3u) * daa_frame.tiles_x + (pixel.x >> 3u)];
}

/// By channel, the share of its casting lights that reach where these bits are. One light alone is white.
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

/// Rays that the samples of a pixel send. What this frame does not trace another may have left there.
fn daa_rays_sent(pixel: vec2u) -> u32 {
    let n = DAA_M * DAA_M;
    var rays = 0u;
    for (var rank = 0u; rank < n && daa_frame.casting > 0u; rank++) {
        rays += daa_shadows[daa_sample_index(pixel, n + rank)];
    }
    for (var rank = 0u; rank < n && (daa_frame.flags & DAA_FLAG_BOUNCES) != 0u; rank++) {
        let sent = daa_secondary[daa_sample_index(pixel, n + 6u + rank)];
        rays += (sent & 0xffffu) + (sent >> 16u);
    }
    return rays;
}

@fragment
fn daa_view_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let slot = ((pixel.y >> 3u) * daa_frame.tiles_x + (pixel.x >> 3u)) * 64u + (pixel.y & 7u) * 8u + (pixel.x & 7u);
    let s = daa_fetch(pixel, 0u, 1.0, vec2f(0.0));
    let d = daa_depth_at(pixel * DAA_M + daa_order(0u));
    // Without a plan every window has the same k: n, or 1.
    var plan = daa_plan[slot];
    if (daa_frame.flags & DAA_FLAG_PLANNED) == 0u {
        plan = select(1u, DAA_M * DAA_M, (daa_frame.flags & DAA_FLAG_FULL) != 0u);
    }
    let selective = (daa_frame.flags & DAA_FLAG_SELECTIVE) != 0u;
    let sky = s.depth == 0.0;
    var c = vec3f(0.0);
    switch daa_frame.view {
        case 1u: { // Count
            c = daa_heat(log2(f32(max(plan & 0xffu, 1u))) / max(log2(f32(DAA_M * DAA_M)), 1.0));
        }
        case 2u: { // Decided: black nothing, red depth, green normal, blue luminance, yellow identity, cyan shadow
            var by = (plan >> 8u) & 15u;
            if selective && by > 0u {
                // Colour; object, normal, shadow, texture.
                by = select(select(select(select(3u, 1u, (by & 3u) == 0u), 2u, (by & 3u) == 3u), 4u, (by & 3u) == 2u), 3u, by == 1u);
            }
            c = vec3f(f32(by == 1u || by == 4u), f32(by == 2u || by == 4u || by == 6u), f32(by == 3u || by == 6u));
        }
        case 3u: { // First
            let first = textureLoad(daa_first, pixel, 0).rgb * daa_frame.exposure;
            c = first / (1.0 + first);
        }
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
        case 13u: { // Quadrants: black, red, green, blue, white
            let chosen = countOneBits((plan >> 16u) & 15u);
            c = select(vec3f(f32(chosen == 1u), f32(chosen == 2u), f32(chosen == 3u)), vec3f(1.0), chosen == 4u);
            c = select(vec3f(0.0), c, selective);
        }
        case 14u: { // Levels: black interpolated, white its own, cyan shifted, green every second, yellow fourth, red eighth pixel
            let own = (daa_frame.flags & DAA_FLAG_LATTICE) != 0u && (plan & 0x8000u) != 0u;
            let place = (plan >> 12u) & 7u;
            c = vec3f(f32(place == 0u || place >= 3u), f32(place < 4u), f32(place < 2u)) * f32(own);
        }
        case 15u: { // Surfaces
            c = daa_heat(log2(f32(daa_surfaces(pixel))) / max(log2(f32(DAA_M * DAA_M)), 1.0));
        }
        case 16u: { // Tiles: black nothing, blue a surface, yellow one that sends rays
            let classes = daa_tile_classes(pixel);
            c = select(vec3f(0.0), select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 1.0, 0.0), (classes & 2u) != 0u), classes != 0u);
        }
        case 17u: { // Shadows: red, green and blue lights in turn
            c = select(daa_reached(daa_shadows[daa_sample_index(pixel, 0u)]), vec3f(0.0), sky);
        }
        case 18u: { // Rays
            let most = DAA_M * DAA_M * (daa_frame.casting + 2u);
            c = daa_heat(log2(f32(1u + daa_rays_sent(pixel))) / log2(f32(1u + most)));
        }
        default: {}
    }
    let everywhere = daa_frame.view <= 3u || daa_frame.view >= 13u;
    return vec4f(select(c, vec3f(0.0), sky && !everywhere), 1.0);
}
