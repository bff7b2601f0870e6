// The sky of a camera with a `Skybox`, for pixels at an edge before it. Bevy draws whole pixels of sky itself.

struct DeferredAaSkybox {
    brightness: f32,
    sky_from_world: mat4x4f,
}
@group(2) @binding(102) var deferred_aa_skybox: texture_cube<f32>;
@group(2) @binding(103) var deferred_aa_skybox_sampler: sampler;
@group(2) @binding(104) var<uniform> deferred_aa_skybox_settings: DeferredAaSkybox;

fn sky(s: DaaSample) -> vec4f {
    let direction = (deferred_aa_skybox_settings.sky_from_world * vec4f(-s.view, 0.0)).xyz;
    // Cube maps are left-handed.
    let color = textureSampleLevel(deferred_aa_skybox, deferred_aa_skybox_sampler, direction * vec3f(1.0, 1.0, -1.0), 0.0);
    return vec4f(color.rgb * deferred_aa_skybox_settings.brightness, color.a);
}
