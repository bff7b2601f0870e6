// check: counts the samples of a G-buffer that do not fit the contract. src/host/check.rs judges the counts. CPU twin:
// src/reference/check.rs.

/// The counts, in the order of `InputCounts` of src/host/check.rs.
@group(3) @binding(0) var<storage, read_write> daa_input: array<atomic<u32>, 18>;

const DAA_INPUT_COUNTS: u32 = 18u;
const DAA_COVERED: u32 = 0u;
const DAA_BAD_DEPTH: u32 = 1u;
const DAA_NEAR: u32 = 2u;
const DAA_OBJECTS: u32 = 3u;
const DAA_STEPS: u32 = 4u;
const DAA_PLANES: u32 = 5u;
/// Counts of the shading normal; those of the geometric normal lie four further on.
const DAA_NORMAL_FITS: u32 = 6u;
const DAA_NORMAL_UNSET: u32 = 7u;
const DAA_NORMAL_IN_VIEW: u32 = 8u;
const DAA_NORMAL_FLIPPED: u32 = 9u;
const DAA_SLOPES: u32 = 14u;
const DAA_GRADIENT_FITS: u32 = 15u;
const DAA_GRADIENT_MISSING: u32 = 16u;
const DAA_GRADIENT_PER_PIXEL: u32 = 17u;

var<workgroup> daa_group_input: array<atomic<u32>, 18>;

fn daa_count(what: u32, yes: bool) {
    if yes {
        atomicAdd(&daa_group_input[what], 1u);
    }
}

struct DaaChecked {
    /// Position relative to the camera.
    position: vec3f,
    /// Depth along the view direction.
    depth: f32,
    uv: vec2f,
    identity: u32,
    /// Whether the sample lies in the G-buffer and is not the sky.
    valid: bool,
}

fn daa_checked(at: vec2i) -> DaaChecked {
    let last = vec2i(daa_frame.size * DAA_M) - 1;
    let inside = all(at >= vec2i(0)) && all(at <= last);
    let place = clamp(at, vec2i(0), last);
    let d = daa_depth_at(vec2u(place));
    let valid = inside && d > DAA_SKY_DEPTH && d <= 1.0;
    let position = daa_relative_position(vec2f(place) + 0.5, select(1.0, d, valid));
    let uv = daa_uv_at(vec2u(place));
    let identity = daa_identity_at(vec2u(place));
    return DaaChecked(position, dot(position, daa_frame.camera_forward), uv, identity, valid);
}

/// Whether two neighbours belong to the surface of the sample between them and lie on a line with it, within 3°.
fn daa_on_line(a: DaaChecked, b: DaaChecked, c: DaaChecked) -> bool {
    if !a.valid || !c.valid || a.identity != b.identity || c.identity != b.identity {
        return false;
    }
    let before = b.position - a.position;
    let behind = c.position - b.position;
    let apart = cross(before, behind);
    return dot(apart, apart) < 0.0025 * dot(before, before) * dot(behind, behind);
}

/// Counts how a normal fits the surface that depth shows.
fn daa_count_normal(first: u32, normal: vec3f, unset: bool, plane: vec3f, in_view: mat3x3f) {
    let c = dot(normal, plane);
    daa_count(first, c > 0.7);
    daa_count(first + DAA_NORMAL_UNSET - DAA_NORMAL_FITS, unset);
    daa_count(first + DAA_NORMAL_IN_VIEW - DAA_NORMAL_FITS, dot(in_view * normal, plane) > 0.7);
    daa_count(first + DAA_NORMAL_FLIPPED - DAA_NORMAL_FITS, c < -0.7);
}

/// Counts how a gradient fits the difference of uv to the next sample.
fn daa_count_gradient(here: DaaChecked, next: DaaChecked, gradient: vec2f) {
    let apart = next.uv - here.uv;
    let slope = sqrt(dot(apart, apart));
    // Smaller differences are lost in rounding. The comparison below also fails for NaN.
    let least = 1e-5 + 1e-5 * sqrt(dot(here.uv, here.uv));
    if !next.valid || next.identity != here.identity || !(slope > least && slope < 1e9) {
        return;
    }
    let ratio = sqrt(dot(gradient, gradient)) / slope;
    let m = f32(DAA_M);
    daa_count(DAA_SLOPES, true);
    daa_count(DAA_GRADIENT_FITS, ratio > 0.6 && ratio < 1.5);
    daa_count(DAA_GRADIENT_MISSING, ratio == 0.0);
    daa_count(DAA_GRADIENT_PER_PIXEL, DAA_M > 1u && ratio > 0.75 * m && ratio < 1.34 * m);
}

fn daa_check_sample(at: vec2i) {
    let d = daa_depth_at(vec2u(at));
    let no_number = (bitcast<u32>(d) & 0x7f800000u) == 0x7f800000u;
    daa_count(DAA_BAD_DEPTH, no_number || d < 0.0 || d > 1.0);
    let here = daa_checked(at);
    if no_number || !here.valid {
        return;
    }
    let perspective = daa_frame.orthographic == 0u;
    daa_count(DAA_COVERED, true);
    daa_count(DAA_NEAR, perspective && d > 0.9);
    daa_count(DAA_OBJECTS, (here.identity >> 16u) != 0u);

    let left = daa_checked(at - vec2i(1, 0));
    let right = daa_checked(at + vec2i(1, 0));
    let up = daa_checked(at - vec2i(0, 1));
    let down = daa_checked(at + vec2i(0, 1));
    daa_count(DAA_STEPS, right.valid && abs(right.depth - here.depth) > 0.1 * abs(here.depth));
    let a = daa_attributes_at(vec2u(at), d);
    daa_count_gradient(here, right, a.ddx);
    daa_count_gradient(here, down, a.ddy);

    if !daa_on_line(left, here, right) || !daa_on_line(up, here, down) {
        return;
    }
    var plane = cross(right.position - left.position, up.position - down.position);
    let squared = dot(plane, plane);
    if !(squared > 0.0) {
        return;
    }
    let towards = select(-daa_frame.camera_forward, -here.position, perspective);
    plane *= inverseSqrt(squared) * select(1.0, -1.0, dot(plane, towards) < 0.0);
    daa_count(DAA_PLANES, true);
    let along = daa_relative_position(vec2f(at) + vec2f(1.5, 0.5), 1.0) - daa_relative_position(vec2f(at) + 0.5, 1.0);
    let x = normalize(along);
    let in_view = mat3x3f(x, cross(x, daa_frame.camera_forward), -daa_frame.camera_forward);
    daa_count_normal(DAA_NORMAL_FITS, a.normal, a.normal_unset, plane, in_view);
    daa_count_normal(DAA_NORMAL_FITS + 4u, a.geometric_normal, a.geometric_normal_unset, plane, in_view);
}

@compute @workgroup_size(8, 8)
fn daa_check_main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    if all(id.xy < daa_frame.size * DAA_M) {
        daa_check_sample(vec2i(id.xy));
    }
    workgroupBarrier();
    if lane < DAA_INPUT_COUNTS {
        let counted = atomicLoad(&daa_group_input[lane]);
        if counted > 0u {
            atomicAdd(&daa_input[lane], counted);
        }
    }
}
