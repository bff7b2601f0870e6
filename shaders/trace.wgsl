// trace: from the samples that will be shaded, rays towards the lights that cast shadows. Joined with rays.wgsl and the
// chunk of a tier. CPU twin: src/reference/trace.rs.

@group(3) @binding(1) var<storage, read> daa_ray_geometry: array<vec4u>;
@group(3) @binding(2) var<storage, read> daa_ray_top: array<vec4u>;
@group(3) @binding(3) var<uniform> daa_casting: DaaCasting;
@group(3) @binding(4) var<storage, read> daa_plan: array<u32>;
/// The shadow bits of all samples, rank by rank.
@group(3) @binding(5) var<storage, read_write> daa_shadows: array<u32>;
@group(3) @binding(6) var<storage, read_write> daa_statistics: DaaStatistics;

/// A light that casts shadows.
struct DaaCastingLight {
    /// From the camera; of a directional light the unit vector towards it.
    position: vec3f,
    /// 0: infinitely far, in one direction.
    punctual: u32,
    /// In which it shines.
    direction: vec3f,
    /// Cosine of the angle from there beyond which it is dark; -1: it shines everywhere.
    cone: f32,
    /// Beyond, it is dark.
    range: f32,
}

struct DaaCasting {
    count: u32,
    lights: array<DaaCastingLight, 32>,
}

/// How far rays start from a surface: 2⁻¹⁶ of its distance, for what the depth buffer and the ray scene round differently.
/// Coordinates in the world have no part in it: both are relative to the camera.
fn daa_ray_offset(relative: vec3f) -> f32 {
    let from_camera = abs(relative);
    return max(max(from_camera.x, from_camera.y), from_camera.z) * 1.52587890625e-5;
}

/// Whether light i does not reach a surface, and 1 if a ray was needed to say so.
fn daa_shadow(i: u32, position: vec3f, normal: vec3f, geometric_normal: vec3f, object: u32) -> vec2u {
    let light = daa_casting.lights[i];
    var towards = light.position;
    if light.punctual != 0u {
        towards -= position;
        let squared = dot(towards, towards);
        // Where it does not shine, nothing keeps it from shining.
        if squared >= light.range * light.range || squared == 0.0 || dot(towards, light.direction) > -light.cone * sqrt(squared) {
            return vec2u(0u);
        }
    }
    if dot(normal, towards) <= 0.0 {
        return vec2u(1u, 0u);
    }
    // Where the smooth surface faces the light and its coarse triangle does not, the ray starts inside of the body, and where
    // it leaves it that does not count: else the triangles would show at the terminator.
    let inside = dot(geometric_normal, towards) <= 0.0;
    let origin = position + geometric_normal * select(daa_ray_offset(position), -daa_ray_offset(position), inside);
    var ray = DaaRay(origin, 0.0, towards, 1e30);
    if light.punctual != 0u {
        ray.direction = light.position - origin;
        // Not the lamp itself.
        ray.t_max = 0.9998;
    }
    let hit = daa_trace(ray, true, select(DAA_MISS, object, inside));
    return vec2u(u32(hit.instance != DAA_MISS), 1u);
}

/// Bits of all lights in x, rays in y.
fn daa_shadow_rays(pixel: vec2u, rank: u32) -> vec2u {
    let s = daa_fetch(pixel, rank, 1.0, vec2f(0.0));
    var bits = vec2u(0u);
    if s.depth == 0.0 {
        return bits;
    }
    for (var i = 0u; i < daa_casting.count; i++) {
        let shadow = daa_shadow(i, s.relative_position, s.normal, s.geometric_normal, s.object);
        bits += vec2u(shadow.x << i, shadow.y);
    }
    return bits;
}

var<workgroup> daa_group_rays: array<u32, 64>;

/// Ranks `first` to `end` of a pixel.
fn daa_trace_ranks(tile: vec3u, lane: u32, first: u32, end: u32) {
    let pixel = tile.xy * 8u + vec2u(lane & 7u, lane >> 3u);
    var rays = 0u;
    if all(pixel < daa_frame.size) {
        for (var rank = first; rank < end; rank++) {
            let bits = daa_shadow_rays(pixel, rank);
            daa_shadows[daa_sample_index(pixel, rank)] = bits.x;
            rays += bits.y;
        }
    }
    daa_group_rays[lane] = rays;
    workgroupBarrier();
    if lane == 0u {
        var sum = 0u;
        for (var i = 0u; i < 64u; i++) {
            sum += daa_group_rays[i];
        }
        atomicAdd(&daa_statistics.shadow_rays, sum);
    }
}

/// The first sample of every window.
@compute @workgroup_size(64)
fn daa_trace_first(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    daa_trace_ranks(tile, lane, 0u, 1u);
}

/// All samples.
@compute @workgroup_size(64)
fn daa_trace_full(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    daa_trace_ranks(tile, lane, 0u, DAA_M * DAA_M);
}

/// The planned samples beyond the first.
@compute @workgroup_size(64)
fn daa_trace_planned(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let k = daa_plan[(tile.y * daa_frame.tiles_x + tile.x) * 64u + lane] & 0xffu;
    daa_trace_ranks(tile, lane, 1u, k);
}

/// The samples of audited tiles that were not planned.
@compute @workgroup_size(64)
fn daa_trace_audited(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile = vec3u(daa_audited_tile(group.xy), 0u);
    if tile.x >= daa_frame.tiles_x {
        return;
    }
    let k = daa_plan[(tile.y * daa_frame.tiles_x + tile.x) * 64u + lane] & 0xffu;
    daa_trace_ranks(tile, lane, k, DAA_M * DAA_M);
}

/// Whether rays could tell the samples of a window apart: it holds two surfaces, or the first samples of the windows around it
/// differ in shadow or identity.
fn daa_worth_tracing(pixel: vec2u) -> bool {
    let identity = textureLoad(daa_gbuffer_surface, pixel * DAA_M + daa_order(0u), 0).y;
    for (var rank = 1u; rank < daa_frame.geometry; rank++) {
        if textureLoad(daa_gbuffer_surface, pixel * DAA_M + daa_order(rank), 0).y != identity {
            return true;
        }
    }
    let bits = daa_shadows[daa_sample_index(pixel, 0u)];
    let last = vec2i(daa_frame.size) - 1;
    for (var i = 0; i < 9; i++) {
        let at = vec2u(clamp(vec2i(pixel) + vec2i(i % 3, i / 3) - 1, vec2i(0), last));
        let other = textureLoad(daa_gbuffer_surface, at * DAA_M + daa_order(0u), 0).y;
        if daa_shadows[daa_sample_index(at, 0u)] != bits || other != identity {
            return true;
        }
    }
    return false;
}

/// The geometric samples of `reconstruct`, whose first are traced. Where rays are not worth it, all have the first one's bits.
@compute @workgroup_size(64)
fn daa_trace_geometric(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = min(tile.xy * 8u + vec2u(lane & 7u, lane >> 3u), daa_frame.size - 1u);
    let traces = (daa_frame.flags & DAA_FLAG_TRACE_ALL) != 0u || daa_worth_tracing(pixel);
    if !traces {
        let bits = daa_shadows[daa_sample_index(pixel, 0u)];
        for (var rank = 1u; rank < daa_frame.geometry; rank++) {
            daa_shadows[daa_sample_index(pixel, rank)] = bits;
        }
    }
    daa_trace_ranks(tile, lane, select(daa_frame.geometry, 1u, traces), daa_frame.geometry);
}
