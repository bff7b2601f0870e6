// The hooks of deferred-aa on Bevy's lighting (shading.wesl).

/// Bevy's deferred G-buffer, rendered beside the node's.
@group(2) @binding(100) var deferred_aa_texels: texture_2d<u32>;

struct DeferredAaView {
    /// The first pixel of the viewport.
    origin: vec2u,
    /// The deferred lighting pass that is Bevy's own: `PbrDeferredLightingDepthId` of the camera.
    lighting_pass: u32,
    padding: u32,
}
@group(2) @binding(101) var<uniform> deferred_aa_view: DeferredAaView;

fn material(s: DaaSample) -> DaaMaterial {
    let b = bevy_material(textureLoad(deferred_aa_texels, s.texel, 0));
    var m: DaaMaterial;
    m.base_color = vec4f(b.base_color, 1.0);
    m.emissive = b.emissive;
    m.roughness = b.perceptual_roughness;
    m.normal = b.normal;
    m.metallic = b.metallic;
    m.user0 = vec4f(b.reflectance, b.clearcoat, b.clearcoat_perceptual_roughness, 0.0);
    m.occlusion = b.diffuse_occlusion;
    return m;
}

fn light(f: DaaSurface, m: DaaMaterial) -> vec4f {
    // What another pass lights keeps what that pass has drawn below.
    if (f.material & 0xffu) != deferred_aa_view.lighting_pass {
        return vec4f(0.0);
    }
    let normal = m.normal * inverseSqrt(max(dot(m.normal, m.normal), 1e-20));
    let b = BevyMaterial(m.base_color.rgb, m.roughness, m.emissive, m.metallic, normal, m.occlusion, m.user0.x, m.user0.y, m.user0.z);
    return vec4f(bevy_light(b, f.material >> 8u, f.position, f.view).rgb, 1.0);
}
