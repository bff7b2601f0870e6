// select: chooses the quadrants of each pixel of which four samples are shaded, by the differences between the first
// samples of the pixels that meet at its corners (Jin, Ihm, Chang, Park, Lee, Jung 2009, "Selective and Adaptive
// Supersampling for Real-Time Ray Tracing", sections 4.1.3 and 4.2, ActSubPixDetector). CPU twin:
// src/reference/selective.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read_write> daa_plan: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_statistics: DaaStatistics;
/// A bit for each material that has a texture, then a byte for each object: its importance in 255ths.
@group(3) @binding(3) var<storage, read> daa_marks: array<u32>;

/// The index in `daa_marks` of the first object's word.
const DAA_IMPORTANCE_AT: u32 = 2048u;

/// A threshold that is off: greater than all others, and than any contrast in every channel.
const DAA_OFF: f32 = 2.0;

/// The attribute of a threshold, `Attribute` of src/host/plan.rs.
const DAA_COLOR: u32 = 0u;

/// The object id of the sky, and of a ray that hits nothing.
const DAA_NO_OBJECT: u32 = 0xffffffffu;

/// The values by which a pixel is compared: its colour reference, and for the surface that it shows, reflects and
/// refracts the normal, the object, the shadow, and whether it has a texture.
struct DaaSeen {
    color: vec3f,
    hits: array<vec4u, DAA_KINDS>,
}

/// The pixels of the tile and those around it, 10 × 10.
var<workgroup> daa_near: array<DaaSeen, 100>;
/// The luminances of these pixels and of those around them, 12 × 12.
var<workgroup> daa_luminances: array<f32, 144>;
var<workgroup> daa_group_quadrants: array<atomic<u32>, 9>;

fn daa_shadow_of(bits: u32) -> u32 {
    return select(countOneBits(bits), bits, daa_flag(DAA_FLAG_SHADOW_LIGHTS));
}

fn daa_hit(object: u32, material: u32, normal: u32, bits: u32) -> vec4u {
    let textured = (daa_marks[material >> 5u] >> (material & 31u)) & 1u;
    return vec4u(normal, object, daa_shadow_of(bits), textured);
}

/// The surface that the first sample of a pixel shows (kind 0), reflects (1) or refracts (2).
fn daa_seen(pixel: vec2u, kind: u32) -> vec4u {
    let nothing = vec4u(0u, DAA_NO_OBJECT, 0u, 0u);
    if kind > 0u {
        let hit = daa_reflection_hit(pixel, kind - 1u);
        if hit.y == 0u {
            return nothing;
        }
        return daa_hit(hit.x & 0xffffu, hit.x >> 16u, hit.y, hit.z);
    }
    let at = pixel * DAA_M + daa_order(0u);
    if daa_depth_at(at) <= DAA_SKY_DEPTH {
        return nothing;
    }
    let surface = daa_surface_at(at);
    return daa_hit(surface.y >> 16u, surface.y & 0xffffu, surface.x, daa_shadow_bits(pixel, 0u));
}

/// 1 for each of object, normal and shadow in which a differs from b.
fn daa_disagreeing(a: vec4u, b: vec4u) -> vec4f {
    var bent = a.x != b.x;
    if bent && a.y != DAA_NO_OBJECT && b.y != DAA_NO_OBJECT {
        let na = daa_octahedral_decode(unpack2x16snorm(a.x));
        bent = dot(na, daa_octahedral_decode(unpack2x16snorm(b.x))) < daa_frame.selective.normal_cosine;
    }
    return vec4f(f32(a.y != b.y), f32(bent), f32(a.z != b.z), 0.0);
}

/// The importance of an object's attributes, 0 to 1.
fn daa_importance(object: u32) -> f32 {
    if object == DAA_NO_OBJECT {
        return 0.0;
    }
    return f32((daa_marks[DAA_IMPORTANCE_AT + (object >> 2u)] >> (8u * (object & 3u))) & 0xffu) / 255.0;
}

/// The importance of each attribute that disagrees, for the surface that is shown and for those that are reflected or
/// refracted.
struct DaaDisagreement {
    shown: vec4f,
    beyond: vec4f,
}

/// A quadrant's pixel and the three others at its corner: the range of their colours and their disagreement.
struct DaaCorner {
    most: vec3f,
    least: vec3f,
    disagreement: DaaDisagreement,
}

/// Adds a pixel to the corner if it lies there.
fn daa_joins(corner: DaaCorner, color: vec3f, disagreement: DaaDisagreement, joins: bool) -> DaaCorner {
    return DaaCorner(
        select(corner.most, max(corner.most, color), joins),
        select(corner.least, min(corner.least, color), joins),
        DaaDisagreement(
            select(corner.disagreement.shown, max(corner.disagreement.shown, disagreement.shown), joins),
            select(corner.disagreement.beyond, max(corner.disagreement.beyond, disagreement.beyond), joins),
        ),
    );
}

/// The number of surfaces that are compared for a pixel: 1, or 3 with those that it reflects and refracts. The bound is
/// not a constant, so that compilers do not unroll the loops.
fn daa_kinds() -> u32 {
    return min(DAA_KINDS, daa_frame.size.x + 2u);
}

fn daa_disagreement(own: u32, place: u32) -> DaaDisagreement {
    var found = DaaDisagreement();
    for (var kind = 0u; kind < daa_kinds(); kind++) {
        let a = daa_near[own].hits[kind];
        let b = daa_near[place].hits[kind];
        var differs = daa_disagreeing(a, b);
        if daa_flag(DAA_FLAG_FOCUSED) {
            let of_own = max(daa_importance(daa_near[own].hits[0].y), daa_importance(a.y));
            differs *= max(of_own, max(daa_importance(daa_near[place].hits[0].y), daa_importance(b.y)));
        }
        found.shown = select(found.shown, differs, kind == 0u);
        found.beyond = select(max(found.beyond, differs), found.beyond, kind == 0u);
    }
    return found;
}

/// A texture counts wherever the pixel itself has one, whatever its neighbours have.
fn daa_textures(own: u32) -> DaaDisagreement {
    var found = DaaDisagreement();
    for (var kind = 0u; kind < daa_kinds(); kind++) {
        let a = daa_near[own].hits[kind];
        var counts = f32(a.w != 0u);
        if daa_flag(DAA_FLAG_FOCUSED) {
            counts *= max(daa_importance(daa_near[own].hits[0].y), daa_importance(a.y));
        }
        found.shown.w = select(found.shown.w, counts, kind == 0u);
        found.beyond.w = select(max(found.beyond.w, counts), found.beyond.w, kind == 0u);
    }
    return found;
}

/// A quadrant's threshold and its attribute.
struct DaaThreshold {
    tau: f32,
    by: u32,
}

fn daa_least_threshold(least: DaaThreshold, taus: vec4f, importance: vec4f, by: u32) -> DaaThreshold {
    let between = taus * importance + min(daa_frame.selective.color, 1.0) * (1.0 - importance);
    let counts = (importance > vec4f(0.0)) & (taus < vec4f(DAA_OFF));
    let t = select(vec4f(DAA_OFF), between, counts);
    var found = least;
    if t.x < found.tau { found = DaaThreshold(t.x, by); }
    if t.y < found.tau { found = DaaThreshold(t.y, by + 1u); }
    if t.z < found.tau { found = DaaThreshold(t.z, by + 2u); }
    if t.w < found.tau { found = DaaThreshold(t.w, by + 3u); }
    return found;
}

/// The least threshold of the attributes that disagree at the quadrant's corner, otherwise that of colour. With
/// importances, a threshold lies between these two, by the greatest importance of the objects involved.
fn daa_threshold(d: DaaDisagreement) -> DaaThreshold {
    var least = DaaThreshold(DAA_OFF, DAA_COLOR);
    least = daa_least_threshold(least, daa_frame.selective.primary, d.shown, 1u);
    least = daa_least_threshold(least, daa_frame.selective.reflected, d.beyond, 5u);
    if least.tau == DAA_OFF {
        least.tau = daa_frame.selective.color;
    }
    return least;
}

/// Whether the contrast of the colours at the quadrant's corner (Mitchell 1987) is at least the threshold, so that a
/// threshold of 0 makes every quadrant active.
fn daa_contrasts(most: vec3f, least: vec3f, tau: f32) -> bool {
    var apart = most - least;
    // Black has no contrast, and invisibly dark noise has little.
    var contrast = apart / max(most + least, vec3f(1e-6));
    if daa_flag(DAA_FLAG_BY_GRADIENT) {
        apart = most;
        contrast = most;
    }
    contrast = select(contrast, vec3f(0.0), apart < vec3f(daa_frame.selective.contrast_min));
    let by_channel = !daa_flag(DAA_FLAG_BY_GRADIENT | DAA_FLAG_BY_LUMINANCE);
    return any(contrast >= tau * select(vec3f(1.02), vec3f(1.36, 1.02, 2.04), by_channel));
}

/// The quadrants of a pixel that are chosen so far.
struct DaaChosen {
    quadrants: u32,
    /// Attribute of the first one's threshold, counted from 1.
    by: u32,
}

fn daa_choose(chosen: DaaChosen, quadrant: u32, corner: DaaCorner) -> DaaChosen {
    let threshold = daa_threshold(corner.disagreement);
    if !daa_contrasts(corner.most, corner.least, threshold.tau) {
        return chosen;
    }
    atomicAdd(&daa_group_quadrants[threshold.by], 1u);
    return DaaChosen(chosen.quadrants | (1u << quadrant), select(chosen.by, threshold.by + 1u, chosen.quadrants == 0u));
}

/// The length of the luminance gradient at an index of `daa_near`, by the Sobel operator; 1 at a step from 0 to 1.
fn daa_gradient(place: i32) -> f32 {
    let at = (place / 10 + 1) * 12 + place % 10 + 1;
    let falling = daa_luminances[at + 13] - daa_luminances[at - 13];
    let rising = daa_luminances[at - 11] - daa_luminances[at + 11];
    let x = 2.0 * (daa_luminances[at + 1] - daa_luminances[at - 1]) + falling + rising;
    let y = 2.0 * (daa_luminances[at + 12] - daa_luminances[at - 12]) + falling - rising;
    return min(length(vec2f(x, y)) * 0.25, 1.0);
}

@compute @workgroup_size(64)
fn daa_select_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let last = vec2i(daa_frame.size) - 1;
    let by_luminance = daa_flag(DAA_FLAG_BY_GRADIENT | DAA_FLAG_BY_LUMINANCE);
    for (var i = i32(lane); i < 144; i += 64) {
        let at = clamp(vec2i(tile.xy) * 8 + vec2i(i % 12, i / 12) - 2, vec2i(0), last);
        daa_luminances[i] = daa_shown(vec3f(daa_luminance(textureLoad(daa_first, at, 0).rgb))).x;
    }
    workgroupBarrier();
    for (var i = i32(lane); i < 100; i += 64) {
        let at = clamp(vec2i(tile.xy) * 8 + vec2i(i % 10, i / 10) - 1, vec2i(0), last);
        var color = daa_shown(textureLoad(daa_first, at, 0).rgb);
        if by_luminance {
            color = vec3f(daa_luminances[(i / 10 + 1) * 12 + i % 10 + 1]);
        }
        if daa_flag(DAA_FLAG_BY_GRADIENT) {
            color = vec3f(daa_gradient(i));
        }
        daa_near[i].color = color;
        for (var kind = 0u; kind < DAA_KINDS; kind++) {
            daa_near[i].hits[kind] = daa_seen(vec2u(at), kind);
        }
    }
    workgroupBarrier();

    let pixel = daa_tile_pixel(tile.xy, lane);
    var word = 0u;
    if daa_is_shown(pixel) {
        let own = (lane / 8u + 1u) * 10u + lane % 8u + 1u;
        let color = daa_near[own].color;
        var upper_left = DaaCorner(color, color, daa_textures(own));
        var upper_right = upper_left;
        var lower_left = upper_left;
        var lower_right = upper_left;
        // The bound is not a constant, so that compilers do not unroll the loop: eight copies take drivers long to
        // compile and run no faster.
        let end = min(9, last.x + 9);
        for (var i = 0; i < end; i++) {
            let step = vec2i(i % 3, i / 3) - 1;
            if i == 4 {
                continue;
            }
            let place = u32(i32(own) + step.y * 10 + step.x);
            let other = daa_near[place].color;
            let disagreement = daa_disagreement(own, place);
            upper_left = daa_joins(upper_left, other, disagreement, step.x <= 0 && step.y <= 0);
            upper_right = daa_joins(upper_right, other, disagreement, step.x >= 0 && step.y <= 0);
            lower_left = daa_joins(lower_left, other, disagreement, step.x <= 0 && step.y >= 0);
            lower_right = daa_joins(lower_right, other, disagreement, step.x >= 0 && step.y >= 0);
        }
        var found = daa_choose(DaaChosen(0u, 0u), 0u, upper_left);
        found = daa_choose(found, 1u, upper_right);
        found = daa_choose(found, 2u, lower_left);
        found = daa_choose(found, 3u, lower_right);
        let chosen = found.quadrants;
        let k = 1u + daa_rank_count(daa_ranks_of(chosen));
        atomicAdd(&daa_group_histogram[k - 1u], 1u);
        word = daa_plan_word(k, found.by, chosen, 0u);
    }
    let before = daa_tile_sum_before(lane, max(daa_plan_k(word), 1u) - 1u);
    daa_plan[daa_tile_index(tile.xy) * 64u + lane] = daa_plan_word_before(word, before);
    daa_add_histogram(lane);
    if lane < 9u {
        let quadrants = atomicLoad(&daa_group_quadrants[lane]);
        if quadrants > 0u {
            atomicAdd(&daa_statistics.quadrants[lane], quadrants);
        }
    }
}
