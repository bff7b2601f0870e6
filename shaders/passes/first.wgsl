// first: shades the rank-0 sample of every window into S (Holländer et al. 2013, listing 1, ShadeFirstSample).

@group(3) @binding(0) var daa_first: texture_storage_2d<rgba32float, write>;
@group(3) @binding(1) var<storage, read_write> daa_statistics: DaaStatistics;

/// Whether the rank-0 sample stands for its whole window: the window has one material and object, and its corners lie
/// on one plane by their reversed-z depths, which are linear in screen space, and by their normals (within about 4°).
/// Other windows will get more samples, of which the first is one of many.
fn daa_stands_for_all(pixel: vec2u) -> bool {
    let corner = pixel * DAA_M;
    let far = DAA_M - 1u;
    let at_b = corner + vec2u(far, 0u);
    let at_c = corner + vec2u(0u, far);
    let at_d = corner + far;
    let own = daa_seen_identity(corner);
    if any(own != daa_seen_identity(at_b)) || any(own != daa_seen_identity(at_c)) || any(own != daa_seen_identity(at_d)) {
        return false;
    }
    let depth = vec4f(daa_depth_at(corner), daa_depth_at(at_b), daa_depth_at(at_c), daa_depth_at(at_d));
    let bend = abs((depth.x - depth.y) - (depth.z - depth.w));
    if !(bend <= 1e-3 * max(max(depth.x, depth.y), max(depth.z, depth.w))) {
        return false;
    }
    let codes = mat4x2f(
        unpack2x16snorm(daa_surface_at(corner).x),
        unpack2x16snorm(daa_surface_at(at_b).x),
        unpack2x16snorm(daa_surface_at(at_c).x),
        unpack2x16snorm(daa_surface_at(at_d).x),
    );
    let spread = max(max(codes[0], codes[1]), max(codes[2], codes[3])) - min(min(codes[0], codes[1]), min(codes[2], codes[3]));
    return max(spread.x, spread.y) < 0.05;
}

@compute @workgroup_size(8, 8)
fn daa_first_main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= daa_frame.size) {
        return;
    }
    var alone = !daa_flag(DAA_FLAG_EDGE_AWARE_FIRST);
    if !alone && daa_frame.least_samples < 1.5 {
        alone = daa_stands_for_all(id.xy);
    }
    textureStore(daa_first, id.xy, daa_shade_sample(id.xy, 0u, select(DAA_M * DAA_M, 1u, alone)));
}
