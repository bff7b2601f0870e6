// trace: traces shadow rays from the samples that will be shaded. CPU twin: src/reference/rays/trace.rs.

/// The shadow bits of samples, at `daa_result_index`. If the rays of each sample are recorded, their numbers follow in
/// the same layout.
@group(3) @binding(5) var<storage, read_write> daa_shadows: array<u32>;

/// All points are written, those of the sky, too.
fn daa_wants(point: DaaPoint) -> bool {
    return true;
}

/// All points are written, so none needs an initial value.
fn daa_begin(index: u32) {}

/// Whether the shadow bits of a window's samples may differ: the window has two surfaces, or the first samples of the
/// windows around it differ in shadow or identity.
fn daa_worth_tracing(pixel: vec2u) -> bool {
    let identity = daa_identity_at(pixel * DAA_M + daa_order(0u));
    for (var rank = 1u; rank < daa_frame.reconstruct.samples; rank++) {
        if daa_identity_at(pixel * DAA_M + daa_order(rank)) != identity {
            return true;
        }
    }
    let bits = daa_shadows[daa_sample_index(pixel, 0u)];
    let last = vec2i(daa_frame.size) - 1;
    for (var i = 0; i < 9; i++) {
        let at = vec2u(clamp(vec2i(pixel) + vec2i(i % 3, i / 3) - 1, vec2i(0), last));
        let other = daa_identity_at(at * DAA_M + daa_order(0u));
        if daa_shadows[daa_sample_index(at, 0u)] != bits || other != identity {
            return true;
        }
    }
    return false;
}

/// Whether a planned sample casts rays only since `Surfaces` found that what is reflected there differs. No edge of a shadow
/// is near.
fn daa_reflects_alone(pixel: vec2u) -> bool {
    return daa_casting.samples == DAA_SAMPLES_PLANNED && daa_flag(DAA_FLAG_SURFACES)
        && daa_plan_by(daa_plan[daa_slot(pixel)]) == DAA_BY_LUMINANCE;
}

@compute @workgroup_size(64)
fn daa_trace_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let ranks = daa_ranks(group.xy, lane, DAA_TILES_SURFACE);
    // Otherwise the samples take the bits of the window's first one, which is traced.
    var traces = true;
    if daa_casting.samples == DAA_SAMPLES_GEOMETRIC && !daa_flag(DAA_FLAG_TRACE_ALL) && ranks.end > 0u {
        traces = daa_worth_tracing(ranks.pixel);
    }
    var rays = 0u;
    for (var i = ranks.first; i < ranks.end; i += ranks.step) {
        let caster = daa_caster(ranks, i);
        if !caster.wanted {
            continue;
        }
        var bits = vec2u(0u);
        if traces && !daa_reflects_alone(caster.pixel) {
            let s = daa_fetch(caster.pixel, caster.rank, 1.0, vec2f(0.0));
            if s.depth != 0.0 {
                bits = daa_shadows_at(s.relative_position, s.normal, s.geometric_normal, s.object);
            }
        } else {
            bits.x = daa_shadows[daa_sample_index(caster.pixel, 0u)];
        }
        if caster.inside {
            let place = daa_result_index(caster.pixel, caster.rank);
            daa_shadows[place] = bits.x;
            if daa_casting.keeps != 0u {
                // A sample may cast rays twice, as the point of a lattice and by the plan, so its rays are added up.
                daa_shadows[daa_frame.results.words + place] += bits.y;
            }
        }
        if daa_casting.samples == DAA_SAMPLES_POINTS {
            daa_points[caster.found].x = bits.x;
        }
        rays += bits.y;
    }
    daa_count_shadow_rays(lane, rays);
}
