// Blocks of 4 × 4 windows. Those at the corners are lit first. Surfaces between take the light of those corners that show
// the same, alike, if it hardly changes over the block. Uses what light.wgsl binds. CPU twin:
// src/reference/surfaces/light.rs.

/// What is known of a window at a corner of a block, or of a surface that may take its light.
struct DaaCorner {
    light: DaaLight,
    /// The means of the features of its taps.
    spread: DaaSpread,
    relative_position: vec3f,
    /// material | object << 16.
    identity: u32,
    normal: vec3f,
    shadow: u32,
    /// Whether the window is one surface, lit once, that reflects nothing of the scene.
    lends: bool,
}

/// The number of words of a corner.
const DAA_CORNER_WORDS: u32 = 14u;

/// Whether the windows of blocks may share their light.
fn daa_has_blocks() -> bool {
    return DAA_LIGHT_IN_PARTS && daa_frame.surfaces.block_spread > 0.0;
}

/// The first word of a corner of the block of a window.
fn daa_corner_index(pixel: vec2u, i: u32) -> u32 {
    let block = (pixel / 4u) % 2u;
    let corner = daa_tile_index(pixel / 8u) * 16u + block.y * 8u + block.x * 4u + i;
    return daa_label_index(0u, 3u) + corner * DAA_CORNER_WORDS;
}

fn daa_store_corner(pixel: vec2u, i: u32, c: DaaCorner) {
    let at = daa_corner_index(pixel, i);
    for (var channel = 0u; channel < 3u; channel++) {
        daa_surfaces[at + channel] = bitcast<u32>(c.light.diffuse[channel]);
        daa_surfaces[at + 3u + channel] = bitcast<u32>(c.light.rest[channel]);
    }
    daa_surfaces[at + 6u] = bitcast<u32>(c.light.rest.a);
    daa_surfaces[at + 7u] = pack2x16float(c.spread.shape.xy);
    daa_surfaces[at + 8u] = pack2x16float(c.spread.shape.zw);
    daa_surfaces[at + 9u] = pack2x16float(c.spread.tint.xy);
    daa_surfaces[at + 10u] = pack2x16float(c.spread.tint.zw);
    daa_surfaces[at + 11u] = c.identity;
    daa_surfaces[at + 12u] = pack2x16snorm(daa_octahedral_encode(c.normal));
    daa_surfaces[at + 13u] = u32(c.lends);
}

fn daa_stored_corner(pixel: vec2u, i: u32) -> DaaCorner {
    let at = daa_corner_index(pixel, i);
    var c: DaaCorner;
    c.lends = daa_surfaces[at + 13u] != 0u;
    if !c.lends {
        return c;
    }
    for (var channel = 0u; channel < 3u; channel++) {
        c.light.diffuse[channel] = bitcast<f32>(daa_surfaces[at + channel]);
        c.light.rest[channel] = bitcast<f32>(daa_surfaces[at + 3u + channel]);
    }
    c.light.rest.a = bitcast<f32>(daa_surfaces[at + 6u]);
    c.spread.shape = vec4f(unpack2x16float(daa_surfaces[at + 7u]), unpack2x16float(daa_surfaces[at + 8u]));
    c.spread.tint = vec4f(unpack2x16float(daa_surfaces[at + 9u]), unpack2x16float(daa_surfaces[at + 10u]));
    c.identity = daa_surfaces[at + 11u];
    c.normal = daa_octahedral_decode(unpack2x16snorm(daa_surfaces[at + 12u]));
    let corner = pixel / 4u * 4u + vec2u(i & 1u, i >> 1u) * 3u;
    let first = corner * DAA_M + daa_order(0u);
    c.relative_position = daa_relative_position(vec2f(first) + 0.5, daa_depth_at(first));
    c.shadow = daa_shadow_bits(corner, 0u);
    return c;
}

/// What the corners of a block are compared with: taps of a surface.
fn daa_as_corner(g: DaaGathered, s: DaaSample) -> DaaCorner {
    var c: DaaCorner;
    c.lends = g.taps > 0.0 && g.sky_taps == 0.0 && g.any_shadow == g.all_shadow && all(s.reflected == vec3f(0.0));
    c.spread = DaaSpread(g.from_shape + g.shape / g.taps, g.from_tint + g.tint / g.taps);
    c.relative_position = s.relative_position;
    c.identity = s.material | (s.object << 16u);
    c.normal = s.normal;
    c.shadow = g.all_shadow;
    return c;
}

/// Radiance on the display curve c/(1+c).
fn daa_seen_color(color: vec3f) -> vec3f {
    let c = daa_exposed(max(color, vec3f(0.0)));
    return c / (1.0 + c);
}

/// The colour of a surface of a window by light from the corners of its block, and whether it may be lit so.
struct DaaBetween {
    color: vec4f,
    fits: bool,
}

fn daa_between(pixel: vec2u, g: DaaGathered, s: DaaSample) -> DaaBetween {
    let here = daa_as_corner(g, s);
    if !daa_has_blocks() || !here.lends {
        return DaaBetween();
    }
    var m: DaaMaterial;
    m.base_color = g.material.base_color / g.taps;
    m.emissive = g.material.emissive / g.taps;
    let along = vec2f(pixel % 4u) / 3.0;
    var light: DaaLight;
    var shape = vec4f(0.0);
    var tint = vec4f(0.0);
    var share = 0.0;
    var least = vec3f(1e30);
    var most = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let weights = select(1.0 - along, along, vec2u(i & 1u, i >> 1u) == vec2u(1u));
        let weight = weights.x * weights.y;
        if weight == 0.0 {
            continue;
        }
        let corner = daa_stored_corner(pixel, i);
        let off = abs(dot(here.normal, corner.relative_position - here.relative_position));
        let near = off <= daa_frame.surfaces.plane * abs(dot(here.relative_position, daa_frame.camera_forward));
        let even = dot(here.normal, corner.normal) >= daa_frame.surfaces.normal_cosine;
        if corner.lends && corner.identity == here.identity && corner.shadow == here.shadow && near && even {
            share += weight;
            light.diffuse += weight * corner.light.diffuse;
            light.rest += weight * corner.light.rest;
            shape += weight * corner.spread.shape;
            tint += weight * corner.spread.tint;
            let seen = daa_seen_color(daa_radiance(corner.light, m).rgb);
            least = min(least, seen);
            most = max(most, seen);
        }
    }
    if share == 0.0 || daa_greatest_channel(most - least) > daa_frame.surfaces.block_contrast {
        return DaaBetween();
    }
    shape = shape / share - here.spread.shape;
    tint = tint / share - here.spread.tint;
    let apart = dot(shape, shape) + DAA_TINT_WEIGHT * dot(tint, tint);
    if apart > daa_frame.surfaces.block_spread {
        return DaaBetween();
    }
    let clean = daa_clean(daa_radiance(DaaLight(light.diffuse / share, light.rest / share), m));
    if clean.what == DAA_NOT_FINITE {
        atomicAdd(&daa_statistics.not_finite, 1u);
    }
    return DaaBetween(clean.color, true);
}
