//! Depth at the output's size: against the twin, in bands, in a rectangle of a larger texture, and what the host may
//! get wrong.

use crate::harness::{Rig, SHOW_USER, Sample, WHITE, fill, noise, rgba8, target};
use crate::visibility::{self, adapter, has_ids};
use bytemuck::pod_collect_to_vec;
use deferred_aa::gbuffer::DEPTH_FORMAT;
use deferred_aa::reference::depth::depth;
use deferred_aa::{
    DebugView, DeferredAa, Depth, Frame, Needs, Part, PassKind, RecordError, Rect, Resource, Settings, SizeError,
    Technique, sample_order, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use deferred_aa_demo::host::{Host, gbuffer_tier, stored};
use deferred_aa_demo::scene::builtin::builtin;
use insta::assert_snapshot;

const CHOICES: [Depth; 3] = [Depth::Nearest, Depth::Farthest, Depth::First];

/// What the depth texture holds before a frame.
const BEFORE: f32 = 0.625;

/// Surfaces at all depths, sky, and what is no depth.
fn busy(x: u32, y: u32) -> Sample {
    let random = noise(x * 7919 + y);
    let depth = match (random * 64.0) as u32 {
        0 => 0.0,
        1 => 1.0,
        2 => f32::NAN,
        3 => 7.0,
        4 => -0.5,
        _ if (x / 16 + y / 16).is_multiple_of(3) => 0.0,
        _ => noise(x * 104_729 + y),
    };
    Sample { depth, user: rgba8(random, 0.5, 1.0, 1.0), object: 1 + (x / 9 + y / 7) % 3, ..Default::default() }
}

fn needs(choice: Depth) -> Needs<'static> {
    Needs { depth: Some(choice), ..Default::default() }
}

/// A depth texture that holds [`BEFORE`].
fn texture(gpu: &Gpu, size: [u32; 2]) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = target(gpu, DEPTH_FORMAT, size);
    let view = texture.create_view(&Default::default());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(BEFORE), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    }));
    gpu.queue.submit([encoder.finish()]);
    (texture, view)
}

fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<u32> {
    pod_collect_to_vec(&gpu.read_texture(texture, 4))
}

/// The twin's depth of an image, from that of its G-buffer.
fn twin(samples: &[f32], [width, height]: [u32; 2], m: u32, settings: &Settings, choice: Depth) -> Vec<u32> {
    let (x, y) = sample_order(settings, m)[0];
    let first = usize::from(y) * m as usize + usize::from(x);
    let window = |pixel: u32| {
        let (left, top) = (pixel % width * m, pixel / width * m);
        let at = |i: u32| samples[((top + i / m) * width * m + left + i % m) as usize];
        (0..m * m).map(at).collect::<Vec<_>>()
    };
    (0..width * height).map(|pixel| depth(&window(pixel), first, choice).to_bits()).collect()
}

fn gbuffer_depth(gpu: &Gpu, aa: &DeferredAa) -> Vec<f32> {
    pod_collect_to_vec(&gpu.read_texture(aa.gbuffer().expect("a size").depth.texture(), 4))
}

/// A frame of a rig that also writes depth.
fn run(rig: &mut Rig, settings: Settings, choice: Depth, view: &wgpu::TextureView) -> Result<(), RecordError> {
    let image = target(&rig.gpu, wgpu::TextureFormat::Rgba32Float, rig.size).create_view(&Default::default());
    let frame = Frame { settings, needs: needs(choice), depth: Some(view), ..Frame::new(rig.camera, &image) };
    let mut encoder = rig.gpu.device.create_command_encoder(&Default::default());
    rig.aa.record(&rig.gpu.queue, &mut encoder, &frame)?;
    rig.gpu.queue.submit([encoder.finish()]);
    Ok(())
}

/// A frame of the demo's host that also writes depth. Returns the depth, and that of the G-buffer.
fn run_host(host: &mut Host, settings: Settings, choice: Depth) -> (Vec<u32>, Vec<f32>) {
    let (texture, view) = texture(&host.gpu, [host.options.width, host.options.height]);
    let camera = host.scene.default_camera();
    host.frame_by(&camera, settings, |aa, queue, encoder, frame| {
        let needs = Needs { depth: Some(choice), ..frame.needs };
        aa.record(queue, encoder, &Frame { needs, depth: Some(&view), ..*frame })
    })
    .expect("a frame");
    assert_eq!(host.gpu.take_errors(), Vec::<String>::new());
    (read(&host.gpu, &texture), host.depths())
}

#[test]
fn depth_is_the_twins_for_every_window_size() {
    for m in [1, 2, 3, 4, 8] {
        let size = [37, 23];
        let mut rig = Rig::new(m, size[0], size[1], WHITE);
        rig.fill(busy);
        let samples = gbuffer_depth(&rig.gpu, &rig.aa);
        let mut seen = Vec::new();
        for choice in CHOICES {
            let (texture, view) = texture(&rig.gpu, size);
            run(&mut rig, Settings::default(), choice, &view).expect("a frame");
            let found = read(&rig.gpu, &texture);
            assert_eq!(found, twin(&samples, size, m, &Settings::default(), choice), "{choice:?} at m = {m}");
            assert!(found.iter().all(|&bits| (0.0..=1.0).contains(&f32::from_bits(bits))), "{choice:?} at m = {m}");
            seen.push(found);
        }
        if m == 1 {
            // A host may give its G-buffer's depth to what comes after, and so sees no difference.
            let sound = |d: f32| if d > 0.0 { d.min(1.0) } else { 0.0 };
            let own: Vec<u32> = samples.iter().map(|&d| sound(d).to_bits()).collect();
            assert!(seen.iter().all(|depth| *depth == own));
        } else {
            assert!(seen[0] != seen[1] && seen[1] != seen[2] && seen[2] != seen[0], "m = {m}");
        }
        assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
    }
}

/// On both tiers and for every technique, whose first samples may differ.
#[test]
fn depth_is_the_twins_on_both_tiers_for_every_technique() {
    let tiers: &[bool] = if has_ids() { &[false, true] } else { &[false] };
    for &visible in tiers {
        let scene = builtin("fence").expect("a scene");
        let tier = if visible { gbuffer_tier(&scene, &adapter()) } else { stored(&scene) };
        let size = [61, 47];
        let mut host = visibility::host(scene, 3, size, tier);
        for technique in Technique::ALL {
            let settings = Settings { technique, ..Default::default() };
            for choice in CHOICES {
                let (found, samples) = run_host(&mut host, settings, choice);
                assert!(found == twin(&samples, size, 3, &settings, choice), "{technique:?} {choice:?} {tier:?}");
            }
        }
    }
}

/// Neither the image nor what is counted of it changes, nor the memory of the node.
#[test]
fn the_image_is_the_same_with_depth() {
    let mut host = visibility::host(builtin("mirrors").expect("a scene"), 2, [45, 31], Default::default());
    let camera = host.scene.default_camera();
    for technique in Technique::ALL {
        for view in [DebugView::Image, DebugView::Count] {
            let settings = Settings { technique, view, ..Default::default() };
            let without = host.frame(&camera, settings).expect("a frame").statistics;
            let (image, memory) = (host.picture().rgba, host.aa.memory());
            run_host(&mut host, settings, Depth::Farthest);
            let with = host.aa.statistics().expect("statistics").clone();
            assert!(host.picture().rgba == image, "{technique:?} {view:?}");
            assert_eq!(host.aa.memory(), memory);
            assert_eq!((with.shaded, &with.histogram_k), (without.shaded, &without.histogram_k));
            let [with, without] = [with, without].map(|s| s.passes.into_iter().map(|p| p.kind).collect::<Vec<_>>());
            assert_eq!(with, [&without[..], &[PassKind::Depth]].concat());
        }
    }
}

#[test]
fn the_depth_of_bands_in_a_rectangle_is_that_of_the_whole() {
    let (size, settings) = ([37, 53], Settings::default());
    let mut rig = Rig::new(2, size[0], size[1], SHOW_USER);
    let device = rig.gpu.device.clone();
    for choice in CHOICES {
        rig.aa.resize(&device, size[0], size[1]).expect("a size");
        rig.fill(busy);
        let (whole, view) = texture(&rig.gpu, size);
        run(&mut rig, settings, choice, &view).expect("a frame");
        let whole = read(&rig.gpu, &whole);
        let of = (size[0], size[1]);
        let Err(SizeError::Limit { least, .. }) = rig.aa.resize_banded(&device, of, 0, &settings, &needs(choice))
        else {
            panic!("no limit")
        };
        for (limit, place) in [(least, None), (u64::MAX, Some([27, 19])), (least, Some([5, 11]))] {
            let all = if place.is_some() { [80, 80] } else { size };
            let [left, top] = place.unwrap_or_default();
            let viewport = place.map(|[x, y]| Rect { x, y, width: size[0], height: size[1] });
            let image = target(&rig.gpu, wgpu::TextureFormat::Rgba32Float, all).create_view(&Default::default());
            let (texture, view) = texture(&rig.gpu, all);
            let bands = rig.aa.resize_banded(&device, of, limit, &settings, &needs(choice)).expect("bands");
            assert_eq!(bands.len() > 1, limit == least);
            for band in bands {
                let [x0, y0] = [band.raster.x * 2, band.raster.y * 2];
                fill(&rig.gpu, rig.aa.gbuffer().expect("a size"), |x, y| busy(x0 + x, y0 + y));
                let (needs, band, depth) = (needs(choice), Some(band), Some(&view));
                let frame = Frame { settings, needs, viewport, band, depth, ..Frame::new(rig.camera, &image) };
                let mut encoder = device.create_command_encoder(&Default::default());
                rig.aa.record(&rig.gpu.queue, &mut encoder, &frame).expect("a frame");
                rig.gpu.queue.submit([encoder.finish()]);
            }
            for (i, found) in (0..).zip(read(&rig.gpu, &texture)) {
                let (x, y) = (i % all[0], i / all[0]);
                let inside = (left..left + size[0]).contains(&x) && (top..top + size[1]).contains(&y);
                let at = || whole[((y - top) * size[0] + x - left) as usize];
                let expected = if inside { at() } else { BEFORE.to_bits() };
                assert_eq!(found, expected, "{choice:?} {place:?} {limit}: {x}, {y}");
            }
        }
    }
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}

#[test]
fn depth_is_a_pass_that_a_graph_sees() {
    let mut rig = Rig::new(2, 37, 23, WHITE);
    rig.fill(busy);
    let settings = Settings::default();
    let (without, with) = (Needs::default(), needs(Depth::Nearest));
    let plain: Vec<_> = DeferredAa::passes(&settings, &without).map(|pass| pass.info).collect();
    let passes: Vec<_> = DeferredAa::passes(&settings, &with).collect();
    assert!(passes[..plain.len()].iter().map(|pass| pass.info).eq(plain.iter().copied()));
    let [own] = passes[plain.len()..] else { panic!("one more") };
    assert_eq!((own.info.name, own.info.kind), ("depth", PassKind::Depth));
    assert!(own.info.reads.iter().eq([Resource::GBuffer]) && own.info.writes.iter().eq([Resource::Depth]));
    let has = |rig: &Rig, needs| rig.aa.parts(&settings, needs).iter().any(|info| info.part == Part::Depth);
    assert!(has(&rig, &with) && !has(&rig, &without));

    rig.aa.warm_up(&settings, &without).expect("pipelines");
    assert!(rig.aa.is_ready(&settings, &without) && !rig.aa.is_ready(&settings, &with));
    rig.aa.warm_up(&settings, &with).expect("pipelines");
    assert!(rig.aa.is_ready(&settings, &with));

    // A graph may record it before all others.
    let (texture, view) = texture(&rig.gpu, rig.size);
    let image = target(&rig.gpu, wgpu::TextureFormat::Rgba32Float, rig.size).create_view(&Default::default());
    let frame = Frame { settings, needs: with, depth: Some(&view), ..Frame::new(rig.camera, &image) };
    let mut encoder = rig.gpu.device.create_command_encoder(&Default::default());
    let recording = rig.aa.begin(&rig.gpu.queue, &mut encoder, &frame).expect("a frame");
    for pass in passes.iter().rev().take(1).chain(&passes[..passes.len() - 1]) {
        recording.record(&mut encoder, *pass).expect("a pass");
    }
    recording.finish(&rig.gpu.queue, &mut encoder);
    rig.gpu.queue.submit([encoder.finish()]);
    let samples = gbuffer_depth(&rig.gpu, &rig.aa);
    assert_eq!(read(&rig.gpu, &texture), twin(&samples, rig.size, 2, &settings, Depth::Nearest));
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}

#[test]
fn a_depth_view_that_does_not_fit_is_refused() {
    let mut rig = Rig::new(2, 37, 23, WHITE);
    rig.fill(busy);
    let device = rig.gpu.device.clone();
    let view = |format, [width, height]: [u32; 2], sample_count, mip_level_count, usage| {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("depth"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count,
            sample_count,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let level = wgpu::TextureViewDescriptor { base_mip_level: mip_level_count - 1, ..Default::default() };
        texture.create_view(&level)
    };
    let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
    let refused = |rig: &mut Rig, view| {
        let e = run(rig, Settings::default(), Depth::Nearest, &view).expect_err("a view that does not fit");
        e.to_string()
    };
    let small = view(DEPTH_FORMAT, [37, 22], 1, 1, drawn);
    assert_snapshot!(refused(&mut rig, small), @"the depth texture is 37×22, the target 37×23; create it with the target's size");
    let plain = view(wgpu::TextureFormat::Depth24Plus, [37, 23], 1, 1, drawn);
    assert_snapshot!(refused(&mut rig, plain), @"the depth texture is Depth24Plus, the node writes Depth32Float; create it with gbuffer::DEPTH_FORMAT");
    let many = view(DEPTH_FORMAT, [37, 23], 4, 1, drawn);
    assert_snapshot!(refused(&mut rig, many), @"the depth texture has 4 samples a pixel, the node writes one; render into a texture with sample_count = 1");
    let sampled = view(DEPTH_FORMAT, [37, 23], 1, 1, wgpu::TextureUsages::TEXTURE_BINDING);
    assert_snapshot!(refused(&mut rig, sampled), @"the depth texture can't be rendered to; create it with TextureUsages::RENDER_ATTACHMENT");
    // A level of the right size is accepted.
    let level = view(DEPTH_FORMAT, [74, 46], 1, 2, drawn);
    run(&mut rig, Settings::default(), Depth::Nearest, &level).expect("a frame");

    let image = target(&rig.gpu, wgpu::TextureFormat::Rgba32Float, [64, 64]).create_view(&Default::default());
    let mut record = |needs, depth, viewport| {
        let frame = Frame { needs, depth, viewport, ..Frame::new(rig.camera, &image) };
        let mut encoder = device.create_command_encoder(&Default::default());
        rig.aa.record(&rig.gpu.queue, &mut encoder, &frame)
    };
    let viewport = Some(Rect { x: 3, y: 5, width: 37, height: 23 });
    let sound = view(DEPTH_FORMAT, [64, 64], 1, 1, drawn);
    record(needs(Depth::First), Some(&sound), viewport).expect("a frame");
    let e = record(needs(Depth::First), None, viewport).expect_err("no view");
    assert_snapshot!(e, @"Needs::depth asks for depth, but the frame has no view for it; set Frame::depth");
    let e = record(Needs::default(), Some(&sound), viewport).expect_err("no choice");
    assert_snapshot!(e, @"Frame::depth has a view, but nothing is written to it; set Needs::depth to say which depth");
    let of_the_node = view(DEPTH_FORMAT, [37, 23], 1, 1, drawn);
    let e = record(needs(Depth::First), Some(&of_the_node), viewport).expect_err("another size than the target");
    assert_snapshot!(e, @"the depth texture is 37×23, the target 64×64; create it with the target's size");
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}
