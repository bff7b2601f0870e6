// glTF materials by index: what raster.wgsl and shading.wgsl share. Each binds `materials` in its own group.

const NO_TEXTURE: u32 = 0xffffffffu;
const BASE_COLOR: u32 = 0u;
const METALLIC_ROUGHNESS: u32 = 1u;
const NORMAL: u32 = 2u;
const OCCLUSION: u32 = 3u;
const EMISSIVE: u32 = 4u;

struct Material {
    base_color: vec4f,
    emissive: vec3f,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    alpha_cutoff: f32,
    /// Indices into the texture table.
    textures: array<u32, 5>,
    unlit: u32,
    transmission: f32,
    /// 1 for a thin wall.
    ior: f32,
    /// KHR_texture_transform: two rows for each texture.
    transforms: array<vec4f, 10>,
}

fn material_texture(material: u32, which: u32, uv: vec2f, ddx: vec2f, ddy: vec2f) -> vec4f {
    let u = materials[material].transforms[which * 2u].xyz;
    let v = materials[material].transforms[which * 2u + 1u].xyz;
    return daa_texture(
        materials[material].textures[which],
        vec2f(dot(u, vec3f(uv, 1.0)), dot(v, vec3f(uv, 1.0))),
        vec2f(dot(u.xy, ddx), dot(v.xy, ddx)),
        vec2f(dot(u.xy, ddy), dot(v.xy, ddy)),
    );
}
