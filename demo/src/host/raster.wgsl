// Renders the scene into the G-buffer. Joined with material.wgsl and vertices.wgsl; raster_stored.wgsl and
// raster_ids.wgsl have the fragments of the two tiers.

@group(0) @binding(2) var<storage, read> materials: array<Material>;

/// Whether a masked material has a hole there. Alpha is tested at the G-buffer's resolution, so that cut-outs are
/// anti-aliased like any edge.
fn is_hole(v: Varying) -> bool {
    let ddx = dpdx(v.uv);
    let ddy = dpdy(v.uv);
    let material = instances[v.instance].material;
    var alpha = materials[material].base_color.a * v.color.a;
    if materials[material].textures[BASE_COLOR] != NO_TEXTURE {
        alpha *= material_texture(material, BASE_COLOR, v.uv, ddx, ddy).a;
    }
    return alpha < materials[material].alpha_cutoff;
}
