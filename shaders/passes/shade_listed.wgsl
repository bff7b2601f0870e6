// shade_listed: `shade` for the executions that run a list of pixels or of samples.

@group(3) @binding(4) var<storage, read> daa_list: array<u32>;
@group(3) @binding(5) var<storage, read> daa_work: DaaWork;
/// The colours of a batch of listed samples.
@group(3) @binding(6) var<storage, read_write> daa_colors: array<vec4f>;
/// The number of samples in the list before those of each tile.
@group(3) @binding(7) var<storage, read> daa_rows: array<u32>;

/// The first entry of a workgroup.
fn daa_first_entry(group: vec3u) -> u32 {
    return daa_work.begin + (group.y * daa_work.groups_x + group.x) * 64u;
}

/// `Bucketed` and `Sorted`. All pixels of a dispatch have the same k with `Bucketed` (the stencil variant of section
/// 4.2), and all pixels of a workgroup with `Sorted`.
@compute @workgroup_size(64)
fn daa_shade_pixels(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let draw = daa_draw(daa_work.begin, daa_work.end, group.y * daa_work.groups_x + group.x);
    if !draw.any {
        return;
    }
    // The first entry is never padding.
    let k = daa_plan_k(daa_plan[daa_list[draw.begin]]);
    let slot = daa_list[draw.begin + lane];
    if slot == DAA_NO_ENTRY {
        return;
    }
    let pixel = daa_slot_pixel(slot);
    var others = DaaMean();
    for (var rank = 1u; rank < k; rank++) {
        others = daa_weighted(others, daa_shade_sample(pixel, rank, k));
    }
    daa_store(pixel, others);
}

/// `Packed`: a lane shades one sample (Jin et al. 2009, ExtraSampler).
@compute @workgroup_size(64)
fn daa_shade_packed(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let entry = daa_first_entry(group) + lane;
    if entry >= daa_work.end {
        return;
    }
    let n = DAA_M * DAA_M;
    let slot = daa_list[entry] / n;
    let c = daa_shade_sample(daa_slot_pixel(slot), daa_list[entry] % n, daa_plan_k(daa_plan[slot]));
    daa_colors[entry - daa_work.begin] = c;
}

/// Adds up the colours of `daa_shade_packed`, in the order of ranks.
@compute @workgroup_size(8, 8)
fn daa_shade_gather(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = daa_tile_index(tile.xy);
    let word = daa_plan[index * 64u + lane];
    let k = daa_plan_k(word);
    let before = daa_rows[index];
    if k < 2u || before < daa_work.begin || before >= daa_work.end {
        return;
    }
    let begin = before - daa_work.begin + daa_plan_before(word);
    var others = DaaMean();
    for (var i = 0u; i < k - 1u; i++) {
        others = daa_weighted(others, daa_colors[begin + i]);
    }
    daa_store(id.xy, others);
}
