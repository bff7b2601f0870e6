// The errors of audited tiles: what passes that audit the image share. Each has `daa_audits`.

var<workgroup> daa_errors: array<vec2f, 64>;

/// The displayed colour: x/(1+x), then the transfer function of sRGB (IEC 61966-2-1).
fn daa_display(c: vec3f) -> vec3f {
    let exposed = min(max(c * daa_frame.exposure, vec3f(0.0)), vec3f(1e30));
    let x = exposed / (1.0 + exposed);
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}

fn daa_squared_distance(a: vec4f, b: vec4f) -> f32 {
    let apart = daa_display(a.rgb) - daa_display(b.rgb);
    return dot(apart, apart) / 3.0;
}

/// Stores the errors of a tile, of which each lane has a pixel's. Every lane of the workgroup calls it.
fn daa_store_errors(group: vec2u, row: u32, lane: u32, errors: vec2f) {
    let tile = daa_audited_tile(group);
    daa_errors[lane] = errors;
    workgroupBarrier();
    if lane == 0u {
        var sum = vec2f(0.0);
        for (var i = 0u; i < 64u; i++) {
            sum += daa_errors[i];
        }
        // Each part of the image writes the tiles that it shows, and what lies beyond the end of their rows.
        let exists = tile.x * 8u < daa_frame.image.x;
        let first = daa_tile_pixel(daa_tile_of_image(tile), 0u);
        if daa_is_shown(select(vec2u(daa_frame.shown.x, first.y), first, exists)) {
            daa_audits[tile.y * row + group.x] = select(vec2f(-1.0), sum, exists);
        }
    }
}
