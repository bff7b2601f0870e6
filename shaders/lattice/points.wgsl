// points: shades the chosen points of a lattice.

@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

fn daa_wants(point: DaaPoint) -> bool {
    return true;
}

fn daa_begin(index: u32) {}

@compute @workgroup_size(8, 8)
fn daa_points_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let l = daa_step.points;
    let total = daa_choose_points(daa_step, group.xy, lane);
    for (var i = lane; i < total; i += 64u) {
        let at = daa_chosen_at(group.xy, i);
        let point = daa_point(l, at);
        daa_lattice_colors[daa_point_index(l, at)] = daa_shade_sample(point.pixel, point.rank, 1u);
    }
    if lane == 0u && total != 0u {
        atomicAdd(&daa_statistics.points[l.place], total);
    }
}
