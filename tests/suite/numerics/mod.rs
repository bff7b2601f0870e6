//! Hard cases, one or more tests each, numbered as in the project's list: on the GPU, and held against the f64 twin.

mod cameras;
mod limits;
mod metrics;
mod textures;
mod values;

use crate::harness::{Output, Sample, noise, rgba8};
use deferred_aa::glam::Vec3;
use deferred_aa::{DepthMeasure, Preset, Settings, Windowed};

/// The user word as a grey radiance, of whatever bits: no compiler can know them.
const SHOW_FLOAT: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(vec3f(bitcast<f32>(s.user)), 1.0); }";

/// Everything of a sample that geometry feeds, so that a NaN in any of it is counted. Scaled: positions of far samples
/// are large on purpose.
const SHOW_GEOMETRY: &str = "
fn parts(s: DaaSample) -> vec4f {
    let p = clamp(abs(s.position) + abs(s.relative_position), vec3f(0.0), vec3f(1e30));
    let units = abs(s.view) + abs(s.normal) + abs(s.tangent.xyz) + abs(s.geometric_normal);
    return vec4f(p * 1e-30 + units, s.depth * 1e-30);
}
fn shade(s: DaaSample) -> vec4f { return parts(s); }
fn sky(s: DaaSample) -> vec4f { return parts(s); }";

/// Only the depth metric.
fn by_depth(depth: DepthMeasure, depth_scale: f32) -> Settings {
    let windowed = Windowed { depth, depth_scale, normal_scale: 0.0, luminance_scale: 0.0, ..Default::default() };
    Settings { windowed, ..Default::default() }
}

/// Only the normal metric.
fn by_normal(normal_scale: f32, two_sided: bool) -> Settings {
    let windowed = Windowed { depth_scale: 0.0, normal_scale, two_sided, luminance_scale: 0.0, ..Default::default() };
    Settings { windowed, ..Default::default() }
}

/// Only the luminance metric.
fn by_luminance(w: Windowed) -> Settings {
    Settings { windowed: Windowed { depth_scale: 0.0, normal_scale: 0.0, ..w }, ..Default::default() }
}

/// Ours and the paper's.
fn presets() -> [Windowed; 4] {
    let [fast, balanced, quality] = Preset::ALL.map(Preset::windowed);
    [fast, balanced, quality, Windowed::PAPER]
}

fn counts(output: &Output) -> Vec<u32> {
    output.plan.iter().map(|p| p.0).collect()
}

#[track_caller]
fn assert_finite(output: &Output, n: u32) {
    assert!(output.image.iter().flatten().all(|c| c.is_finite()), "not finite");
    assert!(output.plan.iter().all(|p| (1..=n).contains(&p.0)), "k out of range");
    assert_eq!(output.statistics.not_finite, 0);
}

/// Coloured noise on planes with steps, without sky.
fn land(x: u32, y: u32) -> Sample {
    let object = 1 + x / 11 + y / 13 * 5;
    Sample {
        depth: 0.05 + noise(object) * 0.5 + x as f32 * 1e-5,
        normal: Vec3::new(noise(object + 70) - 0.5, (y as f32 * 0.02).sin() * 0.3, 1.0),
        object,
        user: rgba8(noise(object * 3), noise(object * 5), noise(x / 3 + y * 977), 1.0),
        ..Default::default()
    }
}
