// Packs what decides where samples are needed from Bevy's deferred G-buffer into the node's. `daa_pack` precedes this.

@group(0) @binding(0) var texels: texture_2d<u32>;
@group(0) @binding(1) var lighting_passes: texture_2d<u32>;

/// The unit vector of an octahedral code in 0 to 1.
fn normal_of(code: vec2f) -> vec3f {
    let v = code * 2.0 - 1.0;
    var n = vec3f(v, 1.0 - abs(v.x) - abs(v.y));
    let below = max(-n.z, 0.0);
    n.x += select(below, -below, n.x >= 0.0);
    n.y += select(below, -below, n.y >= 0.0);
    return normalize(n);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> DaaGBuffer {
    let at = vec2u(position.xy);
    let texel = textureLoad(texels, at, 0);
    let flags = texel.a >> 24u;
    var f: DaaFragment;
    f.normal = normal_of(vec2f(vec2u(texel.a, texel.a >> 12u) & vec2u(0xfffu)) / 4095.0);
    // Samples of different lighting passes or flags are of different surfaces.
    f.material = textureLoad(lighting_passes, at, 0).r | (flags << 8u);
    // Base colour and roughness; where nothing is lit, the colour itself.
    f.user = select(texel.r, texel.g, (flags & 1u) != 0u);
    return daa_pack(f);
}
