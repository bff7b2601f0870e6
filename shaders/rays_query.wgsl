// rays_query: the same by the adapter's ray query. Joined with rays.wgsl; the module begins with `enable wgpu_ray_query;`
// and declares daa_ray_tlas, daa_ray_geometry and daa_ray_top.

/// Vec4s of an instance.
const DAA_RAY_RECORD: u32 = 5u;

/// The first hit of the ray; with `any`, whichever the adapter finds.
fn daa_trace(ray: DaaRay, any: bool) -> DaaHit {
    let flags = select(RAY_FLAG_FORCE_OPAQUE, RAY_FLAG_FORCE_OPAQUE | RAY_FLAG_TERMINATE_ON_FIRST_HIT, any);
    var query: ray_query;
    rayQueryInitialize(&query, daa_ray_tlas, RayDesc(flags, 0xffu, ray.t_min, ray.t_max, ray.origin, ray.direction));
    while rayQueryProceed(&query) {}
    let found = rayQueryGetCommittedIntersection(&query);
    if found.kind == RAY_QUERY_INTERSECTION_NONE {
        return DaaHit(ray.t_max, DAA_MISS, 0u, 0u, vec2f(0.0));
    }
    let names = daa_ray_top[daa_ray_top[0].x + found.instance_custom_data * DAA_RAY_RECORD + 3u];
    let corners = daa_ray_geometry[names.z + found.primitive_index];
    return DaaHit(found.t, names.y, corners.w, u32(found.front_face), found.barycentrics);
}
