// The demo's shading: glTF metallic-roughness under a sun, punctual lights and a sky. Joined with material.wgsl, which
// goes first, and textured.wgsl or untextured.wgsl.

struct Lighting {
    /// Towards the sun.
    to_sun: vec3f,
    light_count: u32,
    /// Irradiance at normal incidence.
    sun: vec3f,
    /// How often the light loop runs.
    stall: u32,
    zenith: vec4f,
    horizon: vec4f,
    ground: vec4f,
    /// World space. Lights are taken relative to it, as surfaces are, so that worlds may be large.
    camera: vec3f,
    /// The sun's shadow bit.
    sun_casts: u32,
}

struct Light {
    position: vec3f,
    /// 0: not limited.
    inverse_range: f32,
    intensity: vec3f,
    /// 0 point, 1 spot, 2 directional.
    kind: u32,
    /// In which it shines.
    direction: vec3f,
    spot_scale: f32,
    spot_offset: f32,
    /// Its shadow bit, 0 if it casts none.
    casts: u32,
    padding: array<u32, 2>,
}

@group(2) @binding(0) var<uniform> lighting: Lighting;
@group(2) @binding(1) var<storage, read> lights: array<Light>;
@group(2) @binding(2) var<storage, read> materials: array<Material>;

fn sky_radiance(d: vec3f) -> vec3f {
    let up = mix(lighting.horizon.rgb, lighting.zenith.rgb, sqrt(clamp(d.y, 0.0, 1.0)));
    return select(mix(lighting.horizon.rgb, lighting.ground.rgb, clamp(-d.y * 4.0, 0.0, 1.0)), up, d.y >= 0.0);
}

fn sky(s: DaaSample) -> vec4f {
    return vec4f(sky_radiance(-s.view), 1.0);
}

fn material(s: DaaSample) -> DaaMaterial {
    let index = min(s.material, arrayLength(&materials) - 1u);
    let tint = unpack4x8unorm(s.user);
    var m: DaaMaterial;
    m.base_color = materials[index].base_color * tint;
    m.emissive = materials[index].emissive;
    m.roughness = materials[index].roughness;
    m.metallic = materials[index].metallic;
    m.normal = s.normal;
    m.occlusion = 1.0;
    m.user0 = vec4f(f32(materials[index].unlit), materials[index].transmission, materials[index].ior, 0.0);
    m = textured(m, s, index);
    m.emissive = select(m.emissive, vec3f(0.0), materials[index].unlit != 0u);
    return m;
}

/// Where a masked material stops a ray: at the finest mip, for a ray has no footprint here.
fn solid(material: u32, uv: vec2f, user: u32) -> bool {
    let index = min(material, arrayLength(&materials) - 1u);
    var alpha = materials[index].base_color.a * unpack4x8unorm(user).a;
    if materials[index].textures[BASE_COLOR] != NO_TEXTURE {
        alpha *= material_texture(index, BASE_COLOR, uv, vec2f(0.0), vec2f(0.0)).a;
    }
    return alpha >= materials[index].alpha_cutoff;
}

/// Perceptual roughness up to which metal and glass are mirrors: `MIRROR_ROUGHNESS` of rays.rs.
const MIRROR_ROUGHNESS: f32 = 0.2;

/// Schlick's share of what is mirrored.
fn mirrored_share(m: DaaMaterial, n_dot_v: f32) -> vec3f {
    let f0 = mix(vec3f(0.04), m.base_color.rgb, m.metallic);
    return f0 + (1.0 - f0) * pow(1.0 - clamp(n_dot_v, 0.0, 1.0), 5.0);
}

fn reflection(s: DaaSample) -> DaaReflection {
    let m = material(s);
    var b: DaaReflection;
    b.normal = m.normal * inverseSqrt(max(dot(m.normal, m.normal), 1e-12));
    b.ior = m.user0.z;
    let smooth_enough = m.roughness <= MIRROR_ROUGHNESS && (m.metallic >= 0.5 || m.user0.y > 0.0);
    if smooth_enough && m.user0.x < 0.5 {
        let mirrored = mirrored_share(m, dot(b.normal, s.view));
        b.reflection = mirrored;
        b.refraction = (1.0 - mirrored) * (m.user0.y * (1.0 - m.metallic)) * m.base_color.rgb;
    }
    return b;
}

struct Brdf {
    /// The share of the base colour that is diffuse albedo, and that is mirrored at normal incidence.
    diffuse: f32,
    metallic: f32,
    /// The share that is mirrored at normal incidence whatever the colour is.
    dielectric: f32,
    f0: vec3f,
    alpha: f32,
    normal: vec3f,
    view: vec3f,
    n_dot_v: f32,
}

/// Lambert and GGX with height-correlated Smith visibility (Heitz 2014) and Schlick's Fresnel term, as glTF's appendix
/// B. Times n·l.
fn reflected(b: Brdf, l: vec3f) -> DaaLight {
    let n_dot_l = dot(b.normal, l);
    if n_dot_l <= 0.0 {
        return DaaLight();
    }
    let sum = b.view + l;
    let h = sum * inverseSqrt(max(dot(sum, sum), 1e-12));
    let n_dot_h = clamp(dot(b.normal, h), 0.0, 1.0);
    let v_dot_h = clamp(dot(b.view, h), 0.0, 1.0);
    let a2 = b.alpha * b.alpha;
    let q = (n_dot_h * a2 - n_dot_h) * n_dot_h + 1.0;
    let distribution = a2 / (3.14159265 * q * q);
    let visibility = 0.5
        / (n_dot_l * sqrt(b.n_dot_v * b.n_dot_v * (1.0 - a2) + a2) + b.n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2));
    let grazing = pow(1.0 - v_dot_h, 5.0);
    let lost = 1.0 - grazing;
    let fresnel = b.f0 * lost + grazing;
    let mirrored = distribution * visibility;
    let by_color = b.diffuse * (1.0 - fresnel) / 3.14159265 + mirrored * (b.metallic * lost);
    let rest = mirrored * (b.dielectric * lost + grazing);
    return DaaLight(by_color * n_dot_l, vec4f(vec3f(rest * n_dot_l), 0.0));
}

fn lit(f: DaaSurface, b: Brdf) -> DaaLight {
    var sum: DaaLight;
    if (f.shadow & lighting.sun_casts) == 0u {
        let by_sun = reflected(b, lighting.to_sun);
        sum.diffuse = by_sun.diffuse * lighting.sun;
        sum.rest = by_sun.rest * vec4f(lighting.sun, 0.0);
    }
    for (var i = 0u; i < lighting.light_count; i++) {
        let light = lights[i];
        if (f.shadow & light.casts) != 0u {
            continue;
        }
        var to_light = -light.direction;
        var intensity = light.intensity;
        if light.kind != 2u {
            let offset = (light.position - lighting.camera) - f.relative_position;
            let squared = max(dot(offset, offset), 1e-8);
            to_light = offset * inverseSqrt(squared);
            // KHR_lights_punctual's window over the inverse square.
            let reach = squared * light.inverse_range * light.inverse_range;
            let window = clamp(1.0 - reach * reach, 0.0, 1.0);
            intensity *= window / squared;
            if light.kind == 1u {
                let cone = clamp(dot(light.direction, -to_light) * light.spot_scale + light.spot_offset, 0.0, 1.0);
                intensity *= cone * cone;
            }
        }
        let by_light = reflected(b, to_light);
        sum.diffuse += by_light.diffuse * intensity;
        sum.rest += by_light.rest * vec4f(intensity, 0.0);
    }
    return sum;
}

fn light(f: DaaSurface, m: DaaMaterial) -> DaaLight {
    if m.user0.x > 0.5 {
        return DaaLight(vec3f(1.0), vec4f(0.0, 0.0, 0.0, 1.0));
    }
    var b: Brdf;
    b.normal = m.normal * inverseSqrt(max(dot(m.normal, m.normal), 1e-12));
    b.view = f.view;
    // Normals that a map bends away from the eye count as grazing.
    b.n_dot_v = max(dot(b.normal, f.view), 0.001);
    b.metallic = m.metallic;
    b.dielectric = 0.04 * (1.0 - m.metallic);
    b.f0 = mix(vec3f(0.04), m.base_color.rgb, m.metallic);
    b.diffuse = (1.0 - m.metallic) * (1.0 - m.user0.y);
    let roughness = clamp(m.roughness, 0.045, 1.0);
    b.alpha = roughness * roughness;

    var sum = lit(f, b);
    // Stands for a costly shader: each round needs the one before, so none can be left out.
    for (var i = 1u; i < lighting.stall; i++) {
        b.alpha += min(sum.rest.x, 0.0);
        sum = lit(f, b);
    }

    // The sky: its mean over the hemisphere for the diffuse part, and Lazarov's 2013 fit for the specular one, which
    // falls below 0 where f0 is 0.
    let hemisphere = mix(lighting.ground.rgb, mix(lighting.horizon.rgb, lighting.zenith.rgb, 0.5), b.normal.y * 0.5 + 0.5);
    sum.diffuse += hemisphere * (b.diffuse * m.occlusion);
    // What rays have brought is not guessed.
    if f.traced == 0u {
        let mirrored = reflect(-f.view, b.normal);
        let blurred = mix(sky_radiance(mirrored), sky_radiance(b.normal) * 0.5 + lighting.horizon.rgb * 0.5, roughness) * m.occlusion;
        let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
        let a004 = min(r.x * r.x, exp2(-9.28 * b.n_dot_v)) * r.x + r.y;
        let scale = -1.04 * a004 + r.z;
        let least = -b.metallic * scale * min(min(m.base_color.r, m.base_color.g), m.base_color.b);
        sum.diffuse += blurred * (b.metallic * scale);
        sum.rest += vec4f(blurred * max(b.dielectric * scale + (1.04 * a004 + r.w), least), 0.0);
        if m.user0.y > 0.0 {
            let through = (1.0 - mirrored_share(m, b.n_dot_v)) * (m.user0.y * (1.0 - m.metallic));
            sum.diffuse += sky_radiance(-f.view) * through;
        }
    }
    sum.rest += vec4f(f.reflected, 1.0);
    return sum;
}
