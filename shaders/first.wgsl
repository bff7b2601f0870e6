// first: shades the rank-0 sample of every window into S (Holländer et al. 2013, listing 1, ShadeFirstSample).

@group(3) @binding(0) var daa_first: texture_storage_2d<rgba32float, write>;
@group(3) @binding(1) var<storage, read_write> daa_statistics: DaaStatistics;

@compute @workgroup_size(8, 8)
fn daa_first_main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= daa_frame.size) {
        return;
    }
    textureStore(daa_first, id.xy, daa_shade_sample(id.xy, 0u, f32(DAA_M), daa_centre(1u)));
}
