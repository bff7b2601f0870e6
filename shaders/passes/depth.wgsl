// depth: writes depth at the output's size, reversed as in the G-buffer: 1 is near, 0 is far and the sky. CPU twin:
// src/reference/resolve/depth.rs.

/// The depth of a sample as its bits, which are ordered as numbers from 0 up are: within 0 to 1, and 0 if it is not a
/// number or negative.
fn daa_depth_bits(at: vec2u) -> u32 {
    let bits = bitcast<u32>(daa_depth_at(at));
    // The sign is the greatest bit, and NaN lies above infinity.
    return select(min(bits, 0x3f800000u), 0u, bits > 0x7f800000u);
}

/// The least and the greatest of the pixel's samples.
fn daa_depth_range(position: vec4f) -> vec2u {
    let corner = daa_target_pixel(position) * DAA_M;
    var range = vec2u(0x3f800000u, 0u);
    for (var y = 0u; y < DAA_M; y++) {
        for (var x = 0u; x < DAA_M; x++) {
            let bits = daa_depth_bits(corner + vec2u(x, y));
            range = vec2u(min(range.x, bits), max(range.y, bits));
        }
    }
    return range;
}

@fragment
fn daa_depth_nearest(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    return bitcast<f32>(daa_depth_range(position).y);
}

@fragment
fn daa_depth_farthest(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    return bitcast<f32>(daa_depth_range(position).x);
}

@fragment
fn daa_depth_first(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    return bitcast<f32>(daa_depth_bits(daa_target_pixel(position) * DAA_M + daa_order(0u)));
}
