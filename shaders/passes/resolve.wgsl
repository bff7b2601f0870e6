// resolve: writes the image into the host's target, clamped to the target's range. There is an entry point for each
// resource that may hold the image. CPU twin: src/reference/resolve.rs.

/// The greatest finite value of the target's format.
override DAA_TARGET_MAX: f32 = 1.0;

@group(3) @binding(0) var daa_first: texture_2d<f32>;
@group(3) @binding(1) var daa_color: texture_2d<f32>;
@group(3) @binding(2) var<storage, read> daa_plan: array<u32>;
@group(3) @binding(3) var<storage, read> daa_lattice_colors: array<vec4f>;

fn daa_in_range(c: vec4f) -> vec4f {
    // Clamped first, since f16 turns 65520 into infinity.
    return clamp(c, vec4f(0.0), vec4f(vec3f(DAA_TARGET_MAX), min(DAA_TARGET_MAX, 1.0)));
}

/// For frames whose image is S.
@fragment
fn daa_resolve_first(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return daa_in_range(textureLoad(daa_first, daa_target_pixel(position), 0));
}

/// For frames in which every pixel has a mean.
@fragment
fn daa_resolve_color(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return daa_in_range(textureLoad(daa_color, daa_target_pixel(position), 0));
}

/// For frames with a plan: windows with k > 1 have a mean, the others their first sample.
@fragment
fn daa_resolve_by_plan(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = daa_target_pixel(position);
    if daa_plan_k(daa_plan[daa_slot(pixel)]) > 1u {
        return daa_in_range(textureLoad(daa_color, pixel, 0));
    }
    return daa_in_range(textureLoad(daa_first, pixel, 0));
}

/// For frames whose image is the lattice of pixels, which is the first of all lattices and has one column beyond the
/// image.
@fragment
fn daa_resolve_lattice(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = daa_target_pixel(position);
    return daa_in_range(daa_lattice_colors[pixel.y * (daa_frame.size.x + 1u) + pixel.x]);
}
