// The taps of surfaces: what is read of them, and what their spread says. Declares no bindings. CPU twin:
// src/reference/surfaces/light.rs.

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
    var sum = vec2i(0);
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        sum += vec2i(daa_order(daa_least(queue)));
    }
    // In whole numbers: where two are as near, rounding would decide.
    var nearest = 0u;
    var least = 0x7fffffff;
    for (var queue = ranks; any(queue != vec2u(0u)); queue = daa_without_least(queue)) {
        let rank = daa_least(queue);
        let apart = vec2i(daa_order(rank)) * i32(samples) - sum;
        let squared = apart.x * apart.x + apart.y * apart.y;
        if squared < least {
            least = squared;
            nearest = rank;
        }
    }
    return nearest;
}

/// The labels of a window's samples: three sets of ranks.
struct DaaLabels {
    bits: array<vec2u, 3>,
}

fn daa_stored_labels(slot: u32) -> DaaLabels {
    var labels: DaaLabels;
    for (var bit = 0u; bit < 3u; bit++) {
        let at = daa_label_index(slot, bit);
        labels.bits[bit].x = daa_surfaces[at];
        if DAA_M > 5u {
            labels.bits[bit].y = daa_surfaces[at + daa_tile_count() * 64u];
        }
    }
    return labels;
}

/// The ranks of a surface.
fn daa_label_ranks(labels: DaaLabels, label: u32) -> vec2u {
    let is_set = (vec3u(label) & vec3u(1u, 2u, 4u)) != vec3u(0u);
    return daa_all_ranks() & select(~labels.bits[0], labels.bits[0], is_set.x) & select(~labels.bits[1], labels.bits[1], is_set.y)
        & select(~labels.bits[2], labels.bits[2], is_set.z);
}

/// The label of the largest surface among some.
fn daa_largest_surface(labels: DaaLabels, among: u32) -> u32 {
    var most = 0u;
    var largest = 0u;
    for (var queue = among; queue != 0u; queue &= queue - 1u) {
        let label = firstTrailingBit(queue);
        let samples = daa_rank_count(daa_label_ranks(labels, label));
        largest = select(largest, label, samples > most);
        most = max(most, samples);
    }
    return largest;
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

/// What was read of a surface at a set of taps: the sums, one of the taps that show a surface, and the ranks.
struct DaaRead {
    g: DaaGathered,
    s: DaaSample,
    ranks: vec2u,
}

/// Reads a tap, and adds it to those read. `keeps`: the lane keeps its spread.
fn daa_read_tap(before: DaaRead, pixel: vec2u, rank: u32, footprint: f32, offset: vec2f, keeps: bool, lane: u32, tap: u32) -> DaaRead {
    var read = before;
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
    if keeps {
        daa_keep_spread(lane, tap, spread);
    }
    return read;
}

/// Reads some taps of a surface. `keeps`: the lane keeps their spreads.
fn daa_read_taps(pixel: vec2u, surface: DaaTapped, chosen: u32, keeps: bool, lane: u32) -> DaaRead {
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
        read = daa_read_tap(read, pixel, rank, footprint, offset, keeps, lane, tap);
    }
    return read;
}

/// The number of taps of a window of one surface.
fn daa_most_taps() -> u32 {
    return select(1u, min(daa_frame.surfaces.taps, DAA_M * DAA_M), DAA_SPLIT_HOOK);
}

/// What was read of a window of one surface, and the number of taps for it.
struct DaaWhole {
    read: DaaRead,
    taps: u32,
    /// Whether the taps are too far apart to share a light.
    apart: bool,
    /// Whether there are too few.
    coarse: bool,
}

/// Reads a window of one surface at `first` taps, and at all if those are too few and `goes_on` says so.
fn daa_read_whole(pixel: vec2u, first: u32, goes_on: bool) -> DaaWhole {
    let n = DAA_M * DAA_M;
    let all = daa_most_taps();
    var taps = min(first, all);
    var whole: DaaWhole;
    loop {
        var offset = vec2f(0.0);
        if DAA_SPLIT_HOOK {
            let pair = daa_frame.centres[(taps - 1u) >> 1u];
            offset = select(pair.xy, pair.zw, (taps & 1u) == 0u);
        }
        let footprint = daa_tap_footprint(n, taps);
        whole.read = DaaRead();
        for (var tap = 0u; tap < taps; tap++) {
            var rank = tap;
            if !DAA_SPLIT_HOOK {
                rank = daa_central(daa_all_ranks(), n);
            }
            whole.read = daa_read_tap(whole.read, pixel, rank, footprint, offset, false, 0u, 0u);
        }
        whole.taps += taps;
        let g = whole.read.g;
        if !DAA_SPLIT_HOOK || g.taps == 0.0 {
            break;
        }
        let deviations = daa_deviations(g) / g.taps;
        let spreads = daa_light_deviation(deviations) > daa_frame.surfaces.spread;
        let mixed = daa_mixed_shadow(pixel, daa_all_ranks());
        whole.apart = (spreads || mixed) && daa_frame.surfaces.most_groups > 1u;
        whole.coarse = taps < all && (mixed || daa_coarse(deviations, taps));
        if whole.apart || !whole.coarse || !goes_on {
            break;
        }
        taps = all;
    }
    return whole;
}

/// Whether all taps of a surface are too far apart to share a light.
fn daa_apart(g: DaaGathered, share: f32) -> bool {
    if !DAA_SPLIT_HOOK || g.taps == 0.0 || daa_frame.surfaces.most_groups < 2u {
        return false;
    }
    return daa_light_deviation(daa_deviations(g) * share) > daa_frame.surfaces.spread || g.any_shadow != g.all_shadow;
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
