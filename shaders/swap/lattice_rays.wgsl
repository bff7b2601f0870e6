// The values of a lattice whose points cast rays: shadow bits, and reflected and refracted radiance. They are stored
// with the points, and for points in the image also among the ray results of all samples.

@group(3) @binding(0) var<uniform> daa_step: DaaStep;
@group(3) @binding(1) var<storage, read_write> daa_points: array<vec4u>;
@group(3) @binding(2) var<storage, read_write> daa_shadows: array<u32>;
@group(3) @binding(3) var<storage, read_write> daa_reflections: array<u32>;

/// The reflected and refracted radiance, with 1 in w if anything was traced.
fn daa_value(index: u32, point: DaaPoint) -> vec4f {
    if (daa_step.rays & 2u) == 0u {
        return vec4f(0.0);
    }
    let code = daa_points[index + daa_step.found].y;
    return vec4f(daa_radiance_decode(code), f32(code != 0u));
}

fn daa_bits(index: u32) -> u32 {
    return daa_points[index + daa_step.found].x;
}

fn daa_shadow_at(index: u32, point: DaaPoint) -> u32 {
    return daa_bits(index);
}

fn daa_put(index: u32, point: DaaPoint, value: vec4f, bits: u32) {
    let code = select(0u, daa_radiance_encode(value.rgb), value.a > 0.0);
    daa_points[index + daa_step.found] = vec4u(bits, code, 0u, 0u);
    if !point.inside {
        return;
    }
    let at = daa_sample_index(point.pixel, point.rank);
    if (daa_step.rays & 1u) != 0u {
        daa_shadows[at] = bits;
    }
    if (daa_step.rays & 2u) != 0u {
        daa_reflections[at] = code;
    }
}

/// Copies the value of a coarser point to the same point of the finer lattice.
fn daa_keep(index: u32, coarser: u32) {
    daa_points[index + daa_step.found] = daa_points[coarser + daa_step.found];
}

/// `trace` and `reflect` write the value later.
fn daa_leave(index: u32) {
    daa_points[index + daa_step.found] = vec4u(0u);
}
