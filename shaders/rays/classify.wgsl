// classify: lists the tiles in which rays are needed, by kind, so that `trace` and `reflect` run only there. CPU twin:
// src/reference/rays/classify.rs.

@group(3) @binding(0) var<storage, read_write> daa_tile_lists: DaaTileLists;
/// A bit for each material: whether it sends rays.
@group(3) @binding(1) var<storage, read> daa_reflective: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_statistics: DaaStatistics;

/// A class of tiles: their number, and the workgroups of an indirect dispatch over them.
struct DaaTileClass {
    count: atomic<u32>,
    groups_x: u32,
    groups_y: u32,
    groups_z: u32,
}

struct DaaTileLists {
    /// Class 0: tiles with a surface. Class 1: tiles with a surface that sends rays.
    classes: array<DaaTileClass, 2>,
    /// Indices of tiles in no particular order; those of class 1 begin at the number of all tiles. A word for each tile
    /// follows both lists, with a bit for each class.
    tiles: array<u32>,
}

var<workgroup> daa_found: atomic<u32>;

@compute @workgroup_size(64)
fn daa_classify_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = daa_tile_pixel(tile.xy, lane);
    // If no material sends rays, the search ends at the first surface.
    let wanted = select(1u, 3u, daa_flag(DAA_FLAG_REFLECTS));
    var found = 0u;
    if all(pixel < daa_frame.size) {
        for (var i = 0u; i < DAA_M * DAA_M && found != wanted; i++) {
            let at = pixel * DAA_M + vec2u(i % DAA_M, i / DAA_M);
            if daa_depth_at(at) > DAA_SKY_DEPTH {
                let material = daa_identity_at(at) & 0xffffu;
                found |= 1u | (((daa_reflective[material >> 5u] >> (material & 31u)) & 1u) << 1u);
            }
        }
    }
    if found != 0u {
        atomicOr(&daa_found, found);
    }
    workgroupBarrier();
    let all_tiles = daa_tile_count();
    let of_tile = atomicLoad(&daa_found) & wanted;
    let index = daa_tile_index(tile.xy);
    if lane == 0u {
        daa_tile_lists.tiles[2u * all_tiles + index] = of_tile;
    }
    if lane < 2u && ((of_tile >> lane) & 1u) != 0u {
        let place = atomicAdd(&daa_tile_lists.classes[lane].count, 1u);
        daa_tile_lists.tiles[lane * all_tiles + place] = index;
    }
}

/// Runs after it, and writes the workgroups of the dispatches over the lists, at most 65,535 along a dimension.
@compute @workgroup_size(1)
fn daa_classify_finish() {
    for (var kind = 0u; kind < 2u; kind++) {
        let count = atomicLoad(&daa_tile_lists.classes[kind].count);
        let x = min(count, 32768u);
        daa_tile_lists.classes[kind].groups_x = x;
        daa_tile_lists.classes[kind].groups_y = (count + max(x, 1u) - 1u) / max(x, 1u);
        daa_tile_lists.classes[kind].groups_z = 1u;
        atomicAdd(&daa_statistics.tiles[kind], count);
    }
}
