// Reads a visibility buffer: the triangle of each sample, and the attributes of the point where the sample's ray meets
// it. CPU twin: src/reference/visibility.rs.

@group(0) @binding(2) var daa_gbuffer_ids: texture_2d<u32>;
/// The triangles, vertices and attributes of all meshes: the geometry of src/rays/scene.rs.
@group(0) @binding(3) var<storage, read> daa_meshes: array<vec4u>;
/// The instances of the frame, four vec4s each: `DrawnRecord` of src/rays/scene.rs.
@group(0) @binding(4) var<storage, read> daa_instances: array<vec4u>;

/// A triangle as it lies before the camera.
struct DaaDrawn {
    /// The ids as they stand in the G-buffer.
    ids: vec2u,
    /// material | object << 16.
    identity: u32,
    /// The first vertex relative to the camera.
    a: vec3f,
    /// The unit normal of the plane, in which the vertices run counterclockwise.
    plane: vec3f,
    /// The weights of the second and the third vertex grow along these vectors from `a`.
    along_b: vec3f,
    along_c: vec3f,
    /// The rows of the linear part of the transform from the mesh's own space.
    x: vec3f,
    y: vec3f,
    z: vec3f,
    attributes: DaaTriangle,
    /// Whether all vertices have one normal, and then its code as seen from the side on which they run
    /// counterclockwise, and from the other.
    flat: bool,
    flat_codes: vec2u,
}

/// The triangle that was read last. Most samples of a window show the same.
var<private> daa_drawn: DaaDrawn;

fn daa_read_triangle(ids: vec2u) {
    if all(ids == daa_drawn.ids) {
        return;
    }
    let at = (ids.x - 1u) * 4u;
    let x = bitcast<vec4f>(daa_instances[at]);
    let y = bitcast<vec4f>(daa_instances[at + 1u]);
    let z = bitcast<vec4f>(daa_instances[at + 2u]);
    // The first triangle, the offset from a vertex to its attributes, the identity, and the table of the triangles'
    // places, where a tree has sorted them.
    let names = daa_instances[at + 3u];
    var place = ids.y;
    if names.w != 0u {
        place = daa_meshes[names.w + (ids.y >> 2u)][ids.y & 3u];
    }
    let corners = daa_meshes[names.x + place].xyz;
    let word_a = daa_meshes[corners.x];
    let word_b = daa_meshes[corners.y];
    let word_c = daa_meshes[corners.z];
    let a = bitcast<vec3f>(word_a.xyz);
    let own_ab = bitcast<vec3f>(word_b.xyz) - a;
    let own_ac = bitcast<vec3f>(word_c.xyz) - a;
    let ab = vec3f(dot(x.xyz, own_ab), dot(y.xyz, own_ab), dot(z.xyz, own_ab));
    let ac = vec3f(dot(x.xyz, own_ac), dot(y.xyz, own_ac), dot(z.xyz, own_ac));
    let product = cross(ab, ac);
    let inverse_area = inverseSqrt(max(dot(product, product), 1e-36));
    let plane = product * inverse_area;
    daa_drawn.ids = ids;
    daa_drawn.identity = names.z;
    let point = vec4f(a, 1.0);
    daa_drawn.a = vec3f(dot(x, point), dot(y, point), dot(z, point));
    daa_drawn.plane = plane;
    daa_drawn.along_b = cross(ac, plane) * inverse_area;
    daa_drawn.along_c = cross(plane, ab) * inverse_area;
    daa_drawn.x = x.xyz;
    daa_drawn.y = y.xyz;
    daa_drawn.z = z.xyz;
    daa_drawn.attributes = daa_triangle_attributes(
        daa_meshes[corners.x + names.y],
        daa_meshes[corners.y + names.y],
        daa_meshes[corners.z + names.y],
        vec3u(word_a.w, word_b.w, word_c.w),
    );
    let normals = daa_drawn.attributes.normals;
    daa_drawn.flat = all(normals.xx == normals.yz);
    if daa_drawn.flat {
        let first = vec3f(1.0, 0.0, 0.0);
        daa_drawn.flat_codes = vec2u(
            pack2x16snorm(daa_octahedral_encode(daa_drawn_normal(first, -1.0))),
            pack2x16snorm(daa_octahedral_encode(daa_drawn_normal(first, 1.0))),
        );
    }
}

/// Where a ray meets the plane of the triangle.
struct DaaMeeting {
    point: vec3f,
    /// The weights of the second and the third vertex.
    weights: vec2f,
    /// Negative where the ray meets the side on which the vertices run counterclockwise.
    facing: f32,
}

/// The weights of the second and the third vertex at a point of the plane.
fn daa_weights_of(point: vec3f) -> vec2f {
    let from_a = point - daa_drawn.a;
    return vec2f(dot(from_a, daa_drawn.along_b), dot(from_a, daa_drawn.along_c));
}

/// `near` is the point of the near plane through which the ray runs, homogeneous. The plane is met as a whole, so it
/// makes no difference how much of the triangle lies behind the camera.
fn daa_meet(near: vec4f) -> DaaMeeting {
    var origin = vec3f(0.0);
    var direction = near.xyz * sign(near.w);
    if daa_frame.orthographic != 0u {
        origin = near.xyz / near.w;
        direction = daa_frame.camera_forward;
    }
    let facing = dot(daa_drawn.plane, direction);
    let point = origin + direction * (dot(daa_drawn.plane, daa_drawn.a - origin) / facing);
    return DaaMeeting(point, daa_weights_of(point), facing);
}

/// `DaaMeeting::facing` of the ray through a point of the near plane.
fn daa_facing(near: vec4f) -> f32 {
    let direction = select(near.xyz * sign(near.w), daa_frame.camera_forward, daa_frame.orthographic != 0u);
    return dot(daa_drawn.plane, direction);
}

/// The point of the near plane under the centre of a sample, homogeneous and relative to the camera.
fn daa_near_point(at: vec2u) -> vec4f {
    return daa_frame.relative_from_clip * vec4f(daa_ndc(vec2f(at) + 0.5), 1.0, 1.0);
}

/// The point of the triangle that a sample shows.
fn daa_shown_point(at: vec2u, near: vec4f) -> DaaMeeting {
    var met = daa_meet(near);
    let inside = all(met.weights > vec2f(-0.25)) && met.weights.x + met.weights.y < 1.25;
    let length = select(dot(near.xyz, near.xyz), 1.0, daa_frame.orthographic != 0u);
    if !inside || met.facing * met.facing < 1e-10 * length {
        // A sliver, or a triangle that is seen edge-on: the rasteriser's vertices lie on a grid, so its ray may pass by
        // the triangle. The depth is on the surface.
        met.point = daa_relative_position(vec2f(at) + 0.5, daa_depth_at(at));
        met.weights = daa_weights_of(met.point);
    }
    return met;
}

/// The weights of the three vertices, none below 0.
fn daa_inside(weights: vec2f) -> vec3f {
    // Written so that NaN becomes the first vertex.
    let w = select(vec2f(0.0), weights, weights > vec2f(0.0));
    let inner = w / max(w.x + w.y, 1.0);
    return vec3f(1.0 - inner.x - inner.y, inner);
}

/// Which side of the triangle is seen: 1 if its vertices run counterclockwise as they lie before the camera, otherwise
/// −1.
fn daa_drawn_side(facing: f32) -> f32 {
    return select(-1.0, 1.0, facing < 0.0);
}

/// The unit normal on the visible side.
fn daa_drawn_normal(w: vec3f, facing: f32) -> vec3f {
    let own = daa_triangle_normal(daa_drawn.attributes, w);
    // Normals go with the cofactors, as that of the plane does: where an instance mirrors its mesh, both turn around.
    // They also hold where the matrix is singular.
    let normal = vec3f(
        dot(cross(daa_drawn.y, daa_drawn.z), own),
        dot(cross(daa_drawn.z, daa_drawn.x), own),
        dot(cross(daa_drawn.x, daa_drawn.y), own),
    );
    let squared = dot(normal, normal);
    let unit = normal * (daa_drawn_side(facing) * inverseSqrt(max(squared, 1e-36)));
    return select(daa_drawn_plane(facing), unit, squared > 1e-30);
}

/// The unit normal of the triangle on the visible side.
fn daa_drawn_plane(facing: f32) -> vec3f {
    let plane = select(daa_drawn.plane, -daa_drawn.plane, facing > 0.0);
    return select(vec3f(0.0, 1.0, 0.0), plane, dot(plane, plane) > 0.25);
}

/// The code of the normal, and material | object << 16. Both are 0 where the host has drawn nothing.
fn daa_surface_at(at: vec2u) -> vec2u {
    let ids = daa_ids_at(at);
    if ids.x == 0u {
        return vec2u(0u);
    }
    daa_read_triangle(ids);
    let near = daa_near_point(at);
    if daa_drawn.flat {
        // The weights of the vertices make no difference.
        let code = select(daa_drawn.flat_codes.y, daa_drawn.flat_codes.x, daa_facing(near) < 0.0);
        return vec2u(code, daa_drawn.identity);
    }
    let met = daa_shown_point(at, near);
    let normal = daa_drawn_normal(daa_inside(met.weights), met.facing);
    return vec2u(pack2x16snorm(daa_octahedral_encode(normal)), daa_drawn.identity);
}

/// What two samples share that are known to show one triangle, or nothing.
fn daa_triangle_at(at: vec2u) -> vec2u {
    return daa_ids_at(at);
}

/// material | object << 16.
fn daa_identity_at(at: vec2u) -> u32 {
    let instance = daa_ids_at(at).x;
    if instance == 0u {
        return 0u;
    }
    return daa_instances[instance * 4u - 1u].z;
}

/// The codes of the normals of each lane's window, at 64 i + lane for its i-th sample. They are computed, so that none
/// should be read twice. The windows of m > 4 would leave room for few workgroups.
var<workgroup> daa_codes: array<u32, 1024>;

fn daa_keep_code(lane: u32, i: u32, code: u32) {
    if DAA_M <= 4u {
        daa_codes[64u * i + lane] = code;
    }
}

/// The code of the i-th sample of the lane's window, which lies at `at`.
fn daa_kept_code(lane: u32, i: u32, at: vec2u) -> u32 {
    if DAA_M <= 4u {
        return daa_codes[64u * i + lane];
    }
    return daa_surface_at(at).x;
}

fn daa_uv_at(at: vec2u) -> vec2f {
    let ids = daa_ids_at(at);
    if ids.x == 0u {
        return vec2f(0.0);
    }
    daa_read_triangle(ids);
    return daa_triangle_uv(daa_drawn.attributes, daa_inside(daa_shown_point(at, daa_near_point(at)).weights));
}

/// The host's 32 bits, interpolated as four bytes.
fn daa_user_at(at: vec2u) -> u32 {
    let ids = daa_ids_at(at);
    if ids.x == 0u {
        return 0u;
    }
    daa_read_triangle(ids);
    return daa_triangle_user(daa_drawn.attributes, daa_inside(daa_shown_point(at, daa_near_point(at)).weights));
}

/// The change of uv from one sample to the next along an axis, within the sample's quad, as rasterisers take it. Behind
/// the horizon of the plane it is taken on the other side. `step` leads from `near` to the next sample's.
fn daa_uv_change(place: u32, here: DaaMeeting, near: vec4f, step: vec4f) -> vec2f {
    let way = select(1.0, -1.0, (place & 1u) != 0u);
    var next = daa_meet(near + step * way);
    var apart = (next.weights - here.weights) * way;
    if next.facing * here.facing <= 0.0 {
        next = daa_meet(near - step * way);
        apart = (here.weights - next.weights) * way;
    }
    let change = daa_drawn.attributes.uv_ab * apart.x + daa_drawn.attributes.uv_ac * apart.y;
    let no_number = (bitcast<vec2u>(change) & vec2u(0x7f800000u)) == vec2u(0x7f800000u);
    return select(clamp(change, vec2f(-65504.0), vec2f(65504.0)), vec2f(0.0), no_number);
}

/// `d` is the sample's depth.
fn daa_attributes_at(at: vec2u, d: f32) -> DaaAttributes {
    var a: DaaAttributes;
    let ids = daa_ids_at(at);
    if ids.x == 0u || d <= DAA_SKY_DEPTH {
        a.relative_position = daa_relative_position(vec2f(at) + 0.5, 1.0);
        a.normal = vec3f(0.0, 0.0, 1.0);
        a.geometric_normal = a.normal;
        a.tangent = vec4f(1.0, 0.0, 0.0, 1.0);
        return a;
    }
    daa_read_triangle(ids);
    let near = daa_near_point(at);
    let met = daa_shown_point(at, near);
    let w = daa_inside(met.weights);
    a.relative_position = met.point;
    a.identity = daa_drawn.identity;
    a.normal = daa_drawn_normal(w, met.facing);
    a.geometric_normal = daa_drawn_plane(met.facing);
    let own = daa_triangle_tangent(daa_drawn.attributes, w);
    let along = vec3f(dot(daa_drawn.x, own.xyz), dot(daa_drawn.y, own.xyz), dot(daa_drawn.z, own.xyz));
    let across = along - a.normal * dot(a.normal, along);
    let squared = dot(across, across);
    let tangent = select(daa_basis_x(a.normal), across * inverseSqrt(max(squared, 1e-36)), squared > 1e-30);
    a.tangent = vec4f(tangent, own.w * daa_drawn_side(met.facing));
    a.user = daa_triangle_user(daa_drawn.attributes, w);
    a.uv = daa_triangle_uv(daa_drawn.attributes, w);
    let sample = daa_sample_ndc();
    a.ddx = daa_uv_change(at.x, met, near, daa_frame.relative_from_clip[0] * sample.x);
    a.ddy = daa_uv_change(at.y, met, near, daa_frame.relative_from_clip[1] * sample.y);
    return a;
}
