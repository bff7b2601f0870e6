//! Several views a frame: nodes beside each other, and one node for all, by G-buffers that a host lends it or renders
//! anew.

use crate::harness::{self, SHOW_USER, Sample, fill, noise, rgba8};
use deferred_aa::glam::{Mat4, Vec2, Vec3};
use deferred_aa::{
    DeferredAa, Descriptor, Frame, GBuffer, GBufferTier, LendError, Lent, Part, Physical, Settings, Shading, Technique,
    gbuffer, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use wgpu::TextureUsages as Usage;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const COLOR: [Part; 3] = [Part::GBufferSurface, Part::GBufferFrame, Part::GBufferUv];

fn node(gpu: &Gpu, m: u32) -> DeferredAa {
    let descriptor = Descriptor { m, ..Descriptor::new(FORMAT, Shading { source: SHOW_USER, file: "test.wgsl" }) };
    DeferredAa::new(&gpu.device, &descriptor, None).expect("a node")
}

fn texture(gpu: &Gpu, format: wgpu::TextureFormat, [width, height]: [u32; 2], usage: Usage) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("host"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A view of a frame: its G-buffer, in textures of the host's own, and its target.
struct View {
    size: [u32; 2],
    frame: Settings,
    eye: f32,
    gbuffer: GBuffer,
    target: wgpu::Texture,
    target_view: wgpu::TextureView,
}

impl View {
    fn new(gpu: &Gpu, m: u32, size: [u32; 2], seed: u32, technique: Technique) -> Self {
        let usage = Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC | Usage::COPY_DST;
        let made = |format| texture(gpu, format, size.map(|side| side * m), usage).create_view(&Default::default());
        let gbuffer = GBuffer {
            width: size[0] * m,
            height: size[1] * m,
            color: GBufferTier::default().color_formats().into_iter().map(made).collect(),
            depth: made(gbuffer::DEPTH_FORMAT),
        };
        fill(gpu, &gbuffer, |x, y| {
            let object = seed + 1 + x / 9 + y / 7 * 11;
            Sample {
                depth: 0.02 + noise(object) * 0.2,
                normal: Vec3::new(noise(object + 5) - 0.5, 0.2, 1.0).normalize(),
                uv: Vec2::new(x as f32, y as f32) * 0.01,
                object,
                user: rgba8(noise(object * 3), noise(object * 5), noise(x / 3 + y * 977 + seed), 1.0),
                ..Default::default()
            }
        });
        let target = texture(gpu, FORMAT, size, Usage::RENDER_ATTACHMENT | Usage::COPY_SRC);
        let target_view = target.create_view(&Default::default());
        let frame = Settings { technique, ..Default::default() };
        Self { size, frame, eye: seed as f32, gbuffer, target, target_view }
    }

    fn record(&self, gpu: &Gpu, aa: &mut DeferredAa, encoder: &mut wgpu::CommandEncoder) {
        let mut camera = harness::camera(self.size[0] as f32 / self.size[1] as f32);
        camera.world_from_view = Mat4::from_translation(Vec3::splat(self.eye));
        let frame = Frame { settings: self.frame, ..Frame::new(camera, &self.target_view) };
        aa.record(&gpu.queue, encoder, &frame).expect("a frame");
    }

    /// The node renders this view next.
    fn lend(&self, gpu: &Gpu, aa: &mut DeferredAa) {
        aa.resize(&gpu.device, self.size[0], self.size[1]).expect("a size");
        let color = COLOR.into_iter().zip(&self.gbuffer.color);
        let lent: Vec<_> = color
            .chain([(Part::GBufferDepth, &self.gbuffer.depth)])
            .map(|(part, view)| Lent { part, memory: Physical::Texture(view.texture()) })
            .collect();
        aa.lend(&gpu.device, &lent).expect("a G-buffer");
        assert_eq!(aa.memory().gbuffer, 0);
    }

    /// As a host's raster pass would, in the middle of an encoder.
    fn render(&self, encoder: &mut wgpu::CommandEncoder, into: &GBuffer) {
        let views = self.gbuffer.color.iter().chain([&self.gbuffer.depth]);
        for (from, to) in views.zip(into.color.iter().chain([&into.depth])) {
            let (from, to) = (from.texture(), to.texture());
            encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), from.size());
        }
    }

    fn image(&self, gpu: &Gpu) -> Vec<u8> {
        gpu.read_texture(&self.target, 8)
    }

    /// By a node of its own, in a submit of its own.
    fn alone(&self, gpu: &Gpu, m: u32) -> Vec<u8> {
        let mut aa = node(gpu, m);
        self.lend(gpu, &mut aa);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.record(gpu, &mut aa, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let image = self.image(gpu);
        self.clear(gpu);
        image
    }

    fn clear(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.target_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::RED), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        gpu.queue.submit([encoder.finish()]);
    }
}

const SIZES: [[u32; 2]; 3] = [[33, 21], [33, 21], [18, 40]];
const TECHNIQUES: [Technique; 3] = [Technique::Windowed, Technique::Selective, Technique::MultiResolution];

fn views(gpu: &Gpu, m: [u32; 3]) -> Vec<View> {
    (0..3).map(|i| View::new(gpu, m[i], SIZES[i], i as u32 * 40, TECHNIQUES[i])).collect()
}

fn check(gpu: &Gpu, views: &[View], alone: &[Vec<u8>]) {
    for (i, (view, alone)) in views.iter().zip(alone).enumerate() {
        assert!(view.image(gpu) == *alone, "view {i}");
    }
    assert!(alone[0] != alone[1], "views differ");
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

/// Split screen: nodes of other sizes and windows on one device, in one encoder.
#[test]
fn nodes_beside_each_other_make_the_images_that_they_make_alone() {
    let gpu = harness::device(deferred_aa::TextureTier::None);
    let m = [2, 3, 4];
    let views = views(&gpu, m);
    let alone: Vec<_> = views.iter().zip(m).map(|(view, m)| view.alone(&gpu, m)).collect();
    let mut nodes = m.map(|m| node(&gpu, m));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for (view, aa) in views.iter().zip(&mut nodes) {
        view.lend(&gpu, aa);
        view.record(&gpu, aa, &mut encoder);
    }
    gpu.queue.submit([encoder.finish()]);
    check(&gpu, &views, &alone);
}

/// One node, all views in one encoder: resized and lent each view's G-buffer.
#[test]
fn one_node_goes_from_view_to_view() {
    let gpu = harness::device(deferred_aa::TextureTier::None);
    let views = views(&gpu, [3; 3]);
    let alone: Vec<_> = views.iter().map(|view| view.alone(&gpu, 3)).collect();
    let mut aa = node(&gpu, 3);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for view in &views {
        view.lend(&gpu, &mut aa);
        view.record(&gpu, &mut aa, &mut encoder);
    }
    gpu.queue.submit([encoder.finish()]);
    check(&gpu, &views, &alone);
}

/// One node, one G-buffer, two views of it one after the other in one encoder, as two eyes would be.
#[test]
fn a_gbuffer_is_rendered_anew_between_two_views() {
    let gpu = harness::device(deferred_aa::TextureTier::None);
    let views = &views(&gpu, [3; 3])[..2];
    let alone: Vec<_> = views.iter().map(|view| view.alone(&gpu, 3)).collect();
    let shared = View::new(&gpu, 3, SIZES[0], 99, Technique::Full);
    let mut aa = node(&gpu, 3);
    shared.lend(&gpu, &mut aa);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for view in views {
        view.render(&mut encoder, aa.gbuffer().expect("a size"));
        view.record(&gpu, &mut aa, &mut encoder);
    }
    gpu.queue.submit([encoder.finish()]);
    check(&gpu, views, &alone);
}

/// What lend refuses, after which all is as it was.
#[test]
fn lend_refuses_what_can_not_serve() {
    let gpu = harness::device(deferred_aa::TextureTier::None);
    let mut aa = node(&gpu, 2);
    assert_eq!(aa.lend(&gpu.device, &[]), Err(LendError::NoSize));
    aa.resize(&gpu.device, 16, 16).expect("a size");
    let held = aa.memory();
    let image = |format, size, usage| texture(&gpu, format, size, usage);
    let buffer = |size, usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let float = wgpu::TextureFormat::Rgba32Float;
    let usage = Usage::STORAGE_BINDING | Usage::TEXTURE_BINDING;
    let good = image(float, [16, 16], usage);
    let words = buffer(16 * 16 * 4, wgpu::BufferUsages::STORAGE);
    let large = buffer(1 << 16, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT);
    let mut refused = |lent: &[(Part, Physical<'_>)]| {
        let lent: Vec<_> = lent.iter().map(|&(part, memory)| Lent { part, memory }).collect();
        aa.lend(&gpu.device, &lent).expect_err("a refusal")
    };
    use Physical::{Buffer, Texture};
    fn first(texture: &wgpu::Texture) -> [(Part, Physical<'_>); 1] {
        [(Part::First, Texture(texture))]
    }
    assert_eq!(refused(&[(Part::Counters, Buffer(&large))]), LendError::NotLendable(Part::Counters));
    assert_eq!(refused(&[first(&good)[0], first(&good)[0]]), LendError::Twice(Part::First));
    let (part, other) = (Part::Color, Part::First);
    assert_eq!(refused(&[first(&good)[0], (part, Texture(&good))]), LendError::Together { part, other });
    let part = Part::First;
    assert_eq!(refused(&[(part, Buffer(&words))]), LendError::Kind { part, needed: "texture" });
    let (lent, needed) = (wgpu::TextureFormat::Rgba16Float, float);
    assert_eq!(refused(&first(&image(lent, [16, 16], usage))), LendError::Format { part, lent, needed });
    let extent = LendError::Extent { part, width: 16, height: 16 };
    assert_eq!(refused(&first(&image(float, [16, 17], usage))), extent);
    let missing = Usage::STORAGE_BINDING;
    let sampled = image(float, [16, 16], Usage::TEXTURE_BINDING);
    assert_eq!(refused(&first(&sampled)), LendError::TextureUsage { part, missing });
    let part = Part::Plan;
    let small = buffer(16 * 16 * 4 - 4, wgpu::BufferUsages::STORAGE);
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    let bytes = LendError::Bytes { part, lent: 1020, needed: 1040, limit };
    assert_eq!(refused(&[(part, Buffer(&small))]), bytes);
    let missing = wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
    let part = Part::Tiles;
    assert_eq!(refused(&[(part, Buffer(&words))]), LendError::BufferUsage { part, missing });
    let stranger = Gpu::with(gpu.adapter.clone(), wgpu::Features::empty(), wgpu::Limits::default()).expect("a device");
    let strange = texture(&stranger, float, [16, 16], usage);
    assert!(matches!(refused(&first(&strange)), LendError::Refused(_)));
    assert_eq!(aa.memory(), held);
    aa.lend(&gpu.device, &[Lent { part: Part::First, memory: Texture(&good) }]).expect("a loan");
    assert_eq!(aa.memory().scratch, held.scratch - 16 * 16 * 16);
    aa.resize(&gpu.device, 8, 8).expect("a size");
    aa.resize(&gpu.device, 16, 16).expect("a size");
    assert_eq!(aa.memory(), held, "a resize ends loans");
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

/// Memory is what the size says, however often it changes.
#[test]
fn resizing_two_hundred_times_keeps_memory_flat() {
    let gpu = harness::device(deferred_aa::TextureTier::None);
    let mut aa = node(&gpu, 2);
    let views: Vec<_> = SIZES.iter().zip(TECHNIQUES).map(|(&size, t)| View::new(&gpu, 2, size, 7, t)).collect();
    // By label; wgpu's own staging buffers come and go.
    let held = || {
        let report = gpu.device.generate_allocator_report().expect("an allocator");
        let own = report.allocations.iter().filter(|a| a.name.starts_with("daa"));
        own.fold((0, 0), |(count, bytes), a| (count + 1, bytes + a.size))
    };
    let mut run = |i: usize| {
        let view = &views[1 + i % 2];
        aa.resize(&gpu.device, view.size[0], view.size[1]).expect("a size");
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        view.record(&gpu, &mut aa, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait();
        (held(), aa.memory())
    };
    (0..4).for_each(|i| {
        run(i);
    });
    let before = [run(0), run(1)];
    assert_ne!(before[0], before[1]);
    for i in 0..200 {
        let (((count, bytes), memory), ((count_then, bytes_then), memory_then)) = (run(i), before[i % 2]);
        assert_eq!((count, memory), (count_then, memory_then), "resize {i}");
        // Some are aligned otherwise, on SwiftShader by more.
        let aligned = if crate::drivers::is_swiftshader(&gpu) { 8192 } else { 1024 };
        assert!(bytes.abs_diff(bytes_then) < aligned, "resize {i}: {bytes}, {bytes_then} before");
    }
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}
