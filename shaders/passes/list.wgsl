// list: writes the frame's work as one list, for the executions that need it. A stable counting sort keeps the order
// the same in each run: it counts by row and tile, scans each row, and then every tile writes its own part.
//
// A list of pixels has a row for each k, from n down to 2, each padded to whole workgroups with DAA_NO_ENTRY, so that
// all pixels of a workgroup have the same k. Its entries are indices into the plan (slots). A list of samples has one
// row, in batches of whole tiles. Its entries are slot · n + rank. CPU twin: src/reference/list.rs.

/// The number of samples in a batch; its last tile may exceed it. A larger batch needs fewer dispatches, and 16 bytes
/// for each sample.
const DAA_BATCH: u32 = 4194304u;

@group(3) @binding(0) var<storage, read> daa_plan: array<u32>;
/// At r · tiles + t, the number of entries that tile t has in row r; after the scan, the number of entries of row r
/// before those of tile t.
@group(3) @binding(1) var<storage, read_write> daa_rows: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_list: array<u32>;
@group(3) @binding(3) var<storage, read_write> daa_work: array<DaaWork>;

/// The number of rows of a list of pixels: one for each k from 2, or at n = 1 one that stays empty.
fn daa_pixel_rows() -> u32 {
    return max(DAA_M * DAA_M - 1u, 1u);
}

fn daa_row(k: u32) -> u32 {
    return DAA_M * DAA_M - k;
}

/// The number of entries that each lane's tile has in each row so far, at most 64: bits 8 (r % 4) to 8 (r % 4) + 7 of
/// word 64 (r / 4) + lane for row r. A private array that is indexed at run time would lie in slower memory.
var<workgroup> daa_entries: array<u32, 1024>;

fn daa_entries_of(row: u32, lane: u32) -> u32 {
    return (daa_entries[(row >> 2u) * 64u + lane] >> ((row & 3u) * 8u)) & 0xffu;
}

fn daa_add_entry(row: u32, lane: u32) {
    daa_entries[(row >> 2u) * 64u + lane] += 1u << ((row & 3u) * 8u);
}

@compute @workgroup_size(64)
fn daa_list_count_pixels(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tiles = daa_tile_count();
    if id.x >= tiles {
        return;
    }
    for (var i = 0u; i < 64u; i++) {
        let k = daa_plan_k(daa_plan[id.x * 64u + i]);
        if k > 1u {
            daa_add_entry(daa_row(k), lane);
        }
    }
    for (var row = 0u; row < daa_pixel_rows(); row++) {
        daa_rows[row * tiles + id.x] = daa_entries_of(row, lane);
    }
}

@compute @workgroup_size(64)
fn daa_list_count_samples(@builtin(global_invocation_id) id: vec3u) {
    if id.x < daa_tile_count() {
        let last = daa_plan[id.x * 64u + 63u];
        daa_rows[id.x] = daa_plan_before(last) + max(daa_plan_k(last), 1u) - 1u;
    }
}

/// A workgroup scans a row. Each lane scans a run of tiles, and adds the sums of the runs before it.
@compute @workgroup_size(256)
fn daa_list_scan(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tiles = daa_tile_count();
    let run = (tiles + 255u) / 256u;
    let row = group.x * tiles;
    let begin = row + min(lane * run, tiles);
    let end = row + min((lane + 1u) * run, tiles);
    var sum = 0u;
    for (var i = begin; i < end; i++) {
        sum += daa_rows[i];
    }
    var before = daa_sum_before(lane, sum);
    if lane == 255u {
        daa_work[group.x + 1u].count = before + sum;
    }
    for (var i = begin; i < end; i++) {
        let entries = daa_rows[i];
        daa_rows[i] = before;
        before += entries;
    }
}

fn daa_set_work(index: u32, begin: u32, end: u32) {
    daa_work[index].begin = begin;
    daa_work[index].end = end;
    // Whole strides, see `daa_draw`, with at most 65,535 workgroups along a dimension.
    let groups = (((end - begin + 63u) / 64u) + DAA_STRIDES - 1u) / DAA_STRIDES * DAA_STRIDES;
    let x = min(groups, 32768u);
    daa_work[index].groups_x = x;
    daa_work[index].groups_y = (groups + max(x, 1u) - 1u) / max(x, 1u);
    daa_work[index].groups_z = 1u;
}

/// The first entry of each row.
var<workgroup> daa_begins: array<u32, 64>;

@compute @workgroup_size(64)
fn daa_list_pixels(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tiles = daa_tile_count();
    // The bound is not a constant, so that compilers do not unroll the loop.
    let rows = min(daa_pixel_rows(), daa_frame.size.x + 62u);
    var begin = 0u;
    for (var row = 0u; row < rows; row++) {
        let end = begin + daa_work[row + 1u].count;
        let padded = (end + 63u) & ~63u;
        if lane == 0u {
            daa_begins[row] = begin;
        }
        if id.x == 0u {
            daa_set_work(row + 1u, begin, padded);
        }
        // The first workgroup pads the row, by less than an entry for each of its lanes.
        if id.x < padded - end {
            daa_list[end + id.x] = DAA_NO_ENTRY;
        }
        begin = padded;
    }
    if id.x == 0u {
        daa_set_work(0u, 0u, begin);
    }
    workgroupBarrier();
    if id.x >= tiles {
        return;
    }
    for (var i = 0u; i < 64u; i++) {
        let slot = id.x * 64u + i;
        let k = daa_plan_k(daa_plan[slot]);
        if k > 1u {
            let row = daa_row(k);
            daa_list[daa_begins[row] + daa_rows[row * tiles + id.x] + daa_entries_of(row, lane)] = slot;
            daa_add_entry(row, lane);
        }
    }
}

/// The number of batches into which the samples of any frame of this size fit, `batches` of src/gpu/sizes.rs. A host may
/// have lent memory with room for more.
fn daa_batches() -> u32 {
    let samples = daa_frame.size.x * daa_frame.size.y * (DAA_M * DAA_M - 1u);
    return max((samples + DAA_BATCH - 1u) / DAA_BATCH, 1u);
}

/// The number of samples before the first tile that has at least `samples` before it, or of all samples if there is
/// none.
fn daa_cut(samples: u32) -> u32 {
    var below = 0u;
    var above = daa_tile_count();
    while below < above {
        let tile = (below + above) / 2u;
        if daa_rows[tile] < samples {
            below = tile + 1u;
        } else {
            above = tile;
        }
    }
    if below == daa_tile_count() {
        return daa_work[1].count;
    }
    return daa_rows[below];
}

@compute @workgroup_size(64)
fn daa_list_samples(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = daa_tile_index(tile.xy);
    if index == 0u {
        for (var batch = lane; batch < daa_batches(); batch += 64u) {
            daa_set_work(batch + 1u, daa_cut(batch * DAA_BATCH), daa_cut((batch + 1u) * DAA_BATCH));
        }
    }
    let slot = index * 64u + lane;
    let word = daa_plan[slot];
    let begin = daa_rows[index] + daa_plan_before(word);
    for (var rank = 1u; rank < daa_plan_k(word); rank++) {
        daa_list[begin + rank - 1u] = slot * DAA_M * DAA_M + rank;
    }
}
