//! Row 25: cameras.

use super::{SHOW_GEOMETRY, assert_finite, land};
use crate::harness::{Rig, Sample, camera};
use crate::textures::{full, single};
use deferred_aa::glam::camera::rh::proj::directx;
use deferred_aa::glam::{DVec4, Mat4, Vec3};
use deferred_aa::{Camera, RecordError, Settings, Technique};
use deferred_aa_demo::host::{Host, HostError, Options};
use deferred_aa_demo::scene::{Lens, builtin};

// ---- Row 25: cameras ----

#[test]
fn row_25_singular_cameras_are_refused_by_name() {
    let mut rig = Rig::new(2, 5, 3, SHOW_GEOMETRY);
    rig.fill(land);
    let good = camera(5.0 / 3.0);
    let squashed = Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0));
    let projections = [Mat4::ZERO, squashed * good.clip_from_view, Mat4::NAN, good.clip_from_view * f32::INFINITY];
    for clip_from_view in projections {
        rig.camera = Camera { clip_from_view, ..good };
        let refused = rig.try_record(Settings::default()).map(|_| ());
        assert_eq!(refused, Err(RecordError::Camera("projection")), "{clip_from_view}");
    }
    for world_from_view in [Mat4::ZERO, squashed, Mat4::NAN, Mat4::from_translation(Vec3::INFINITY)] {
        rig.camera = Camera { world_from_view, ..good };
        let refused = rig.try_record(Settings::default()).map(|_| ());
        assert_eq!(refused, Err(RecordError::Camera("view")), "{world_from_view}");
    }
    // The node is none the worse.
    rig.camera = good;
    assert_finite(&rig.run(Settings::default()), 4);
}

#[test]
fn row_25_the_same_projection_in_other_numbers_is_the_same() {
    let mut rig = Rig::new(2, 8, 8, "fn shade(s: DaaSample) -> vec4f { return vec4f(0.5 + 0.5 * s.view, s.depth); }");
    rig.fill(|x, _| Sample { depth: 0.3 + 0.01 * x as f32, ..Default::default() });
    for projection in [directx::orthographic(-1.0, 1.0, -1.0, 1.0, 10.0, 0.1), camera(1.0).clip_from_view] {
        // Up to factors that no determinant in f32 survives.
        let images = [1.0, 2.0, 0.25, 2f32.powi(-40), 2f32.powi(40)].map(|scale| {
            rig.camera.clip_from_view = projection * scale;
            rig.run(full()).image
        });
        assert!(images.iter().all(|image| *image == images[0]), "{projection}");
    }
}

#[test]
fn row_25_positions_are_those_of_f64() {
    let (w, h) = (16, 8);
    let mut rig = Rig::new(
        1,
        w,
        h,
        "fn shade(s: DaaSample) -> vec4f { return vec4f(abs(s.relative_position), s.depth * 1e-9); }",
    );
    let depths = [1.0, 0.5, 1e-3, 1e-6];
    rig.fill(|x, y| Sample { depth: depths[(x + y) as usize % 4], ..Default::default() });
    // Near planes very near and far away, a finite range of eight magnitudes, a thin slice far away, and a slanted
    // projection.
    let mut slanted = directx::perspective_infinite_reverse(1.0, 2.0, 0.1);
    slanted.x_axis.z = 0.03;
    slanted.y_axis.z = -0.02;
    for clip_from_view in [
        directx::perspective_infinite_reverse(1.0, 2.0, 1e-6),
        directx::perspective_infinite_reverse(3e-4, 2.0, 1e3),
        directx::perspective(1.0, 2.0, 1e6, 0.01),
        directx::perspective(1.0, 2.0, 1000.1, 1000.0),
        slanted,
    ] {
        rig.camera.clip_from_view = clip_from_view;
        let output = rig.run(full());
        let view_from_clip = clip_from_view.as_dmat4().inverse();
        for (i, pixel) in output.image.iter().enumerate() {
            let (x, y) = (i % w as usize, i / w as usize);
            let ndc = [(x as f64 + 0.5) / 8.0 - 1.0, 1.0 - (y as f64 + 0.5) / 4.0];
            let p = view_from_clip * DVec4::new(ndc[0], ndc[1], f64::from(depths[(x + y) % 4]), 1.0);
            let (expected, found) = ((p.truncate() / p.w).abs(), Vec3::from_slice(pixel).as_dvec3());
            let apart = (found - expected).length() / expected.length();
            assert!(apart < 1e-5, "{clip_from_view}, {x}, {y}: {found}, {expected}, {apart:e}");
        }
    }
    // The inverse of a near plane this near is beyond f32.
    rig.camera.clip_from_view = directx::perspective_infinite_reverse(1.0, 2.0, 1e-39);
    assert_eq!(rig.try_record(full()).map(|_| ()), Err(RecordError::Camera("projection")));
}

#[test]
fn row_25_projections_that_no_sample_survives_are_refused() {
    use deferred_aa::glam::camera::lh::proj::directx as left;
    let mut rig = Rig::new(2, 5, 3, SHOW_GEOMETRY);
    rig.fill(land);
    let good = rig.camera;
    let refused = |rig: &mut Rig, clip_from_view| {
        rig.camera.clip_from_view = clip_from_view;
        rig.try_record(Settings::default()).map(|_| ())
    };
    for clip_from_view in [
        left::perspective_infinite_reverse(1.0, 2.0, 0.1),
        good.clip_from_view * -1.0,
        left::perspective(1.0, 2.0, 0.1, 9.0),
    ] {
        assert_eq!(refused(&mut rig, clip_from_view), Err(RecordError::Handedness), "{clip_from_view}");
    }
    for (near, aspect) in [(1e30, 1.0), (2e8, 1.0), (1e10, 1e6), (1e3, 1e6)] {
        let clip_from_view = directx::perspective_infinite_reverse(1.0, aspect, near);
        let found = refused(&mut rig, clip_from_view);
        assert!(matches!(found, Err(RecordError::NearPlane(d)) if d > 1e8), "{near}, {aspect}: {found:?}");
    }
    // Up to there, every depth has a position.
    rig.fill(|x, y| Sample { depth: [1.0, 1e-3, 2e-30, 0.0][(x + y) as usize % 4], ..land(x, y) });
    rig.camera.clip_from_view = directx::perspective_infinite_reverse(1.0, 1.0, 5e7);
    let output = rig.run(full());
    assert!(output.image.iter().flatten().all(|c| c.is_finite()) && output.statistics.not_finite == 0);
}

#[test]
fn row_25_everything_at_the_near_plane_or_far_away_is_finite() {
    let mut rig = Rig::new(3, 8, 4, SHOW_GEOMETRY);
    // Depth 1 is the near plane itself.
    rig.fill(|x, y| Sample { depth: [1.0, 0.999_999_9, 1e-28, 0.0][(x / 3 + y) as usize % 4], ..land(x, y) });
    for near in [1e-6, 0.1, 1e6] {
        for clip_from_view in [
            directx::perspective_infinite_reverse(0.01, 2.0, near),
            directx::perspective_infinite_reverse(3.0, 2.0, near),
            directx::orthographic(-1e3, 1e3, -1e3, 1e3, near * 1e3, near),
        ] {
            for eye in [Vec3::ZERO, Vec3::splat(1e6)] {
                rig.camera = Camera { clip_from_view, world_from_view: Mat4::from_translation(eye) };
                for settings in [full(), single(), Settings::default()] {
                    let output = rig.run(settings);
                    assert!(output.image.iter().flatten().all(|c| c.is_finite()), "{near}, {settings:?}");
                    assert_eq!(output.statistics.not_finite, 0, "{near}, {settings:?}");
                }
            }
        }
    }
}

#[test]
fn row_25_a_camera_inside_geometry_or_beyond_it_still_gives_a_picture() {
    let scene = builtin::builtin("cornell").unwrap();
    let own = scene.default_camera();
    let options = Options { anisotropy: 4, ..Options::new(32, 18, 2) };
    let adapter = deferred_aa_demo::gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).unwrap();
    let descriptor = options.descriptor();
    let gpu = deferred_aa_demo::gpu::Gpu::new(adapter, &descriptor).unwrap();
    let mut host = Host::new(gpu, scene, options).unwrap();
    let at = |eye: Vec3| deferred_aa_demo::scene::Camera { eye, target: eye + Vec3::NEG_Z, ..own };
    let cameras = [
        // In the tall box, in a wall, at the lamp, the near plane through all, all of it behind the near plane.
        at(Vec3::new(-0.36, -0.4, -0.3)),
        at(Vec3::new(0.0, -1.0, 0.0)),
        at(Vec3::new(0.0, 0.8, 0.0)),
        deferred_aa_demo::scene::Camera { near: 3.5, ..own },
        deferred_aa_demo::scene::Camera { near: 1e4, ..own },
        deferred_aa_demo::scene::Camera { lens: Lens::Perspective { fov_y: 3.1 }, ..own },
        deferred_aa_demo::scene::Camera { lens: Lens::Orthographic { half_height: 1e-6, far: 9.0 }, ..own },
    ];
    for camera in cameras {
        for technique in [Technique::Full, Technique::Single, Technique::Windowed] {
            let shot = host.frame(&camera, Settings { technique, ..Default::default() }).unwrap();
            assert_eq!(shot.statistics.not_finite, 0, "{camera:?}");
            assert!(host.picture().rgba.iter().flatten().all(|c| c.is_finite()), "{camera:?}");
        }
    }
    let nothing = [Lens::Orthographic { half_height: 0.0, far: 9.0 }, Lens::Perspective { fov_y: 0.0 }];
    for lens in nothing {
        let result = host.frame(&deferred_aa_demo::scene::Camera { lens, ..own }, Settings::default());
        assert!(matches!(result, Err(HostError::Record(RecordError::Camera(_)))), "{lens:?}: {result:?}");
    }
    host.frame(&own, Settings::default()).unwrap();
}
