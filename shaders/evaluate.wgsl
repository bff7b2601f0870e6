// One sample from G-buffer to clean radiance: what `first` and `shade` share. The join makes `daa_call_hook` and
// `daa_call_sky` from the host's functions.

/// How far the first k samples lie from the window's centre on average, in samples: the shift that recentres the
/// texture footprint of what they stand for. Zero if the settings do not ask for it.
fn daa_centre(k: u32) -> vec2f {
    let pair = daa_frame.centres[(k - 1u) >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 0u);
}

fn daa_shade_sample(pixel: vec2u, rank: u32, footprint: f32, offset: vec2f) -> vec4f {
    let s = daa_fetch(pixel, rank, footprint, offset);
    var radiance: vec4f;
    if s.depth == 0.0 {
        radiance = daa_call_sky(s);
    } else {
        // footprint² of the window's n samples stand behind this one.
        radiance = daa_call_hook(s, footprint * footprint / f32(DAA_M * DAA_M));
    }
    let clean = daa_clean(radiance);
    if clean.what == DAA_NOT_FINITE {
        atomicAdd(&daa_statistics.not_finite, 1u);
    } else if clean.what == DAA_NEGATIVE {
        atomicAdd(&daa_statistics.negative, 1u);
    }
    return clean.color;
}
