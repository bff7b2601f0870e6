// rays_query: traversal by the adapter's ray query, with the functions of rays_software.wgsl. The module must declare
// daa_ray_tlas, daa_ray_meshes, daa_ray_top and daa_ray_solid.

/// The number of vec4s of an instance.
const DAA_RAY_RECORD: u32 = 5u;
/// Bits of `RayDesc::flags`.
const DAA_RAY_FORCE_NO_OPAQUE: u32 = 2u;
const DAA_RAY_TERMINATE_ON_FIRST_HIT: u32 = 4u;
/// The bit of the masks of instances that cast shadows: `MASK_SHADOW` of src/rays/query.rs.
const DAA_RAY_MASK_SHADOW: u32 = 2u;

fn daa_trace(ray: DaaRay, flags: u32, through: u32) -> DaaHit {
    var hit = DaaHit(ray.t_max, DAA_MISS, 0u, 0u, vec2f(0.0), 0u, 0u);
    let instances = daa_ray_top[0].x;
    if daa_ray_top[0].y == 0u {
        return hit;
    }
    // The loop below only sees triangles that are not opaque, so these are forced where a surface may be passed
    // through.
    let culls = (flags & DAA_RAY_CULL) != 0u && daa_ray_top[1].w != 0u;
    let first = select(0u, DAA_RAY_TERMINATE_ON_FIRST_HIT, (flags & DAA_RAY_ANY) != 0u);
    let adapters = first | select(0u, DAA_RAY_FORCE_NO_OPAQUE, through != DAA_MISS || culls);
    let mask = select(0xffu, DAA_RAY_MASK_SHADOW, (flags & DAA_RAY_SHADOW) != 0u);
    // A top level of the host's own is in world space.
    let origin = ray.origin + bitcast<vec3f>(daa_ray_top[1].xyz);
    var query: ray_query;
    rayQueryInitialize(&query, daa_ray_tlas, RayDesc(adapters, mask, ray.t_min, ray.t_max, origin, ray.direction));
    while rayQueryProceed(&query) {
        let found = rayQueryGetCandidateIntersection(&query);
        if found.kind != RAY_QUERY_INTERSECTION_TRIANGLE {
            continue;
        }
        let at = instances + found.instance_custom_data * DAA_RAY_RECORD;
        let names = daa_ray_top[at + 3u];
        let corners = daa_ray_meshes[names.z + found.primitive_index];
        if daa_ray_stops(names, daa_ray_top[at + 4u], corners.xyz, found.barycentrics, found.front_face, DaaPassing(flags, through)) {
            rayQueryConfirmIntersection(&query);
        }
    }
    let found = rayQueryGetCommittedIntersection(&query);
    if found.kind == RAY_QUERY_INTERSECTION_TRIANGLE {
        let record = instances + found.instance_custom_data * DAA_RAY_RECORD;
        let names = daa_ray_top[record + 3u];
        let corners = names.z + found.primitive_index;
        let triangle = daa_ray_meshes[corners].w;
        hit = DaaHit(found.t, names.y, triangle, u32(found.front_face), found.barycentrics, record, corners);
    }
    return hit;
}
