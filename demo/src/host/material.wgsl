// glTF materials by index: what raster.wgsl and shading.wgsl share. Each binds `materials` in its own group.

const NO_TEXTURE: u32 = 0xffffffffu;
const BASE_COLOR: u32 = 0u;
const METALLIC_ROUGHNESS: u32 = 1u;
const NORMAL: u32 = 2u;
const OCCLUSION: u32 = 3u;
const EMISSIVE: u32 = 4u;

// Bits of `Material.readings`: what a texture's sampler leaves to `material_texture`. 0 for most.
/// The nearest texel is read where the texture is magnified, and where it is minified.
const NEAREST_MAGNIFIED: u32 = 1u;
const NEAREST_MINIFIED: u32 = 2u;
/// The sampler mirrors, but the coordinate is clamped.
const CLAMP_U: u32 = 4u;
const CLAMP_V: u32 = 8u;
/// A copy or the mirror image is stored on the right, and the sampler repeats both.
const STORED_TWICE: u32 = 16u;

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
    /// For each texture; the last three are unused.
    readings: array<u32, 8>,
    /// KHR_texture_transform: two rows for each texture.
    transforms: array<vec4f, 10>,
    /// The size of each texture in texels: xy as its picture has it, zw as it is stored, once.
    texels: array<vec4f, 5>,
}

/// Where a texture is read, and over what.
struct Read {
    uv: vec2f,
    ddx: vec2f,
    ddy: vec2f,
}

/// The centre of the texel that uv lies in.
fn texel_centre(uv: vec2f, texels: vec2f) -> vec2f {
    return (floor(uv * texels) + 0.5) / texels;
}

/// Does what the sampler does not.
fn by_hand(asked: Read, reading: u32, texels: vec4f) -> Read {
    var read = asked;
    let footprint = max(length(asked.ddx * texels.xy), length(asked.ddy * texels.xy));
    if (reading & select(NEAREST_MINIFIED, NEAREST_MAGNIFIED, footprint <= 1.0)) != 0u {
        // At the centre of a texel, a linear filter reads that one alone. The stored texture may be larger than its
        // picture, so the centre is sought in both.
        let side = exp2(round(log2(max(footprint, 1.0))));
        read.uv = texel_centre(read.uv, max(floor(texels.xy / side), vec2f(1.0)));
        read.uv = texel_centre(read.uv, max(floor(texels.zw / side), vec2f(1.0)));
        read.ddx = vec2f(side / texels.z, 0.0);
        read.ddy = vec2f(0.0, side / texels.w);
    }
    let clamped = clamp(read.uv, vec2f(0.0), vec2f(1.0));
    read.uv = select(read.uv, clamped, (vec2u(reading) & vec2u(CLAMP_U, CLAMP_V)) != vec2u(0u));
    if (reading & STORED_TWICE) != 0u {
        read.uv.x *= 0.5;
        read.ddx.x *= 0.5;
        read.ddy.x *= 0.5;
    }
    return read;
}

fn material_texture(material: u32, which: u32, uv: vec2f, ddx: vec2f, ddy: vec2f) -> vec4f {
    let u = materials[material].transforms[which * 2u].xyz;
    let v = materials[material].transforms[which * 2u + 1u].xyz;
    var read: Read;
    read.uv = vec2f(dot(u, vec3f(uv, 1.0)), dot(v, vec3f(uv, 1.0)));
    read.ddx = vec2f(dot(u.xy, ddx), dot(v.xy, ddx));
    read.ddy = vec2f(dot(u.xy, ddy), dot(v.xy, ddy));
    if materials[material].readings[which] != 0u {
        read = by_hand(read, materials[material].readings[which], materials[material].texels[which]);
    }
    return daa_texture(materials[material].textures[which], read.uv, read.ddx, read.ddy);
}
