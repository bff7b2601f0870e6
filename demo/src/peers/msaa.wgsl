// Forward shading into a target of several samples a pixel. Joined with fragment.wgsl and what that takes.

/// Camera-relative from clip space.
@group(0) @binding(2) var<uniform> relative_from_clip: mat4x4f;

@fragment
fn msaa_opaque(v: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return vec4f(shaded(v, front).rgb, 1.0);
}

/// The alpha is a coverage: 1/2 at the cut-off, rising from 0 to 1 over a pixel, so that cut-outs are anti-aliased, too
/// (Golus 2017, "Anti-aliased Alpha Test: The Esoteric Alpha To Coverage").
@fragment
fn msaa_mask(v: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let c = shaded(v, front);
    let cutoff = materials[instances[v.instance].material].alpha_cutoff;
    return vec4f(c.rgb, clamp((c.a - cutoff) / max(fwidth(c.a), 1e-4) + 0.5, 0.0, 1.0));
}

struct SkyVarying {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn msaa_sky_vertex(@builtin(vertex_index) index: u32) -> SkyVarying {
    // One triangle that covers the view, infinitely far.
    let ndc = vec2f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
    return SkyVarying(vec4f(ndc, 0.0, 1.0), ndc);
}

@fragment
fn msaa_sky(v: SkyVarying) -> @location(0) vec4f {
    let near = relative_from_clip * vec4f(v.ndc, 1.0, 1.0);
    var s: DaaSample;
    s.view = normalize(towards_camera(near.xyz / near.w));
    s.pixel = vec2u(v.clip.xy);
    return vec4f(min(sky(s).rgb, vec3f(MOST)), 1.0);
}
