// A visibility buffer: vertices with no more than their position, and fragments that name their triangle. Joined with
// the packing, the texture table, material.wgsl, vertices.wgsl and raster.wgsl.

struct Placed {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) instance: u32,
}

@vertex
fn ids_vertex(@location(0) position: vec3f, @builtin(instance_index) index: u32) -> Placed {
    let i = instances[index];
    let p = vec4f(position, 1.0);
    let relative = vec3f(dot(i.rows[0], p), dot(i.rows[1], p), dot(i.rows[2], p));
    return Placed(view.clip_from_relative * vec4f(relative, 1.0), index);
}

@fragment
fn ids_opaque(v: Placed, @builtin(primitive_index) triangle: u32) -> DaaGBuffer {
    return daa_pack(v.instance, triangle);
}

@fragment
fn ids_mask(v: Varying, @builtin(primitive_index) triangle: u32) -> DaaGBuffer {
    if is_hole(v) {
        discard;
    }
    return daa_pack(v.instance, triangle);
}
