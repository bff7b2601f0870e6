// The shared parts of `trace` and `reflect`: the samples from which they cast rays, and shadow rays. Each pass defines
// its own `daa_wants` and `daa_begin`.

@group(3) @binding(1) var<storage, read> daa_ray_meshes: array<vec4u>;
@group(3) @binding(2) var<storage, read> daa_ray_top: array<vec4u>;
@group(3) @binding(3) var<uniform> daa_casting: DaaCasting;
@group(3) @binding(4) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(6) var<storage, read_write> daa_statistics: DaaStatistics;
/// `DaaTileLists` of classify.wgsl, word by word: two classes of four words, then the tiles of each class.
@group(3) @binding(7) var<storage, read> daa_tile_lists: array<u32>;
/// The points of lattices, see lattice.wgsl.
@group(3) @binding(8) var<storage, read_write> daa_points: array<vec4u>;

/// The samples from which a dispatch casts rays: `CastSamples` of src/gpu/uniforms/casting.rs.
const DAA_SAMPLES_FIRST: u32 = 0u;
const DAA_SAMPLES_FULL: u32 = 1u;
const DAA_SAMPLES_PLANNED: u32 = 2u;
const DAA_SAMPLES_AUDITED: u32 = 3u;
const DAA_SAMPLES_GEOMETRIC: u32 = 4u;
const DAA_SAMPLES_POINTS: u32 = 5u;

/// A light that casts shadows.
struct DaaCastingLight {
    /// Position relative to the camera; for a directional light, the unit vector towards it.
    position: vec3f,
    /// 0 for a directional light, 1 for a punctual light.
    punctual: u32,
    /// Axis of the cone.
    direction: vec3f,
    /// Cosine of half the cone's angle; -1 if the light shines in all directions.
    cone: f32,
    /// Distance beyond which the light is dark.
    range: f32,
}

struct DaaCasting {
    /// Number of lights.
    count: u32,
    /// DAA_SAMPLES_*.
    samples: u32,
    /// 1 if the number of rays of each sample is recorded, for the debug view of rays.
    keeps: u32,
    /// Distance from a surface at which rays start, over that to the camera unless that is orthographic.
    bias: f32,
    /// The lattice of DAA_SAMPLES_POINTS.
    step: DaaStep,
    lights: array<DaaCastingLight, 32>,
}

/// Classes of tiles, in the order of `DaaTileLists`.
const DAA_TILES_SURFACE: u32 = 0u;
const DAA_TILES_REFLECT: u32 = 1u;

/// The samples of a lane: of a pixel, the ranks from `first` up to, but without, `end`. Planned samples are dealt to
/// the lanes in turn, since a few pixels have many: with DAA_SAMPLES_PLANNED, `pixel` is the tile, and each 64th of its
/// planned samples takes the place of a rank. With DAA_SAMPLES_POINTS, `pixel` is the workgroup's position, and it is
/// each 64th of its chosen points.
struct DaaRanks {
    pixel: vec2u,
    first: u32,
    end: u32,
    step: u32,
}

/// A sample, and whether it casts rays: those without room for results of their own do not.
struct DaaCaster {
    pixel: vec2u,
    rank: u32,
    wanted: bool,
    /// Whether the results belong to the sample itself.
    inside: bool,
    /// For DAA_SAMPLES_POINTS, the index in `daa_points` for the results.
    found: u32,
}

fn daa_caster(ranks: DaaRanks, i: u32) -> DaaCaster {
    if daa_casting.samples == DAA_SAMPLES_POINTS {
        let at = daa_chosen_at(ranks.pixel, i);
        let l = daa_casting.step.points;
        let point = daa_point(l, at);
        let found = daa_point_index(l, at) + daa_casting.step.found;
        return DaaCaster(point.pixel, point.rank, true, point.inside, found);
    }
    if daa_casting.samples == DAA_SAMPLES_PLANNED {
        let planned = daa_planned_sample(ranks.pixel, i);
        let pixel = daa_tile_pixel(ranks.pixel, planned.x);
        return DaaCaster(pixel, planned.y, daa_has_results(pixel, planned.y), true, 0u);
    }
    return DaaCaster(ranks.pixel, i, true, true, 0u);
}

/// The place in the tile, and the rank, of its i-th planned sample beyond first ones.
fn daa_planned_sample(tile: vec2u, i: u32) -> vec2u {
    let first_slot = daa_tile_index(tile) * 64u;
    // The last window whose samples begin at or before this one.
    var place = 0u;
    for (var stride = 32u; stride > 0u; stride >>= 1u) {
        place += select(0u, stride, daa_plan_before(daa_plan[first_slot + place + stride]) <= i);
    }
    let word = daa_plan[first_slot + place];
    let in_window = i - daa_plan_before(word);
    if daa_flag(DAA_FLAG_SELECTIVE) {
        return vec2u(place, daa_nth_rank(daa_ranks_of(daa_plan_quadrants(word)), in_window));
    }
    return vec2u(place, in_window + 1u);
}

const DAA_NO_TILE: u32 = 0xffffffffu;

/// The tile of a workgroup over the list of tiles of a kind. x is DAA_NO_TILE beyond its end.
fn daa_listed_tile(group: vec2u, kind: u32) -> vec2u {
    let place = group.y * daa_tile_lists[kind * 4u + 1u] + group.x;
    if place >= daa_tile_lists[kind * 4u] {
        return vec2u(DAA_NO_TILE);
    }
    let listed = daa_tile_lists[8u + kind * daa_tile_count() + place];
    return vec2u(listed % daa_frame.tiles_x, listed / daa_frame.tiles_x);
}

/// The samples of a lane. There are none outside the image, or beyond the end of the list of tiles of this kind.
fn daa_ranks(group: vec2u, lane: u32, kind: u32) -> DaaRanks {
    if daa_casting.samples == DAA_SAMPLES_POINTS {
        return DaaRanks(group, lane, daa_choose_points(daa_casting.step, group, lane), 64u);
    }
    var tile = group;
    if daa_casting.samples == DAA_SAMPLES_AUDITED {
        tile = daa_tile_of_image(daa_audited_tile(group));
    } else {
        tile = daa_listed_tile(group, kind);
        if tile.x == DAA_NO_TILE {
            return DaaRanks(vec2u(0u), 0u, 0u, 1u);
        }
    }
    if daa_casting.samples == DAA_SAMPLES_PLANNED {
        let last = daa_plan[daa_tile_index(tile) * 64u + 63u];
        return DaaRanks(tile, lane, daa_plan_before(last) + max(daa_plan_k(last), 1u) - 1u, 64u);
    }
    let pixel = daa_tile_pixel(tile, lane);
    // Neighbours read the first samples of pixels that are not shown.
    let first_alone = daa_casting.samples == DAA_SAMPLES_FIRST;
    if any(pixel >= daa_frame.size) || (!first_alone && !daa_is_shown(pixel)) {
        return DaaRanks(pixel, 0u, 0u, 1u);
    }
    let n = DAA_M * DAA_M;
    switch daa_casting.samples {
        case DAA_SAMPLES_FIRST: { return DaaRanks(pixel, 0u, 1u, 1u); }
        case DAA_SAMPLES_FULL: { return DaaRanks(pixel, 0u, n, 1u); }
        // The samples that were not planned.
        case DAA_SAMPLES_AUDITED: { return DaaRanks(pixel, daa_plan_k(daa_plan[daa_slot(pixel)]), n, 1u); }
        default: { return DaaRanks(pixel, 1u, daa_frame.reconstruct.samples, 1u); }
    }
}

/// The distance from a surface at which rays start: 2⁻¹⁶ of its distance to the camera, since the depth buffer and the
/// ray scene round differently, or the share of a sample that the rasteriser may lose. World coordinates do not matter,
/// as both are relative to the camera. Large triangles, and coordinates in a mesh's own space that are much larger, do:
/// objects that have them have a least offset (`RayScene::least_offsets`).
fn daa_ray_offset(relative: vec3f, object: u32) -> f32 {
    let from_camera = abs(relative);
    let distance = max(max(from_camera.x, from_camera.y), from_camera.z);
    let by_sample = daa_casting.bias * select(distance, 1.0, daa_frame.orthographic != 0u);
    let by_distance = max(distance * 1.52587890625e-5, by_sample);
    let offsets = daa_ray_top[0].zw;
    if object >= offsets.x {
        return by_distance;
    }
    return max(by_distance, bitcast<f32>(daa_ray_top[offsets.y + object / 4u][object % 4u]));
}

/// 1 if light i does not reach a surface, and 1 if a ray was traced to find out.
fn daa_shadow(i: u32, position: vec3f, normal: vec3f, geometric_normal: vec3f, object: u32) -> vec2u {
    let light = daa_casting.lights[i];
    var towards = light.position;
    if light.punctual != 0u {
        towards -= position;
        let squared = dot(towards, towards);
        // Outside its range or cone a light casts no shadow.
        if squared >= light.range * light.range || squared == 0.0 || dot(towards, light.direction) > -light.cone * sqrt(squared) {
            return vec2u(0u);
        }
    }
    if dot(normal, towards) <= 0.0 {
        return vec2u(1u, 0u);
    }
    // If the smooth surface faces the light but its coarse triangle does not, the ray starts inside the object, and the
    // surface where it leaves the object is ignored. Otherwise triangles would show at the terminator.
    let inside = dot(geometric_normal, towards) <= 0.0;
    let offset = daa_ray_offset(position, object);
    let origin = position + geometric_normal * select(offset, -offset, inside);
    var ray = DaaRay(origin, 0.0, towards, 1e30);
    if light.punctual != 0u {
        ray.direction = light.position - origin;
        // The ray ends before the lamp itself.
        ray.t_max = 0.9998;
    }
    let hit = daa_trace(ray, DAA_RAY_ANY | DAA_RAY_SHADOW, select(DAA_MISS, object, inside));
    return vec2u(u32(hit.instance != DAA_MISS), 1u);
}

/// The shadow bits of all lights in x, and the number of rays in y.
fn daa_shadows_at(position: vec3f, normal: vec3f, geometric_normal: vec3f, object: u32) -> vec2u {
    var bits = vec2u(0u);
    for (var i = 0u; i < daa_casting.count; i++) {
        let shadow = daa_shadow(i, position, normal, geometric_normal, object);
        bits += vec2u(shadow.x << i, shadow.y);
    }
    return bits;
}

var<workgroup> daa_group_shadow_rays: array<u32, 64>;

/// Adds the shadow rays of a workgroup's 64 lanes to the statistics. All lanes call it.
fn daa_count_shadow_rays(lane: u32, rays: u32) {
    daa_group_shadow_rays[lane] = rays;
    workgroupBarrier();
    if lane == 0u {
        var sum = 0u;
        for (var i = 0u; i < 64u; i++) {
            sum += daa_group_shadow_rays[i];
        }
        if sum != 0u {
            atomicAdd(&daa_statistics.shadow_rays, sum);
        }
    }
}
