// Groups: sets of the taps of a surface that share a light. Uses what light.wgsl binds. CPU twin:
// src/reference/surfaces/light.rs.

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

/// The largest group among some.
fn daa_largest_group(groups: DaaGroups, among: u32) -> u32 {
    var most = 0u;
    var largest = 0u;
    for (var queue = among; queue != 0u; queue &= queue - 1u) {
        let i = firstTrailingBit(queue);
        let taps = countOneBits(daa_group(groups, i));
        largest = select(largest, i, taps > most);
        most = max(most, taps);
    }
    return largest;
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

/// Stores the groups of a window of one surface in the place of labels.
fn daa_store_groups(slot: u32, groups: DaaGroups) {
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
