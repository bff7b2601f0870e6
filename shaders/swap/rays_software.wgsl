// rays_software: traversal in WGSL, without ray tracing hardware. It uses two levels of eight-way compressed nodes
// (Ylitie, Karras, Laine 2017, in the layout of obvhs), box tests with a margin for rounding (Ize 2013), and a
// watertight triangle test (Woop, Benthin, Wald 2013). The module must declare daa_ray_meshes,
// daa_ray_top and daa_ray_solid. CPU twin: src/reference/rays.rs, by brute force.

/// The size of the traversal stack. At most one group waits for each level, and two more for an entered instance: see
/// src/rays/mesh.rs.
const DAA_RAY_STACK: u32 = 60u;
/// A group with the root as its only node.
const DAA_RAY_ROOT: u32 = 0x80000000u;
/// The number of vec4s of a node and of an instance.
const DAA_RAY_RECORD: u32 = 5u;

/// A ray in the space of a tree's nodes.
struct DaaRaySpace {
    origin: vec3f,
    direction: vec3f,
    /// 1 / direction, always finite.
    inverse: vec3f,
    /// Bits 2, 1 and 0: whether x, y and z do not decrease along the ray.
    octant: u32,
}

fn daa_ray_space(origin: vec3f, direction: vec3f) -> DaaRaySpace {
    let a = abs(direction);
    // An axis along which the ray does not move gets a large reciprocal, so that 0 · ∞ does not occur.
    let least = max(max(max(a.x, a.y), a.z) * 1e-18, 1e-30);
    let d = select(select(vec3f(-least), vec3f(least), direction >= vec3f(0.0)), direction, a > vec3f(least));
    let bits = select(vec3u(0u), vec3u(4u, 2u, 1u), d >= vec3f(0.0));
    return DaaRaySpace(origin, direction, 1.0 / d, bits.x | bits.y | bits.z);
}

fn daa_byte(word: u32, i: u32) -> u32 {
    return (word >> (i * 8u)) & 0xffu;
}

/// The children of a node that the ray meets before `t_max`: inner nodes in bits 24 to 31, in the order in which the
/// ray meets them, and triangles or instances in bits 0 to 23.
fn daa_ray_children(s: DaaRaySpace, t_min: f32, t_max: f32, n0: vec4u, n1: vec4u, n2: vec4u, n3: vec4u, n4: vec4u) -> u32 {
    let scale = bitcast<vec3f>(vec3u(n0.w & 0xffu, (n0.w >> 8u) & 0xffu, (n0.w >> 16u) & 0xffu) << vec3u(23u));
    let a = scale * s.inverse;
    let b = (bitcast<vec3f>(n0.xyz) - s.origin) * s.inverse;
    // A margin of four roundings of the greatest term.
    let slack = (abs(b) + 255.0 * abs(a)) * 2.4e-7;
    let near_b = b - slack;
    let far_b = b + slack;
    let falls = s.inverse < vec3f(0.0);
    var hits = 0u;
    for (var i = 0u; i < 8u; i++) {
        let code = daa_byte(select(n1.z, n1.w, i >= 4u), i & 3u);
        if code == 0u {
            continue;
        }
        let high = i >= 4u;
        let lo = vec3f(vec3u(
            daa_byte(select(n2.x, n2.y, high), i & 3u),
            daa_byte(select(n3.x, n3.y, high), i & 3u),
            daa_byte(select(n4.x, n4.y, high), i & 3u),
        ));
        let hi = vec3f(vec3u(
            daa_byte(select(n2.z, n2.w, high), i & 3u),
            daa_byte(select(n3.z, n3.w, high), i & 3u),
            daa_byte(select(n4.z, n4.w, high), i & 3u),
        ));
        let near = select(lo, hi, falls) * a + near_b;
        let far = select(hi, lo, falls) * a + far_b;
        let enters = max(max(near.x, near.y), max(near.z, t_min));
        let leaves = min(min(far.x, far.y), min(far.z, t_max));
        if enters <= leaves {
            let inner = (code & (code << 1u) & 16u) != 0u;
            let bit = select(code, code ^ s.octant, inner) & 31u;
            hits |= (code >> 5u) << bit;
        }
    }
    return hits;
}

/// The axes of the ray for the triangle test; z is the direction's greatest component.
struct DaaShear {
    axes: vec3u,
    shear: vec3f,
}

fn daa_shear(d: vec3f) -> DaaShear {
    let a = abs(d);
    var z = 2u;
    if a.x >= a.y && a.x >= a.z {
        z = 0u;
    } else if a.y >= a.z {
        z = 1u;
    }
    var x = (z + 1u) % 3u;
    var y = (x + 1u) % 3u;
    if d[z] < 0.0 {
        let swapped = x;
        x = y;
        y = swapped;
    }
    return DaaShear(vec3u(x, y, z), vec3f(d[x] / d[z], d[y] / d[z], 1.0 / d[z]));
}

/// A vertex relative to the ray's origin, sheared so that the ray runs along z.
fn daa_sheared(s: DaaShear, p: vec3f) -> vec3f {
    return vec3f(p[s.axes.x] - s.shear.x * p[s.axes.z], p[s.axes.y] - s.shear.y * p[s.axes.z], s.shear.z * p[s.axes.z]);
}

/// Twice the signed area of the triangle of the origin, p and q. The order of p and q in the computation does not
/// depend on their order in the call, so that the triangles on both sides of an edge get exactly opposite values,
/// whatever the compiler fuses.
fn daa_edge(p: vec3f, q: vec3f) -> f32 {
    let swapped = p.x > q.x || (p.x == q.x && p.y > q.y);
    let first = select(p, q, swapped);
    let second = select(q, p, swapped);
    let area = first.x * second.y - first.y * second.x;
    return select(area, -area, swapped);
}

/// The hit of a ray with a triangle: t, and the weights of the second and the third vertex. t = `t_max` if there is
/// none. Edges and vertices count as inside, for all triangles that share them.
struct DaaTriangleHit {
    t: f32,
    barycentrics: vec2f,
    front: bool,
}

fn daa_triangle(s: DaaShear, t_min: f32, t_max: f32, a: vec3f, b: vec3f, c: vec3f) -> DaaTriangleHit {
    let none = DaaTriangleHit(t_max, vec2f(0.0), false);
    let pa = daa_sheared(s, a);
    let pb = daa_sheared(s, b);
    let pc = daa_sheared(s, c);
    let u = daa_edge(pc, pb);
    let v = daa_edge(pa, pc);
    let w = daa_edge(pb, pa);
    if min(min(u, v), w) < 0.0 && max(max(u, v), w) > 0.0 {
        return none;
    }
    let area = u + v + w;
    if area == 0.0 {
        return none;
    }
    let t = (u * pa.z + v * pb.z + w * pc.z) / area;
    if !(t > t_min && t < t_max) {
        return none;
    }
    return DaaTriangleHit(t, vec2f(v, w) / area, area > 0.0);
}

/// The nearest hit of the ray, or with DAA_RAY_ANY the first that the traversal finds. Back faces of the object `through`
/// are ignored; with DAA_MISS, there is no such object.
fn daa_trace(ray: DaaRay, flags: u32, through: u32) -> DaaHit {
    var hit = DaaHit(ray.t_max, DAA_MISS, 0u, 0u, vec2f(0.0), 0u, 0u);
    if daa_ray_top[0].y == 0u {
        return hit;
    }
    let instances = daa_ray_top[0].x;
    let outside = daa_ray_space(ray.origin, ray.direction);
    var space = outside;
    var shear: DaaShear;
    var stack: array<vec2u, DAA_RAY_STACK>;
    var height = 0u;
    // The height of the stack below which its entries belong to the top level; DAA_MISS while the traversal is in the
    // top level.
    var entry = DAA_MISS;
    var record = 0u;
    var names: vec4u;
    var more: vec4u;
    var nodes = vec2u(0u, DAA_RAY_ROOT);
    var leaves = vec2u(0u);
    loop {
        if leaves.y != 0u {
            let bit = firstLeadingBit(leaves.y);
            leaves.y &= ~(1u << bit);
            let index = leaves.x + bit;
            if entry == DAA_MISS {
                // Enters an instance; the rest of the top level waits on the stack.
                if nodes.y > 0x00ffffffu {
                    stack[height] = nodes;
                    height += 1u;
                }
                if leaves.y != 0u {
                    stack[height] = leaves;
                    height += 1u;
                }
                entry = height;
                let at = instances + index * DAA_RAY_RECORD;
                record = at;
                let x = bitcast<vec4f>(daa_ray_top[at]);
                let y = bitcast<vec4f>(daa_ray_top[at + 1u]);
                let z = bitcast<vec4f>(daa_ray_top[at + 2u]);
                names = daa_ray_top[at + 3u];
                more = daa_ray_top[at + 4u];
                let o = vec4f(ray.origin, 1.0);
                let origin = vec3f(dot(x, o), dot(y, o), dot(z, o));
                let d = ray.direction;
                let direction = vec3f(dot(x.xyz, d), dot(y.xyz, d), dot(z.xyz, d));
                space = daa_ray_space(origin, direction);
                shear = daa_shear(direction);
                nodes = vec2u(names.x, DAA_RAY_ROOT);
                leaves = vec2u(0u);
            } else {
                let corners = daa_ray_meshes[index];
                let a = bitcast<vec3f>(daa_ray_meshes[corners.x].xyz) - space.origin;
                let b = bitcast<vec3f>(daa_ray_meshes[corners.y].xyz) - space.origin;
                let c = bitcast<vec3f>(daa_ray_meshes[corners.z].xyz) - space.origin;
                let found = daa_triangle(shear, ray.t_min, hit.t, a, b, c);
                if found.t < hit.t && daa_ray_stops(names, more, corners.xyz, found.barycentrics, found.front, DaaPassing(flags, through)) {
                    hit = DaaHit(found.t, names.y, corners.w, u32(found.front), found.barycentrics, record, index);
                    if (flags & DAA_RAY_ANY) != 0u {
                        return hit;
                    }
                }
            }
        } else if nodes.y > 0x00ffffffu {
            let bit = firstLeadingBit(nodes.y);
            let group = nodes;
            nodes.y &= ~(1u << bit);
            if nodes.y > 0x00ffffffu {
                stack[height] = nodes;
                height += 1u;
            }
            let slot = (bit - 24u) ^ space.octant;
            let node = group.x + countOneBits(group.y & ~(0xffffffffu << slot));
            let at = node * DAA_RAY_RECORD;
            var n: array<vec4u, 5>;
            if entry == DAA_MISS {
                n = array(daa_ray_top[at + 1u], daa_ray_top[at + 2u], daa_ray_top[at + 3u], daa_ray_top[at + 4u], daa_ray_top[at + 5u]);
            } else {
                n = array(daa_ray_meshes[at], daa_ray_meshes[at + 1u], daa_ray_meshes[at + 2u], daa_ray_meshes[at + 3u], daa_ray_meshes[at + 4u]);
            }
            let hits = daa_ray_children(space, ray.t_min, hit.t, n[0], n[1], n[2], n[3], n[4]);
            nodes = vec2u(n[1].x, (hits & 0xff000000u) | (n[0].w >> 24u));
            leaves = vec2u(n[1].y, hits & 0x00ffffffu);
        } else {
            if height == entry {
                entry = DAA_MISS;
                space = outside;
            }
            if height == 0u {
                return hit;
            }
            height -= 1u;
            let group = stack[height];
            // Of the two groups that wait for an instance, leaves lie above nodes.
            if group.y > 0x00ffffffu {
                nodes = group;
            } else {
                leaves = group;
            }
        }
    }
    return hit;
}
