// The textures of a material.

fn textured(plain: DaaMaterial, s: DaaSample, index: u32) -> DaaMaterial {
    let textures = materials[index].textures;
    var m = plain;
    if textures[BASE_COLOR] != NO_TEXTURE {
        m.base_color *= material_texture(index, BASE_COLOR, s.uv, s.ddx, s.ddy);
    }
    if textures[METALLIC_ROUGHNESS] != NO_TEXTURE {
        let t = material_texture(index, METALLIC_ROUGHNESS, s.uv, s.ddx, s.ddy);
        m.roughness *= t.g;
        m.metallic *= t.b;
    }
    if textures[NORMAL] != NO_TEXTURE {
        let t = material_texture(index, NORMAL, s.uv, s.ddx, s.ddy).xyz * 2.0 - 1.0;
        m.normal = daa_apply_normal_map(s, vec3f(t.xy * materials[index].normal_scale, t.z));
    }
    if textures[OCCLUSION] != NO_TEXTURE {
        let t = material_texture(index, OCCLUSION, s.uv, s.ddx, s.ddy).r;
        m.occlusion = 1.0 + materials[index].occlusion_strength * (t - 1.0);
    }
    if textures[EMISSIVE] != NO_TEXTURE {
        m.emissive *= material_texture(index, EMISSIVE, s.uv, s.ddx, s.ddy).rgb;
    }
    return m;
}
