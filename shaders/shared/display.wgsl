// An approximation of the displayed value of radiance: x/(1+x) of the exposed radiance, and a square root.

fn daa_exposed(c: vec3f) -> vec3f {
    // The product may be infinite, and ∞/∞ is NaN.
    return min(c * daa_frame.exposure, vec3f(1e30));
}

/// Radiance on the display curve.
fn daa_displayed(c: vec3f) -> vec3f {
    let l = daa_exposed(c);
    return sqrt(l / (1.0 + l));
}

/// The greatest difference of a channel.
fn daa_greatest_channel(c: vec3f) -> f32 {
    return max(c.r, max(c.g, c.b));
}

/// Radiance as the metrics see it: exposed, and on the display curve if the settings ask for it.
fn daa_shown(c: vec3f) -> vec3f {
    return select(daa_exposed(c), daa_displayed(c), daa_flag(DAA_FLAG_LUMINANCE_PERCEPTUAL));
}
