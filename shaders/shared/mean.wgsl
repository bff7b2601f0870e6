// Weighted means of shaded samples, and the clean-up of samples before they enter a mean. Declares no bindings.

/// The state of a shaded sample before its clean-up, for the statistics.
const DAA_GOOD: u32 = 0u;
const DAA_NOT_FINITE: u32 = 1u;
const DAA_NEGATIVE: u32 = 2u;

/// A sample after its clean-up: NaN and infinity become opaque black, negative components become 0, and values are
/// limited to 1e30, so that a sum of 64 stays finite. NaN is recognised by its bits, since a compiler may assume that
/// it never occurs.
struct DaaClean {
    color: vec4f,
    what: u32,
}

fn daa_clean(c: vec4f) -> DaaClean {
    let exponents = bitcast<vec4u>(c) & vec4u(0x7f800000u);
    if any(exponents == vec4u(0x7f800000u)) {
        return DaaClean(vec4f(0.0, 0.0, 0.0, 1.0), DAA_NOT_FINITE);
    }
    let what = select(DAA_GOOD, DAA_NEGATIVE, any(c < vec4f(0.0)));
    return DaaClean(clamp(c, vec4f(0.0), vec4f(1e30)), what);
}

/// The running sum of a pixel: Σ w c and Σ w.
struct DaaMean {
    sum: vec4f,
    weight: f32,
}

/// The weight of a sample: 1, or 1/(1 + luminance) against fireflies (Karis 2014, "High Quality Temporal
/// Supersampling", slide 19).
fn daa_weight(c: vec4f, by_luminance: bool, exposure: f32) -> f32 {
    // The product may be infinite, and all weights would be 0.
    return select(1.0, 1.0 / (1.0 + min(daa_luminance(c.rgb) * exposure, 1e30)), by_luminance);
}

fn daa_mean_add(mean: DaaMean, c: vec4f, weight: f32) -> DaaMean {
    return DaaMean(mean.sum + c * weight, mean.weight + weight);
}

fn daa_mean_finish(mean: DaaMean) -> vec4f {
    return mean.sum / mean.weight;
}
