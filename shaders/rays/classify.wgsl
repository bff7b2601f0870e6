// classify: lists the tiles in which rays are needed, by kind, so that `trace` and `reflect` run only there. CPU twin:
// src/reference/rays/classify.rs.

@group(3) @binding(0) var<storage, read_write> daa_tile_lists: DaaTileLists;
/// A bit for each material: whether it sends rays.
@group(3) @binding(1) var<uniform> daa_reflective: array<vec4u, 512>;
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

/// The i-th sample of a tile, row by row. Beyond the tile or the image it is one of the tile's last.
fn daa_tile_sample(tile: vec2u, i: u32) -> vec2u {
    let side = 8u * DAA_M;
    return min(tile * side + min(vec2u(i % side, i / side), vec2u(side - 1u)), daa_frame.size * DAA_M - 1u);
}

/// 1 if the material of a sample sends rays.
fn daa_sends(at: vec2u) -> u32 {
    let material = daa_identity_at(at) & 0xffffu;
    return (daa_reflective[material >> 7u][(material >> 5u) & 3u] >> (material & 31u)) & 1u;
}

@compute @workgroup_size(64)
fn daa_classify_main(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    // If no material sends rays, the search ends at the first surface.
    let reflects = daa_flag(DAA_FLAG_REFLECTS);
    let wanted = select(1u, 3u, reflects);
    // Each lane reads four samples at a time, which do not wait for each other. The search ends in all lanes when the
    // tile is in every class.
    for (var i = lane; i < 64u * DAA_M * DAA_M && atomicLoad(&daa_found) != wanted; i += 256u) {
        let a = daa_tile_sample(tile.xy, i);
        let b = daa_tile_sample(tile.xy, i + 64u);
        let c = daa_tile_sample(tile.xy, i + 128u);
        let d = daa_tile_sample(tile.xy, i + 192u);
        let depths = vec4f(daa_depth_at(a), daa_depth_at(b), daa_depth_at(c), daa_depth_at(d));
        let surfaces = depths > vec4f(DAA_SKY_DEPTH);
        if any(surfaces) {
            var found = 1u;
            if reflects {
                let sends = vec4u(daa_sends(a), daa_sends(b), daa_sends(c), daa_sends(d));
                found |= u32(any(surfaces & (sends != vec4u(0u)))) << 1u;
            }
            atomicOr(&daa_found, found);
        }
    }
    workgroupBarrier();
    let all_tiles = daa_tile_count();
    let of_tile = atomicLoad(&daa_found);
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
