//! G-buffers of any bits: not a number, infinite, out of range, names of nothing. Images are finite all the same, and
//! the checker names what is certainly wrong.

use super::Campaign;
use super::frames::{self, Stage as _, Traced};
use super::random::Random;
use super::settings::settings;
use super::words::Writer;
use crate::harness::Rig;
use deferred_aa::{DebugView, Effect, GBuffer, InputMistake, InputReport, Settings, wgpu};
use deferred_aa_demo::host::HostError;

pub const CAMPAIGN: Campaign = Campaign {
    name: "gbuffers",
    share: 0.15,
    few: 5,
    limit: frames::CAMPAIGN.limit,
    start: || {
        let mut rigs: [Option<(Rig, Writer)>; 4] = Default::default();
        Box::new(move |seed| match seed % 5 {
            4 => traced(seed),
            i => plain(rigs[i as usize].get_or_insert_with(|| rig(1 + i)), seed),
        })
    },
};

/// The number of frames of a seed.
const FRAMES: u64 = 8;
const SIZE: [u32; 2] = [23, 18];

/// Shows everything that a sample has.
const SHOW: &str = "fn shade(s: DaaSample) -> vec4f {
    let surface = s.normal + s.geometric_normal + s.tangent.xyz + s.view;
    let place = s.position + s.relative_position + vec3f(s.uv, s.depth) + vec3f(s.ddx, length(s.ddy));
    return vec4f(surface + place, f32(s.material)) + unpack4x8unorm(s.user);
}
fn sky(s: DaaSample) -> vec4f { return shade(s); }";

fn rig(m: u32) -> (Rig, Writer) {
    let rig = Rig::new(m, SIZE[0], SIZE[1], SHOW);
    let writer = Writer::new(&rig.gpu, rig.aa.gbuffer().expect("a size"));
    (rig, writer)
}

/// A node that traces no rays; returns how many frames it rendered.
fn plain((rig, writer): &mut (Rig, Writer), seed: u32) -> u64 {
    let mut random = Random::new(seed);
    for _ in 0..FRAMES {
        let (shadows, reflections, refraction) = (Effect::Off, Effect::Off, Effect::Off);
        let settings = Settings { shadows, reflections, refraction, ..settings(&mut random) };
        let told = format!("m = {}, {settings:?}", rig.aa.m());
        let gbuffer = rig.aa.gbuffer().expect("a size");
        writer.write(&rig.gpu, gbuffer, &words(&mut random, gbuffer, writer.words));
        if rig.aa.m() > 1 || rig.try_record(settings).is_ok() {
            assert_sound(&rig.run(settings).image, &told);
            // It shows floats as they are stored.
            assert_sound(&rig.run(Settings { view: DebugView::Uv, ..settings }).image, &told);
        }
        let depths = bytemuck::pod_collect_to_vec(&rig.gpu.read_texture(gbuffer_depth(rig), 4));
        assert_names(&rig.check().expect("a report"), &depths, &told);
    }
    FRAMES
}

fn gbuffer_depth(rig: &Rig) -> &wgpu::Texture {
    rig.aa.gbuffer().expect("a size").depth.texture()
}

/// A host whose G-buffer is written over before the node reads it; returns how many frames it rendered.
fn traced(seed: u32) -> u64 {
    let mut random = Random::new(seed);
    let visible = random.once_in(2);
    let mut traced = Traced::new(&mut random, visible);
    let host = &traced.host;
    let writer = Writer::new(&host.gpu, host.aa.gbuffer().expect("a size"));
    let (camera, device) = (host.scene.default_camera(), host.gpu.device.clone());
    for _ in 0..FRAMES {
        let settings = traced.adapt(settings(&mut random));
        let host = &mut traced.host;
        let told = format!("{}, {:?}, {settings:?}", host.scene.name, host.options);
        let words = words(&mut random, host.aa.gbuffer().expect("a size"), writer.words);
        let rendered = host.frame_by(&camera, settings, |aa, queue, encoder, frame| {
            writer.record(&device, encoder, aa.gbuffer().expect("a size"), &words);
            aa.check_input(queue, encoder, frame)?;
            aa.record(queue, encoder, frame)
        });
        match rendered {
            Ok(_) => {}
            Err(HostError::Record(_)) => continue,
            Err(error) => panic!("{error}: {told}"),
        }
        assert_sound(&host.picture().rgba, &told);
        let depths = host.depths();
        assert_names(host.aa.input_report().expect("a report"), &depths, &told);
    }
    FRAMES
}

fn assert_sound(image: &[[f32; 4]], told: &str) {
    let bad = image.iter().position(|pixel| pixel.iter().any(|c| !c.is_finite() || *c < 0.0));
    assert_eq!(bad, None, "{:?}: {told}", bad.map(|i| image[i]));
}

/// Holds a report against the depths that are really there.
fn assert_names(report: &InputReport, depths: &[f32], told: &str) {
    let bad = depths.iter().filter(|d| !(0.0..=1.0).contains(*d)).count() as u32;
    let near = depths.iter().filter(|&&d| d > 0.9).count();
    let named = report.mistakes.iter().any(|mistake| matches!(mistake, InputMistake::DepthOutOfRange { .. }));
    assert_eq!((report.counts.bad_depth, named), (bad, bad > 0), "{report:?}: {told}");
    let reversed = report.mistakes.iter().any(|mistake| matches!(mistake, InputMistake::DepthNotReversed { .. }));
    assert_eq!(reversed, 2 * near > depths.len(), "{near} of {} near, {report:?}: {told}", depths.len());
}

/// Samples of random bits, each channel in one of several ways.
fn words(random: &mut Random, gbuffer: &GBuffer, of_sample: usize) -> Vec<u32> {
    let ways: Vec<u32> = (0..of_sample).map(|_| random.below(4)).collect();
    let depth = random.below(5);
    let mut all = Vec::new();
    for _ in 0..gbuffer.width * gbuffer.height {
        all.push(any_depth(random, depth).to_bits());
        all.extend(ways[1..].iter().map(|&way| any_word(random, way)));
    }
    all
}

fn any_depth(random: &mut Random, way: u32) -> f32 {
    match way {
        0 => f32::from_bits(random.bits()),
        1 => random.magnitude(1e-38, 1.0),
        2 => random.within(0.8, 1.0),
        3 => random.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, 0.0, 1.0, 1e-40, 0.1]),
        _ => random.unit(),
    }
}

fn any_word(random: &mut Random, way: u32) -> u32 {
    match way {
        0 => random.bits(),
        1 => random.below(8),
        2 => {
            random.pick(&[0, 1, u32::MAX, 0x7fff_ffff, 0x8000_0000, 0x7f80_0000, 0xff80_0000, 0x7fc0_0000, 0x7c00_7c00])
        }
        // Halves and floats of most magnitudes.
        _ => (random.pick(&[1.0, -1.0]) * random.magnitude(1e-30, 1e30)).to_bits(),
    }
}
