// audit of `Surfaces`: measures the error of the finished image in some tiles by shading all of their samples. It does not
// change the image. CPU twin: src/reference/audit.rs.

@group(3) @binding(0) var daa_color: texture_2d<f32>;
/// Counters of the audit's own: audited samples are not counted among the frame's.
@group(3) @binding(1) var<storage, read_write> daa_statistics: DaaStatistics;
/// The squared displayed error of each audited tile, summed over its pixels: at the frame's effort, and expected a step
/// below it. -1 for a tile beyond the end of its row.
@group(3) @binding(2) var<storage, read_write> daa_audits: array<vec2f>;
@group(3) @binding(3) var<storage, read> daa_plan: array<u32>;

/// A workgroup audits one tile of each period of its row.
@compute @workgroup_size(64)
fn daa_audit_surfaces(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = daa_tile_pixel(daa_tile_of_image(daa_audited_tile(group.xy)), lane);
    var error = 0.0;
    if daa_is_shown(pixel) {
        var mean = DaaMean();
        for (var rank = 0u; rank < DAA_M * DAA_M; rank++) {
            mean = daa_weighted(mean, daa_shade_sample(pixel, rank, DAA_M * DAA_M));
        }
        error = daa_squared_distance(textureLoad(daa_color, pixel, 0), daa_mean_finish(mean));
    }
    // Spreads are squared errors, and a step doubles them. Measured, the error grows less.
    daa_store_errors(group.xy, groups.x, lane, vec2f(error, error * exp2(daa_frame.audit.step)));
}
