// reconstruct: gives every geometric sample the filtered colour of the shaded samples on its surface around it. The
// bilateral filter is that of subpixel reconstruction (Chajdas, McGuire, Luebke 2011, "Subpixel Reconstruction
// Antialiasing for Deferred Shading") as extended to ray tracing, where shadows gate the weights (WSCG 2012, section
// 3). A sample with no similar neighbour is shaded. CPU twin: src/reference/reconstruct.rs.

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var<storage, read_write> daa_plan: array<u32>;
@group(3) @binding(2) var daa_color: texture_storage_2d<rgba32float, write>;
@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

/// The shaded samples of the tile's windows and of the windows around it, 10 × 10.
var<workgroup> daa_near: array<DaaGeometry, 100>;
/// Their colours; in each round, the colours of the samples that it shades.
var<workgroup> daa_colors: array<vec4f, 100>;
/// The number of samples that the tile shades.
var<workgroup> daa_queued: atomic<u32>;
var<workgroup> daa_total: u32;
/// The samples that a round shades, one for each lane: window (6 bits) | rank (6 bits) | k (8 bits).
var<workgroup> daa_round: array<u32, 64>;

/// The weighted sum of the shaded samples of 3 × 3 windows around a geometric sample.
struct DaaReconstructed {
    sum: vec4f,
    weight: f32,
}

fn daa_reconstruct_sample(pixel: vec2u, i: DaaGeometry) -> DaaReconstructed {
    var r = DaaReconstructed(vec4f(0.0), 0.0);
    let last = vec2i(daa_frame.size) - 1;
    let local = vec2i(pixel & vec2u(7u));
    // The bound is not a constant, so that compilers do not unroll the loop: nine copies take drivers seconds to
    // compile and run no faster.
    let end = min(9, last.x + 9);
    for (var place = 0; place < end; place++) {
        let step = vec2i(place % 3, place / 3);
        let at = vec2i(pixel) + step - 1;
        if any(at < vec2i(0)) || any(at > last) {
            continue;
        }
        let near = (local.y + step.y) * 10 + local.x + step.x;
        let w = daa_reconstruct_weight(i, daa_near[near]);
        r.sum += daa_colors[near] * w;
        r.weight += w;
    }
    return r;
}

/// The number of samples of its own surface that a window shades. It follows from the greatest range of a channel over
/// the four direct neighbours' shaded samples that are similar to its own, since other contrast is due to geometry.
fn daa_contrast_samples(pixel: vec2u, own: DaaGeometry, own_color: vec4f) -> u32 {
    if !daa_flag(DAA_FLAG_OWN_FIRST) || daa_frame.reconstruct.contrast_scale == 0.0 || own.depth == 0.0 {
        return 1u;
    }
    var least = daa_displayed(own_color.rgb);
    var most = least;
    let last = vec2i(daa_frame.size) - 1;
    let end = min(4, last.x + 4);
    for (var i = 0; i < end; i++) {
        let step = select(vec2i(i - 2, 0), vec2i(0, i - 1), (i & 1) == 0);
        let at = clamp(vec2i(pixel) + step, vec2i(0), last);
        let beside = at - vec2i(pixel) + vec2i(pixel & vec2u(7u)) + 1;
        let near = beside.y * 10 + beside.x;
        if daa_reconstruct_weight(own, daa_near[near]) >= 0.5 {
            let c = daa_displayed(daa_colors[near].rgb);
            least = min(least, c);
            most = max(most, c);
        }
    }
    let range = daa_greatest_channel(most - least);
    let contrast = select(range, 0.0, range < daa_frame.reconstruct.contrast_min);
    return u32(clamp(round(daa_frame.reconstruct.contrast_scale * contrast), 1.0, f32(daa_frame.reconstruct.samples)));
}

/// The radiance that a geometric sample reflects and refracts, unless the shaded colours include it. It was traced for
/// this sample and is not filtered.
fn daa_reflection_of(pixel: vec2u, rank: u32) -> vec4f {
    if !daa_flag(DAA_FLAG_REFLECTIONS_APART) {
        return vec4f(0.0);
    }
    return vec4f(daa_radiance_decode(daa_reflection_code(pixel, rank)), 0.0);
}

@compute @workgroup_size(64)
fn daa_reconstruct_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let last = vec2i(daa_frame.size) - 1;
    for (var i = i32(lane); i < 100; i += 64) {
        let at = clamp(vec2i(tile.xy) * 8 + vec2i(i % 10, i / 10) - 1, vec2i(0), last);
        daa_near[i] = daa_geometry(vec2u(at), 0u);
        daa_colors[i] = textureLoad(daa_first, at, 0);
    }
    // With the host's code, workgroup memory is not initialised to 0.
    atomicStore(&daa_group_histogram[lane], 0u);
    if lane == 0u {
        atomicStore(&daa_queued, 0u);
    }
    workgroupBarrier();

    let pixel = daa_tile_pixel(tile.xy, lane);
    let inside = daa_is_shown(pixel);
    let n = DAA_M * DAA_M;
    let own_first = daa_flag(DAA_FLAG_OWN_FIRST);
    let own_place = (lane / 8u + 1u) * 10u + lane % 8u + 1u;
    let own_color = daa_colors[own_place];
    // Of the first k ranks, those on the window's own surface are shaded.
    var k = 1u;
    var shaded = vec2u(0u);
    var on_own = vec2u(0u);
    var reflections_on_own = vec4f(0.0);
    var others = DaaMean();
    if inside {
        let own = daa_near[own_place];
        k = daa_contrast_samples(pixel, own, own_color);
        for (var rank = 0u; rank < daa_frame.reconstruct.samples; rank++) {
            let i = daa_geometry(pixel, rank);
            let reflected = daa_reflection_of(pixel, rank);
            // The window's own shaded sample is as near as any other, and its texture footprint covers this window.
            if own_first && daa_reconstruct_weight(i, own) >= 0.5 {
                on_own = daa_with(on_own, rank);
                reflections_on_own += reflected;
                if rank > 0u && rank < k {
                    shaded = daa_with(shaded, rank);
                }
                continue;
            }
            let around = daa_reconstruct_sample(pixel, i);
            if around.weight >= daa_frame.reconstruct.least_weight {
                others = daa_weighted(others, around.sum / around.weight + reflected);
            } else if rank == 0u {
                others = daa_weighted(others, own_color + reflected);
            } else {
                shaded = daa_with(shaded, rank);
            }
        }
    }

    // The tile's samples are shaded end to end, 64 in a round, so that no lane waits for another. Their order is that
    // in which lanes come here; it does not matter, since each lane adds up its own samples by rank.
    let count = countOneBits(shaded.x) + countOneBits(shaded.y);
    var next = 0u;
    if count > 0u {
        next = atomicAdd(&daa_queued, count);
    }
    if inside {
        atomicAdd(&daa_group_histogram[count], 1u);
    }
    workgroupBarrier();
    daa_add_histogram(lane);
    if lane == 0u {
        daa_total = atomicLoad(&daa_queued);
    }
    let total = workgroupUniformLoad(&daa_total);
    var own_mean = daa_weighted(DaaMean(), own_color);
    for (var done = 0u; done < total; done += 64u) {
        var queued = shaded;
        for (var at = next; at < done + 64u && any(queued != vec2u(0u)); at++) {
            let rank = daa_least(queued);
            daa_round[at - done] = lane | (rank << 6u) | (select(n, k, daa_has(on_own, rank)) << 12u);
            queued = daa_without_least(queued);
        }
        workgroupBarrier();
        if done + lane < total {
            let entry = daa_round[lane];
            let window = tile.xy * 8u + vec2u(entry & 7u, (entry >> 3u) & 7u);
            daa_colors[lane] = daa_shade_sample(window, (entry >> 6u) & 63u, entry >> 12u);
        }
        workgroupBarrier();
        for (; next < done + 64u && any(shaded != vec2u(0u)); next++) {
            let rank = daa_least(shaded);
            let c = daa_colors[next - done];
            if daa_has(on_own, rank) {
                own_mean = daa_weighted(own_mean, c);
            } else {
                others = daa_weighted(others, c + daa_reflection_of(pixel, rank));
            }
            shaded = daa_without_least(shaded);
        }
    }
    if !inside {
        return;
    }
    let of_own = f32(countOneBits(on_own.x) + countOneBits(on_own.y));
    let all_own = daa_weighted(DaaMean(), daa_mean_finish(own_mean) + reflections_on_own / max(of_own, 1.0));
    let mean = DaaMean(others.sum + all_own.sum * of_own, others.weight + all_own.weight * of_own);
    textureStore(daa_color, pixel, daa_mean_finish(mean));
    daa_plan[daa_tile_index(tile.xy) * 64u + lane] = daa_plan_word(count + 1u, DAA_BY_NOTHING, 0u, 0u);
}
