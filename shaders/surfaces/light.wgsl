// light: reads the material of each surface at several taps, gathers the taps that would be lit alike into groups, and
// lights each group once. CPU twin: src/reference/surfaces/light.rs.

@group(3) @binding(0) var<storage, read_write> daa_surfaces: array<u32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;
@group(3) @binding(4) var<storage, read_write> daa_list_out: DaaWindowList;
@group(3) @binding(5) var<storage, read> daa_list: array<u32>;
@group(3) @binding(6) var<storage, read_write> daa_cut_list_out: DaaWindowList;
@group(3) @binding(7) var<storage, read> daa_cut_list: array<u32>;

/// The number of taps of a surface is at most this.
const DAA_MOST_TAPS: u32 = 16u;

/// What is known of a set of taps: sums over them.
struct DaaGathered {
    taps: f32,
    material: DaaMaterial,
    relative_position: vec3f,
    normal: vec3f,
    traced: u32,
    /// The shadow bits that any tap has, and that all have.
    any_shadow: u32,
    all_shadow: u32,
    /// The first tap's spread. Sums are of differences to it, so that they keep their precision.
    from_shape: vec4f,
    from_tint: vec4f,
    shape: vec4f,
    tint: vec4f,
    squared_shape: f32,
    squared_tint: f32,
    /// The radiance of taps that show the sky, which are not among the others, and their number.
    sky: vec4f,
    sky_taps: f32,
}

/// The features of a tap that decide which taps share a light, where the host has no `spread`.
fn daa_default_spread(s: DaaSample, m: DaaMaterial) -> DaaSpread {
    let color = max(m.base_color.rgb, vec3f(0.0));
    let specular = mix(vec3f(0.04), color, m.metallic);
    let diffuse = color * (1.0 - m.metallic);
    let alpha = max(m.roughness * m.roughness, 0.002);
    let grazing = 1.0 - clamp(dot(m.normal, s.view), 0.0, 1.0);
    let fresnel = mix(daa_luminance(specular), 1.0, grazing * grazing * grazing * grazing * grazing);
    let sharpness = sqrt(max(fresnel / alpha + 1.5 * daa_luminance(diffuse), 0.0));
    let shown = sqrt(max(specular + diffuse, vec3f(0.0)) + clamp(m.emissive, vec3f(0.0), vec3f(1.0)));
    return DaaSpread(vec4f(m.normal * sharpness, 0.3 * m.roughness), vec4f(shown, 1.5 * m.metallic));
}

/// NaN and infinity become 0, so that they can't keep a surface from being cut.
fn daa_finite(v: vec4f) -> vec4f {
    let exponents = bitcast<vec4u>(v) & vec4u(0x7f800000u);
    return select(clamp(v, vec4f(-6e4), vec4f(6e4)), vec4f(0.0), exponents == vec4u(0x7f800000u));
}

fn daa_spread(s: DaaSample, m: DaaMaterial) -> DaaSpread {
    let spread = daa_call_spread(s, m);
    return DaaSpread(daa_finite(spread.shape), daa_finite(spread.tint));
}

/// Adds a tap to those gathered.
fn daa_gather(to: DaaGathered, s: DaaSample, m: DaaMaterial, spread: DaaSpread) -> DaaGathered {
    var g = to;
    if g.taps == 0.0 {
        g.from_shape = spread.shape;
        g.from_tint = spread.tint;
        g.all_shadow = 0xffffffffu;
    }
    g.taps += 1.0;
    g.material.base_color += m.base_color;
    g.material.emissive += m.emissive;
    g.material.roughness += m.roughness;
    g.material.normal += m.normal;
    g.material.metallic += m.metallic;
    g.material.user0 += m.user0;
    g.material.user1 += m.user1;
    g.material.occlusion += m.occlusion;
    g.relative_position += s.relative_position;
    g.normal += s.normal;
    g.traced |= s.traced;
    g.any_shadow |= s.shadow;
    g.all_shadow &= s.shadow;
    let shape = spread.shape - g.from_shape;
    let tint = spread.tint - g.from_tint;
    g.shape += shape;
    g.tint += tint;
    g.squared_shape += dot(shape, shape);
    g.squared_tint += dot(tint, tint);
    return g;
}

/// The sums of squared deviations from the mean, of the shape and of the tint.
fn daa_deviations(g: DaaGathered) -> vec2f {
    let shape = g.squared_shape - dot(g.shape, g.shape) / g.taps;
    return max(vec2f(shape, g.squared_tint - dot(g.tint, g.tint) / g.taps), vec2f(0.0));
}

/// The weight of a squared deviation of the tint where lights are shared. Light is multiplied by it, and the product of
/// the means is close to the mean of the products.
const DAA_TINT_WEIGHT: f32 = 0.04;

/// Whether the first taps are so far apart that all are read. The deviations of few from their own mean are too small.
fn daa_coarse(deviations: vec2f, taps: u32) -> bool {
    return (deviations.x + deviations.y) * f32(taps) > daa_frame.surfaces.tap_spread * f32(max(taps, 2u) - 1u);
}

fn daa_light_deviation(deviations: vec2f) -> f32 {
    return deviations.x + DAA_TINT_WEIGHT * deviations.y;
}

/// The mean material. What the mean normal has lost in length becomes roughness: κ of a von Mises–Fisher distribution
/// (Banerjee et al. 2005) as slopes that widen the lobe (Tokuyoshi, Kaplanyan 2019, "Improved Geometric Specular
/// Antialiasing").
fn daa_mean_material(g: DaaGathered) -> DaaMaterial {
    let share = 1.0 / g.taps;
    var m: DaaMaterial;
    m.base_color = g.material.base_color * share;
    m.emissive = g.material.emissive * share;
    m.roughness = g.material.roughness * share;
    m.metallic = g.material.metallic * share;
    m.user0 = g.material.user0 * share;
    m.user1 = g.material.user1 * share;
    m.occlusion = g.material.occlusion * share;
    let mean = g.material.normal * share;
    let squared = dot(mean, mean);
    // Normals that cancel leave the surface's own.
    m.normal = select(g.normal * inverseSqrt(max(dot(g.normal, g.normal), 1e-30)), mean * inverseSqrt(max(squared, 1e-30)), squared > 1e-6);
    m.roughness = daa_widened(m.roughness, sqrt(min(squared, 1.0)));
    return m;
}

/// The perceptual roughness that also stands for normals whose mean has this length.
fn daa_widened(roughness: f32, length: f32) -> f32 {
    let lost = 1.0 - length * length;
    if !(lost > 1e-5) || daa_frame.surfaces.widening == 0.0 {
        return roughness;
    }
    let kappa = (3.0 * length - length * length * length) / lost;
    let alpha = clamp(roughness * roughness, 0.0, 1.0);
    let squared = alpha * alpha;
    let slopes = squared / max(1.0 - squared, 1e-6);
    var widened = slopes + 2.0 * daa_frame.surfaces.widening / max(kappa, 1e-6);
    widened = select(widened, min(widened, 1.0), slopes < 1.0);
    return sqrt(sqrt(widened / (1.0 + widened)));
}

/// The mean radiance that those of the ranks reflect and refract whose own rays were traced, else that of `s`.
fn daa_mean_reflected(ranks: vec2u, s: DaaSample) -> vec3f {
    let pixel = s.pixel - daa_frame.origin;
    var sum = vec3f(0.0);
    var own = 0.0;
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        let rank = daa_least(queue);
        let code = daa_reflection_code(pixel, rank);
        if code != 0u && daa_has_results(pixel, rank) {
            sum += daa_radiance_decode(code);
            own += 1.0;
        }
    }
    return select(s.reflected, sum / max(own, 1.0), own > 0.0);
}

/// The colour of taps that share a light, and that light. `good`: it is finite and not negative.
struct DaaLit {
    color: vec4f,
    light: DaaLight,
    good: bool,
}

/// Lights the taps once. `s` is one of those that show a surface, `ranks` are the samples that they stand for, and
/// `coverage` is their share of the window.
fn daa_light(g: DaaGathered, s: DaaSample, ranks: vec2u, coverage: f32) -> DaaLit {
    var radiance = vec4f(0.0);
    var light: DaaLight;
    if g.taps == 0.0 {
        // Nothing but sky.
    } else if DAA_SPLIT_HOOK {
        var f = daa_surface(s, coverage);
        f.relative_position = g.relative_position / g.taps;
        f.position = f.relative_position + daa_frame.camera_position;
        let towards = select(-f.relative_position, -daa_frame.camera_forward, daa_frame.orthographic != 0u);
        f.view = towards * inverseSqrt(max(dot(towards, towards), 1e-30));
        f.depth = max(dot(f.relative_position, daa_frame.camera_forward), 1e-30);
        let squared = dot(g.normal, g.normal);
        f.normal = select(s.normal, g.normal * inverseSqrt(max(squared, 1e-30)), squared > 1e-6);
        f.shadow = g.all_shadow;
        f.traced = g.traced;
        if g.traced != 0u {
            f.reflected = daa_mean_reflected(ranks, s);
        }
        let m = daa_mean_material(g);
        light = daa_call_light(f, m);
        radiance = daa_of_light(light, m);
    } else {
        radiance = daa_call_hook(s, coverage);
    }
    let clean = daa_clean((radiance * g.taps + g.sky) / (g.taps + g.sky_taps));
    if clean.what == DAA_NOT_FINITE {
        atomicAdd(&daa_statistics.not_finite, 1u);
    } else if clean.what == DAA_NEGATIVE {
        atomicAdd(&daa_statistics.negative, 1u);
    }
    return DaaLit(clean.color, light, clean.what == DAA_GOOD);
}

/// Adds the colour of a share of the window.
fn daa_covered(mean: DaaMean, c: vec4f, coverage: f32) -> DaaMean {
    let by_luminance = daa_flag(DAA_FLAG_WEIGHT_LUMINANCE);
    return daa_mean_add(mean, c, coverage * daa_weight(c, by_luminance, daa_frame.exposure));
}

/// The footprint of each of so many taps of so many samples.
fn daa_tap_footprint(samples: u32, taps: u32) -> f32 {
    return max(sqrt(f32(samples) / f32(taps)) * daa_frame.footprint, 1.0);
}

/// The offset from the mean place of the first taps of a surface to that of all its samples, in samples.
fn daa_tap_offset(ranks: vec2u, samples: u32, taps: u32) -> vec2f {
    if taps == samples {
        return vec2f(0.0);
    }
    var all = vec2f(0.0);
    var first = vec2f(0.0);
    var i = 0u;
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        let place = vec2f(daa_order(daa_least(queue)));
        all += place;
        first += select(vec2f(0.0), place, i < taps);
        i += 1u;
    }
    return all / f32(samples) - first / f32(taps);
}

/// The rank of the surface's sample that is nearest to its centroid, for hosts that shade a sample as a whole.
fn daa_central(ranks: vec2u, samples: u32) -> u32 {
    var centre = vec2f(0.0);
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        centre += vec2f(daa_order(daa_least(queue)));
    }
    centre /= f32(samples);
    var nearest = 0u;
    var least = 1e30;
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        let rank = daa_least(queue);
        let apart = vec2f(daa_order(rank)) - centre;
        if dot(apart, apart) < least {
            least = dot(apart, apart);
            nearest = rank;
        }
    }
    return nearest;
}

// Blocks of 4 × 4 windows. Those at the corners are lit first. Surfaces between take the light of those corners that show
// the same, alike, if it hardly changes over the block.

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

/// The place of a lane in its tile: the corners of blocks go first, so that few lanes wait while they are lit.
fn daa_block_place(lane: u32) -> vec2u {
    let is_corner = lane < 16u;
    let block = select((lane - 16u) / 12u, lane >> 2u, is_corner);
    let between = (lane - 16u) % 12u;
    let inner = between + 1u + u32(between >= 2u) + u32(between >= 10u);
    let corner = vec2u(lane & 1u, (lane >> 1u) & 1u) * 3u;
    return vec2u(block & 1u, block >> 1u) * 4u + select(vec2u(inner & 3u, inner >> 2u), corner, is_corner);
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

/// Luminance on the display curve c/(1+c).
fn daa_seen_luminance(color: vec3f) -> f32 {
    let c = daa_luminance(daa_exposed(max(color, vec3f(0.0))));
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
    var least = 1e30;
    var most = 0.0;
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
            let seen = daa_seen_luminance(daa_radiance(corner.light, m).rgb);
            least = min(least, seen);
            most = max(most, seen);
        }
    }
    if share == 0.0 || most - least > daa_frame.surfaces.block_contrast {
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

/// Lights windows of one surface whose first taps are alike. The others are left to the list.
@compute @workgroup_size(8, 8)
fn daa_light_one(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let blocks = daa_has_blocks();
    let place = select(vec2u(lane & 7u, lane >> 3u), daa_block_place(lane), blocks);
    let pixel = tile.xy * 8u + place;
    let slot = daa_slot(pixel);
    let word = daa_surfaces[slot];
    let n = DAA_M * DAA_M;
    let all = select(1u, min(daa_frame.surfaces.taps, n), DAA_SPLIT_HOOK);
    var taps = min(daa_frame.surfaces.first_taps, all);
    var read = 0u;
    var g: DaaGathered;
    var s: DaaSample;
    var left = daa_surface_count(word) == 1u;
    // The first taps, and all at the corners of blocks, if those are not alike.
    for (var more = left; more; ) {
        var offset = vec2f(0.0);
        if DAA_SPLIT_HOOK {
            let pair = daa_frame.centres[(taps - 1u) >> 1u];
            offset = select(pair.xy, pair.zw, (taps & 1u) == 0u);
        }
        let footprint = daa_tap_footprint(n, taps);
        g = DaaGathered();
        for (var rank = 0u; rank < taps; rank++) {
            let tap = daa_fetch(pixel, select(daa_central(daa_all_ranks(), n), rank, DAA_SPLIT_HOOK), footprint, offset);
            if tap.depth == 0.0 {
                g.sky_taps += 1.0;
                g.sky += daa_call_sky(tap);
            } else {
                s = tap;
                if DAA_SPLIT_HOOK {
                    let m = daa_call_material(tap);
                    g = daa_gather(g, tap, m, daa_spread(tap, m));
                } else {
                    g.taps = 1.0;
                }
            }
        }
        read += taps;
        more = false;
        if DAA_SPLIT_HOOK && g.taps > 0.0 {
            let deviations = daa_deviations(g) / g.taps;
            let coarse = taps < all && daa_coarse(deviations, taps);
            let apart = daa_light_deviation(deviations) > daa_frame.surfaces.spread && daa_frame.surfaces.most_groups > 1u;
            left = !(apart || daa_mixed_shadow(pixel, daa_all_ranks()));
            more = left && coarse && blocks && lane < 16u;
            left = left && (more || !coarse);
            taps = select(taps, all, more);
        }
    }
    if read > 0u && !left {
        daa_surfaces[slot] = word | (read << 16u);
    }
    // First the corners, then what is left between.
    for (var turn = 0u; turn < 2u; turn++) {
        if turn == 1u && left {
            let between = daa_between(pixel, g, s);
            if between.fits {
                textureStore(daa_color, pixel, between.color);
                daa_surfaces[slot] = daa_surface_word_lit(word, 0u, read, 1u);
                left = false;
            }
        }
        var corner: DaaCorner;
        if left && (turn == 1u || lane < 16u || !blocks) {
            let lit = daa_light(g, s, daa_all_ranks(), 1.0);
            let mean = daa_covered(DaaMean(), lit.color, 1.0);
            textureStore(daa_color, pixel, daa_mean_finish(mean));
            daa_surfaces[slot] = daa_surface_word_lit(word, 1u, read, 0u);
            corner = daa_as_corner(g, s);
            corner.light = lit.light;
            corner.lends = corner.lends && lit.good;
            left = false;
        }
        if !blocks {
            break;
        }
        if turn == 0u && lane < 16u {
            daa_store_corner(pixel, lane & 3u, corner);
        }
        storageBarrier();
    }
}

/// The windows that are left.
struct DaaWindowList {
    /// The workgroups of the dispatch.
    groups_x: u32,
    groups_y: atomic<u32>,
    groups_z: u32,
    count: atomic<u32>,
    slots: array<u32>,
}

/// The number of workgroups in a row of the dispatch.
const DAA_LIST_ROW: u32 = 16u;
const DAA_LIST_LANES: u32 = 32u;

/// Lists the windows that are left. A lane lists a whole tile.
@compute @workgroup_size(64)
fn daa_light_list(@builtin(global_invocation_id) id: vec3u) {
    if id.x == 0u {
        daa_list_out.groups_x = DAA_LIST_ROW;
        daa_list_out.groups_z = 1u;
        daa_cut_list_out.groups_x = DAA_LIST_ROW;
        daa_cut_list_out.groups_z = 1u;
    }
    if id.x >= daa_tile_count() {
        return;
    }
    let first_slot = id.x * 64u;
    var left = 0u;
    for (var i = 0u; i < 64u; i++) {
        let word = daa_surfaces[first_slot + i];
        left += u32(!daa_surface_is_lit(word));
    }
    if left == 0u {
        return;
    }
    // The order of the list differs from run to run, which changes nothing: each window is lit on its own.
    var at = atomicAdd(&daa_list_out.count, left);
    let row = DAA_LIST_ROW * DAA_LIST_LANES;
    atomicMax(&daa_list_out.groups_y, (at + left + row - 1u) / row);
    // Windows of one surface first, as neighbours in the list take turns together.
    for (var kind = 0u; kind < 2u; kind++) {
        for (var i = 0u; i < 64u; i++) {
            let word = daa_surfaces[first_slot + i];
            let of_kind = select(daa_surface_count(word) == 1u, daa_surface_count(word) > 1u, kind == 1u);
            if of_kind && !daa_surface_is_lit(word) {
                daa_list_out.slots[at] = first_slot + i;
                at += 1u;
            }
        }
    }
}

/// The spreads of the taps of each lane's surface, in halves, at DAA_LIST_LANES i + lane for its i-th tap. No lane
/// reads those of another.
var<workgroup> daa_tap_spreads: array<vec4u, 512>;

fn daa_keep_spread(lane: u32, tap: u32, spread: DaaSpread) {
    let shape = vec2u(pack2x16float(spread.shape.xy), pack2x16float(spread.shape.zw));
    daa_tap_spreads[DAA_LIST_LANES * tap + lane] = vec4u(shape, pack2x16float(spread.tint.xy), pack2x16float(spread.tint.zw));
}

fn daa_kept_spread(lane: u32, tap: u32) -> DaaSpread {
    let kept = daa_tap_spreads[DAA_LIST_LANES * tap + lane];
    let shape = vec4f(unpack2x16float(kept.x), unpack2x16float(kept.y));
    return DaaSpread(shape, vec4f(unpack2x16float(kept.z), unpack2x16float(kept.w)));
}

/// Up to eight sets of taps, 16 bits each.
struct DaaGroups {
    sets: vec4u,
    count: u32,
}

fn daa_group(groups: DaaGroups, i: u32) -> u32 {
    return (groups.sets[i >> 1u] >> ((i & 1u) * 16u)) & 0xffffu;
}

fn daa_set_group(groups: DaaGroups, i: u32, chosen: u32) -> DaaGroups {
    var changed = groups;
    let shift = (i & 1u) * 16u;
    changed.sets[i >> 1u] = (groups.sets[i >> 1u] & ~(0xffffu << shift)) | (chosen << shift);
    return changed;
}

/// The shadow bits of a sample, none for the sky.
fn daa_tap_bits(pixel: vec2u, rank: u32) -> u32 {
    let d = daa_depth_at(pixel * DAA_M + daa_order(rank));
    return select(0u, daa_shadow_bits(pixel, rank), d > DAA_SKY_DEPTH);
}

/// Whether the shadow bits of a surface's samples differ.
fn daa_mixed_shadow(pixel: vec2u, ranks: vec2u) -> bool {
    var any_shadow = 0u;
    var all_shadow = 0xffffffffu;
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        let bits = daa_tap_bits(pixel, daa_least(queue));
        any_shadow |= bits;
        all_shadow &= bits;
    }
    return any_shadow != all_shadow;
}

/// The taps of a set that are cut off: those above the mean of the feature that deviates most, or those that lack a
/// shadow bit that others have. 0 if nothing is cut: the deviation, times the share of the window that a tap has, is
/// at most the setting `spread`.
fn daa_cut(lane: u32, chosen: u32, share: f32, pixel: vec2u, ranks: vec2u) -> u32 {
    var any_shadow = 0u;
    var all_shadow = 0xffffffffu;
    var shape = vec4f(0.0);
    var tint = vec4f(0.0);
    var squared_shape = vec4f(0.0);
    var squared_tint = vec4f(0.0);
    let base = daa_kept_spread(lane, firstTrailingBit(chosen));
    for (var queue = chosen; queue != 0u; queue &= queue - 1u) {
        let tap = firstTrailingBit(queue);
        let bits = daa_tap_bits(pixel, daa_nth_rank(ranks, tap));
        any_shadow |= bits;
        all_shadow &= bits;
        let spread = daa_kept_spread(lane, tap);
        let to_shape = spread.shape - base.shape;
        let to_tint = spread.tint - base.tint;
        shape += to_shape;
        tint += to_tint;
        squared_shape += to_shape * to_shape;
        squared_tint += to_tint * to_tint;
    }
    var off = 0u;
    if any_shadow != all_shadow {
        let light = firstTrailingBit(any_shadow & ~all_shadow);
        for (var queue = chosen; queue != 0u; queue &= queue - 1u) {
            let tap = firstTrailingBit(queue);
            let bits = daa_tap_bits(pixel, daa_nth_rank(ranks, tap));
            off |= (1u - ((bits >> light) & 1u)) << tap;
        }
        return off;
    }
    let taps = f32(countOneBits(chosen));
    shape /= taps;
    tint /= taps;
    let of_shape = max(squared_shape - shape * shape * taps, vec4f(0.0));
    let of_tint = max(squared_tint - tint * tint * taps, vec4f(0.0)) * DAA_TINT_WEIGHT;
    if !((dot(of_shape, vec4f(1.0)) + dot(of_tint, vec4f(1.0))) * share > daa_frame.surfaces.spread) {
        return 0u;
    }
    var feature = 0u;
    var most = of_shape.x;
    for (var i = 1u; i < 8u; i++) {
        let deviation = select(of_shape[i & 3u], of_tint[i & 3u], i > 3u);
        if deviation > most {
            most = deviation;
            feature = i;
        }
    }
    for (var queue = chosen; queue != 0u; queue &= queue - 1u) {
        let tap = firstTrailingBit(queue);
        let spread = daa_kept_spread(lane, tap);
        let value = select(spread.shape[feature & 3u] - base.shape[feature & 3u], spread.tint[feature & 3u] - base.tint[feature & 3u], feature > 3u);
        let mean = select(shape[feature & 3u], tint[feature & 3u], feature > 3u);
        off |= u32(value > mean) << tap;
    }
    return select(off, 0u, off == chosen);
}

/// Cuts the taps of a surface into groups that may share a light.
fn daa_grouped(lane: u32, surface: DaaTapped, pixel: vec2u) -> DaaGroups {
    var groups = DaaGroups(vec4u(daa_all_taps(surface), 0u, 0u, 0u), 1u);
    for (var i = 0u; i < groups.count && groups.count < daa_frame.surfaces.most_groups; ) {
        let chosen = daa_group(groups, i);
        let off = daa_cut(lane, chosen, surface.share, pixel, surface.ranks);
        if off == 0u {
            i += 1u;
        } else {
            groups = daa_set_group(groups, i, chosen & ~off);
            groups = daa_set_group(groups, groups.count, off);
            groups.count += 1u;
        }
    }
    return groups;
}

/// Stores the groups of a window of one surface as labels of its taps.
fn daa_store_labels(slot: u32, groups: DaaGroups) {
    var labels = vec3u(0u);
    for (var i = 1u; i < groups.count; i++) {
        labels |= select(vec3u(0u), vec3u(daa_group(groups, i)), (vec3u(i) & vec3u(1u, 2u, 4u)) != vec3u(0u));
    }
    daa_surfaces[daa_label_index(slot, 0u)] = labels.x;
    daa_surfaces[daa_label_index(slot, 1u)] = labels.y;
    daa_surfaces[daa_label_index(slot, 2u)] = labels.z;
}

/// The groups that were stored. None is empty.
fn daa_stored_groups(slot: u32, all: u32) -> DaaGroups {
    var groups: DaaGroups;
    for (var i = 0u; i < 8u; i++) {
        var chosen = all;
        for (var bit = 0u; bit < 3u; bit++) {
            let labels = daa_surfaces[daa_label_index(slot, bit)];
            chosen &= select(~labels, labels, ((i >> bit) & 1u) != 0u);
        }
        if chosen != 0u {
            groups = daa_set_group(groups, i, chosen);
            groups.count = i + 1u;
        }
    }
    return groups;
}

/// The ranks of a surface.
fn daa_label_ranks(slot: u32, label: u32, surfaces: u32) -> vec2u {
    var ranks = daa_all_ranks();
    if surfaces == 1u {
        return ranks;
    }
    let slots = daa_tile_count() * 64u;
    for (var bit = 0u; bit < 3u; bit++) {
        let at = daa_label_index(slot, bit);
        var chosen = vec2u(daa_surfaces[at], 0u);
        if DAA_M > 5u {
            chosen.y = daa_surfaces[at + slots];
        }
        ranks &= select(~chosen, chosen, ((label >> bit) & 1u) != 0u);
    }
    return ranks;
}

/// What was read of a surface at a set of taps: the sums, one of the taps that show a surface, and the ranks.
struct DaaRead {
    g: DaaGathered,
    s: DaaSample,
    ranks: vec2u,
}

/// A surface of a window, and its taps.
struct DaaTapped {
    ranks: vec2u,
    samples: u32,
    taps: u32,
    /// The share of the window that each tap stands for.
    share: f32,
}

fn daa_tapped(ranks: vec2u) -> DaaTapped {
    let samples = daa_rank_count(ranks);
    let taps = select(1u, min(min(daa_frame.surfaces.taps, DAA_MOST_TAPS), samples), DAA_SPLIT_HOOK);
    return DaaTapped(ranks, samples, taps, f32(samples) / f32(DAA_M * DAA_M * taps));
}

/// All taps of a surface.
fn daa_all_taps(surface: DaaTapped) -> u32 {
    return 0xffffu >> (16u - surface.taps);
}

/// Reads some taps of a surface. Their spreads are kept on request.
fn daa_read_taps(pixel: vec2u, surface: DaaTapped, chosen: u32, lane: u32, keep: bool) -> DaaRead {
    let footprint = daa_tap_footprint(surface.samples, surface.taps);
    var offset = vec2f(0.0);
    if DAA_SPLIT_HOOK {
        offset = daa_tap_offset(surface.ranks, surface.samples, surface.taps);
    }
    var read: DaaRead;
    for (var queue = chosen; queue != 0u; queue &= queue - 1u) {
        let tap = firstTrailingBit(queue);
        var rank = daa_nth_rank(surface.ranks, tap);
        if !DAA_SPLIT_HOOK {
            rank = daa_central(surface.ranks, surface.samples);
        }
        let s = daa_fetch(pixel, rank, footprint, offset);
        read.ranks = daa_with(read.ranks, rank);
        var spread: DaaSpread;
        if s.depth == 0.0 {
            read.g.sky_taps += 1.0;
            read.g.sky += daa_call_sky(s);
        } else {
            read.s = s;
            if DAA_SPLIT_HOOK {
                let m = daa_call_material(s);
                spread = daa_spread(s, m);
                read.g = daa_gather(read.g, s, m, spread);
            } else {
                read.g.taps = 1.0;
            }
        }
        if keep {
            daa_keep_spread(lane, tap, spread);
        }
    }
    return read;
}

/// Whether all taps of a surface are too far apart to share a light.
fn daa_apart(g: DaaGathered, share: f32) -> bool {
    if !DAA_SPLIT_HOOK || g.taps == 0.0 || daa_frame.surfaces.most_groups < 2u {
        return false;
    }
    return daa_light_deviation(daa_deviations(g) * share) > daa_frame.surfaces.spread || g.any_shadow != g.all_shadow;
}

/// Lights the windows that are left, those of several surfaces and those whose first taps are not alike, but for those
/// with a surface to be cut, which are listed in turn: else the lanes beside it would wait for its groups.
@compute @workgroup_size(32)
fn daa_light_listed(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * DAA_LIST_ROW + group.x) * DAA_LIST_LANES + lane;
    if index >= daa_list[3] {
        return;
    }
    let slot = daa_list[4u + index];
    let pixel = daa_slot_pixel(slot);
    let word = daa_surfaces[slot];
    let surfaces = daa_surface_count(word);
    var mean: DaaMean;
    var taps = daa_surface_taps(word);
    var interpolated = 0u;
    for (var label = 0u; label < surfaces; label++) {
        let surface = daa_tapped(daa_label_ranks(slot, label, surfaces));
        let all = daa_all_taps(surface);
        let read = daa_read_taps(pixel, surface, all, lane, surfaces == 1u);
        taps += surface.taps;
        if daa_apart(read.g, surface.share) {
            if surfaces == 1u {
                // The sets of taps take the place of labels.
                daa_store_labels(slot, daa_grouped(lane, surface, pixel));
            }
            let at = atomicAdd(&daa_cut_list_out.count, 1u);
            let row = DAA_LIST_ROW * DAA_LIST_LANES;
            atomicMax(&daa_cut_list_out.groups_y, at / row + 1u);
            daa_cut_list_out.slots[at] = slot;
            return;
        }
        let coverage = surface.share * f32(surface.taps);
        let between = daa_between(pixel, read.g, read.s);
        if between.fits {
            mean = daa_covered(mean, between.color, coverage);
            interpolated += 1u;
            continue;
        }
        mean = daa_covered(mean, daa_light(read.g, read.s, surface.ranks, coverage).color, coverage);
    }
    textureStore(daa_color, pixel, daa_mean_finish(mean));
    daa_surfaces[slot] = daa_surface_word_lit(word, surfaces - interpolated, taps, interpolated);
}

/// Lights the windows with a surface that is cut into groups.
@compute @workgroup_size(32)
fn daa_light_cut(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * DAA_LIST_ROW + group.x) * DAA_LIST_LANES + lane;
    if index >= daa_cut_list[3] {
        return;
    }
    let slot = daa_cut_list[4u + index];
    let pixel = daa_slot_pixel(slot);
    let word = daa_surfaces[slot];
    let surfaces = daa_surface_count(word);
    var mean: DaaMean;
    var lights = 0u;
    var interpolated = 0u;
    // The surface, and its groups that are still to be lit. There is one call of each of the host's functions, as
    // compilers copy them into every place.
    var label = 0u;
    var surface = daa_tapped(daa_all_ranks());
    var groups: DaaGroups;
    var next = 0u;
    var taps = daa_surface_taps(word);
    if surfaces == 1u {
        groups = daa_stored_groups(slot, daa_all_taps(surface));
        label = 1u;
        taps += surface.taps;
    }
    loop {
        let grouped = next < groups.count;
        var chosen = 0u;
        if grouped {
            chosen = daa_group(groups, next);
            next += 1u;
        } else if label == surfaces {
            break;
        } else {
            surface = daa_tapped(daa_label_ranks(slot, label, surfaces));
            chosen = daa_all_taps(surface);
            label += 1u;
        }
        let read = daa_read_taps(pixel, surface, chosen, lane, !grouped);
        taps += countOneBits(chosen);
        if !grouped && daa_apart(read.g, surface.share) {
            groups = daa_grouped(lane, surface, pixel);
            next = 0u;
            if groups.count > 1u {
                continue;
            }
            next = groups.count;
        }
        let coverage = surface.share * f32(countOneBits(chosen));
        if !grouped {
            let between = daa_between(pixel, read.g, read.s);
            if between.fits {
                mean = daa_covered(mean, between.color, coverage);
                interpolated += 1u;
                continue;
            }
        }
        let ranks = select(surface.ranks, read.ranks, grouped);
        mean = daa_covered(mean, daa_light(read.g, read.s, ranks, coverage).color, coverage);
        lights += 1u;
    }
    textureStore(daa_color, pixel, daa_mean_finish(mean));
    daa_surfaces[slot] = daa_surface_word_lit(word, lights, taps, interpolated);
}

/// Counts what was lit. A lane counts a whole tile.
@compute @workgroup_size(64)
fn daa_light_count(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    atomicStore(&daa_group_histogram[lane], 0u);
    workgroupBarrier();
    if id.x < daa_tile_count() {
        var taps = 0u;
        var surfaces = 0u;
        var merged = 0u;
        var interpolated = 0u;
        var ones = 0u;
        for (var i = 0u; i < 64u; i++) {
            let word = daa_surfaces[id.x * 64u + i];
            let lights = daa_surface_lights(word);
            interpolated += daa_surface_interpolated(word);
            taps += daa_surface_taps(word);
            surfaces += daa_surface_count(word);
            merged += u32(daa_surface_merged(word));
            if lights == 1u {
                ones += 1u;
            } else if lights > 1u {
                atomicAdd(&daa_group_histogram[lights - 1u], 1u);
            }
        }
        atomicAdd(&daa_group_histogram[0], ones);
        atomicAdd(&daa_statistics.surfaces[0], surfaces);
        atomicAdd(&daa_statistics.surfaces[1], taps);
        if merged > 0u {
            atomicAdd(&daa_statistics.surfaces[2], merged);
        }
        if interpolated > 0u {
            atomicAdd(&daa_statistics.surfaces[3], interpolated);
        }
    }
    workgroupBarrier();
    daa_add_histogram(lane);
}
