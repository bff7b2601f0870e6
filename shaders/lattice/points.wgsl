// points: shades the chosen points of a lattice.

@group(3) @binding(3) var<storage, read_write> daa_statistics: DaaStatistics;

var<workgroup> daa_group_points: array<u32, 64>;

fn daa_wants(point: DaaPoint) -> bool {
    return true;
}

fn daa_begin(index: u32) {}

@compute @workgroup_size(8, 8)
fn daa_points_main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    let l = daa_step.points;
    let chosen = daa_chosen_points(daa_step, id.xy);
    let end = countOneBits(chosen);
    for (var i = 0u; i < end; i++) {
        let at = daa_chosen_at(id.xy, chosen, i);
        let point = daa_point(l, at);
        daa_lattice_colors[daa_point_index(l, at)] = daa_shade_sample(point.pixel, point.rank, 1u);
    }
    daa_group_points[lane] = end;
    workgroupBarrier();
    if lane == 0u {
        var sum = 0u;
        for (var i = 0u; i < 64u; i++) {
            sum += daa_group_points[i];
        }
        if sum != 0u {
            atomicAdd(&daa_statistics.points[l.place], sum);
        }
    }
}
