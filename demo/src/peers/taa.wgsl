// taa: one frame into the history. Karis 2014, "High Quality Temporal Supersampling", with the box of the neighbourhood
// from its variance (Salvi 2016, "An Excursion in Temporal Supersampling").

struct Frame {
    /// Clip space of the frame before from that of this one, both without jitter.
    before_from_now: mat4x4f,
    /// From the centre of a pixel to the place of its sample, in uv.
    jitter: vec2f,
    /// The sample of a pixel's m × m that the image shows.
    place: vec2u,
    m: u32,
    /// 0 on the first frame and after a cut.
    has_history: u32,
    padding: vec2u,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var image: texture_2d<f32>;
/// Of all samples. Reversed: 0 is infinitely far.
@group(0) @binding(2) var depth: texture_depth_2d;
@group(0) @binding(3) var history: texture_2d<f32>;
@group(0) @binding(4) var linear: sampler;

/// Weight of the frame against the history (Karis, slide 16).
const BLEND: f32 = 0.1;
/// Half the side of the box in standard deviations (Salvi: about 1).
const GAMMA: f32 = 1.0;
/// The greatest value that the target holds.
const MOST: f32 = 65504.0;
/// Where a float is an infinity or a NaN, all of these bits are set.
const EXPONENT: vec3u = vec3u(0x7f800000u);

@vertex
fn taa_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the view.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn luma(c: vec3f) -> f32 {
    return dot(c, vec3f(0.25, 0.5, 0.25));
}

/// A mean of these, turned back, is the mean of radiances with the weight 1 / (1 + luma), so that highlights do not
/// flicker (Karis, slides 34 to 36).
fn weighted(c: vec3f) -> vec3f {
    return c / (1.0 + luma(c));
}

fn unweighted(c: vec3f) -> vec3f {
    return c / max(1.0 - luma(c), 1.0 / MOST);
}

fn ycocg(c: vec3f) -> vec3f {
    return vec3f(luma(c), dot(c, vec3f(0.5, 0.0, -0.5)), dot(c, vec3f(-0.25, 0.5, -0.25)));
}

fn rgb(c: vec3f) -> vec3f {
    return vec3f(c.x + c.y - c.z, c.x + c.z, c.x - c.y - c.z);
}

/// What is not finite counts as black, or it would stay in the history.
fn sample(pixel: vec2i) -> vec3f {
    let c = textureLoad(image, pixel, 0).rgb;
    let lost = (bitcast<vec3u>(c) & EXPONENT) == EXPONENT;
    return weighted(clamp(select(c, vec3f(0.0), lost), vec3f(0.0), vec3f(MOST)));
}

fn depth_at(pixel: vec2i) -> f32 {
    return textureLoad(depth, pixel * i32(frame.m) + vec2i(frame.place), 0);
}

/// Catmull-Rom over 4 × 4 pixels by 9 bilinear reads: the history is resampled in each frame, and blurs least so.
fn history_at(uv: vec2f, size: vec2f) -> vec3f {
    let place = uv * size;
    let centre = floor(place - 0.5) + 0.5;
    let f = place - centre;
    let w0 = f * (-0.5 + f * (1.0 - 0.5 * f));
    let w1 = 1.0 + f * f * (-2.5 + 1.5 * f);
    let w2 = f * (0.5 + f * (2.0 - 1.5 * f));
    let w3 = f * f * (-0.5 + 0.5 * f);
    let weights = array(w0, w1 + w2, w3);
    let places = array(centre - 1.0, centre + w2 / (w1 + w2), centre + 2.0);
    var sum = vec3f(0.0);
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            let at = vec2f(places[x].x, places[y].y) / size;
            sum += textureSampleLevel(history, linear, at, 0.0).rgb * (weights[x].x * weights[y].y);
        }
    }
    return clamp(sum, vec3f(0.0), vec3f(MOST));
}

@fragment
fn taa_fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(at.xy);
    let size = vec2f(textureDimensions(image));
    let own = sample(pixel);
    var sum = vec3f(0.0);
    var squares = vec3f(0.0);
    // An edge moves with the surface in front, which is the nearest in the neighbourhood.
    var nearest = depth_at(pixel);
    var nearest_at = pixel;
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let p = clamp(pixel + vec2i(x, y), vec2i(0), vec2i(size) - 1);
            let c = ycocg(sample(p));
            sum += c;
            squares += c * c;
            let d = depth_at(p);
            if d > nearest {
                nearest = d;
                nearest_at = p;
            }
        }
    }
    let here = (vec2f(nearest_at) + 0.5) / size + frame.jitter;
    let clip = frame.before_from_now * vec4f(here.x * 2.0 - 1.0, 1.0 - here.y * 2.0, nearest, 1.0);
    let before = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
    let uv = at.xy / size + before - here;
    let on_screen = all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
    if frame.has_history == 0u || !(clip.w > 0.0) || !on_screen {
        return vec4f(min(unweighted(own), vec3f(MOST)), 1.0);
    }
    let mean = sum / 9.0;
    let half_side = GAMMA * sqrt(max(squares / 9.0 - mean * mean, vec3f(0.0)));
    // Towards the middle of the box, until it is in.
    let offset = ycocg(weighted(history_at(uv, size))) - mean;
    let out = abs(offset) / max(half_side, vec3f(1e-6));
    let most = max(max(out.x, out.y), max(out.z, 1.0));
    let old = clamp(rgb(mean + offset / most), vec3f(0.0), vec3f(1.0));
    return vec4f(min(unweighted(mix(old, own, BLEND)), vec3f(MOST)), 1.0);
}
