// An approximation of the displayed value of radiance: x/(1+x) of the exposed radiance, and a square root.

/// Radiance as the metrics see it: exposed, and on the display curve if the settings ask for it.
fn daa_shown(c: vec3f) -> vec3f {
    // The product may be infinite, and ∞/∞ is NaN.
    let l = min(c * daa_frame.exposure, vec3f(1e30));
    return select(l, sqrt(l / (1.0 + l)), daa_flag(DAA_FLAG_LUMINANCE_PERCEPTUAL));
}
