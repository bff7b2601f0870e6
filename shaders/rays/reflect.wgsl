// reflect: traces one mirrored and one refracted ray from samples whose material sends rays, and shades their hits with
// the host's own code (the secondary rays of subpixel reconstruction for ray tracing, WSCG 2012, section 3). CPU twin:
// src/reference/rays/reflect.rs.

/// The reflected and refracted radiance of samples, at `daa_result_index`, as codes of shared_exponent.wgsl. The hits
/// of first samples follow for `Selective`. If the rays of each sample are recorded, their counts follow the room for
/// hits: mirrored rays + refracted rays · 2¹⁶.
@group(3) @binding(5) var<storage, read_write> daa_reflections: array<u32>;
/// A bit for each material: whether it sends rays; 128 to a vector.
@group(3) @binding(9) var<uniform> daa_reflective: array<vec4u, 512>;

/// The most surfaces of its own object that a refracted ray passes.
const DAA_MAX_PASSAGES: u32 = 4u;

/// The surface that the last ray hit, as `daa_reflection_hit` returns it.
var<private> daa_last_hit: vec3u;

/// The cone of a ray. Its angle is that of a sample, and its width grows with distance (Akenine-Möller et al. 2019,
/// "Texture Level of Detail Strategies for Real-Time Ray Tracing", section 20.3.4).
struct DaaCone {
    width: f32,
    spread: f32,
}

fn daa_cone(pixel: vec2u, rank: u32, s: DaaSample) -> DaaCone {
    let at = vec2f(pixel * DAA_M + daa_order(rank)) + 0.5;
    let here = daa_relative_position(at, 1.0);
    let apart = length(daa_relative_position(at + vec2f(1.0, 0.0), 1.0) - here);
    if daa_frame.orthographic != 0u {
        return DaaCone(apart, 0.0);
    }
    let spread = apart / max(length(here), 1e-30);
    return DaaCone(spread * length(s.relative_position), spread);
}

/// A surface that a ray hit.
struct DaaMet {
    s: DaaSample,
    front: bool,
}

fn daa_met(pixel: vec2u, rank: u32, ray: DaaRay, hit: DaaHit, cone: DaaCone) -> DaaMet {
    let x = bitcast<vec4f>(daa_ray_top[hit.record]).xyz;
    let y = bitcast<vec4f>(daa_ray_top[hit.record + 1u]).xyz;
    let z = bitcast<vec4f>(daa_ray_top[hit.record + 2u]).xyz;
    let names = daa_ray_top[hit.record + 3u];
    let more = daa_ray_top[hit.record + 4u];
    let corners = daa_ray_meshes[hit.corners].xyz;
    let v0 = daa_ray_meshes[corners.x];
    let a = bitcast<vec3f>(v0.xyz);
    let e1 = bitcast<vec3f>(daa_ray_meshes[corners.y].xyz) - a;
    let e2 = bitcast<vec3f>(daa_ray_meshes[corners.z].xyz) - a;
    let users = vec3u(v0.w, daa_ray_meshes[corners.y].w, daa_ray_meshes[corners.z].w);
    let t = daa_triangle_attributes(
        daa_ray_meshes[corners.x + names.w],
        daa_ray_meshes[corners.y + names.w],
        daa_ray_meshes[corners.z + names.w],
        users,
    );
    let w = vec3f(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
    // The rows transform positions to the mesh's own space, so they transform normals back; their inverse transforms
    // tangents back.
    let back = mat3x3f(x, y, z);
    let side = select(-1.0, 1.0, hit.front != 0u);
    let tangents = daa_triangle_tangent(t, w);
    let flat_normal = back * cross(e1, e2);
    let smooth_normal = back * daa_triangle_normal(t, w);
    let volume = dot(x, cross(y, z));
    let inverse = mat3x3f(cross(y, z), cross(z, x), cross(x, y));
    let tangent = inverse * tangents.xyz * sign(volume);
    let p = ray.origin + ray.direction * hit.t;

    var s: DaaSample;
    s.pixel = pixel + daa_frame.origin;
    s.rank = rank;
    s.texel = DAA_NO_TEXEL;
    s.relative_position = p;
    s.position = p + daa_frame.camera_position;
    s.depth = max(hit.t, 1e-30);
    s.view = -ray.direction;
    s.geometric_normal = flat_normal * (side * inverseSqrt(max(dot(flat_normal, flat_normal), 1e-36)));
    s.normal = smooth_normal * (side * inverseSqrt(max(dot(smooth_normal, smooth_normal), 1e-36)));
    // A mirroring instance reverses N × T, but not the bitangent.
    s.tangent = vec4f(tangent * inverseSqrt(max(dot(tangent, tangent), 1e-36)), tangents.w * side * sign(volume));
    s.material = more.x;
    s.object = more.y;
    s.user = daa_triangle_user(t, w);
    s.uv = daa_triangle_uv(t, w);
    // The ratio of texture to world lengths follows from the areas. The area of the edges transforms like their normal.
    let world_area = length(flat_normal) / max(abs(volume), 1e-36);
    let scale = sqrt(abs(t.uv_ab.x * t.uv_ac.y - t.uv_ab.y * t.uv_ac.x) / max(world_area, 1e-36));
    let across = (cone.width + cone.spread * hit.t) / max(abs(dot(s.normal, ray.direction)), 0.05);
    let footprint = min(across * scale, 65504.0);
    s.ddx = vec2f(footprint, 0.0);
    s.ddy = vec2f(0.0, footprint);
    return DaaMet(s, hit.front != 0u);
}

/// Radiance after its clean-up, whose faults are counted as those of samples are.
fn daa_counted(c: vec4f) -> vec3f {
    let clean = daa_clean(c);
    if clean.what == DAA_NOT_FINITE {
        atomicAdd(&daa_statistics.not_finite, 1u);
    } else if clean.what == DAA_NEGATIVE {
        atomicAdd(&daa_statistics.negative, 1u);
    }
    return clean.color.rgb;
}

/// Whether all components are numbers, by their bits.
fn daa_is_finite(v: vec3f) -> bool {
    return all((bitcast<vec3u>(v) & vec3u(0x7f800000u)) != vec3u(0x7f800000u));
}

fn daa_sky_towards(pixel: vec2u, rank: u32, direction: vec3f) -> vec3f {
    var s: DaaSample;
    s.pixel = pixel + daa_frame.origin;
    s.rank = rank;
    s.texel = DAA_NO_TEXEL;
    s.view = -direction;
    s.relative_position = direction;
    s.position = direction + daa_frame.camera_position;
    return daa_counted(daa_call_sky(s));
}

/// The radiance along a ray that leaves a surface of `object`. A refracted ray passes through the back faces of the
/// object.
fn daa_arriving(pixel: vec2u, rank: u32, from_point: vec3f, towards: vec3f, refracted: bool, ior: f32, object: u32, start: DaaCone) -> vec3f {
    var origin = from_point;
    var direction = towards;
    var cone = start;
    let end = select(1u, DAA_MAX_PASSAGES, refracted);
    var inside = refracted;
    for (var i = 0u; i < end; i++) {
        let ray = DaaRay(origin, 0.0, direction, 1e30);
        // Inside a body, rays meet back faces that the camera would not see.
        let hit = daa_trace(ray, select(DAA_RAY_CULL, 0u, inside), DAA_MISS);
        if hit.instance == DAA_MISS {
            daa_last_hit = vec3u(0u);
            return daa_sky_towards(pixel, rank, direction);
        }
        let met = daa_met(pixel, rank, ray, hit, cone);
        if refracted && met.s.object == object && !met.front && i + 1u < end {
            // The ray leaves the object, or is reflected inside it where the angle is too flat.
            let out = refract(direction, met.s.normal, ior);
            let leaves = dot(out, out) > 0.0;
            direction = normalize(select(reflect(direction, met.s.normal), out, leaves));
            let offset = daa_ray_offset(met.s.relative_position, object) * select(1.0, -1.0, leaves);
            origin = met.s.relative_position + met.s.geometric_normal * offset;
            cone.width += cone.spread * hit.t;
            inside = !leaves;
            continue;
        }
        var s = met.s;
        let normal = s.geometric_normal;
        s.shadow = daa_shadows_at(s.relative_position, s.normal, normal, s.object).x;
        // The lowest bit of the normal's code is set, so that no hit has the code 0.
        let code = pack2x16snorm(daa_octahedral_encode(s.normal)) | 1u;
        daa_last_hit = vec3u((s.object & 0xffffu) | (s.material << 16u), code, s.shadow);
        return daa_counted(daa_call_hook(s, 1.0));
    }
    daa_last_hit = vec3u(0u);
    return vec3f(0.0);
}

var<workgroup> daa_group_rays: array<vec2u, 64>;

/// Whether the material of a sample sends rays.
fn daa_sends_rays(pixel: vec2u, rank: u32) -> bool {
    let material = daa_identity_at(pixel * DAA_M + daa_order(rank)) & 0xffffu;
    return (daa_reflective[material >> 7u][(material >> 5u) & 3u] & (1u << (material & 31u))) != 0u;
}

/// A point that sends no rays has no radiance.
fn daa_begin(index: u32) {
    daa_points[index + daa_casting.step.found].y = 0u;
}

fn daa_wants(point: DaaPoint) -> bool {
    return daa_sends_rays(point.pixel, point.rank);
}

@compute @workgroup_size(64)
fn daa_reflect_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let ranks = daa_ranks(group.xy, lane, DAA_TILES_REFLECT);
    var rays = vec2u(0u);
    let keeps_hits = daa_flag(DAA_FLAG_SELECTIVE) && daa_casting.samples == DAA_SAMPLES_FIRST;
    for (var i = ranks.first; i < ranks.end; i += ranks.step) {
        let caster = daa_caster(ranks, i);
        let pixel = caster.pixel;
        let rank = caster.rank;
        if !caster.wanted || !daa_sends_rays(pixel, rank) {
            continue;
        }
        let place = daa_result_index(pixel, rank);
        let s = daa_fetch(pixel, rank, 1.0, vec2f(0.0));
        if s.depth == 0.0 {
            continue;
        }
        let b = daa_call_reflection(s);
        let cone = daa_cone(pixel, rank, s);
        let offset = daa_ray_offset(s.relative_position, s.object);
        var sum = vec3f(0.0);
        var traced = false;
        // The bound is not a constant, so that compilers do not unroll the loop: one copy of the host's code takes long
        // enough to compile.
        let kinds = min(2u, daa_frame.size.x + 1u);
        for (var kind = 0u; kind < kinds; kind++) {
            let weight = select(b.reflection, b.refraction, kind == 1u);
            let allowed = daa_flag(select(DAA_FLAG_REFLECTIONS, DAA_FLAG_REFRACTIONS, kind == 1u));
            if !allowed || all(weight <= vec3f(0.0)) {
                continue;
            }
            var direction = reflect(-s.view, b.normal);
            if kind == 1u {
                direction = refract(-s.view, b.normal, 1.0 / max(b.ior, 1e-3));
            }
            if !daa_is_finite(direction) {
                atomicAdd(&daa_statistics.not_finite, 1u);
                continue;
            }
            if dot(direction, direction) == 0.0 {
                continue;
            }
            // A normal map may mirror a ray into the surface. It then runs along the surface, raised by more than the
            // 1° within which the geometric normal is known, since otherwise it might hit the triangle that it leaves.
            let into = dot(direction, s.geometric_normal);
            if kind == 0u && into < 0.0 {
                direction += s.geometric_normal * (0.02 - into);
            }
            let origin = s.relative_position + s.geometric_normal * select(offset, -offset, kind == 1u);
            sum += weight * daa_arriving(pixel, rank, origin, normalize(direction), kind == 1u, b.ior, s.object, cone);
            rays += select(vec2u(1u, 0u), vec2u(0u, 1u), kind == 1u);
            if daa_casting.keeps != 0u && caster.inside {
                daa_reflections[daa_frame.results.words + 6u * daa_tile_count() * 64u + place] += 1u << (kind * 16u);
            }
            traced = true;
            if keeps_hits {
                let at = daa_frame.results.words + daa_sample_index(pixel, kind * 3u);
                let slots = daa_tile_count() * 64u;
                daa_reflections[at] = daa_last_hit.x;
                daa_reflections[at + slots] = daa_last_hit.y;
                daa_reflections[at + 2u * slots] = daa_last_hit.z;
            }
        }
        if traced {
            let code = daa_radiance_encode(daa_counted(vec4f(sum, 1.0)));
            if caster.inside {
                daa_reflections[place] = code;
            }
            if daa_casting.samples == DAA_SAMPLES_POINTS {
                daa_points[caster.found].y = code;
            }
        }
    }
    daa_group_rays[lane] = rays;
    workgroupBarrier();
    if lane == 0u {
        var sum = vec2u(0u);
        for (var i = 0u; i < 64u; i++) {
            sum += daa_group_rays[i];
        }
        if sum.x != 0u {
            atomicAdd(&daa_statistics.reflection_rays, sum.x);
        }
        if sum.y != 0u {
            atomicAdd(&daa_statistics.refraction_rays, sum.y);
        }
    }
}
