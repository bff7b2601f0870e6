//! The checker of a host's input: silent on what is sound, and each mistake named.

use crate::harness::{Rig, Sample, WHITE};
use crate::shadows::host;
use bytemuck::pod_collect_to_vec;
use deferred_aa::glam::{
    Mat4, Vec2, Vec3, Vec4,
    camera::{lh, rh::proj::directx},
};
use deferred_aa::reference::check::Input;
use deferred_aa::{InputCounts, InputMistake as Mistake, InputReport, Normal, RecordError, Settings, Technique, wgpu};
use deferred_aa_demo::raster::node_camera;
use deferred_aa_demo::scene::builtin;

const SIZE: [u32; 2] = [40, 24];

/// No false alarm, and the counts are the twin's but for what rounding decides.
#[test]
fn nothing_is_wrong_with_the_demos_scenes() {
    let settings = Settings { technique: Technique::Single, ..Default::default() };
    for name in builtin::NAMES {
        let scene = builtin::builtin(name).unwrap();
        let camera = scene.default_camera();
        for m in [2, 4] {
            let mut host = host(scene.clone(), m, SIZE);
            host.frame_by(&camera, settings, |aa, queue, encoder, frame| {
                aa.check_input(queue, encoder, frame)?;
                aa.record(queue, encoder, frame)
            })
            .expect("a frame");
            let report = host.aa.input_report().expect("a report").clone();
            assert_eq!(report.mistakes, [], "{name}, m = {m}: {:?}", report.counts);
            let gbuffer = host.aa.gbuffer().expect("a size");
            let read = |i: usize| host.gpu.read_texture(gbuffer.color[i].texture(), [8, 8, 16][i]);
            let twin = Input {
                camera: node_camera(&camera, SIZE[0], SIZE[1]),
                samples: SIZE.map(|side| side * m),
                m,
                depth: &host.depths(),
                surface: &pod_collect_to_vec::<_, [u32; 2]>(&read(0)),
                frame: &pod_collect_to_vec::<_, [u32; 2]>(&read(1)),
                uv: &pod_collect_to_vec::<_, [u32; 4]>(&read(2)),
            };
            let words = |counts: &InputCounts| bytemuck::cast::<_, [u32; 18]>(*counts);
            for (i, (gpu, twin)) in words(&report.counts).into_iter().zip(words(&twin.counts())).enumerate() {
                assert!(gpu.abs_diff(twin) <= 2 + twin / 200, "{name}, m = {m}, count {i}: {gpu}, twin {twin}");
            }
        }
    }
}

/// A plane before the camera, and beyond its left third another one.
struct Planes {
    rig: Rig,
    turn: Mat4,
}

impl Planes {
    fn new(m: u32) -> Self {
        let turn = Mat4::from_rotation_y(2.0) * Mat4::from_rotation_x(0.9);
        let mut rig = Rig::new(m, SIZE[0], SIZE[1], WHITE);
        rig.camera.world_from_view = turn;
        Self { rig, turn }
    }

    /// A sound sample.
    fn sample(&self, x: u32, y: u32) -> Sample {
        let samples = SIZE.map(|side| (side * self.rig.aa.m()) as f32);
        let normal = Vec3::new(0.3, 0.4, 1.0).normalize();
        let far = x * 3 < SIZE[0] * self.rig.aa.m();
        let at = Vec3::new(0.0, 0.0, if far { -6.0 } else { -3.0 });
        let clip = self.rig.camera.clip_from_view;
        let point = |x: f32, y: f32| {
            let ndc = [x / samples[0] * 2.0 - 1.0, 1.0 - y / samples[1] * 2.0];
            let way = Vec3::new(ndc[0] / clip.x_axis.x, ndc[1] / clip.y_axis.y, -1.0);
            way * (normal.dot(at) / normal.dot(way))
        };
        let uv = |p: Vec3| Vec2::new(p.x, p.y) * 0.5;
        let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
        let p = point(x, y);
        Sample {
            depth: 0.1 / -p.z,
            normal: self.turn.transform_vector3(normal),
            tangent: Vec4::ZERO,
            uv: uv(p),
            ddx: uv(point(x + 0.5, y)) - uv(point(x - 0.5, y)),
            ddy: uv(point(x, y + 0.5)) - uv(point(x, y - 0.5)),
            material: 0,
            object: 1 + u32::from(far),
            user: 0,
        }
    }

    fn report(&mut self, change: impl Fn(&mut Sample)) -> InputReport {
        self.rig.fill(|x, y| {
            let mut sample = self.sample(x, y);
            change(&mut sample);
            sample
        });
        self.rig.check().expect("a report")
    }
}

#[test]
fn each_mistake_is_named() {
    for m in [2, 3, 4] {
        let mut planes = Planes::new(m);
        let sound = planes.report(|_| {});
        assert_eq!(sound.mistakes, [], "{:?}", sound.counts);
        let back = planes.turn.inverse();
        let both = |of: fn(Normal, f32) -> Mistake| [of(Normal::Shading, 1.0), of(Normal::Geometric, 1.0)].to_vec();
        let unset = both(|which, share| Mistake::NormalsUnset { which, share });
        let in_view = both(|which, share| Mistake::NormalsInViewSpace { which, share });
        let flipped = both(|which, share| Mistake::NormalsFlipped { which, share });
        let off = both(|which, share| Mistake::NormalsOff { which, share });
        assert_eq!(planes.report(|s| s.normal = Vec3::ZERO).mistakes, unset);
        assert_eq!(planes.report(|s| s.normal = back.transform_vector3(s.normal)).mistakes, in_view);
        assert_eq!(planes.report(|s| s.normal = -s.normal).mistakes, flipped);
        assert_eq!(planes.report(|s| s.normal = s.normal.any_orthonormal_pair().1).mistakes, off);
        let mistakes = planes.report(|s| (s.ddx, s.ddy) = (Vec2::ZERO, Vec2::ZERO)).mistakes;
        assert_eq!(mistakes, [Mistake::GradientsMissing { share: 1.0 }]);
        let mistakes = planes.report(|s| (s.ddx, s.ddy) = (s.ddx * m as f32, s.ddy * m as f32)).mistakes;
        assert!(matches!(mistakes[..], [Mistake::GradientsPerPixel { m: of, .. }] if of == m), "{mistakes:?}");
        let mistakes = planes.report(|s| (s.ddx, s.ddy) = (s.ddx * 30.0, s.ddy * 30.0)).mistakes;
        assert!(matches!(mistakes[..], [Mistake::GradientsOff { .. }]), "{mistakes:?}");
        assert_eq!(planes.report(|s| s.object = 0).mistakes, [Mistake::ObjectsUnset]);
        let mistakes = planes.report(|s| s.depth = 1.0 - s.depth).mistakes;
        assert!(matches!(mistakes[..], [Mistake::DepthNotReversed { share: 1.0 }]), "{mistakes:?}");
        let mistakes = planes.report(|s| s.depth = 1.0).mistakes;
        assert!(matches!(mistakes[..], [Mistake::DepthNotReversed { share: 1.0 }]), "{mistakes:?}");
    }
}

#[test]
fn cameras_that_do_not_fit_are_named() {
    let mut planes = Planes::new(2);
    let aspect = SIZE[0] as f32 / SIZE[1] as f32;
    planes.rig.camera.clip_from_view = directx::perspective(1.0, aspect, 0.1, 100.0);
    let mistakes = planes.report(|_| {}).mistakes;
    assert!(mistakes.contains(&Mistake::ProjectionNotReversed), "{mistakes:?}");
    planes.rig.camera.clip_from_view = lh::proj::directx::perspective_infinite_reverse(1.0, aspect, 0.1);
    assert_eq!(planes.rig.try_check().map(|_| ()), Err(RecordError::Handedness));
}

#[test]
fn radiance_that_is_encoded_twice_is_named() {
    let encoding = "fn shade(s: DaaSample) -> vec4f { return vec4f(pow(abs(s.normal), vec3f(1.0 / 2.2)), 1.0); }";
    let decoding = "fn shade(s: DaaSample) -> vec4f { return vec4f(pow(abs(s.normal), vec3f(2.2)), 1.0); }";
    let srgb = wgpu::TextureFormat::Rgba8UnormSrgb;
    for (source, target, named) in
        [(encoding, srgb, true), (decoding, srgb, false), (encoding, wgpu::TextureFormat::Rgba16Float, false)]
    {
        let mut rig = Rig::with_format(1, 16, 16, source, target);
        rig.fill(|_, _| Sample::SKY);
        let mistakes = rig.check().expect("a report").mistakes;
        assert_eq!(mistakes.contains(&Mistake::EncodedTwice { target }), named, "{target:?} {source}");
    }
}

/// A check whose commands are dropped leaves no trace, and one under way keeps others out.
#[test]
fn checks_come_one_at_a_time() {
    let mut planes = Planes::new(2);
    planes.report(|_| {});
    let rig = &mut planes.rig;
    drop(rig.try_check().expect("a check"));
    let under_way = rig.try_check().expect("a check");
    let second = rig.try_check().expect("nothing");
    rig.gpu.queue.submit([under_way, second]);
    rig.gpu.wait();
    assert_eq!(rig.aa.input_report().map(|report| report.mistakes.len()), Some(0));
    rig.camera.clip_from_view = Mat4::ZERO;
    assert_eq!(rig.try_check().map(|_| ()), Err(RecordError::Camera("projection")));
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}
