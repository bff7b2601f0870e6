// light: reads the material of each surface at several taps, gathers the taps that would be lit alike into groups, and
// lights each group once. CPU twin: src/reference/surfaces/light.rs.
//
// Windows of one surface are read at their first taps, those at the corners of blocks before those between. Whoever is not
// lit with that is listed for a stage of its own kind, so that the lanes of a workgroup have like work: one surface that
// wants more taps, one that is cut into groups, several surfaces.

@group(3) @binding(0) var<storage, read_write> daa_surfaces: array<u32>;
@group(3) @binding(1) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;
@group(3) @binding(4) var<storage, read_write> daa_list_out: DaaWindowList;
@group(3) @binding(5) var<storage, read> daa_list: array<u32>;
@group(3) @binding(6) var<storage, read_write> daa_cut_list_out: DaaWindowList;
@group(3) @binding(7) var<storage, read> daa_cut_list: array<u32>;

/// The arguments of an indirect dispatch, and the number of windows that it is for.
struct DaaListHead {
    groups_x: u32,
    groups_y: atomic<u32>,
    groups_z: u32,
    count: atomic<u32>,
}

/// Windows that are left: those of one surface from the front, those of several from the back. The list of those that
/// are cut has no others.
struct DaaWindowList {
    one: DaaListHead,
    several: DaaListHead,
    slots: array<u32>,
}

/// The positions of the two counts and of the slots, in words.
const DAA_LIST_ONE_COUNT: u32 = 3u;
const DAA_LIST_SEVERAL_COUNT: u32 = 7u;
const DAA_LIST_SLOTS: u32 = 8u;
/// The number of workgroups in a row of the dispatch.
const DAA_LIST_ROW: u32 = 16u;
const DAA_LIST_LANES: u32 = 32u;

/// The rows of a dispatch for so many windows.
fn daa_list_rows(windows: u32) -> u32 {
    let row = DAA_LIST_ROW * DAA_LIST_LANES;
    return (windows + row - 1u) / row;
}

/// The window of a lane in that order.
fn daa_list_index(group: vec3u, lane: u32) -> u32 {
    return (group.y * DAA_LIST_ROW + group.x) * DAA_LIST_LANES + lane;
}

/// The colour of taps that share a light, and that light. `good`: it is finite and not negative.
struct DaaLit {
    color: vec4f,
    light: DaaLight,
    good: bool,
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

/// Lights a window of one surface with what was read of it.
fn daa_light_whole(pixel: vec2u, slot: u32, read: DaaRead, taps: u32) -> DaaLit {
    let lit = daa_light(read.g, read.s, daa_all_ranks(), 1.0);
    textureStore(daa_color, pixel, daa_mean_finish(daa_covered(DaaMean(), lit.color, 1.0)));
    daa_surfaces[slot] = daa_surface_word_lit(daa_surfaces[slot], 1u, taps, 0u);
    return lit;
}

/// Lights it by the corners of its block, if those will do.
fn daa_lit_between(pixel: vec2u, slot: u32, read: DaaRead, taps: u32) -> bool {
    let between = daa_between(pixel, read.g, read.s);
    if between.fits {
        textureStore(daa_color, pixel, between.color);
        daa_surfaces[slot] = daa_surface_word_lit(daa_surfaces[slot], 0u, taps, 1u);
    }
    return between.fits;
}

/// Whether a pixel lies in a tile of the image.
fn daa_is_in_tile(pixel: vec2u) -> bool {
    return all(pixel / 8u < (daa_frame.size + 7u) / 8u);
}

/// Lights the windows of one surface at the corners of blocks, if their taps are alike. The others are left to the list.
/// A lane has a corner, and the workgroup those of 16 × 16 windows.
@compute @workgroup_size(8, 8)
fn daa_light_corners(@builtin(global_invocation_id) corner: vec3u) {
    let pixel = corner.xy / 2u * 4u + (corner.xy & vec2u(1u)) * 3u;
    if !daa_is_in_tile(pixel) {
        return;
    }
    let slot = daa_slot(pixel);
    let word = daa_surfaces[slot];
    var known: DaaCorner;
    if daa_surface_count(word) == 1u {
        let whole = daa_read_whole(pixel, daa_frame.surfaces.first_taps, daa_has_blocks());
        if !whole.apart && !whole.coarse {
            known = daa_as_corner(whole.read.g, whole.read.s);
            let lit = daa_light_whole(pixel, slot, whole.read, whole.taps);
            known.light = lit.light;
            known.lends = known.lends && lit.good;
        } else {
            daa_surfaces[slot] = daa_surface_word_read(word, whole.taps, whole.apart);
        }
    }
    if daa_has_blocks() {
        daa_store_corner(pixel, (corner.x & 1u) + 2u * (corner.y & 1u), known);
    }
}

/// Lights the windows of one surface between the corners, likewise, but reads their first taps alone. Each of 16 blocks
/// has twelve lanes.
@compute @workgroup_size(192)
fn daa_light_between(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let block = lane / 12u;
    let between = lane % 12u;
    let place = between + 1u + u32(between >= 2u) + u32(between >= 10u);
    let pixel = group.xy * 16u + vec2u(block & 3u, block >> 2u) * 4u + vec2u(place & 3u, place >> 2u);
    if !daa_is_in_tile(pixel) {
        return;
    }
    let slot = daa_slot(pixel);
    let word = daa_surfaces[slot];
    if daa_surface_count(word) != 1u {
        return;
    }
    let whole = daa_read_whole(pixel, daa_frame.surfaces.first_taps, false);
    if whole.apart || whole.coarse {
        daa_surfaces[slot] = daa_surface_word_read(word, whole.taps, whole.apart);
    } else if !daa_lit_between(pixel, slot, whole.read, whole.taps) {
        _ = daa_light_whole(pixel, slot, whole.read, whole.taps);
    }
}

/// 1 for the list that a window belongs to: one surface, several, one that is cut. 0 if it is lit.
fn daa_kind(word: u32) -> vec3u {
    if daa_surface_is_lit(word) {
        return vec3u(0u);
    }
    if daa_surface_count(word) > 1u {
        return vec3u(0u, 1u, 0u);
    }
    return select(vec3u(1u, 0u, 0u), vec3u(0u, 0u, 1u), daa_surface_is_apart(word));
}

/// Lists the windows that are left. A lane lists a whole tile.
@compute @workgroup_size(64)
fn daa_light_list(@builtin(global_invocation_id) id: vec3u) {
    if id.x == 0u {
        daa_list_out.one.groups_x = DAA_LIST_ROW;
        daa_list_out.one.groups_z = 1u;
        daa_list_out.several.groups_x = DAA_LIST_ROW;
        daa_list_out.several.groups_z = 1u;
        daa_cut_list_out.one.groups_x = DAA_LIST_ROW;
        daa_cut_list_out.one.groups_z = 1u;
    }
    if id.x >= daa_tile_count() {
        return;
    }
    let first_slot = id.x * 64u;
    // The numbers of windows of one surface, of several, and of one that is cut.
    var left = vec3u(0u);
    for (var i = 0u; i < 64u; i++) {
        left += daa_kind(daa_surfaces[first_slot + i]);
    }
    // The order of the list differs from run to run, which changes nothing: each window is lit on its own.
    var at = vec3u(0u);
    if left.x > 0u {
        at.x = atomicAdd(&daa_list_out.one.count, left.x);
        atomicMax(&daa_list_out.one.groups_y, daa_list_rows(at.x + left.x));
    }
    if left.y > 0u {
        at.y = atomicAdd(&daa_list_out.several.count, left.y);
        atomicMax(&daa_list_out.several.groups_y, daa_list_rows(at.y + left.y));
    }
    if left.z > 0u {
        at.z = atomicAdd(&daa_cut_list_out.one.count, left.z);
        atomicMax(&daa_cut_list_out.one.groups_y, daa_list_rows(at.z + left.z));
    }
    let last = daa_tile_count() * 64u - 1u;
    for (var i = 0u; i < 64u && any(left > vec3u(0u)); i++) {
        let kind = daa_kind(daa_surfaces[first_slot + i]);
        if kind.z > 0u {
            daa_cut_list_out.slots[at.z] = first_slot + i;
        } else if any(kind > vec3u(0u)) {
            daa_list_out.slots[select(at.x, last - at.y, kind.y > 0u)] = first_slot + i;
        }
        at += kind;
        left -= kind;
    }
}

/// Lights the windows of one surface whose first taps were too few. Those that are cut are listed: else the lanes beside
/// would wait for their groups.
@compute @workgroup_size(32)
fn daa_light_one(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = daa_list_index(group, lane);
    if index >= daa_list[DAA_LIST_ONE_COUNT] {
        return;
    }
    let slot = daa_list[DAA_LIST_SLOTS + index];
    let pixel = daa_slot_pixel(slot);
    let whole = daa_read_whole(pixel, daa_most_taps(), false);
    let word = daa_surfaces[slot];
    let taps = daa_surface_taps(word) + whole.taps;
    if whole.apart {
        daa_surfaces[slot] = daa_surface_word_read(word, taps, true);
        let at = atomicAdd(&daa_cut_list_out.one.count, 1u);
        atomicMax(&daa_cut_list_out.one.groups_y, daa_list_rows(at + 1u));
        daa_cut_list_out.slots[at] = slot;
    } else if !daa_lit_between(pixel, slot, whole.read, taps) {
        _ = daa_light_whole(pixel, slot, whole.read, taps);
    }
}

const DAA_NO_SLOT: u32 = 0xffffffffu;

/// The window that is cut by a lane.
fn daa_cut_slot(group: vec3u, lane: u32) -> u32 {
    let index = daa_list_index(group, lane);
    if index >= daa_cut_list[DAA_LIST_ONE_COUNT] {
        return DAA_NO_SLOT;
    }
    return daa_cut_list[DAA_LIST_SLOTS + index];
}

/// Finds the groups of windows of one surface.
@compute @workgroup_size(32)
fn daa_light_group(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = daa_cut_slot(group, lane);
    if slot == DAA_NO_SLOT {
        return;
    }
    let pixel = daa_slot_pixel(slot);
    let surface = daa_tapped(daa_all_ranks());
    _ = daa_read_taps(pixel, surface, daa_all_taps(surface), true, lane);
    daa_store_groups(slot, daa_grouped(lane, surface, pixel));
}

/// Lights the windows of one surface that is cut into groups.
@compute @workgroup_size(32)
fn daa_light_cut(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = daa_cut_slot(group, lane);
    if slot == DAA_NO_SLOT {
        return;
    }
    let pixel = daa_slot_pixel(slot);
    let surface = daa_tapped(daa_all_ranks());
    let groups = daa_stored_groups(slot, daa_all_taps(surface));
    var mean: DaaMean;
    // The largest first, so that the lanes beside have as much to read.
    for (var left = (1u << groups.count) - 1u; left != 0u; ) {
        let i = daa_largest_group(groups, left);
        left &= ~(1u << i);
        let chosen = daa_group(groups, i);
        let read = daa_read_taps(pixel, surface, chosen, false, lane);
        let coverage = surface.share * f32(countOneBits(chosen));
        mean = daa_covered(mean, daa_light(read.g, read.s, read.ranks, coverage).color, coverage);
    }
    textureStore(daa_color, pixel, daa_mean_finish(mean));
    let word = daa_surfaces[slot];
    // One read to find the groups, and one to light them.
    daa_surfaces[slot] = daa_surface_word_lit(word, groups.count, daa_surface_taps(word) + 2u * surface.taps, 0u);
}

/// Lights the windows of several surfaces.
@compute @workgroup_size(32)
fn daa_light_several(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = daa_list_index(group, lane);
    if index >= daa_list[DAA_LIST_SEVERAL_COUNT] {
        return;
    }
    let slot = daa_list[DAA_LIST_SLOTS + daa_tile_count() * 64u - 1u - index];
    let pixel = daa_slot_pixel(slot);
    let word = daa_surfaces[slot];
    let labels = daa_stored_labels(slot);
    var mean: DaaMean;
    var lights = 0u;
    var interpolated = 0u;
    var taps = 0u;
    // The surfaces that are left, the one at hand, and those of its groups that are left: the largest first. There is
    // one call of each of the host's functions, as compilers copy them into every place.
    var surfaces_left = (1u << daa_surface_count(word)) - 1u;
    var surface: DaaTapped;
    var groups: DaaGroups;
    var groups_left = 0u;
    while (surfaces_left | groups_left) != 0u {
        let is_group = groups_left != 0u;
        var chosen = 0u;
        if is_group {
            let i = daa_largest_group(groups, groups_left);
            groups_left &= ~(1u << i);
            chosen = daa_group(groups, i);
        } else {
            let label = daa_largest_surface(labels, surfaces_left);
            surfaces_left &= ~(1u << label);
            surface = daa_tapped(daa_label_ranks(labels, label));
            chosen = daa_all_taps(surface);
        }
        let read = daa_read_taps(pixel, surface, chosen, !is_group, lane);
        taps += countOneBits(chosen);
        let coverage = surface.share * f32(countOneBits(chosen));
        var ranks = read.ranks;
        if !is_group {
            ranks = surface.ranks;
            if daa_apart(read.g, surface.share) {
                groups = daa_grouped(lane, surface, pixel);
                groups_left = (1u << groups.count) - 1u;
                continue;
            }
            let between = daa_between(pixel, read.g, read.s);
            if between.fits {
                mean = daa_covered(mean, between.color, coverage);
                interpolated += 1u;
                continue;
            }
        }
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
