// Shades one sample of the G-buffer with the host's functions, which are called through the generated `daa_call_hook`
// and `daa_call_sky`.

/// Shades a sample of a window in which k samples are shaded. It stands for n/k samples, so its texture footprint is
/// √(n/k) times its own (Holländer et al. 2013, section 4.1, which leaves the formula out), times a setting, and never
/// smaller than its own. On request the texture lookup is shifted so that the k footprints together are centred on the
/// pixel.
fn daa_shade_sample(pixel: vec2u, rank: u32, k: u32) -> vec4f {
    let footprint = max(f32(DAA_M) * inverseSqrt(f32(k)) * daa_frame.footprint, 1.0);
    let pair = daa_frame.centres[(k - 1u) >> 1u];
    let s = daa_fetch(pixel, rank, footprint, select(pair.xy, pair.zw, (k & 1u) == 0u));
    var radiance: vec4f;
    if s.depth == 0.0 {
        radiance = daa_call_sky(s);
    } else {
        radiance = daa_call_hook(s, 1.0 / f32(k));
    }
    let clean = daa_clean(radiance);
    if clean.what == DAA_NOT_FINITE {
        atomicAdd(&daa_statistics.not_finite, 1u);
    } else if clean.what == DAA_NEGATIVE {
        atomicAdd(&daa_statistics.negative, 1u);
    }
    return clean.color;
}

fn daa_weighted(mean: DaaMean, c: vec4f) -> DaaMean {
    let by_luminance = daa_flag(DAA_FLAG_WEIGHT_LUMINANCE);
    return daa_mean_add(mean, c, daa_weight(c, by_luminance, daa_frame.exposure));
}
