// Radiance about as a display shows it: x/(1+x) of what is exposed, and a square root. Needs frame.wgsl.

/// As metrics see it: exposed, and on request as a display shows it.
fn daa_shown(c: vec3f) -> vec3f {
    // The product may be infinite, and ∞/∞ is no number.
    let l = min(c * daa_frame.exposure, vec3f(1e30));
    return select(l, sqrt(l / (1.0 + l)), daa_flag(DAA_FLAG_LUMINANCE_PERCEPTUAL));
}
