// The fragments of a stored G-buffer. Joined with the packing, the texture table, material.wgsl, vertices.wgsl
// and raster.wgsl.

fn fragment(v: Varying, front: bool, ddx: vec2f, ddy: vec2f, across: vec3f, down: vec3f) -> DaaGBuffer {
    let instance = instances[v.instance];
    let own = facing(v, front, across, down);
    var f: DaaFragment;
    f.normal = own.normal;
    f.geometric_normal = own.geometric_normal;
    f.tangent = own.tangent;
    f.uv = v.uv;
    f.ddx = ddx;
    f.ddy = ddy;
    f.material = instance.material;
    f.object = instance.object;
    f.user = pack4x8unorm(v.color);
    return daa_pack(f);
}

@fragment
fn raster_opaque(v: Varying, @builtin(front_facing) front: bool) -> DaaGBuffer {
    return fragment(v, front, dpdx(v.uv), dpdy(v.uv), dpdx(v.relative), dpdy(v.relative));
}

/// Alpha is tested at the G-buffer's resolution, so that cut-outs are anti-aliased like any edge.
@fragment
fn raster_mask(v: Varying, @builtin(front_facing) front: bool) -> DaaGBuffer {
    let ddx = dpdx(v.uv);
    let ddy = dpdy(v.uv);
    let packed = fragment(v, front, ddx, ddy, dpdx(v.relative), dpdy(v.relative));
    if is_hole(v) {
        discard;
    }
    return packed;
}
