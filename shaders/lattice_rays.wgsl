// The values of a lattice of points that cast rays: where those of all samples are.

@group(3) @binding(0) var<uniform> daa_step: DaaStep;
@group(3) @binding(1) var<storage, read_write> daa_points: array<u32>;
@group(3) @binding(2) var<storage, read_write> daa_shadows: array<u32>;
@group(3) @binding(3) var<storage, read_write> daa_secondary: array<u32>;

/// What is reflected and refracted, and 1 if anything was traced for it.
fn daa_value(index: u32, point: DaaPoint) -> vec4f {
    if (daa_step.rays & 2u) == 0u {
        return vec4f(0.0);
    }
    let code = daa_secondary[daa_sample_index(point.pixel, point.rank)];
    return vec4f(daa_radiance_decode(code), f32(code != 0u));
}

fn daa_bits(point: DaaPoint, valid: bool) -> u32 {
    return select(0u, daa_shadow_at(point), valid);
}

fn daa_shadow_at(point: DaaPoint) -> u32 {
    if (daa_step.rays & 1u) == 0u {
        return 0u;
    }
    return daa_shadows[daa_sample_index(point.pixel, point.rank)];
}

fn daa_put(index: u32, point: DaaPoint, value: vec4f, bits: u32) {
    let at = daa_sample_index(point.pixel, point.rank);
    if (daa_step.rays & 1u) != 0u {
        daa_shadows[at] = bits;
    }
    if (daa_step.rays & 2u) != 0u {
        daa_secondary[at] = select(0u, daa_radiance_encode(value.rgb), value.a > 0.0);
    }
}

/// Both are one sample.
fn daa_keep(index: u32, value: vec4f) {}
