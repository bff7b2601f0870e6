// probe: looks for shadows that first samples miss. Near a change of shadow, three more samples of a window cast shadow
// rays; if their bits differ from the first one's, an edge of a shadow crosses the window. CPU twin:
// src/reference/rays/probe.rs.

@group(3) @binding(5) var<storage, read_write> daa_shadows: array<u32>;
/// 1 for each window that an edge of a shadow crosses, in the place of the plan, which is not made yet.
@group(3) @binding(9) var<storage, read_write> daa_probed: array<u32>;

/// No lattice casts rays here.
fn daa_wants(point: DaaPoint) -> bool {
    return false;
}

fn daa_begin(index: u32) {}

/// Whether first samples within `shadow_reach` have other shadow bits.
fn daa_near_change(pixel: vec2u) -> bool {
    let bits = daa_shadows[daa_sample_index(pixel, 0u)];
    let last = vec2i(daa_frame.size) - 1;
    let reach = i32(daa_frame.surfaces.shadow_reach);
    for (var y = -reach; y <= reach; y++) {
        for (var x = -reach; x <= reach; x++) {
            let at = vec2u(clamp(vec2i(pixel) + vec2i(x, y), vec2i(0), last));
            if daa_shadows[daa_sample_index(at, 0u)] != bits {
                return true;
            }
        }
    }
    return false;
}

@compute @workgroup_size(64)
fn daa_probe_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile = daa_listed_tile(group.xy, DAA_TILES_SURFACE);
    let pixel = daa_tile_pixel(tile, lane);
    var rays = 0u;
    if tile.x != DAA_NO_TILE && all(pixel < daa_frame.size) {
        let is_surface = daa_depth_at(pixel * DAA_M + daa_order(0u)) > DAA_SKY_DEPTH;
        let place = daa_sample_index(pixel, 0u);
        let bits = daa_shadows[place];
        var differs = false;
        if is_surface && daa_near_change(pixel) {
            for (var rank = 1u; rank < min(DAA_M * DAA_M, 4u) && !differs; rank++) {
                let s = daa_fetch(pixel, rank, 1.0, vec2f(0.0));
                if s.depth != 0.0 {
                    let found = daa_shadows_at(s.relative_position, s.normal, s.geometric_normal, s.object);
                    differs = found.x != bits;
                    rays += found.y;
                }
            }
            if daa_casting.keeps != 0u {
                daa_shadows[daa_frame.results.words + place] += rays;
            }
        }
        daa_probed[daa_slot(pixel)] = u32(differs);
    }
    daa_count_shadow_rays(lane, rays);
}
