// FXAA, written from its description (T. Lottes, "FXAA", NVIDIA white paper, 2009; the quality variant of version 3.11,
// 2011). It finds edges by luma contrast, follows each to its ends, and moves the lookup across the edge by as much as
// the pixel's place along it says; single pixels that stick out are moved by their contrast alone.

/// Displayed values, alpha their luma.
@group(0) @binding(0) var shown: texture_2d<f32>;
/// Linear, clamped.
@group(0) @binding(1) var between: sampler;

/// Contrast below this share of the greatest luma is no edge: the published default.
const EDGE_SHARE = 0.166;
/// Contrast below this is no edge in the dark: the published default.
const EDGE_LEAST = 0.0833;
/// How much of a lone pixel's contrast is removed, 0 to 1: the published default.
const LONE_PIXEL = 0.75;
/// From one probe along the edge to the next, in pixels: preset 29.
const STRIDES = array<f32, 12>(1.0, 1.5, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 4.0, 8.0);
/// The edge ends where luma differs from the edge's own by this share of the step across it.
const END_SHARE = 0.25;

@vertex
fn fxaa_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

/// Luma of a pixel of the image, or of the nearest one to it.
fn luma_at(pixel: vec2i) -> f32 {
    return textureLoad(shown, clamp(pixel, vec2i(0), vec2i(textureDimensions(shown)) - 1), 0).a;
}

/// Between pixels; `place` in pixels.
fn look_up(place: vec2f) -> vec4f {
    return textureSampleLevel(shown, between, place / vec2f(textureDimensions(shown)), 0.0);
}

/// How a line of three bends.
fn bend(a: f32, b: f32, c: f32) -> f32 {
    return abs(a - 2.0 * b + c);
}

/// One way along an edge.
struct End {
    /// In pixels, from the pixel that asked.
    distance: f32,
    /// Of luma there, from the edge's own.
    rise: f32,
}

/// Follows the edge from `start`, which lies halfway across it, until its luma has changed by `enough`.
fn follow(start: vec2f, along: vec2f, edge_luma: f32, enough: f32) -> End {
    var end = End(0.0, 0.0);
    for (var i = 0u; i < 12u; i++) {
        end.distance += STRIDES[i];
        end.rise = look_up(start + along * end.distance).a - edge_luma;
        if abs(end.rise) >= enough {
            break;
        }
    }
    return end;
}

@fragment
fn fxaa_fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let own = textureLoad(shown, pixel, 0);

    let left = luma_at(pixel + vec2i(-1, 0));
    let right = luma_at(pixel + vec2i(1, 0));
    let up = luma_at(pixel + vec2i(0, -1));
    let down = luma_at(pixel + vec2i(0, 1));
    let greatest = max(max(max(left, right), max(up, down)), own.a);
    let contrast = greatest - min(min(min(left, right), min(up, down)), own.a);
    if contrast < max(EDGE_LEAST, EDGE_SHARE * greatest) {
        return own;
    }

    let up_left = luma_at(pixel + vec2i(-1, -1));
    let up_right = luma_at(pixel + vec2i(1, -1));
    let down_left = luma_at(pixel + vec2i(-1, 1));
    let down_right = luma_at(pixel + vec2i(1, 1));

    // A lone pixel: how far it is from the mean of its eight neighbours, the near ones twice.
    let mean = (2.0 * (left + right + up + down) + up_left + up_right + down_left + down_right) / 12.0;
    let lone = smoothstep(0.0, 1.0, abs(mean - own.a) / contrast);
    let lone_move = LONE_PIXEL * lone * lone;

    // A horizontal edge bends columns more than rows.
    let columns = bend(up_left, left, down_left) + 2.0 * bend(up, own.a, down) + bend(up_right, right, down_right);
    let rows = bend(up_left, up, up_right) + 2.0 * bend(left, own.a, right) + bend(down_left, down, down_right);
    let horizontal = columns >= rows;
    let before = select(left, up, horizontal);
    let after = select(right, down, horizontal);
    // To the other side: where the step is steeper.
    let back = abs(before - own.a) >= abs(after - own.a);
    let other = select(after, before, back);
    let across = select(vec2f(1.0, 0.0), vec2f(0.0, 1.0), horizontal) * select(1.0, -1.0, back);
    let along = select(vec2f(0.0, 1.0), vec2f(1.0, 0.0), horizontal);

    let centre = vec2f(pixel) + 0.5;
    let edge_luma = 0.5 * (own.a + other);
    let enough = END_SHARE * abs(other - own.a);
    let one = follow(centre + 0.5 * across, -along, edge_luma, enough);
    let two = follow(centre + 0.5 * across, along, edge_luma, enough);

    // Near an end the edge has crossed half of this pixel, in the middle none. Only on the side that it has crossed
    // into.
    let nearer_rise = select(two.rise, one.rise, one.distance < two.distance);
    let crossed = (nearer_rise < 0.0) != (own.a < edge_luma);
    let edge_move = 0.5 - min(one.distance, two.distance) / (one.distance + two.distance);
    let moved = max(select(0.0, edge_move, crossed), lone_move);
    return look_up(centre + across * moved);
}
