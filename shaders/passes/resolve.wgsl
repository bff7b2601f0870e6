// resolve: writes the image into the host's target, in the target's range. Joined with fullscreen.wgsl; an entry point for each place
// that the image may lie in. CPU twin: src/reference/resolve.rs.

/// The greatest value that the target's format holds as a finite number.
override DAA_TARGET_MAX: f32 = 1.0;

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var daa_color: texture_2d<f32>;
@group(3) @binding(2) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(3) var<storage, read> daa_lattice_colors: array<vec4f>;

fn daa_in_range(c: vec4f) -> vec4f {
    // f16 turns 65520 into infinity: clamp first.
    return clamp(c, vec4f(0.0), vec4f(vec3f(DAA_TARGET_MAX), min(DAA_TARGET_MAX, 1.0)));
}

/// S is the image.
@fragment
fn daa_resolve_first(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return daa_in_range(textureLoad(daa_first, vec2u(position.xy), 0));
}

/// Every pixel has its mean.
@fragment
fn daa_resolve_color(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return daa_in_range(textureLoad(daa_color, vec2u(position.xy), 0));
}

/// Windows with k > 1 have a mean, the others their first sample.
@fragment
fn daa_resolve_by_plan(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    if daa_plan_k(daa_plan[daa_slot(pixel)]) > 1u {
        return daa_in_range(textureLoad(daa_color, pixel, 0));
    }
    return daa_in_range(textureLoad(daa_first, pixel, 0));
}

/// The lattice of the pixels is the first of all, with a column beyond the image.
@fragment
fn daa_resolve_lattice(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    return daa_in_range(daa_lattice_colors[pixel.y * (daa_frame.size.x + 1u) + pixel.x]);
}
