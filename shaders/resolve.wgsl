// resolve: writes the image into the host's target, in the target's range. CPU twin: src/reference/resolve.rs.

/// The greatest value that the target's format holds as a finite number.
override DAA_TARGET_MAX: f32 = 1.0;
/// Where the image lies: 0 in S, 1 in the shaded image, 2 in either as the plan says, 3 on the lattice of the pixels.
override DAA_SOURCE: u32 = 0u;

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var daa_color: texture_2d<f32>;
@group(3) @binding(2) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(3) var<storage, read> daa_lattice_colors: array<vec4f>;

@vertex
fn daa_resolve_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn daa_plan_word(pixel: vec2u) -> u32 {
    let tile = (pixel.y >> 3u) * daa_frame.tiles_x + (pixel.x >> 3u);
    return daa_plan[tile * 64u + (pixel.y & 7u) * 8u + (pixel.x & 7u)];
}

@fragment
fn daa_resolve_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    var shaded = DAA_SOURCE == 1u;
    if DAA_SOURCE == 2u {
        shaded = (daa_plan_word(pixel) & 0xffu) > 1u;
    }
    var c: vec4f;
    if DAA_SOURCE == 3u {
        // The first of all lattices, with a column beyond the image.
        c = daa_lattice_colors[pixel.y * (daa_frame.size.x + 1u) + pixel.x];
    } else if shaded {
        c = textureLoad(daa_color, pixel, 0);
    } else {
        c = textureLoad(daa_first, pixel, 0);
    }
    // f16 turns 65520 into infinity: clamp first.
    return clamp(c, vec4f(0.0), vec4f(vec3f(DAA_TARGET_MAX), min(DAA_TARGET_MAX, 1.0)));
}
