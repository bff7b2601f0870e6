use super::*;
use crate::host::raster::node_camera;
use crate::host::{Host, Options};
use crate::measure::quality;
use crate::measure::temporal::{self, Motion};
use crate::peers::display;
use crate::peers::tests::{gpu, grey, texture};
use crate::scene::builtin::builtin;
use deferred_aa::gbuffer::DEPTH_FORMAT;
use deferred_aa::{Settings, Technique};

const SIZE: (u32, u32) = (96, 54);

/// A scene at one sample a pixel, and TAA over it.
struct Run {
    host: Host,
    taa: Taa,
}

impl Run {
    fn new(scene: &str) -> Self {
        Self::at(scene, 1)
    }

    fn at(scene: &str, m: u32) -> Self {
        let options = Options::new(SIZE.0, SIZE.1, m);
        let gpu = Gpu::new(crate::host::gpu::choose(None).unwrap(), &options.descriptor()).unwrap();
        let host = Host::new(gpu, builtin(scene).unwrap(), options).unwrap();
        let taa = Taa::new(&host.gpu, SIZE.0, SIZE.1, m).unwrap();
        Self { host, taa }
    }

    fn still(&self) -> Camera {
        node_camera(&self.host.scene.default_camera(), SIZE.0, SIZE.1)
    }

    /// The same view turned by this many frames of a slow turn.
    fn turned(&self, frame: u32) -> Camera {
        temporal::camera(Motion::Turn, &self.host.scene.default_camera(), frame, SIZE.0, SIZE.1)
    }

    fn frame(&mut self, camera: Camera) -> Picture {
        let settings = Settings { technique: Technique::Single, ..Default::default() };
        self.host.frame_with(self.taa.jittered(camera), settings).unwrap();
        let depth = &self.host.aa.gbuffer().unwrap().depth;
        let shot = self.taa.run(self.host.target(), depth, camera).unwrap();
        assert!(shot.milliseconds.is_none_or(|ms| ms > 0.0), "{shot:?}");
        self.taa.picture()
    }

    fn frames(&mut self, camera: Camera, count: u32) -> Picture {
        (1..count).for_each(|_| drop(self.frame(camera)));
        self.frame(camera)
    }

    /// The mean of the frames of all phases.
    fn mean(&mut self, camera: Camera) -> Picture {
        let mut sum = vec![[0.0; 4]; (SIZE.0 * SIZE.1) as usize];
        self.taa.cut();
        for _ in 0..PHASES {
            self.frame(camera);
            for (sum, c) in sum.iter_mut().zip(self.host.picture().rgba) {
                (0..4).for_each(|i| sum[i] += c[i] / PHASES as f32);
            }
        }
        Picture::new(SIZE.0, SIZE.1, sum).unwrap()
    }
}

#[test]
fn jitter_stays_in_the_pixel_and_fills_it() {
    let all: Vec<_> = (0..PHASES).map(jitter).collect();
    assert!(all.iter().all(|j| j.abs().max_element() <= 0.5), "{all:?}");
    let mean = all.iter().copied().sum::<Vec2>() / PHASES as f32;
    assert!(mean.length() < 0.06, "{mean}");
    // One in each half, quarter and eighth, as base 2 has them.
    let mut columns: Vec<_> = all.iter().map(|j| ((j.x + 0.5) * PHASES as f32) as u32).collect();
    columns.sort_unstable();
    assert_eq!(columns, (0..PHASES).collect::<Vec<_>>());
}

#[test]
fn a_still_camera_comes_near_to_the_mean_of_its_frames() {
    let mut run = Run::new("fence");
    let camera = run.still();
    let mean = run.mean(camera);
    run.taa.cut();
    let first = run.frame(camera);
    let last = run.frames(camera, 31);
    let [before, after] = [first, last].map(|picture| quality::psnr(&picture, &mean).unwrap());
    println!("{before:.2} dB after one frame, {after:.2} dB after 32");
    assert!(after > 30.0 && after > before + 6.0, "{before} dB, then {after} dB");
}

/// A finer G-buffer, of which one sample a pixel is shaded, gives the frames that one of a sample a pixel gives.
#[test]
fn a_finer_gbuffer_changes_nothing() {
    let mut coarse = false;
    let shown = [1, 2, 4].map(|m| {
        let mut run = Run::at("fence", m);
        coarse = run.host.gpu.least_ray_bias() > 0.0;
        (0..8).for_each(|frame| drop(run.frame(run.turned(16 * frame))));
        run.frame(run.turned(16 * 8))
    });
    for (m, fine) in [(2, &shown[1]), (4, &shown[2])] {
        let db = quality::psnr(fine, &shown[0]).unwrap();
        println!("m = {m}: {db:.2} dB");
        // SwiftShader's corners lie on a sixteenth of a sample, which is a finer grid the more samples there are.
        assert!(db > if coarse { 34.0 } else { 45.0 }, "m = {m}: {db} dB");
    }
}

#[test]
fn what_moves_is_read_where_it_was() {
    let mut run = Run::new("fence");
    // A pixel a frame.
    for frame in 0..16 {
        run.frame(run.turned(16 * frame));
    }
    let (before, now) = (run.turned(16 * 15), run.turned(16 * 16));
    let moved = run.frame(now);
    let mean = run.mean(now);
    // The same frames for a TAA that takes the camera to be still.
    let mut stuck = Run::new("fence");
    for frame in 0..=16 {
        let camera = stuck.turned(16 * frame);
        let settings = Settings { technique: Technique::Single, ..Default::default() };
        stuck.host.frame_with(stuck.taa.jittered(camera), settings).unwrap();
        let depth = &stuck.host.aa.gbuffer().unwrap().depth;
        stuck.taa.run(stuck.host.target(), depth, now).unwrap();
    }
    let [right, wrong] = [moved, stuck.taa.picture()].map(|picture| quality::psnr(&picture, &mean).unwrap());
    println!("{right:.2} dB with the motion, {wrong:.2} dB without");
    assert_ne!(before, now);
    assert!(right > wrong + 1.0, "{right} dB with the motion, {wrong} dB without");
}

#[test]
fn a_point_is_found_where_the_camera_before_saw_it() {
    let run = Run::new("fence");
    let view = run.host.scene.default_camera();
    let [before, now] = [1, 0].map(|left| temporal::uncovering(&view, left, SIZE.0, SIZE.1));
    let seen = |camera: &Camera, at: glam::Vec3| {
        let clip = camera.clip_from_view * camera.world_from_view.inverse() * at.extend(1.0);
        clip / clip.w
    };
    for at in [view.target, view.target + 0.3 * (view.target - view.eye), glam::Vec3::new(0.5, 0.2, -0.4)] {
        let clip = before_from_now(&before, &now) * seen(&now, at);
        let apart = (clip / clip.w - seen(&before, at)).truncate().truncate();
        assert!(apart.length() < 1e-4, "{at}: {apart}");
    }
}

#[test]
fn a_still_camera_moves_nothing() {
    let run = Run::new("cornell");
    let apart = before_from_now(&run.still(), &run.still()) - Mat4::IDENTITY;
    assert!(apart.to_cols_array().into_iter().all(|x| x.abs() < 1e-12), "{apart}");
}

#[test]
fn the_same_frames_twice_are_the_same_bits() {
    let mut run = Run::new("fence");
    let mut shoot = || {
        run.taa.cut();
        (0..6).map(|frame| run.frame(run.turned(8 * frame)).to_srgb8()).collect::<Vec<_>>()
    };
    assert!(shoot() == shoot());
}

#[test]
fn after_a_cut_nothing_is_left_of_what_was() {
    let mut run = Run::new("fence");
    let camera = run.still();
    let fresh = run.frame(camera).to_srgb8();
    (0..5).for_each(|frame| drop(run.frame(run.turned(500 + frame))));
    run.taa.cut();
    assert!(run.frame(camera).to_srgb8() == fresh);
}

/// Depth of one value for images that were not rendered.
fn depth(gpu: &Gpu, width: u32, height: u32) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH_FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

fn camera() -> Camera {
    node_camera(&builtin("flat").unwrap().default_camera(), 16, 9)
}

/// The size of images that were not rendered.
const MADE: (u32, u32) = (16, 9);

/// Takes in pictures one after another, all from one place, and gives what is shown.
fn made_frames() -> impl FnMut(&dyn Fn(u32, u32) -> [f32; 3]) -> Vec<[u8; 3]> {
    let gpu = gpu();
    let (width, height) = MADE;
    let mut taa = Taa::new(&gpu, width, height, 1).unwrap();
    let depth = depth(&gpu, width, height);
    move |picture| {
        taa.run(&texture(&gpu, width, height, picture), &depth, camera()).unwrap();
        taa.picture().to_srgb8()
    }
}

#[test]
fn a_history_of_what_is_no_more_is_clipped_away() {
    let mut run = made_frames();
    // Nobody tells of this cut: without the box 0.9 of the first picture would shine through.
    run(&|_, _| [9.0, 0.5, 0.0]);
    let shown = run(&|x, _| grey(if x < 8 { 60 } else { 160 }));
    for (i, shown) in shown.iter().enumerate() {
        let x = i as u32 % MADE.0;
        // Beside the edge the box holds both sides.
        let expected: u8 = if x < 8 { 60 } else { 160 };
        assert!((7..=8).contains(&x) || shown.iter().all(|c| c.abs_diff(expected) <= 1), "{x}: {shown:?}");
        assert!(shown.iter().all(|c| (55..=165).contains(c)), "{x}: {shown:?}");
    }
}

#[test]
fn what_is_not_finite_does_not_stay() {
    let mut run = made_frames();
    let lost = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for hole in [&|x, y| if (x, y) == (7, 4) { lost } else { grey(90) }, &|_, _| lost] as [&dyn Fn(u32, u32) -> _; 2] {
        assert!(run(hole).iter().all(|&c| c != crate::picture::NOT_FINITE));
    }
    let shown = run(&|_, _| grey(90));
    assert!(shown.iter().flatten().all(|c| c.abs_diff(90) <= 1), "{shown:?}");
    // The greatest that the target holds, beside black.
    let bright = |_: u32, y: u32| if y.is_multiple_of(2) { [65504.0; 3] } else { [0.0; 3] };
    (0..8).for_each(|_| drop(run(&bright)));
    let shown = run(&|_, _| [display::radiance(200), 0.0, 0.0]);
    assert!(shown.iter().all(|c| c[0].abs_diff(200) <= 1 && c[1] <= 1 && c[2] <= 1), "{shown:?}");
}

#[test]
fn an_image_of_another_size_is_refused() {
    let gpu = gpu();
    let mut taa = Taa::new(&gpu, 16, 9, 1).unwrap();
    let (image, small) = (texture(&gpu, 16, 9, |_, _| grey(9)), depth(&gpu, 9, 16));
    let refused = taa.run(&image, &small, camera()).unwrap_err().to_string();
    assert!(refused.contains("taa") && refused.contains("9x16") && refused.contains("16x9"), "{refused}");
}
